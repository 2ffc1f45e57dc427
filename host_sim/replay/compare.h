/* compare.h - where two recorded logs of one plant part. */
#ifndef HOST_SIM_COMPARE_H
#define HOST_SIM_COMPARE_H

#include "host_sim/listen/decode_rows.h"
#include "host_sim/scene/scene_app.h"

enum { COMPARE_TEXT = 400 };
enum compare_verdict { COMPARE_EQUAL, COMPARE_APART, COMPARE_BAD };

struct compare {
    const char *path[2];
    const char *interface[2];         /* on which its plant is; NULL: there is one */
    const char *command;              /* the subcommand that compares */
    const char *name;                 /* the second log is called so in messages; NULL: by its path */
    const struct scene_app *scene;    /* that made both */
    double tolerance[DECODE_SIGNALS]; /* NaN: not compared */
    uint64_t zero;                    /* tick of the second log that is tick 0 of the first one */
    uint64_t end;                     /* the last tick that is compared; UINT64_MAX: all */
    double *part_s; /* NULL, or where the plant time goes at which a value of both leaves its tolerance */
    bool gaps;      /* rows and outputs that one of them has not are passed over */
};

/* Compares the rows of equal ticks, where plant time runs. text[COMPARE_TEXT]: the row in which they part,
 * how many agree, or with COMPARE_BAD why they cannot be compared. */
enum compare_verdict compare_logs(const struct compare *c, char *text);

#endif
