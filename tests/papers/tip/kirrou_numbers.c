/* kirrou_numbers.c - see kirrou_paper.h: statements of the paper
 * that are numbers, or signs, and stand in no chart of their own. */
#include <math.h>
#include <stdio.h>
#include "models/reduced/afm_tip_reduced.h"
#include "tests/papers/tip/kirrou_paper.h"
#include "tests/papers/rows.h"

/* Figure 4b: the modulation from which there is one amplitude only at all detunings. */
static void tell_end_of_bistability(double beta, double fast)
{
    double low = 0.0, high = 1.2, turn[2];
    while (high - low > 1e-6) {
        double middle = 0.5 * (low + high);
        struct tip_theory t = kirrou_theory(beta, middle, fast);
        *(theory_tip_turns(&t, KIRROU_DRIVE, turn) ? &low : &high) = middle;
    }
    rows_number("fig 4b: bistability by eq 21 ends at r", low);
}

/* Figures 7, 10 (its small boxes), 13, 14: softening or not, and where the peak is. */
static void tell_response(const char *figure, double beta, double r, double fast)
{
    char name[80];
    double a, turn[2];
    struct tip_theory t = kirrou_theory(beta, r, fast);
    double sigma = theory_tip_peak(&t, KIRROU_DRIVE, &a);
    snprintf(name, sizeof name, "fig %s, beta %g, Omega %g, r %g: rho_n + rho_l", figure, beta, fast, r);
    rows_number(name, t.rho_n + t.rho_l);
    rows_number("  detuning of the peak of eq 21", sigma);
    rows_number("  its frequency", t.w1 + sigma);
    rows_number("  its amplitude", a);
    rows_number("  jumps (1: yes)", theory_tip_turns(&t, KIRROU_DRIVE, turn));
}

/* Section 3.1: "values of r larger than 1 mean loss of contact", which is u > 1. */
static void tell_contact(double r, double fast)
{
    static struct motion m;
    double paper[MODEL_PARAMETERS];
    char name[80];
    struct tip_theory t = kirrou_theory(0.8, r, fast);
    kirrou_paper(0.8, r, fast, KIRROU_DRIVE, paper);
    paper[TIP_PAPER_OMEGA] = t.w1;
    if (motion_start(&m, &afm_tip, paper, MOTION_TWO_PI / fast / 48.0, 1e-9, NULL) != NULL)
        return;
    bool stays = motion_settle(&m, 1000.0);
    struct seen seen = motion_watch(&m, 0, t.w1, 1000.0);
    snprintf(name, sizeof name, "r %g, Omega %g, true contact at w1: highest u", r, fast);
    rows_number(name, stays ? seen.high : (double)NAN);
    rows_number("  share of time without contact", stays ? seen.loss : (double)NAN);
}

void kirrou_tell_numbers(void)
{
    tell_end_of_bistability(0.8, 1.0);
    tell_end_of_bistability(0.8, 2.0);
    tell_response("7", 0.8, 0.0, 1.0);
    tell_response("7", 0.8, 0.4, 1.0);
    tell_response("7", 0.8, 0.7, 1.0);
    tell_response("7, 10b", 0.8, 1.0, 1.0);
    tell_response("10a", 0.8, 1.0, 0.6);
    tell_response("10c", 0.8, 0.6, 1.5);
    tell_response("13", 0.8, 0.4, 0.6);
    tell_response("13", 0.8, 0.7, 0.6);
    tell_response("13", 0.8, 0.9, 0.6);
    tell_response("14", 0.95, 0.0, 1.0);
    tell_response("14", 0.95, 0.4, 1.0);
    tell_response("14", 0.95, 0.7, 1.0);
    tell_response("14", 0.95, 1.0, 1.0);
    tell_contact(1.1, 3.0);
    tell_contact(1.2, 3.0);
}
