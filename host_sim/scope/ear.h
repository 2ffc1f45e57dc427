/* ear.h - the plants that the scope hears, each with its scene, and the loop that tells the browsers. */
#ifndef HOST_SIM_EAR_H
#define HOST_SIM_EAR_H

#include "host_sim/scope/tee.h"
#include "host_sim/scope/voice.h"

enum { EAR_PLANTS = 8, EAR_OTHERS = 8 };

/* Identifiers of a plant for which there is no scene. */
struct ear_other {
    uint32_t base_id;
    uint64_t messages;
};

/* It must not be moved. All zero before ear_add. */
struct ear {
    struct server server;
    int n_voices, n_sources;
    struct voice *voice[EAR_PLANTS];
    struct source {
        const struct hal *hal;
        struct bus *bus; /* NULL: none, or somebody else's */
    } source[EAR_PLANTS];
    struct tee_reader tee; /* memory NULL: none */
    struct ear_other other[EAR_OTHERS];
    int n_others;
    uint64_t lost;                   /* reports of frames that were lost before they came here */
    double tell_s, link_s, timing_s; /* when the next batch is due, and the next lists of these kinds */
    char text[CONNECTION_FIRST];
};

/* Opens the server at ADDRESS:PORT and says on stderr where to look;
 * with --control, where to command. 0, or the exit status after a line. */
int ear_open(struct ear *e, const struct options *o, const char *at);

/* One plant more, of this scene; its name and bus as text. NULL when out of memory. */
struct voice *ear_add(struct ear *e, const char *name);

/* With --control this plant, the next one, takes commands; see control_add. */
void ear_command(struct ear *e, const struct voice *v, const struct options *o, const char *bus,
                 const char *peer);

/* Hears everything that waits, tells the browsers, serves them, and waits a few milliseconds. */
void ear_turn(struct ear *e);

/* The last words to the browsers; frees what ear_add made. */
void ear_close(struct ear *e, const char *why);

#endif
