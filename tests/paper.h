/* paper.h - any model in its paper's parameters, states and time, for tests. */
#ifndef TESTS_PAPER_H
#define TESTS_PAPER_H

#include "firmware/plant.h"

/* The paper's defaults. */
void paper_defaults(const struct model *m, double *paper);

/* Index of a paper parameter; -1 for none. */
int paper_index(const struct model *m, const char *name);

/* SI parameters and prepared numbers of these paper parameters. */
void paper_prepare(const struct model *m, const double *paper, double *si, double *p, struct scale *scale);

/* A plant with these paper parameters, tick h in the paper's time, started at `state` with its drives on. */
void paper_start(struct plant *pl, const struct model *m, const double *paper, double h, const double *state);

/* The state in the paper's symbols. */
void paper_now(const struct plant *pl, double *state);

#endif
