/* jobs.h - many independent computations over the cores of this machine into one CSV: in order, resumable,
 * in shards.
 *
 * A job is a pure function of its number, and writes the rows that belong to this number. Processes
 * compute jobs side by side. The file has the jobs in the order of their numbers: its bytes depend neither
 * on the number of cores nor on an interruption.
 *
 * Each row begins with the columns `run`, eight hex digits that name what is computed, and `job`, and ends
 * with `check`. They make a file resumable: the rows of the same run stay, the last job among them is
 * computed again, and the rest follows. A file is refused and left as it is when it belongs to another
 * run, or while another process writes it. So is a file with a changed row, or with rows missing before
 * others.
 *
 * Shard i/n has a contiguous share of the jobs, and only the first shard has the header line. In the file of
 * a shard two lines begin with #: the first one tells the share (share.h), and the last one, which only a
 * complete shard has, its rows. Without them the files of all shards in order are the file of one run.
 *
 * A long job can hand over its rows in pieces. A piece is in the file as soon as all jobs before it are,
 * counts as progress, and lets a run resume inside the job (`resume`). */
#ifndef HOST_SIM_JOBS_H
#define HOST_SIM_JOBS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include "host_sim/maps/share.h"

enum { JOBS_MAX = 10000000, JOBS_CORES = 256, JOBS_LINE = 8192 /* bytes of a row */, JOBS_LAST = 48 };

#define JOBS_SHARE "# " /* before the line that tells a share */

/* --out --shard --cores, for the option tables of a command. */
extern const struct option jobs_options[];

struct jobs {
    const struct options *options; /* the command's: --out, --shard, --cores */
    const char *identity;          /* all that decides the rows, as text; `run` is its hash */
    const char *columns;           /* the caller's own ones, as in the header */
    FILE *copy;                    /* NULL, or takes all that goes to standard output, too */
    int n;                         /* jobs, 1 to JOBS_MAX */
    /* Writes the lines of job i, at least one, each with its newline. False: it wrote the reason instead,
     * without newline. */
    bool (*compute)(void *context, int i, FILE *rows);
    void *context; /* each process has a copy: jobs do not see each other's changes */
    int parts;     /* pieces of a job, for the time left; 0 stands for 1 */
    /* NULL, or: is this row (without run and job) the last one of job i? Only behind such a row another
     * job may begin. */
    bool (*ends)(void *context, int i, const char *row);
    /* NULL, or: how many bytes of these rows of job i (without run and job) are whole pieces and stay in
     * the file; the job then resumes behind them. Called once, before any process starts. */
    size_t (*resume)(void *context, int i, const char *rows);
};

/* Computes all jobs of this shard, with progress and the time left on stderr. Returns the exit status:
 * STATUS_DONE when every row is written. Else one line on stderr says what happened and what to do, and
 * the file has the jobs that were finished in order. */
int jobs_run(const struct jobs *j);

/* For `compute`: hands over what it has written to `rows` since the last piece. */
void jobs_piece(FILE *rows);

/* The `run` of an identity: FNV-1a of the text. */
uint32_t jobs_run_number(const char *identity);

/* Continues such a number over n bytes more. */
uint32_t jobs_run_on(uint32_t run, const char *text, size_t n);

/* The check of a row is FNV-1a over all rows of its job up to it, each without its own check and the comma
 * before. */
struct jobs_chain {
    int job; /* job of the last row, or -1 */
    uint32_t check;
};
#define JOBS_CHAIN ((struct jobs_chain){-1, 0})

/* The header line of a file with these columns, newline included. */
void jobs_header(const char *columns, char text[JOBS_LINE]);

/* The last line of a complete shard with so many rows. */
void jobs_last(long rows, char text[JOBS_LAST]);

/* True when a whole line of a file, newline included, is as it was written. Removes the last column,
 * `check`. The caller passes rows in their order; `c` begins as JOBS_CHAIN. */
bool jobs_row_fits(struct jobs_chain *c, char *line);

#endif
