/* adams_weights.h - the weights of `adams`, which a wave sets. */
#ifndef FIRMWARE_METHOD_ADAMS_WEIGHTS_H
#define FIRMWARE_METHOD_ADAMS_WEIGHTS_H

#include "firmware/method/adams/adams.h"

/* Angles (rad a tick) that weights are fitted to. Below the least, polynomials do as well, and the formulas
 * lose digits, as they do towards pi. */
#define ADAMS_FIT_LEAST 0.05
#define ADAMS_FIT_MOST  2.2

/* Weights of s->h for a wave that turns by `angle` (rad) in a tick; outside these bounds they are those of
 * polynomials alone. Returns whether they changed: then the past is to be weighed anew. Costs 400
 * instructions, and nothing where the angle is as before. */
bool adams_weigh(struct adams *s, double angle);

#endif
