/* share.h - the share of a run that --shard names, and the line by which its file tells it.
 *
 *   share 3/64 of 64 jobs, run 1a2b3c4d, contactplant 0.9.0: contactplant sweep rig --shard $i/64 --out
 * part$i.csv
 *
 * The command is one for a shell: with i it computes the I-th share into a file of its own. A file that has
 * all of its share says so at its end: `complete: 4210 rows`. */
#ifndef HOST_SIM_SHARE_H
#define HOST_SIM_SHARE_H

#include <stdbool.h>
#include <stdint.h>
#include "host_sim/cli/options.h"

enum { SHARE_LINE = 4096, SHARE_VERSION = 24, SHARE_END = 40 };

struct share {
    int i, n;       /* the I-th of N, from 1 */
    int first, end; /* its things: [first, end) */
};

/* The share of n things that --shard of this command names: I/N, or auto (docs/guide/maps.md). Returns the
 * exit status. */
int share_take(const struct options *o, int n, struct share *s);

/* The I-th of N shares of so many things. */
struct share share_nth(int i, int n, int things);

/* Writes the line, without its end: of a share of so many jobs or cases. `run` names what is computed. The
 * command is left out where it does not fit. */
void share_tell(const struct options *o, const struct share *s, int things, const char *called, uint32_t run,
                char line[SHARE_LINE]);

/* Writes what stands at the end of a complete file of so many rows or cases. */
void share_end(long n, const char *called, char text[SHARE_END]);

/* The contents of such a line. */
struct share_told {
    int i, n, things;
    unsigned run;
    char version[SHARE_VERSION];
    char command[SHARE_LINE];
};

/* False where it is no line of share_tell. */
bool share_read(const char *line, struct share_told *t);

/* Whether a line has the same share of the same run as this one, whatever its command. */
bool share_is_same(const char *line, const char *other);

#endif
