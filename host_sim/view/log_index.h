/* log_index.h - a log in memory as a page needs it: places to read on from, and the least and the greatest
 * value of each signal over 64, 512 and 4096 rows.
 *
 * A bin of one of these sizes ends early before a hole as long as itself. So where a pixel is longer than the
 * bins of a size, none of them hides a hole that the pixel could show. Rows while plant time stands count
 * nothing towards a size. Memory is about 4 bytes a row. */
#ifndef HOST_SIM_LOG_INDEX_H
#define HOST_SIM_LOG_INDEX_H

#include <stddef.h>
#include "host_sim/view/log_walk.h"

enum {
    LOG_SPEED = DECODE_SIGNALS, /* that of touchdowns; the signals before it are those of a row */
    LOG_SIGNALS,
    LOG_LEVELS = 3,
    LOG_BLOCK_TICKS = 4096, /* rows of different ticks in a block, the greatest size */
    LOG_BLOCK_ROWS = 16384, /* and rows altogether */
    LOG_BLOCK_BINS = 256,   /* with rows of the least size */
    LOG_NO_STATE = 255
};

extern const unsigned log_size[LOG_LEVELS]; /* rows in a bin, the least first */

/* Some rows, of one plant time. */
struct log_bin {
    uint64_t from, to;      /* ticks of the first and the last one */
    uint32_t rows, ticks;   /* all; those with a tick of their own */
    uint32_t known, closed; /* rows that say the contacts; of them with one closed */
    uint32_t n[LOG_MARKS];  /* by kind: marks; periods of overruns, missing frames */
    uint8_t state, session; /* those of the last one; LOG_NO_STATE: none was told */
    uint8_t faults, beyond; /* bits of any: faults; outputs beyond the bus's range */
};

struct log_band {
    double low, high; /* NaN: no row has it */
};

struct log_cell {
    struct log_bin bin;
    struct log_band band[LOG_SIGNALS];
};

/* All before the first row. */
void log_cell_begin(struct log_cell *c);
void log_cell_row(struct log_cell *c, const struct decode_row *row, const struct log_walk_plant *plant);
void log_cell_mark(struct log_cell *c, const struct log_mark *m);
void log_cell_merge(struct log_cell *c, const struct log_cell *more);

struct log_block {
    struct log_walk_place place; /* before its first row */
    unsigned run;                /* how often plant time began anew before */
    uint64_t rows, from, to;     /* ticks, as of a bin */
    unsigned present;            /* bit i: signal i has bands */
    int n_bins[LOG_LEVELS];
    struct log_bin *bin;   /* those of all levels */
    struct log_band *band; /* for each bin, those that are present; in the memory of `bin` */
};

struct log_index {
    struct log_walk walk;
    double tick_s;
    struct log_block **block; /* in the order of the log */
    size_t n_blocks, room;
    uint64_t rows, bytes;   /* rows read; bytes of memory */
    uint64_t step;          /* least distance of two rows, ticks; UINT64_MAX: no two are there */
    struct log_block *open; /* is being read */
    struct log_cell cell[LOG_BLOCK_BINS]; /* its bins of the least size */
    int n_cells;
    struct log_cell next;      /* all that came since the last row */
    uint64_t open_ticks, last; /* rows of the open block with a tick of their own; tick of the newest row */
    char why[LOG_REASON];
};

/* Opens and reads all of it. NULL, or the reason, and then it is closed; see plant_log_open. *x must stay
 * where it is, and is all zero before. */
const char *log_index_open(struct log_index *x, const char *path, const char *interface,
                           const struct wire_scene *scene, double tick_s);

/* Reads on where the file has grown: its last block again, and what follows. NULL, or the reason. */
const char *log_index_more(struct log_index *x);

/* An index of rows that come from elsewhere: bins alone. An end shows all that was added; more may follow.
 * Each call: NULL, or the reason. */
void log_index_begin(struct log_index *x, double tick_s);
const char *log_index_add(struct log_index *x, const struct decode_row *row);
const char *log_index_end(struct log_index *x);

/* It can read its rows again. */
bool log_index_has_rows(const struct log_index *x);

/* Bin i of a level of a block. */
void log_block_cell(const struct log_block *b, int level, int i, struct log_cell *c);

/* The blocks [*first, *end) of a run. False: there is no such run. */
bool log_index_run(const struct log_index *x, unsigned run, size_t *first, size_t *end);

void log_index_close(struct log_index *x);

#endif
