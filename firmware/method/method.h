/* method.h - the interface of an integration method: what the plant hands to it and what it gives back.
 *
 * The plant hands over one segment at a time: a time span with every input as a function of time and no jump
 * of an input inside. The method advances the state to the end of the segment or to the first contact switch,
 * whichever comes first. The plant logs the switch, builds the rest of the segment and calls again.
 *
 * Everything here is in the model's own units (struct scale of models/model.h has their SI values). Nothing
 * allocates, and nothing waits. A method has no memory but the state, and scratch memory that its caller
 * owns.
 *
 *     double scratch[METHOD_SCRATCH];
 *     const char *why = method->refuse(model, p, h, tol);
 *     if (!why) {
 *         method->prepare(model, p, h, tol, scratch);
 *         status = method->bind(model)(model, p, scratch, &segment, regime, x, &crossing);
 *     }
 *
 * A new method is a file with a struct method, a declaration below and an entry in method_table. */
#ifndef FIRMWARE_METHOD_H
#define FIRMWARE_METHOD_H

#include <stdbool.h>
#include <stddef.h>
#include "firmware/method/segment.h"
#include "models/lanes.h"
#include "models/model.h"

/* Tolerances that a method may be asked for, relative to the size of the motion. Below the least one
 * rounding decides. A method with a narrower range refuses what is outside it; taylor keeps TAYLOR_TOL_MOST
 * where more is allowed, for above it rk4 costs less. */
#define METHOD_TOL_MIN     1e-13
#define METHOD_TOL_MAX     0.1
#define TAYLOR_TOL_MOST    1e-2
#define METHOD_TOL_DEFAULT 1e-9 /* where 0 is given */

/* How a step ended. x is the state there, but for STEP_NOT_FINITE. */
enum step_status {
    STEP_END,       /* at the end of the segment */
    STEP_SWITCH,    /* at crossing->done: a contact switched */
    STEP_BUDGET,    /* at crossing->done, before the end: the bound on effort is reached; call again */
    STEP_NOT_FINITE /* the motion escaped, or a number is not finite; x is not to be used */
};

/* A contact switch, as found inside a segment. */
struct crossing {
    double done;  /* model time from the segment's start, in [0, length]; 0 when contacts switch together */
    int contact;  /* number of the gap */
    int residual; /* 1 when the root did not converge within the bound on iterations */
    double early; /* model time by which it was before `done`; 0 for a method that stops at the switch */
};

enum {
    /* A value of `regime`: run through to the end without a stop at switches. The step ends with STEP_END or
     * STEP_NOT_FINITE. */
    REGIME_ANY = 1 << 15,
    /* Doubles of scratch memory that are enough for every method and model. */
    METHOD_SCRATCH = 5760,
    /* Doubles that auto_method keeps for itself, ahead of the scratch memory of the method that it takes. The
     * number is even, so that pairs of doubles stay aligned. */
    METHOD_AUTO_SCRATCH = 14
};

/* One step: advances x[n_states] over the segment, or to the first switch in it.
 *   p        numbers that the model's `prepare` made
 *   scratch  memory that this method prepared for this model, p, h and tol
 *   regime   bit i is set while contact i is closed, or REGIME_ANY
 *   crossing is written with STEP_SWITCH and STEP_BUDGET only
 * The segment may be shorter than h, and of any length within the bounds of `refuse`. */
typedef enum step_status step_function(const struct model *m, const double *p, double *scratch,
                                       const struct segment *e, unsigned regime, double *x,
                                       struct crossing *crossing);

struct phasor {
    double cosine, sine;
};

/* Quiet ticks, one after the other: inputs that only run on, or that are held and jump between two ticks; no
 * other command. Tick k goes from x[k] to x[k + 1], with its inputs at[2 k] at its begin, at[2 k + 1] in its
 * middle and at[2 k + 2] at its end. Where any tick of a block has a jump before it, all inputs hold in each
 * tick: its begin has the inputs of its middle. */
#if TICK_LANES > 1
enum {
    BLOCK_TICKS = 8,    /* a multiple of the next */
    BLOCK_TOGETHER = 2, /* ticks that are turned, moved and booked in one go */
    RUN_SWITCHES = BLOCK_TOGETHER * MODEL_CONTACTS
};
#else
enum {
    BLOCK_TICKS = 8,
    BLOCK_TOGETHER = 1,
    RUN_SWITCHES = 1
}; /* a block of two takes 2 KB less of stack, and a third more time */
#endif

struct method_books;

/* A contact switch in a run. */
struct method_switch {
    uint32_t tick; /* its number in the run */
    int contact;
    double done;     /* model time from the begin of the tick, above 0 */
    double force;    /* by a method with books: the largest contact force before it; they have that behind */
    bool moved;      /* inputs move the gap */
    const double *x; /* the state there; it stays until the next run */
    /* NULL, or the energies before it, beside those of its tick in `books` */
    const struct method_books *before;
};

/* Those of a run, one after the other. */
struct method_switches {
    uint32_t n;
    struct method_switch at[RUN_SWITCHES];
};

struct method_block {
    double length;           /* model time of each */
    unsigned active;         /* as in struct segment; the inputs of the others are 0 */
    unsigned regime;         /* at the begin of the next one that is moved */
    const struct wave *wave; /* waves of active inputs; where they stand is in phasor and at */
    unsigned jumps;          /* bit k: an input jumps, or is told anew, when tick k begins */
    uint64_t instant;        /* as in struct segment */
    double x[1 + BLOCK_TICKS][MODEL_STATES];
    struct input at[1 + 2 * BLOCK_TICKS][MODEL_INPUTS];
    struct phasor phasor[1 + BLOCK_TICKS]
                        [MODEL_INPUTS]; /* where the inputs stand at the begin and at the ends */
    struct method_switches *switches;   /* none, when a run begins */
};

/* Several steps: up to n ticks of the block b, from the one on whose state is x[0] and whose inputs are at[0]
 * to at[2]. It stops before a tick which the state leaves, or in which a contact may switch. Or it notes the
 * switches in b->switches, as long as there is room for those of another tick. Returns the ticks done, which
 * have the bits of single steps. */
typedef uint32_t run_function(const struct model *m, const double *p, double *scratch,
                              const struct method_block *b, const struct input (*at)[MODEL_INPUTS],
                              double (*x)[MODEL_STATES], uint32_t n);

/* The function for several ticks, after `prepare`. It may give NULL: then they are single steps. It is asked
 * anew where inputs may have changed. */
typedef run_function *bind_run_function(const struct model *m, const double *scratch);

/* A state larger than this many model units (the contact's own length) is trouble, not motion. */
#define METHOD_STATE_LIMIT 1e12

/* Energies that one step moved, model units. A method fills them in if it knows them better than powers at
 * three instants show. */
struct method_books {
    double work[MODEL_INPUTS]; /* delivered by each input */
    double damping;            /* lost in dampers and by changes of branch, >= 0 */
    double heat;               /* brought in by thermal forces */
    double force;              /* the largest contact force; of a step of length 0: that of the step before */
};

/* A rule that weighs ticks by the powers at their ends leaves shares of the first begin and of the last end.
 * Between these instants moved the share of the begin, and the sum of the books, less the share of the end.
 */
struct method_share {
    double work[MODEL_INPUTS], damping;
};
struct method_ends {
    struct method_share begin, end;
    bool anew; /* the begin is not the end of the books before */
};

struct method {
    const char *name;  /* as in scenes, options and on the bus */
    const char *title; /* one line for lists */
    int order;         /* the error falls as step^order; 0: it does not depend on the step */
    /* Doubles of scratch memory for this model, at most METHOD_SCRATCH; 0: none, and NULL will do.
     *
     * Scratch memory is counted in doubles for its size and alignment. The method keeps a struct of its own
     * in it (enums, counts, tables), which nobody else reads or writes. It is part of the plant's state: a
     * snapshot is the bytes of plant and scratch, and may be moved. A method must compare x and regime with
     * what it last returned, because a caller may set the state; `changed` speaks of the inputs only. */
    size_t (*n_scratch)(const struct model *m);
    /* The step guard: NULL, or why the method is unsound for this model and step (h: one tick, model time).
     * The text says what to do. tol 0 asks for the method's default. */
    const char *(*refuse)(const struct model *m, const double *p, double h, double tol);
    /* Makes the tables in scratch memory: at the start, and after each change of parameters, step or
     * tolerance. Costs up to 1.5 million instructions (`exact` on the shaft), less than 2000 with the other
     * methods. */
    void (*prepare)(const struct model *m, const double *p, double h, double tol, double *scratch);
    /* The step for this model: with the model inlined where instances.h has it, else the general one. Same
     * bits. */
    step_function *(*bind)(const struct model *m);
    bind_run_function *bind_run; /* NULL: all ticks are single steps */
    /* NULL, or the books of the last step, or of each tick of the last run; the ledger takes them as they
     * are. It may give NULL, too, after `prepare`: then the ledger has its own rule. */
    const struct method_books *(*books)(const double *scratch);
    /* NULL, or the shares of both ends of what `books` gives. It may give NULL, too: the books are whole. */
    const struct method_ends *(*ends)(const double *scratch);
};

extern const struct method rk4;
extern const struct method adams;
extern const struct method rk4_float32;
extern const struct method rk4_unlocated;
extern const struct method taylor;
extern const struct method exact;
extern const struct method auto_method; /* picks a method by model, step, tolerance and drives */
extern const struct method modal;       /* levers */

enum { METHODS = 8 };
extern const struct method *const method_table[METHODS];

/* NULL when there is no method of this name. */
const struct method *method_find(const char *name);

#endif
