/* jobs.h - many independent computations over the cores of this machine into one CSV: in order, resumable, in shards.
 *
 * A job is a pure function of its number: it writes the rows that belong to it. Processes compute jobs side by side; the
 * file has them in the order of their numbers, so its bytes depend on neither the number of cores nor an interruption.
 * Each row begins with the columns `run`, eight hex digits that name what is computed, and `job`, and ends with `check`.
 * With them a file is resumed: whatever is there of the same run stays, the last job in it is done anew, the rest follows;
 * a file of another run is refused and left as it is, and so is one that lacks rows before others, one in which a byte of
 * a row is not as it was written, and one that another process is writing. Shard i/n has a
 * contiguous share of the jobs and only the first has the header line: the shards' files, concatenated in their order, are
 * the file of one run.
 *
 * A long job can hand over its rows in pieces: they are in the file as soon as its turn has come, count as progress, and
 * `resume` lets a file be gone on with inside the job. */
#ifndef HOST_SIM_JOBS_H
#define HOST_SIM_JOBS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include "host_sim/cli/options.h"

enum { JOBS_MAX = 10000000, JOBS_CORES = 256, JOBS_LINE = 8192 /* bytes of a row */ };

/* --out --shard --cores, for the option tables of a command. */
extern const struct option jobs_options[];

struct jobs {
    const struct options *options; /* of the command: where to and which share */
    const char *identity;          /* all that decides the rows, as text: the run is its hash */
    const char *columns;           /* of the caller's own part of a row, as in the CSV's header */
    int n;                         /* jobs, 1 to JOBS_MAX */
    /* Whole lines of job `i`, one at least, each ended with a newline. False: what it wrote is the reason, one line without. */
    bool (*compute)(void *context, int i, FILE *rows);
    void *context; /* each process has its own copy: what a job changes in it, no other one needs to see */
    int parts;     /* pieces that a job has, for the time left; 0: one */
    /* NULL, or: whether this row (without run and job) is the last one of job i. In a file, another job may begin behind it. */
    bool (*ends)(void *context, int i, const char *row);
    /* NULL, or: of job i's whole rows in the file (without run and job), how many bytes end with a piece and stay; the
     * job that is computed first begins behind them. Called once, before any process starts. */
    size_t (*resume)(void *context, int i, const char *rows);
};

/* All jobs of this shard, with progress and the time left on stderr. The exit status: STATUS_DONE with every row written;
 * else one line on stderr says what happened and what to do, and every row of a job that was finished in order is in the
 * file. */
int jobs_run(const struct jobs *j);

/* In compute: what has been written to `rows` since the last piece. */
void jobs_piece(FILE *rows);

/* FNV-1a of a text: the `run` of this identity. */
uint32_t jobs_run_number(const char *identity);

/* The check of a row is FNV-1a over all rows of its job up to it, each without its own check and the comma before. */
struct jobs_chain {
    int job; /* of the last row, or -1 */
    uint32_t check;
};
#define JOBS_CHAIN ((struct jobs_chain){-1, 0})

/* The header line of a file with these columns, newline included. */
void jobs_header(const char *columns, char text[JOBS_LINE]);

/* Whether a whole line of a file, newline included, is as it was written; its last column is taken off. Rows come in their
 * order, `c` begins as JOBS_CHAIN. */
bool jobs_row_fits(struct jobs_chain *c, char *line);

#endif
