/* choose_steps.h - the steps of the search, shared by the files of choose; see choose.h. */
#ifndef HOST_SIM_CHOOSE_STEPS_H
#define HOST_SIM_CHOOSE_STEPS_H

#include "host_sim/choose/choose.h"
#include "host_sim/scene/scene_check.h"

enum { CHOOSE_SUBSTEPS = 4096 /* in a frame, at most */ };

enum { OUTPUT_VELOCITY = 1, OUTPUT_PENETRATION = 2, OUTPUT_FORCE = 3 }; /* outputs of every model */

struct search {
    struct choose_certificate *c;
    struct choose_record truth;
    FILE *progress;
    double begin_s;
};

/* ---- choose_tell.c ---- */

/* Writes text into a field of the certificate, cut at its size. */
void choose_say(char text[CHOOSE_TEXT], const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Prints a line of progress, once the search has taken two seconds. */
void choose_tell(const struct search *o, const char *what, const struct scene *s);

/* ---- choose_truth.c ---- */

/* Tolerances of series where the model is judged, not the method. */
#define CHOOSE_TIGHT 1e-12
#define CHOOSE_LOOSE 1e-10

/* The first number of substeps from n on that the scene may have; 0 and the reason when there is none. */
int choose_allow(struct scene *s, double n, char why[SCENE_CHECK_REASON]);

/* Makes the method exact or, without that, series of this tolerance; exact with `finer` times as many
 * steps. A lever takes fine steps of modal. False: why. */
bool choose_tighten(struct scene *s, double tol, double finer, char why[SCENE_CHECK_REASON]);

/* The truth, its own error, and whether trajectories can be compared at all. NULL, or why there is none. */
const char *choose_truth(struct search *o, bool *escaped);

/* The error of a run by the measure of the certificate; does it keep the tolerance, with room to spare? */
double choose_error(const struct search *o, const struct choose_record *r);
bool choose_meets(const struct search *o, double error);

/* A measured error must leave this much room: others sample elsewhere. */
#define CHOOSE_ROOM 1.25

/* A neighbouring start, model units. */
#define CHOOSE_NUDGE 1e-9

/* The truth's own error and rounding: differences below mean nothing. */
double choose_resolution(const struct choose_certificate *c);

/* ---- choose_climb.c ---- */

/* The rank of a trial: time on the machine, instructions where that is not known. */
double choose_rank(const struct choose_certificate *c, const struct choose_trial *t, int method);

/* The highest frequency of the sweep, of the real plant; 0 without one. */
double choose_swept_Hz(const struct choose_certificate *c);

/* Fills the costs of a trial from its scene. */
void choose_price(const struct search *o, struct choose_trial *t, int method);

/* The coarsest step of a method that meets the tolerance, unless it ranks above `most`. */
void choose_climb(struct search *o, struct choose_verdict *v, int method, double most);

/* ---- choose_refuse.c ---- */

/* The tests that run nothing but what the truth has shown; fills predicted and refused. */
void choose_refuse(const struct search *o, struct choose_verdict *v);

/* ---- choose_beyond.c ---- */

/* How far the chosen reduced model of a shaft is good. It and the full model run with all drives larger
 * and larger, up to four times, until the error passes the tolerance; a chaotic motion is taken as it is.
 * Returns the last factor before, and the reach of these runs. */
double choose_beyond(const struct choose_certificate *c, double reach[2]);

/* ---- choose_watch.c ---- */

/* Fills condition[] of a certificate with a chosen model. */
void choose_watch(struct choose_certificate *c);

#endif
