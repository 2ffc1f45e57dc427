/* lever_judge.h - a lever over a sample, integrated from the equations of docs/reference/afm_lever.md in SI:
 * the pair of Dormand and Prince (1980) with its own steps. It shares no code with the plant but the start
 * at rest. For tests/choose/choose_levers.c. */
#ifndef TESTS_LEVER_JUDGE_H
#define TESTS_LEVER_JUDGE_H

#include <stdbool.h>
#include "models/scenes/scenes.h"

struct lever_judged {
    double *value, span, loss; /* at the instants; range over all time; share of time without contact */
};

/* The observable at the `n` instants `at` of the real plant, in s, into j->value[]. `error` of a step, in
 * 1e-9 m. False: a step without end. */
bool lever_judge(const struct scene *s, double error, const double *at, int n, struct lever_judged *j);

#endif
