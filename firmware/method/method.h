/* method.h - the seam between the plant and an integration method: one file and one table entry each.
 *
 * The plant hands a method one segment: a time span with every input as a function of time, no discontinuity
 * inside. The method advances the state to the segment's end or to the first contact switch, whichever comes
 * first; the plant logs the switch, builds the rest of the segment and calls again. */
#ifndef FIRMWARE_METHOD_H
#define FIRMWARE_METHOD_H

#include <stdbool.h>
#include <stddef.h>
#include "models/model.h"

/* Tolerances that a method may be asked for. Below, rounding decides (orders of taylor from 12), or steps become
 * shorter than those of rk4 (orders below). A method with a narrower range refuses what is outside it. */
#define METHOD_TOL_MIN 1e-13
#define METHOD_TOL_MAX 1e-2

/* One input over a segment, s the model time from the segment's start:
 *   value(s) = offset + slope s + (amplitude + growth s) cos(theta + omega s),  (cosine, sine) of theta.
 * A Taylor method takes its series from this, an exact method its phasor, RK4 the three instants below. */
struct wave {
    double offset, slope;
    double amplitude, growth;
    double cosine, sine;
    double omega;
};

struct segment {
    double length;   /* model time */
    unsigned active; /* bit i: input i is not identically zero */
    bool changed;    /* false when every wave only ran on since the previous segment */
    struct wave wave[MODEL_INPUTS];
    struct input at[3][MODEL_INPUTS]; /* the inputs at 0, length/2 and length */
};

/* Value and rate of a wave at model time s from its start. */
void wave_at(const struct wave *w, double s, struct input *u);

/* The part of a segment up to `length`, and the part from `done` on (model time). */
void segment_head(const struct segment *e, int n_inputs, double length, struct segment *head);
void segment_tail(struct segment *e, int n_inputs, double done);

enum step_status {
    STEP_END,    /* the segment's end is reached */
    STEP_SWITCH, /* a contact switched at *done; x is the state there */
    STEP_BUDGET, /* the method's own bound on work was reached at *done, short of the end; x is the state there */
    STEP_NOT_FINITE /* the state left the finite numbers; x is not to be used */
};

/* A contact switch, as found inside a segment. */
struct crossing {
    double done;  /* model time from the segment's start, in [0, length]; 0 when contacts switch together */
    int contact;  /* which gap */
    int residual; /* 1 when the root's residual stayed above its bound */
};

enum {
    /* As regime: run through to the end, look for no switch; must end in STEP_END or STEP_NOT_FINITE. */
    REGIME_ANY = 1 << 15,
    /* Bound on n_work, so that a target can set its memory aside. */
    METHOD_WORK = 5632,
    /* Ahead of the work memory of the method that auto_method takes. */
    METHOD_AUTO_WORK = 13
};

/* One step. `regime` has bit i set while contact i is closed. On STEP_END and STEP_SWITCH x is advanced. */
typedef enum step_status step_function(const struct model *m, const double *p, double *work,
                                       const struct segment *e, unsigned regime, double *x,
                                       struct crossing *crossing);

struct method {
    const char *name;
    const char *title;
    int order; /* 0: the error does not depend on the step */
    /* Doubles of work memory that the caller provides for this model, at most METHOD_WORK; 0 for none. What a method
     * carries over from one step to the next is part of the plant's state (a snapshot is plant and work), and it must
     * compare x and regime with what it last returned: states can be set, and `changed` speaks of the inputs only. */
    size_t (*n_work)(const struct model *m);
    /* NULL, or why this method and step (model time) are unsound for this model (the step guard). */
    const char *(*refuse)(const struct model *m, const double *p, double h, double tol);
    /* Called at start and after each parameter change: tables in work. */
    void (*prepare)(const struct model *m, const double *p, double h, double tol, double *work);
    /* The step for this model: an instantiation with the model inlined, or the general one. */
    step_function *(*bind)(const struct model *m);
    /* True while the steps in which no contact may switch are rk4's own: they may be taken in blocks (plant/block.h). NULL: never. */
    bool (*runs_rk4)(const double *work);
};

/* The step guard of rk4, rk4_float32 and rk4_unlocated: with eigenfrequency * step above this contact motion is no longer resolved, and energy is
 * made or lost in every bounce. */
#define RK4_ANGLE_MAX 0.2

extern const struct method rk4;
extern const struct method rk4_float32;
extern const struct method rk4_unlocated;
extern const struct method taylor;
extern const struct method exact;
extern const struct method auto_method; /* one of those above, by model, step, tolerance and drives */

/* What auto_method takes under these drives, in SI (NULL: silence); the best of those that refuse where all do. */
const struct method *auto_choice(const struct model *m, const double *p, double h, double tol,
                                 const struct harmonic *drive, const struct scale *scale);

/* What auto_method has taken, from its work memory. */
const struct method *auto_now(const double *work);

enum { METHODS = 6 };
extern const struct method *const method_table[METHODS];

/* NULL when there is none of this name. */
const struct method *method_find(const char *name);

#endif
