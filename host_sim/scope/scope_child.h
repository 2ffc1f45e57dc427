/* scope_child.h - the scope beside a plant: run --scope. */
#ifndef HOST_SIM_SCOPE_CHILD_H
#define HOST_SIM_SCOPE_CHILD_H

#include <sys/types.h>
#include "firmware/observe/timing.h"
#include "host_sim/cli/options.h"
#include "host_sim/scope/ring.h"

/* --scope and --http of a command that runs a plant. */
extern const struct option scope_options[];

/* --http alone. */
#define SCOPE_HTTP                                                                                           \
    {                                                                                                        \
        "http", "ADDRESS:PORT",                                                                              \
            "where browsers find the scope (127.0.0.1:8080); 0.0.0.0 opens it to others", OPTION_TEXT,       \
            .initial = NULL                                                                                  \
    }
#define SCOPE_AT "127.0.0.1:8080"

/* --control, which demo has not: it plays the controller itself. */
#define SCOPE_CONTROL                                                                                        \
    {                                                                                                        \
        .name = "control", .meaning = "let the page command the plant, with the token that is printed"       \
    }

/* The scope in a process of its own, at a lower priority: the plant's loop shares memory with it and nothing
 * else. All zero: none. */
struct scope_child {
    pid_t pid;
    struct ring *ring;
    struct ring_writer writer;
};

/* Starts it where --scope is given, before the plant opens anything; says where it is. 0, or the exit status
 * after a line on stderr. */
int scope_child_start(struct scope_child *c, const struct options *o);

/* From now on it sees what goes through this hal, which stays the same to its owner. */
void scope_child_attach(struct scope_child *c, struct hal *hal, const struct timing *timing);

/* The plant has ended: browsers are told, and it ends. */
void scope_child_end(struct scope_child *c);

#endif
