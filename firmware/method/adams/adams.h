/* adams.h - scratch memory of `adams`. */
#ifndef FIRMWARE_METHOD_ADAMS_H
#define FIRMWARE_METHOD_ADAMS_H

#include "firmware/method/method.h"

/* The step guard of adams, rad a tick: above it the predictor loses its order. */
#define ADAMS_ANGLE_MAX 0.4

/* Likewise of the step times the damping over the mass. The damper's force is extrapolated, too: above 0.049,
 * at that angle, or 0.088, at short steps, errors grow from tick to tick. */
#define ADAMS_DAMPING_MAX 0.04

enum {
    ADAMS_NODES = 5, /* forces that the predictor looks back on */
    ADAMS_TERMS = 28 /* a wave's integrals as power series: 1e-16 at half a turn */
};

/* Two numbers side by side, of the compression eta and of its rate: one operation where the target has such
 * registers, two where it has not, with the same bits. */
typedef double adams_pair __attribute__((vector_size(16), aligned(8)));
enum { ADAMS_PLACE, ADAMS_RATE };

/* A pair that ticks work on, in statements as BOTH SIDE(a) += SIDE(b) * c. gcc keeps an adams_pair in memory
 * where the target has no such registers; then it is two numbers, and a statement is two. */
#if TICK_LANES > 1
typedef adams_pair adams_two;
#define BOTH
#define SIDE(two) (two)
#else
typedef double adams_two[2];
#define BOTH      UNROLL for (int which = 0; which < 2; which++)
#define SIDE(two) (two)[which]
#endif
#define PAIR(two) ((adams_pair){(two)[ADAMS_PLACE], (two)[ADAMS_RATE]})

/* A wave's share of place and rate in a span: times the cosine and the sine of its phase at the begin. */
struct adams_response {
    adams_pair cosine, sine;
};

/* The inputs' share in a span: the turning part of each active input in turn, and all that stands. */
struct adams_push {
    adams_pair steady;
    struct adams_response response[MODEL_INPUTS];
};

/* The contact's part of g: hertz eta^1.5 and, of it, the root of eta; and that times 1 and the modulation. */
struct adams_contact {
    double force, plain, root;
};

/* The motion at the end of a tick. g is the force of contact, spring and damper, by mass. */
struct adams_motion {
    adams_two at;
    adams_two without;            /* without the share of the newest g */
    double g[ADAMS_NODES];        /* the newest first */
    struct adams_contact contact; /* in the newest */
};

/* How the inputs enter the motion. A force only adds to it; the others make g a function of time, too. */
enum adams_kind { ADAMS_FORCED, ADAMS_MODULATED, ADAMS_SHIFTED };

struct adams {
    struct hertz_form form;
    double per_damping;                       /* over the damping; 0 without */
    double h, force_unit;                     /* the unit: of force, over one of the contact's part of g */
    unsigned modulating, shifting, pushing;   /* bit i: so does input i; those that push move the body */
    adams_pair predict[ADAMS_NODES], correct; /* weights: of g, the newest first; of what g is beside its
                                               * extrapolation */
    double free_angle;                        /* by which a free motion turns in a tick */
    double angle, ahead[2];                   /* the wave that they are for; the extrapolation */
    double series[ADAMS_TERMS];
    /* the inputs */
    unsigned active;
    enum adams_kind kind;
    int n_on, on[MODEL_INPUTS]; /* the active ones, */
    double force[MODEL_INPUTS]; /* and the force of each in turn */
    struct wave wave[MODEL_INPUTS];
    struct adams_push push; /* in a whole tick */
    bool sloping;           /* which is another in the next one */
    /* the past */
    int known; /* how many g are; 0: nothing is */
    struct adams_motion m;
    adams_pair from;     /* where the span begins that is told next, */
    double from_contact; /* and the contact's force there */
    double x[2];         /* as last returned */
    /* a tick that was cut at a switch: how much of it is left, its end, its energies */
    double left, end[2];
    struct method_books kept;
    struct method_ends kept_ends;
    struct method_books books[BLOCK_TICKS];
    struct method_ends ends;
    struct method_share more; /* by which that of the begin of a tick is more than that of the end before */
    double booked;            /* the length that ends.end is for; 0: there is none */
    double at_switch[RUN_SWITCHES][2]; /* the states at the switches of a run */
};

#endif
