/* bench.h - problems, entries and results of the speed-against-accuracy benchmark. */
#ifndef TESTS_BENCH_BENCH_H
#define TESTS_BENCH_BENCH_H

#include <stddef.h>
#include "tests/bench/equation.h"

#ifdef __cplusplus
extern "C" {
#endif

struct model;

enum { CASE_SETS = 24, CASE_OUTPUTS = 64, BENCH_ENTRIES = 2000, BENCH_ROUNDS = 32 };

/* A motion to compute. */
struct bench_case {
    const char *name, *title;
    const struct model *model;
    struct {
        const char *name;
        double value;
    } set[CASE_SETS];              /* paper parameters; the others keep their defaults */
    double state[EQUATION_STATES]; /* the paper's */
    const char *omega;             /* the paper's parameter that gives the forcing period, rad or Hz */
    int periods, stride;           /* in all, and from one output to the next */
    int holds;                     /* samples an output interval at which the force changes; 0: harmonic */
};

extern const struct bench_case bench_cases[];
extern const int n_bench_cases;

/* A case made ready. Times and states of the equation. */
struct problem {
    const struct bench_case *c;
    struct equation eq;
    double y0[EQUATION_STATES];
    double interval; /* from output to output */
    int n_out, holds;
    double *held; /* [n_out * holds] force samples, or NULL */
    double ref[CASE_OUTPUTS][EQUATION_STATES];
    double column[EQUATION_STATES]; /* largest |ref| */
    double paper[64];
    double period; /* the paper's time */
};

double problem_paper(const struct problem *b, const char *name);
void problem_make(struct problem *b, const struct bench_case *c);

/* Reference by power series in long double, switches located, contacts in regularised variables. */
void reference_series(struct problem *b);
/* Computes the reference again by Dormand-Prince 5(4) in long double, straight through the switches.
 * Returns the largest difference relative to the column. */
double reference_check(const struct problem *b);

enum side { SIDE_PEER, SIDE_METHOD, SIDE_PLANT, SIDE_BATCH };

/* One way to compute a problem. */
struct entry {
    const char *family; /* one row of the table, the best of its settings */
    char setting[64];
    double knob;    /* tolerance, or steps an output interval */
    enum side side; /* a peer; a method of ours alone; the whole plant around it; many trajectories at once */
    int trajectories; /* that one run computes; the time is that of one of them */
    void (*run)(void *context, double (*out)[EQUATION_STATES]);
    void (*convert)(void *context, double (*out)[EQUATION_STATES]); /* to the equation's states, or NULL */
    void (*release)(void *context);
    void *context;
    /* measured */
    double error;                       /* worst over outputs and states, relative to the column */
    double ns[BENCH_ROUNDS], ns_median; /* a forcing period */
    int repeats;
    bool timed;
};

struct bench {
    struct problem problem;
    struct entry entry[BENCH_ENTRIES];
    int n;
};

/* A new entry to be filled in. */
struct entry *bench_add(struct bench *b, const char *family, const char *setting, double knob);
double bench_now_ns(void);
void *bench_alloc(size_t size);

void ours_add(struct bench *b);
void batch_add(struct bench *b);
void naive_add(struct bench *b);
void gsl_add(struct bench *b);
void cvode_add(struct bench *b);
void odeint_add(struct bench *b);
const char *gsl_version_text(void);
const char *cvode_version_text(void);
const char *odeint_version_text(void);

/* Tolerances that every solver is given: half decades from 1e-2 to 1e-14. */
enum { BENCH_TOLERANCES = 25 };
double bench_tolerance(int i);

/* Cost at an error, from the entries of a family that no other one of it beats: between two of them a
 * straight line in log-log. 0 when the error is never reached. family NULL: the best of that side; *which is
 * the one. */
double front_cost(const struct bench *b, const char *family, enum side side, double error,
                  const char **which);
/* The entry is such a one. */
bool front_has(const struct bench *b, const struct entry *e);

#ifdef __cplusplus
}
#endif
#endif
