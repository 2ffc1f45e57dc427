/* modal_run.h - many ticks of `modal` for a caller that keeps no books, as a virtual microscope is.
 *
 * The bits are those of the method's own steps over whole ticks with REGIME_ANY, force being input 0. No
 * energy is booked, and many ticks are one call: half the instructions. */
#ifndef FIRMWARE_MODAL_RUN_H
#define FIRMWARE_MODAL_RUN_H

#include "firmware/method/method.h"

/* One tick: a force that changes at once between two ticks, and the base on its way. */
struct modal_tick {
    double force[2];  /* at the begin and at the end */
    double base[2];   /* base at both ends; the begin is where the last tick ended */
    double base_rate; /* belongs to the rates of the state */
    double peak;      /* out: the largest force of the sample, 0 apart */
};

/* Runs n ticks from tick number `first`, in scratch memory that `prepare` made. False when the motion left
 * the finite numbers: x is then not to be used. */
bool modal_run(const struct model *m, const double *p, double *scratch, struct modal_tick *ticks, uint32_t n,
               uint64_t first, double *x);

/* From now on p has another sample, all else being as `prepare` had it. */
void modal_change_sample(const struct model *m, const double *p, double *scratch);

#endif
