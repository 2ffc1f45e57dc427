/* kirrou_paper.h - Kirrou & Belhaq 2013: the paper's sets
 * of parameters, its theory, and its figures by group. */
#ifndef TESTS_PAPERS_KIRROU_PAPER_H
#define TESTS_PAPERS_KIRROU_PAPER_H

#include "tests/papers/motion.h"
#include "tests/papers/theory.h"

enum { KIRROU_CURVE = 50 /* pieces of a curve */, KIRROU_STEPS = 36 /* in a sweep */ };
#define KIRROU_LEAP  0.25  /* relative change of amplitude from one point to the next that is a jump */
#define KIRROU_DRIVE 0.008 /* f, where a figure does not vary it */

/* c = 0.02; `fast` is the modulation's frequency Omega. */
void kirrou_paper(double beta, double r, double fast, double f, double *paper);
struct tip_theory kirrou_theory(double beta, double r, double fast);

/* Eq 21 against the detuning. */
void kirrou_draw_theory(const char *figure, const struct tip_theory *t, double f, double from, double to);

/* A stepped sweep of the drive's frequency. */
struct sweep kirrou_sweep(const struct model *model, const double *paper, double from, double to, int steps);

/* Figures 2, 3, 14 (r = 0), 4 and 5 (kirrou_unmodulated.c); 6, 7, 13, 14, 8, 4b, 5, 16 (kirrou_modulated.c);
 * 9 to 12, 15 (kirrou_critical.c); numbers without a chart (kirrou_numbers.c). */
void kirrou_draw_unmodulated(void);
void kirrou_draw_modulated(void);
void kirrou_draw_critical(void);
void kirrou_tell_numbers(void);

#endif
