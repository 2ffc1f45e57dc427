/* exact_tables.h - method exact at the start: refusals, and the tables. */
#ifndef FIRMWARE_EXACT_TABLES_H
#define FIRMWARE_EXACT_TABLES_H

#include "firmware/method/exact/exact.h"

/* `refuse` and `prepare` of the method. */
const char *exact_refuse(const struct model *m, const double *p, double h, double tol);
void exact_prepare(const struct model *m, const double *p, double h, double tol, double *scratch);
/* The tables of input i at this frequency. */
void exact_tune(struct exact_system *s, const struct model *m, double h, int i, double omega);

#endif
