/* choose_watch.h - the conditions that void a certificate, one row each, and who sees each of them.
 *
 * A condition is a limit on an observable wherever one covers the danger. Other dangers leave no trace in
 * the reduced model, or concern motions that nobody has run. For these any change is watched, because the
 * certificate is for the scene's own motion.
 *
 * Errors are carried over by their leading power. The error of a force law cut off after order n grows
 * with amplitude^n relative to the motion. The error of rk4 grows with (h omega)^(5/2) where contact is
 * lost, else with its fourth power; that of modal with the square. Over time errors grow on exponentially, as
 * in the second half of the time asked. The rate is that of the choice, or that between neighbouring full
 * motions where these grow faster. How far a reduced shaft is good is found by runs (choose_beyond.c). */
#ifndef HOST_SIM_CHOOSE_WATCH_H
#define HOST_SIM_CHOOSE_WATCH_H

#include "host_sim/choose/choose.h"
#include "host_sim/choose/choose_steps.h"

/* Fills condition[] of a certificate with a chosen model. */
void choose_watch(struct choose_certificate *c);

/* The watch of a certificate, NULL where nothing is certified. The full model may refuse the climb that it
 * names. */
const struct scene_watch *choose_watched(const struct choose_certificate *c);

#endif
