/* problem_records.h - residuals of records, part of a problem. */
#ifndef HOST_SIM_FIT_PROBLEM_RECORDS_H
#define HOST_SIM_FIT_PROBLEM_RECORDS_H

#include "host_sim/fit/solve/problem.h"

/* Residuals of all records in this form; they and their cost; slopes (not of the linear form). */
int problem_records_size(const struct problem *p);
double problem_records_residuals(const struct problem *p, const double *u, double *r);
void problem_records_slopes(const struct problem *p, const double *u, double *a);

#endif
