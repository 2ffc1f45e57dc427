/* plants.h - the plants of one run: that of a scene, or those of a list, which share a bus and a clock.
 *
 * Plant i of a list owns the FRAME_IDS identifiers from --base-id + i * FRAME_IDS on. All memory is allocated
 * before the first frame. */
#ifndef HOST_SIM_PLANTS_H
#define HOST_SIM_PLANTS_H

#include "hal/link/share.h"
#include "host_sim/cli/options.h"
#include "host_sim/scene/scene.h"

enum { PLANTS_MAX = 512, PLANTS_NAME = 256 };

/* The meaning of --plants, for the help. */
#define PLANTS_HELP                                                                                          \
    "--plants FILE names a scene in each line, without SCENE; # begins a comment. Each scene becomes a "     \
    "plant\n"                                                                                                \
    "of its own on the one bus, with the next 64 identifiers; docs/guide/many-plants.md.\n"

struct plants_one {
    struct scene_app scene;
    char name[PLANTS_NAME]; /* as it was given; of one plant alone: empty */
    uint32_t due;           /* frames to run now */
    unsigned faults;        /* ever latched */
};

struct plants {
    int n;
    struct plants_one *one;
    struct share share; /* used by several plants */
    struct share_part *part;
};

/* The plants that the options say, configured; all zero before. 0, or the exit status after a line on stderr.
 * plants_free in any case. */
int plants_read(struct plants *p, const struct options *o);

/* Their apps, ready to run on this bus, which may still be
 * closed. 0, or the exit status after a line on stderr. */
int plants_start(struct plants *p, const struct hal *bus, const struct options *o);

/* Whether frames are due. */
bool plants_due(const struct plants *p);

/* So many periods have begun: each plant has its frame of
 * the last one due now, and by its overrun policy more. */
void plants_begin(struct plants *p, uint32_t begun);

/* Before and after the frames of one wake-up. */
void plants_collect(struct plants *p);
void plants_flush(struct plants *p);

/* How many plants from plant i on, at most SIDES, have their frames together: those that are due and of one
 * model and method. 1 where plant i has none due. */
int plants_together(const struct plants *p, int i);

/* The frames of so many plants from plant i on; nothing where none is due. */
void plants_frames(struct plants *p, int i, int n);

/* A line for each plant of a list, on stdout: identifiers, state, time, hash, faults, what it missed. */
void plants_report(const struct plants *p);

/* How many plants are in which state, in words, into text[size]. */
void plants_states(const struct plants *p, char *text, size_t size);

void plants_free(struct plants *p);

#endif
