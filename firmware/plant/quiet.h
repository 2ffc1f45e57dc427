/* quiet.h - blocks of quiet ticks of a plant (plant.c), for those who run several plants (plant_beside.c). */
#ifndef FIRMWARE_QUIET_H
#define FIRMWARE_QUIET_H

#include "firmware/plant/plant.h"

enum { QUIET_FEW = 4 }; /* so few ticks take less by themselves */

/* Samples of an input, which are all that sounds. */
struct samples {
    int input;
    const double *value; /* SI */
    double unit;
    uint64_t begin, ticks; /* when the first begins, and for how long each is held */
};

/* Quiet ticks under way. With TICK_LANES > 1 the ledger follows BLOCK_TOGETHER ticks behind, so that it does
 * not stand between one step and the next. */
struct quiet {
    struct method_block b;
    unsigned turning;                 /* bit i: drive i turns; the others that sound stand */
    unsigned sloping;                 /* bit i: drive i has a sample on a slope */
    unsigned moving;                  /* all these, and the input that is held */
    const struct samples *held;       /* NULL: nothing is */
    uint32_t filled;                  /* ticks of the block that have their sample */
    uint64_t origin;                  /* number of the block's first tick */
    uint32_t done, booked;            /* its ticks that are moved, and that the ledger has */
    uint64_t passed;                  /* up to this tick drives and times have gone on */
    struct method_switches switches;  /* in the last run, */
    uint32_t told;                    /* and how many of them the plant has told */
    const struct method_books *books; /* by a method with books: those of the tick with a switch */
    plant_look *look;                 /* NULL, or called at the end of each tick, */
    void *who;
    uint32_t seen;     /* the last one for which it was */
    run_function *run; /* NULL: all ticks by `step` */
#if TICK_LANES > 1
    ledger_ticks_function *book;
#endif
    enum step_status status; /* how the last single step ended */
    struct crossing c;
};

/* Ticks of the block from a certain one on: their states, inputs and phasors. */
struct ticks {
    double (*x)[MODEL_STATES];
    struct input (*at)[MODEL_INPUTS];
    struct phasor (*phasor)[MODEL_INPUTS];
};

ALWAYS_INLINE struct ticks ticks_from(struct method_block *b, uint32_t k)
{
    return (struct ticks){&b->x[k], &b->at[2 * k], &b->phasor[k]};
}

/* Every model has two states, and most have no more: they stand before the loop. */
static inline void copy_state(double *to, const double *x, int n)
{
    to[0] = x[0];
    to[1] = x[1];
    for (int i = 2; i < n; i++)
        to[i] = x[i];
}

ALWAYS_INLINE void rise_to(double *peak, double force)
{
    if (force > *peak)
        *peak = force;
}

/* A call begins before a tick that may begin a block. */
bool quiet_is_next(const struct plant *pl);

/* The first of up to n quiet ticks begins; returns those until a phasor is due. Inputs that do not turn are
 * filled in once. held: NULL, or the samples behind the present one. */
uint32_t quiet_begin(struct plant *pl, uint32_t n, const struct samples *held, struct quiet *q);

/* Drives with a slope in n ticks of the block; their offsets are those of the first. */
void quiet_climb(struct plant *pl, const struct quiet *q, struct ticks t, uint32_t n);

/* The tick behind those that are done, alone, and the ledger's books as far as that. False if it is not a
 * good one to its end. */
bool quiet_step(struct plant *pl, struct quiet *q);

/* look(who, pl) at the end of each tick of the block behind tick `from`. */
void quiet_look(struct plant *pl, const struct quiet *q, uint32_t from, plant_look *look, void *who);

/* The plant goes to the end of the ticks that are done, and not good: through the next one, after which it
 * looks. The plant's times have gone on by `timed` ticks of them. */
bool quiet_stop(struct plant *pl, struct quiet *q, bool good, uint32_t timed, plant_look *look, void *who);

#endif
