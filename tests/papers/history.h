/* history.h - attractors of the shaft as histories, phase portraits and Poincare sections. */
#ifndef TESTS_PAPERS_HISTORY_H
#define TESTS_PAPERS_HISTORY_H

#include "tests/papers/attractor.h"
#include "tests/papers/motion.h"

/* The plant on this attractor's motion, at phase 0, with this many ticks a period. */
int history_ticks(const double *paper);
bool history_start(struct motion *m, const double *paper, const struct attractor *a);

/* Curve NAME of FIGURE: x1 (mm) over `periods` (ms); of "FIGURE x2" and "FIGURE x3" too, if n_coordinates is 3. */
void history_sample(const char *figure, const char *name, const double *paper, const struct attractor *a,
                    int periods, int n_coordinates);

/* Up to four coexisting attractors of so many starts, over two periods: curves "attractor 1" and on; their numbers. */
void history_draw(const char *figure, const double *paper, int starts, int n_coordinates);

#endif
