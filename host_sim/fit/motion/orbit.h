/* orbit.h - a motion with the period of its drive, found on the plant itself, and what it depends on.
 *
 * The plant runs through one period from a state x. Newton's method finds the x to which it returns; the map
 * of the period from x to x is its matrix. A motion is stable where powers of that matrix fall to 0. The
 * response is the first harmonic of an output over a drive that is amplitude cos(2 pi frequency t). States
 * are SI. A period takes as many ticks as the output and the contact need, ORBIT_TICKS at least. */
#ifndef HOST_SIM_FIT_ORBIT_H
#define HOST_SIM_FIT_ORBIT_H

#include "firmware/plant/plant.h"

enum { ORBIT_TICKS = 32, ORBIT_STATES = 6 };

/* A plant, and the response that is measured; all but `periods` stays as it is from one frequency to the
 * next. */
struct orbit_task {
    const struct model *model;
    const struct method *method;
    double tol;
    double *scratch; /* memory of the method */
    int input, output;
    int derivatives; /* the response is that of the output's derivative, so many times */
    double si[MODEL_PARAMETERS];
    double amplitude; /* amplitude of the drive, the input's unit */
    uint64_t periods; /* that were computed so far */
    bool hasty;       /* to a neighbour in one step, and what settles slowly is no motion: for a first look */
    bool to_the_end;  /* runs go on after the user's wish to stop: what was found is told */
};

struct orbit {
    double frequency_Hz;
    double x[ORBIT_STATES]; /* where the drive is at its largest */
    double re, im;          /* the response: re + i im = A e^(i phase) */
    double map[ORBIT_STATES][ORBIT_STATES];
    double re_x[ORBIT_STATES], im_x[ORBIT_STATES]; /* its slopes over x */
};

/* The user wants an end: every run of the plant fails from now on. */
bool orbit_stopped(const struct orbit_task *t);

/* The eigenfrequency of its closed contact, and its plant with ticks of this length. NULL, or why there is no
 * such plant. */
const char *orbit_contact(const struct orbit_task *t, double *contact_Hz);
const char *orbit_plant(const struct orbit_task *t, double tick_s, struct plant *pl);

/* NULL, or why a plant of these parameters does not run at this frequency. */
const char *orbit_refused(const struct orbit_task *t, double frequency_Hz);

/* The state at rest, and for each state one unit of its quantity. */
void orbit_rest(const struct orbit_task *t, double *x, double *unit);

/* So many periods: o->x goes on. False: it escaped. */
bool orbit_settle(struct orbit_task *t, struct orbit *o, int periods);

/* From o->x to the periodic motion near it, with its map and slopes. False: Newton's method found none. */
bool orbit_find(struct orbit_task *t, struct orbit *o);

/* The response of the output's derivative, n times: times (i omega)^n. */
void orbit_differentiate(int n, double omega, double *re, double *im);

bool orbit_is_stable(const struct orbit_task *t, const struct orbit *o);

/* Map and slopes of a motion that was found, to full accuracy: orbit_find leaves those of its last steps. */
bool orbit_sharpen(struct orbit_task *t, struct orbit *o);

/* The slope of the response over something on which the plant depends: `above` and `below` are the plants
 * where that differs by `difference`. False: one escapes. */
bool orbit_slope(struct orbit_task *below, struct orbit_task *above, const struct orbit *o, double difference,
                 double *re, double *im);

#endif
