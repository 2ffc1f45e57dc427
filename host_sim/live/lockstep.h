/* lockstep.h - bus frames that begin with a word of each awaited peer, and no clock: docs/guide/lockstep.md.
 *
 * A word is a packet of the peer, an empty one too. Each bus frame takes one word of each awaited peer
 * and ends with what the plant says, an empty packet at least. The clock only paces, where asked for, and
 * ends a silent run. */
#ifndef HOST_SIM_LOCKSTEP_H
#define HOST_SIM_LOCKSTEP_H

#include <stdbool.h>
#include <stdint.h>
#include "host_sim/cli/options.h"
#include "host_sim/live/bus.h"
#include "host_sim/live/client.h"

/* --lockstep, --wait, --patience, --speed of a plant. */
extern const struct option lockstep_options[];

/* The plant's side. All zero: not in lockstep. */
struct lockstep {
    bool on;
    struct bus *bus;
    double patience_s;         /* 0: for ever */
    double silent_s;           /* while waiting for this frame */
    int64_t pace_ns;           /* least length of a frame; 0: as fast as the words come */
    int64_t begin_ns, last_ns; /* when the first and the last frame began */
    int64_t next_ns;           /* when the next one may */
};

/* 0, or the exit status after a line on stderr: what these options cannot do, before the bus is open. */
int lockstep_check(const struct options *o);

/* After bus_open_options, before faults and recording. 0, or the exit status after a line on stderr. */
int lockstep_open(struct lockstep *l, const struct options *o, struct bus *b, double period_s);

/* Who is waited for, for people, into text[BUS_REASON]. */
void lockstep_describe(const struct lockstep *l, char *text);

enum lockstep_turn { LOCKSTEP_BEGINS, LOCKSTEP_WAITS, LOCKSTEP_SILENT };

/* Waits a while for the words of the next bus frame; `awake`: paced to a microsecond. LOCKSTEP_WAITS: ask
 * again. LOCKSTEP_SILENT: the patience is over, and why[BUS_REASON] names who was silent. */
enum lockstep_turn lockstep_await(struct lockstep *l, bool awake, char *why);

/* The controller's side: from now on the link's client is in lockstep with the plant on this bus, which is
 * one of UDP. NULL, or the reason. */
const char *lockstep_follow(struct client_link *link, struct bus *b, double patience_s);

#endif
