/* rig.h - the Hertz rig in the paper's normalisation, for tests. */
#ifndef TESTS_RIG_H
#define TESTS_RIG_H

#include "firmware/plant.h"

enum { XI, SIGMA, OMEGA, PHI, FAST_OMEGA, A_FORCE, A_BASE, A_STIFF, PAPER };

/* The paper's defaults: xi 0.01, omega 1, Omega 8, no drives. */
void rig_paper(double paper[PAPER]);

/* A plant with these paper parameters, model time as bus time, tick h, started at (q, q_dot) with its drives on. */
void rig_start(struct plant *pl, const double paper[PAPER], double h, double q, double q_dot);

/* The state in the paper's units. */
double rig_q(const struct plant *pl);
double rig_q_dot(const struct plant *pl);

/* Runs whole ticks; a plant that fails is a failed check. */
void rig_run(struct plant *pl, uint64_t ticks);

#endif
