/* hub.h - receives the frames of all plants of the scope, each with its scene, and serves the browsers. */
#ifndef HOST_SIM_HUB_H
#define HOST_SIM_HUB_H

#include "host_sim/scope/decoder.h"
#include "host_sim/scope/ring.h"

enum { HUB_PLANTS = 8, HUB_OTHERS = 8 };

/* Identifiers of a plant for which there is no scene. */
struct hub_other {
    uint32_t base_id;
    uint64_t messages;
};

/* It must not be moved. All zero before hub_add. */
struct hub {
    struct server server;
    int n_decoders, n_sources;
    struct decoder *decoder[HUB_PLANTS];
    struct source {
        const struct hal *hal;
        struct bus *bus; /* NULL: none, or somebody else's */
    } source[HUB_PLANTS];
    struct ring_reader ring; /* memory NULL: none */
    struct hub_other other[HUB_OTHERS];
    int n_others;
    uint64_t lost;                   /* reports of frames that were lost before they came here */
    double send_s, link_s, timing_s; /* when the next batch is due, and the next lists of these kinds */
    char text[CONNECTION_FIRST];
};

/* Opens the server at ADDRESS:PORT and says on stderr where to look;
 * with --control, where to command. 0, or the exit status after a line. */
int hub_open(struct hub *h, const struct options *o, const char *at);

/* One plant more, of this scene; its name and bus as text. NULL when out of memory. */
struct decoder *hub_add(struct hub *h, const char *name);

/* With --control this plant, the next one, takes commands; see page_send_add. */
void hub_command(struct hub *h, const struct decoder *d, const struct options *o, const char *bus,
                 const char *peer);

/* Receives all that waits, serves the browsers, and waits a few milliseconds. */
void hub_turn(struct hub *h);

/* The last words to the browsers; frees what hub_add made. */
void hub_close(struct hub *h, const char *why);

#endif
