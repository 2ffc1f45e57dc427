/* compare.h - where two recorded logs of one plant part. */
#ifndef HOST_SIM_COMPARE_H
#define HOST_SIM_COMPARE_H

#include "host_sim/cli/options.h"
#include "host_sim/cli/unit.h"
#include "host_sim/replay/decode_log.h"
#include "host_sim/scene/scene_app.h"

enum { COMPARE_TEXT = 400 };
enum compare_verdict { COMPARE_EQUAL, COMPARE_APART, COMPARE_BAD };

struct compare_limit {
    double tolerance;     /* NaN: not compared */
    double one;           /* unit in which it was asked, and is answered */
    char unit[UNIT_TEXT]; /* "": that of the signal; one is 1 then */
};

struct compare {
    const char *path[2];
    const char *interface[2];      /* on which its plant is; NULL: there is one */
    const char *command;           /* the subcommand that compares */
    const char *name;              /* the second log is called so in messages; NULL: by its path */
    const struct scene_app *scene; /* that made both */
    struct compare_limit limit[DECODE_SIGNALS];
    uint64_t zero;  /* tick of the second log that is tick 0 of the first one */
    uint64_t end;   /* the last tick that is compared; UINT64_MAX: all */
    double *part_s; /* NULL, or where the plant time goes at which a value of both leaves its tolerance */
    bool gaps;      /* rows and outputs that one of them has not are passed over */
};

/* One of the logs as far as it was read. */
struct compare_side {
    struct decode_log log;
    uint64_t zero, last;
    int got; /* as decode_log_next */
    struct decode_row row;
    struct log_place place; /* some rows before, with */
    struct decode before;   /* the messages up to there, */
    unsigned since;         /* and how many rows those are */
};

/* Two logs from row to row. */
struct compare_course {
    struct compare c;
    bool grow; /* the logs may: their last rows are not whole yet */
    void (*each)(void *context, const struct decode_row *a,
                 const struct decode_row *b); /* two rows of one tick */
    void *context;
    struct compare_side side[2];
    uint64_t rows; /* that agree */
    bool part;     /* a row was outside */
    enum compare_verdict verdict;
    char text[COMPARE_TEXT]; /* about all rows so far, as compare_logs gives it */
};

/* Takes n words SIGNAL=TOLERANCE; without any, all signals must be equal. 0, or the exit status after a line.
 */
int compare_allow(struct compare *c, const struct options *o, const char *const *word, int n);

/* Compares the rows of equal ticks, where plant time runs. text[COMPARE_TEXT]: the row in which they part,
 * how many agree, or with COMPARE_BAD why they cannot be compared. */
enum compare_verdict compare_logs(const struct compare *c, char *text);

/* Opens the logs of g->c: false, with the reason in g->text. *g must stay where it is. */
bool compare_open(struct compare_course *g);

/* Reads to the end of one of them: with g->each both to their last rows, else to where they part. */
void compare_go_on(struct compare_course *g);

void compare_close(struct compare_course *g);

#endif
