/* stability_floquet.h - Floquet multipliers of a contact at rest whose stiffness is modulated.
 *
 * The plant has multipliers, and a method with its step has others: it is a map of the state, too.
 *
 *   x'' + damping x' + (stiffness + modulation cos(omega t)) x = 0
 *
 * is the linear part of the model about its rest: of its hertz_form, hertz (3/2) sqrt(eta) (1 + sum
 * modulation_i u_i), or of its polynomial_form, sum k (C_k + sum M_ki u_i + R_ki u_i') x^(k-1). Other
 * forces of a drive are left out (a Hill equation). Rest is unstable where the larger |multiplier| is
 * above 1: both are found from the map of two unit vectors over the period. */
#ifndef HOST_SIM_STABILITY_FLOQUET_H
#define HOST_SIM_STABILITY_FLOQUET_H

#include "firmware/method/method.h"
#include "models/scenes/scenes.h"

struct stability_tangent {
    double damping, stiffness, modulation, omega; /* model units */
    double time_s;                                /* one model unit of time, real plant */
    int input;                                    /* that modulates */
};

/* Finds the linear part of a scene. NULL, or why there is none. */
const char *stability_tangent_of(const struct scene *s, struct stability_tangent *t);

/* The matrix that takes (x, x') through `periods` periods of the modulation in `steps` steps. False: it is
 * not finite. */
bool stability_map(const struct stability_tangent *t, const struct method *method, double tol, int periods,
                   int steps, double map[2][2]);

/* The larger |multiplier| of one period, of the method and of the plant (by taylor at 1e-13). Infinite
 * where the map is not finite. */
double stability_multiplier(const struct stability_tangent *t, const struct method *method, double tol,
                            int periods, int steps);
double stability_exact(const struct stability_tangent *t);

/* Finds whole periods and whole steps in them such that a step is `step`, in model time, to 1e-3. */
void stability_steps(const struct stability_tangent *t, double step, int *periods, int *steps);

/* NULL, or why this method refuses a modulated stiffness. */
const char *stability_refuse(const struct method *method, double tol);

#endif
