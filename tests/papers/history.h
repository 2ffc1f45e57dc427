/* history.h - attractors of the shaft as histories, phase portraits and Poincare sections. */
#ifndef TESTS_PAPERS_HISTORY_H
#define TESTS_PAPERS_HISTORY_H

#include "tests/papers/attractor.h"
#include "tests/papers/motion.h"

/* `model`: shaft_bearing, or shaft_bearing_mode with the mode that `paper` keeps. */

/* The plant on this attractor's motion, at phase 0, with this many ticks a period. */
int history_ticks(const double *paper);
bool history_start(struct motion *m, const struct model *model, const double *paper,
                   const struct attractor *a);

/* The shaft's paper state now: of a mode, as it moves the three masses. */
void history_state(const struct motion *m, double *state);

/* Curve NAME of FIGURE: x1 (mm) over `periods` (ms); of
 * "FIGURE x2" and "FIGURE x3" too, if n_coordinates is 3. */
void history_sample(const char *figure, const char *name, const struct model *model, const double *paper,
                    const struct attractor *a, int periods, int n_coordinates);

/* Up to four coexisting attractors of so many starts, over two periods: curves "attractor 1" and on, of a
 * mode "mode 1" and on; their numbers. */
void history_draw(const char *figure, const struct model *model, const double *paper, int starts,
                  int n_coordinates);

#endif
