/* shaft_edge.c - where the impacting motion of figures 8, 17, 20 of the shaft-bearing paper ends, hard
 * contact.
 *
 * Prints docs/img/papers/shaft_edge.csv: shares of random starts that still impact after a while, and the
 * frequencies where these pass a level. */
#include <math.h>
#include <stdio.h>
#include "tests/papers/rows.h"
#include "tests/papers/survival.h"

static const double wait = 3.0; /* s, as in maps.c */

/* 25 N, hard contact, this support at bearing 3. */
static struct survival with_support(double ks3, double level, int starts)
{
    struct survival s = {.seconds = wait, .level = level, .starts = starts};
    attractor_paper(SHAFT_HARD, 700.0, s.paper);
    s.paper[SHAFT_KS3] = ks3;
    return s;
}

/* ---- figure 20 ---- */

/* With one mode kept: translation, from `bending` on that. */
static const double bending = 400.0;
static double share_of_mode(const struct survival *s)
{
    return survival_share_mode(s->paper, s->paper[SHAFT_PAPER_HZ] < bending ? 1 : 3, wait, s->starts);
}

static void draw_shares(void)
{
    static const double support[] = {8030.0, 803.0, 0.0};
    char name[32];
    for (int k = 0; k < 3; k += 2) {
        struct survival s = with_support(support[k], 0.0, 80);
        snprintf(name, sizeof name, "mode ks3=%g", support[k]);
        for (int i = 0; i <= 39; i++) {
            s.paper[SHAFT_PAPER_HZ] = 20.0 + 20.0 * i;
            if (s.paper[SHAFT_PAPER_HZ] == bending)
                rows_break();
            rows_point("20 share", name, s.paper[SHAFT_PAPER_HZ], share_of_mode(&s));
        }
        rows_break();
    }
    for (int k = 0; k < 3; k++) {
        struct survival s = with_support(support[k], 0.0, 80);
        snprintf(name, sizeof name, "ks3=%g", support[k]);
        for (int i = 0; i <= 39; i++) {
            s.paper[SHAFT_PAPER_HZ] = 20.0 + 20.0 * i;
            rows_point("20 share", name, s.paper[SHAFT_PAPER_HZ], survival_share(s.paper, wait, s.starts));
        }
        rows_break();
    }
}

static void draw_supports(void)
{
    static const double support[] = {0.0, 200.0, 803.0, 2409.0, 5000.0, 8030.0};
    for (int side = 0; side < 2; side++) {
        for (int i = 0; i < 6; i++) {
            struct survival s = with_support(support[i], 0.5, 100);
            rows_point("20 edges", side ? "upper" : "lower", support[i],
                       survival_edge(&s, 700.0, side ? 850.0 : 500.0));
        }
        rows_break();
    }
}

/* An edge, and its bracket of two standard errors of the share. */
static void tell_edge(const char *what, struct survival s, double inside, double outside)
{
    double level = s.level, error = sqrt(level * (1.0 - level) / s.starts);
    rows_number(what, survival_edge(&s, inside, outside));
    for (int side = -1; side <= 1; side += 2) {
        s.level = level - 2.0 * side * error;
        rows_number(side < 0 ? "  bracket, inside" : "  bracket, outside",
                    survival_edge(&s, inside, outside));
    }
}

static void tell_supports(void)
{
    static const double support[] = {8030.0, 0.0}, near[] = {0.85, 1.15};
    char name[80];
    for (int k = 0; k < 2; k++) {
        struct survival s = with_support(support[k], 0.5, 200);
        rows_number("fig 20, ks3", support[k]);
        rows_number("  no quiet motion from, Hz", survival_quiet(s.paper, 699.8, 650.0));
        rows_number("  to", survival_quiet(s.paper, 699.8, 750.0));
        tell_edge("  half impact after 3 s from", s, 700.0, 500.0);
        tell_edge("  to", s, 700.0, 850.0);
        s.level = 0.1;
        tell_edge("  a tenth from", s, 700.0, 500.0);
        tell_edge("  to", s, 700.0, 850.0);
        for (int i = 0; i < 4; i++) {
            s.paper[SHAFT_PAPER_HZ] = (double[]){670.0, 680.0, 740.0, 760.0}[i];
            snprintf(name, sizeof name, "  %g Hz: impacting after 3 s", s.paper[SHAFT_PAPER_HZ]);
            rows_number(name, survival_share(s.paper, wait, s.starts));
        }
    }
    for (int k = 0; k < 2; k++) {
        struct survival s = with_support(8030.0 * near[k], 0.5, 200);
        rows_number("fig 20, ks3", s.paper[SHAFT_KS3]);
        rows_number("  half impact after 3 s from", survival_edge(&s, 700.0, 500.0));
        rows_number("  to", survival_edge(&s, 700.0, 850.0));
    }
}

/* ---- figure 8: which forces? ---- */

/* Edges of a tenth, which at 25 N are those that the paper tells of figure 20. */
static void draw_forces(void)
{
    for (int side = 0; side < 3; side++) {
        for (int i = 2; i <= 10; i++) {
            struct survival s = with_support(8030.0, 0.1, 100);
            s.paper[SHAFT_PAPER_P1 + 1] = 5.0 * i;
            rows_point("8 edges", (const char *[]){"low", "lower", "upper"}[side], 5.0 * i,
                       survival_edge(&s, side ? 700.0 : 20.0, (double[]){350.0, 500.0, 850.0}[side]));
        }
        rows_break();
    }
    for (double force = 35.0; force <= 40.0; force += 2.5) {
        struct survival s = with_support(8030.0, 0.1, 200);
        s.paper[SHAFT_PAPER_P1 + 1] = force;
        rows_number("fig 8, force", force);
        tell_edge("  a tenth impact after 3 s up to", s, 20.0, 350.0);
        tell_edge("  from", s, 700.0, 500.0);
        tell_edge("  to", s, 700.0, 850.0);
    }
}

/* ---- shares at the ends that the paper names ---- */

static void tell_ends(void)
{
    enum { STARTS = 40 };
    char name[80];
    for (double hz = 26.0; hz <= 29.5; hz += 0.5) {
        struct survival s = with_support(8030.0, 0.0, STARTS);
        s.paper[SHAFT_PAPER_HZ] = hz;
        for (int i = 0; i < 3; i++)
            s.paper[SHAFT_C1 + i] = 184.0;
        snprintf(name, sizeof name, "fig 17, c = 184, %g Hz: impacting after 3 s", hz);
        rows_number(name, survival_share(s.paper, wait, STARTS));
        rows_number("  of one mode kept", share_of_mode(&s));
    }
    for (int i = 0; i < 4; i++) {
        struct survival s = with_support(8030.0, 0.0, 100);
        s.paper[SHAFT_PAPER_HZ] = (double[]){112.0, 200.0, 500.0, 690.0}[i];
        snprintf(name, sizeof name, "fig 8, %g Hz: impacting after 3 s", s.paper[SHAFT_PAPER_HZ]);
        rows_number(name, survival_share(s.paper, wait, s.starts));
        rows_number("  of one mode kept", share_of_mode(&s));
    }
    for (int weak = 0; weak < 2; weak++) {
        for (double hz = 100.0; hz <= 200.0; hz += 50.0) {
            struct survival s = with_support(weak ? 0.0 : 8030.0, 0.0, STARTS);
            s.paper[SHAFT_PAPER_HZ] = hz;
            snprintf(name, sizeof name, "fig 20, ks3 = %g, %g Hz: impacting after 2 s", s.paper[SHAFT_KS3],
                     hz);
            rows_number(name, survival_share(s.paper, 2.0, STARTS));
        }
    }
}

/* Figure 23: where the resonance of a soft spring at bearing 3 begins: x3 of the largest of some motions. */
static void tell_resonance(void)
{
    char name[80];
    for (double hz = 95.0; hz <= 115.0; hz += 5.0) {
        double paper[MODEL_PARAMETERS], state[MODEL_STATES], best = 0.0;
        struct attractor_shaft s;
        struct attractor a;
        uint64_t seed = 9;
        attractor_paper(SHAFT_HARD, hz, paper);
        paper[SHAFT_KG3] = 1e6;
        if (!attractor_open(&s, &shaft_bearing, paper))
            return;
        for (int i = 0; i < 40; i++) {
            attractor_start(&seed, paper[SHAFT_G1], state);
            if (attractor_settle(&s, state, wait, &a))
                best = fmax(best, a.high[2]);
        }
        attractor_close(&s);
        snprintf(name, sizeof name, "fig 23, kg3 = 1e6, %g Hz: largest x3 of 40 starts, mm", hz);
        rows_number(name, best * 1e3);
    }
}

int main(void)
{
    rows_print_header();
    draw_shares();
    draw_supports();
    draw_forces();
    tell_supports();
    tell_ends();
    tell_resonance();
    return 0;
}
