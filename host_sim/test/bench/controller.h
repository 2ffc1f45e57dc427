/* controller.h - the process under test: its command filled in
 * for one run, started, asked to end, its recordings named. */
#ifndef HOST_SIM_CONTROLLER_H
#define HOST_SIM_CONTROLLER_H

#include "host_sim/scene/scene_app.h"
#include "host_sim/test/bench/bench.h"
#include "host_sim/test/bench/child.h"

enum { CONTROLLER_ADDRESS = 64, CONTROLLER_REASON = 512 };

/* Where plant and controller meet. */
struct controller_place {
    char plant[CONTROLLER_ADDRESS], me[CONTROLLER_ADDRESS]; /* HOST:PORT over UDP */
    const char *memory;                                     /* a path (hal/posix/memory.h), or NULL */
    const char *can;                                        /* can:IFACE, or NULL */
    bool lockstep;
};

struct controller {
    struct child child;
    FILE *output; /* where all that it prints goes, or NULL */
};

/* Whether the command asks for the link by memory. */
bool controller_takes_memory(const struct test_file *t);

/* Starts the case's command, with what stands in braces filled in; nothing where the controller connects by
 * itself. False: the result has the error. */
bool controller_start(struct controller *c, const struct bench_setting *s, const struct scene_app *scene,
                      const struct controller_place *at, struct bench_result *r);

/* The end of its process and of all that it left behind, after it was asked. Errors go into the result. */
void controller_end(struct controller *c, struct bench_result *r);

/* True when its process has ended; an error where the case
 * does not say so: `stopped`, it ended its session before. */
bool controller_has_ended(struct controller *c, const struct test_case *k, double plant_s, bool stopped,
                          struct bench_result *r);

/* The error of a plant whose time stands, in this state, before the case is over. */
void controller_explain_stand(const struct test_case *k, const char *state, double plant_s, bool stopped,
                              struct bench_result *r);

/* keep.test, case "bad bus", seed 3: DIR/keep.bad_bus.3END (host_sim/test/record.h) */
void controller_log_path(const struct bench_setting *s, const struct bench_result *r, const char *end,
                         char path[BENCH_PATH]);

/* An error of the bench, which ends the case. `format` has %s for both texts. Always false. */
bool controller_fail(struct bench_result *r, const char *format, const char *a, const char *b);

#endif
