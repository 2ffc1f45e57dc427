/* rules.h - rules for the work and the loss of a motion, compared by ledger_rules.c. */
#ifndef TESTS_BENCH_LEDGER_RULES_H
#define TESTS_BENCH_LEDGER_RULES_H

#include "tests/bench/ledger/record.h"

struct books {
    struct sum work, damping; /* by the one drive, and lost */
    double gross, force;      /* as the ledger books them */
};

/* Adds what pieces from..to - 1 move. */
typedef void rule_function(const struct record *r, int from, int to, struct books *b);

struct rule {
    const char *name;
    rule_function *function[RECORD_SCENES]; /* NULL: not for this scene */
    bool uncounted;                         /* it computes tables on the way, for its error only */
};

enum { RULES = 9 };
extern const struct rule rule_table[RULES];

/* A set-up that some rules need for each record; not part of their cost. */
void rules_prepare(const struct record *r);

/* The terms of `taylor`, summed up over each series, or read after each tick. */
rule_function rule_series_rig, rule_series_tip, rule_terms_rig, rule_terms_tip;

/* Closed forms of a linear regime over whole ticks, Simpson's rule over others; and over all pieces. */
rule_function rule_forms_shaft, rule_all_forms_shaft;
void forms_prepare(const struct record *r);

/* Simpson's rule, as the product has it. */
void rule_by_ledger(const struct record *r, int from, int to, struct books *b);

static inline void rules_add(struct sum *s, double x)
{
    double t = s->value + x, part = t - s->value;
    s->carry += (s->value - (t - part)) + (x - part);
    s->value = t;
}

static inline void rules_book(struct books *b, double work, double damping)
{
    rules_add(&b->work, work);
    rules_add(&b->damping, damping);
    b->gross += (work < 0.0 ? -work : work) + damping;
}

#endif
