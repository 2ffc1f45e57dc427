/* shaft.c - figures 4 to 9, 12 to 16, 18, 19, 21 of the shaft-bearing paper: linear theory, the one-mode rung and the
 * true contact; periodic motions by branch and period, chaotic ones by statistics. Prints docs/papers/shaft.csv. */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "tests/papers/attractor.h"
#include "tests/papers/branch.h"
#include "tests/papers/rows.h"

enum { CURVE = 60 };
static struct motion m;
static const double mm = 1e3;

/* ---- figures 4, 5, 21: linear frequencies ---- */

static void draw_frequencies(void)
{
    double paper[MODEL_PARAMETERS], hz[3];
    char name[32];
    for (int i = 0; i <= CURVE; i++) {
        double share = (double)i / CURVE, kg = 35.02 * pow(1e9, share);
        attractor_paper(kg, 25.0, paper);
        attractor_frequencies(paper, 1.0, hz);
        for (int k = 0; k < 3; k++) {
            snprintf(name, sizeof name, "mode %d", k + 1);
            rows_point("4", name, kg, hz[k]);
        }
        paper[SHAFT_KS3] = 8030.0 * share;
        paper[SHAFT_KG1] = paper[SHAFT_KG3] = SHAFT_SOFT;
        for (int closed = 0; closed < 2; closed++) {
            attractor_frequencies(paper, closed, hz);
            for (int k = 0; k < 2; k++) {
                snprintf(name, sizeof name, "mode %d", k + 1);
                rows_point(closed ? "21" : "5", name, 8030.0 * share, hz[k]);
            }
        }
    }
    rows_break();
}

/* ---- figures 6, 7: the linear shaft with one weak support ---- */

static void draw_linear(void)
{
    static const double ks3[] = {8030.0, 4015.0, 803.0, 0.0};
    double paper[MODEL_PARAMETERS], amplitude[3];
    char name[32];
    for (int middle = 1; middle >= 0; middle--) {
        for (int k = 0; k < 4; k++) {
            for (int i = 0; i <= 160; i++) {
                double hz = 1.0 + 44.0 * i / 160.0;
                attractor_paper(SHAFT_HARD, hz, paper);
                paper[SHAFT_KS3] = ks3[k];
                paper[SHAFT_PAPER_P1] = middle ? 0.0 : 25.0;
                paper[SHAFT_PAPER_P1 + 1] = middle ? 25.0 : 0.0;
                attractor_linear(paper, amplitude);
                snprintf(name, sizeof name, "ks3 %d", k);
                rows_point(middle ? "6" : "7", name, hz, amplitude[0] * mm);
            }
            rows_break();
        }
    }
}

/* ---- figures 8, 12, 14, 15: response curves ---- */

static void draw_theory(const char *figure, double force, double from, double to)
{
    double paper[MODEL_PARAMETERS], amplitude[3];
    for (int i = 0; i <= 2 * CURVE; i++) {
        double hz = from + (to - from) * i / (2 * CURVE);
        attractor_paper(SHAFT_HARD, hz, paper);
        paper[SHAFT_PAPER_P1 + 1] = force;
        attractor_linear(paper, amplitude);
        rows_point(figure, "theory", hz, amplitude[0] * mm);
    }
    rows_break();
}

struct band {
    const char *figure;
    double gap_stiffness, force, from, to;
    int points, starts, mode; /* mode: of the one-mode rung beside it */
    double span, seconds;     /* of the starts' positions; to settle */
};

/* Attractors from starts as the paper's, by their period; one that was seen at this frequency is not drawn again. */
static void draw_attractors(const struct band *b, const struct model *model, const char *prefix)
{
    uint64_t seed = 12345;
    char name[48];
    for (int i = 0; i <= b->points; i++) {
        double hz = b->from + (b->to - b->from) * i / b->points, paper[MODEL_PARAMETERS], state[MODEL_STATES];
        double seen[64];
        int n_seen = 0;
        attractor_paper(b->gap_stiffness, hz, paper);
        paper[SHAFT_PAPER_P1 + 1] = b->force;
        paper[SHAFT_PAPER_MODE] = b->mode;
        for (int k = 0; k < b->starts; k++) {
            struct attractor a;
            attractor_start(&seed, b->span, state);
            if (!attractor_settle(&m, model, paper, k == 0 ? NULL : state, b->seconds, &a))
                continue;
            bool known = false;
            for (int j = 0; j < n_seen; j++)
                known = known || fabs(seen[j] - a.high[0]) < 0.02 * a.high[0];
            if (known)
                continue;
            seen[n_seen++] = a.high[0];
            if (a.period == 0)
                snprintf(name, sizeof name, "%s aperiodic", prefix);
            else
                snprintf(name, sizeof name, "%s period %d", prefix, a.period > 3 ? 4 : a.period);
            rows_value(b->figure, name, hz, a.high[0] * mm, a.period);
        }
    }
    rows_break();
}

static void draw_branch(const char *figure, double gap_stiffness, double from, double to, double step,
                        int ticks, double unit)
{
    static struct branch_point point[BRANCH_POINTS];
    struct branch b = {.model = &shaft_bearing,
                       .swept = SHAFT_PAPER_HZ,
                       .turn = 1.0,
                       .unit = unit,
                       .ticks = ticks,
                       .from = from,
                       .to = to,
                       .step = step};
    char name[64];
    double x = HUGE_VAL, y = HUGE_VAL;
    bool stable = true;
    attractor_paper(gap_stiffness, from, b.paper);
    int n = branch_follow(&b, point);
    for (int i = 0; i < n; i++) {
        const struct branch_point *p = &point[i];
        bool now = p->multiplier < 1.0, special = p->fold || p->crossing;
        if (now == stable && !special &&
            hypot((p->at - x) / (to - from) * 100.0, log(p->high / y) * 10.0) < 1.0)
            continue;
        if (now != stable)
            rows_break();
        stable = now;
        x = p->at;
        y = p->high;
        rows_point(figure, now ? "branch" : "branch unstable", x, y * mm);
        snprintf(name, sizeof name, "fig %s: %s at Hz", figure, p->fold ? "fold" : "crossing");
        if (special)
            rows_number(name, x);
    }
    rows_break();
}

static void draw_responses(void)
{
    static const struct band bands[] = {
        {"8 low 25", SHAFT_HARD, 25.0, 1.0, 150.0, 74, 3, 1, 2.54e-4, 4.0},
        {"8 low 10", SHAFT_HARD, 10.0, 1.0, 150.0, 74, 2, 1, 2.54e-4, 4.0},
        {"8 high 25", SHAFT_HARD, 25.0, 650.0, 750.0, 50, 2, 3, 2.54e-4, 3.0},
        {"12", SHAFT_SOFT, 25.0, 3.0, 100.0, 194, 24, 1, 2.54e-4, 4.0},
        {"14", SHAFT_MID, 25.0, 680.0, 725.0, 60, 40, 3, 1e-3, 4.0},
    };
    for (size_t i = 0; i < sizeof bands / sizeof *bands; i++) {
        struct band mode = bands[i];
        mode.starts = 3;
        draw_theory(bands[i].figure, bands[i].force, bands[i].from, bands[i].to);
        draw_attractors(&bands[i], &shaft_bearing, "true");
        draw_attractors(&mode, &shaft_bearing_mode, "mode");
    }
    draw_branch("12", SHAFT_SOFT, 60.0, 10.0, 0.3, 256, 10.0);
    draw_branch("14", SHAFT_MID, 680.0, 720.0, 0.1, 16, 10.0);
}

/* ---- figure 9 and 19: chaos by statistics ---- */

/* Mean rate at which a nearby start leaves, per second: the largest Lyapunov exponent, over `periods`. */
static double lyapunov(const double *paper, const struct attractor *a, int periods)
{
    static struct motion other;
    double hz = paper[SHAFT_PAPER_HZ], here[MODEL_STATES], there[MODEL_STATES], sum = 0.0;
    double unit[6] = {1.0, 1.0, 1.0, MOTION_TWO_PI * hz, MOTION_TWO_PI * hz, MOTION_TWO_PI * hz};
    const double apart = 1e-9 * paper[SHAFT_G1];
    int ticks = attractor_ticks(paper);
    memcpy(here, a->state, sizeof here);
    memcpy(there, here, sizeof there);
    there[0] += apart;
    for (int i = 0; i < periods; i++) {
        double size = 0.0;
        if (motion_start(&m, &shaft_bearing, paper, 1.0 / (hz * ticks), 0.0, here) != NULL ||
            motion_start(&other, &shaft_bearing, paper, 1.0 / (hz * ticks), 0.0, there) != NULL ||
            !plant_run(&m.pl, (uint64_t)ticks) || !plant_run(&other.pl, (uint64_t)ticks))
            return (double)NAN;
        motion_state(&m, here);
        motion_state(&other, there);
        for (int k = 0; k < 6; k++)
            size += (there[k] - here[k]) * (there[k] - here[k]) / (unit[k] * unit[k]);
        sum += log(sqrt(size) / apart);
        for (int k = 0; k < 6; k++)
            there[k] = here[k] + (there[k] - here[k]) * apart / sqrt(size);
    }
    return sum * hz / periods;
}

static void draw_chaos(const char *figure, double hz, double seconds)
{
    double paper[MODEL_PARAMETERS], state[MODEL_STATES];
    uint64_t seed = 5;
    struct attractor a = {0};
    char name[64];
    attractor_paper(SHAFT_HARD, hz, paper);
    /* The impacting motion, not the quiet one beside it. */
    for (int i = 0; i < 20 && !(a.period == 0 && a.switches > 0.2); i++) {
        attractor_start(&seed, paper[SHAFT_G1], state);
        if (!attractor_settle(&m, &shaft_bearing, paper, state, seconds, &a))
            return;
    }
    snprintf(name, sizeof name, "fig 9, %g Hz: largest x1, mm", hz);
    rows_number(name, a.high[0] * mm);
    snprintf(name, sizeof name, "fig 9, %g Hz: switches in a period", hz);
    rows_number(name, a.switches);
    snprintf(name, sizeof name, "fig 9, %g Hz: share of time in contact", hz);
    rows_number(name, 1.0 - a.loss);
    int ticks = attractor_ticks(paper);
    for (int i = 0; i < 110; i++) {
        motion_state(&m, state);
        rows_point(figure, "true", state[0] * mm, state[3]);
        if (!plant_run(&m.pl, (uint64_t)ticks))
            return;
    }
    rows_break();
    snprintf(name, sizeof name, "fig 9, %g Hz: Lyapunov exponent, 1/s", hz);
    rows_number(name, lyapunov(paper, &a, hz > 100.0 ? 200 : 150));
}

/* Amplitude of harmonic k of x1 over whole periods of the chattering motion (figure 19). */
static void draw_spectrum(void)
{
    enum { HARMONICS = 400, PERIODS = 20 };
    static double complex line[HARMONICS + 1];
    double paper[MODEL_PARAMETERS], state[MODEL_STATES], sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    struct attractor a;
    int n = 0, ticks;
    attractor_paper(SHAFT_HARD, 5.0, paper);
    for (int i = 0; i < 3; i++)
        paper[SHAFT_C1 + i] = 139.0;
    if (!attractor_settle(&m, &shaft_bearing, paper, NULL, 2.0, &a))
        return;
    rows_number("fig 19: switches in a period, c = 139, 5 Hz", a.switches);
    ticks = attractor_ticks(paper);
    for (int i = 0; i < PERIODS * ticks; i++) {
        motion_state(&m, state);
        double complex turn = cexp(-(double complex)I * MOTION_TWO_PI * (i % ticks) / ticks), power = 1.0;
        for (int k = 1; k <= HARMONICS; k++) {
            power *= turn;
            line[k] += state[0] * power * 2.0 / (PERIODS * ticks);
        }
        if (!plant_run(&m.pl, 1))
            return;
    }
    for (int k = 1; k <= HARMONICS; k += 2) {
        if (k < 40 || k % 8 == 1)
            rows_point("19", "true", 5.0 * k, cabs(line[k]) * mm);
        if (k >= 3 && k <= 39) {
            double x = log(k), y = log(cabs(line[k]));
            n++;
            sx += x;
            sy += y;
            sxx += x * x;
            sxy += x * y;
        }
    }
    rows_break();
    rows_number("fig 19: slope of the harmonics, 15 to 195 Hz", (n * sxy - sx * sy) / (n * sxx - sx * sx));
}

/* ---- figures 13, 18: histories ---- */

static void draw_history(const char *figure, const double *paper, int coordinate, double seconds, int starts)
{
    uint64_t seed = 3;
    double state[MODEL_STATES], seen[8], hz = paper[SHAFT_PAPER_HZ];
    int n_seen = 0, ticks = attractor_ticks(paper);
    char name[64];
    for (int k = 0; k < starts && n_seen < 3; k++) {
        struct attractor a;
        bool known = false;
        attractor_start(&seed, paper[SHAFT_G1], state);
        if (!attractor_settle(&m, &shaft_bearing, paper, state, seconds, &a))
            return;
        for (int j = 0; j < n_seen; j++)
            known = known || fabs(seen[j] - a.high[0]) < 0.02 * a.high[0];
        if (known)
            continue;
        seen[n_seen++] = a.high[0];
        snprintf(name, sizeof name, "fig %s, attractor %d (period %d): largest x1, mm", figure, n_seen,
                 a.period);
        rows_number(name, a.high[0] * mm);
        snprintf(name, sizeof name, "fig %s, attractor %d: largest x3; switches a period", figure, n_seen);
        rows_number(name, a.high[2] * mm);
        rows_number(name, a.switches);
        snprintf(name, sizeof name, "attractor %d", n_seen);
        int every = ticks / 60 + 1;
        for (int i = 0; i <= 2 * ticks; i++) {
            motion_state(&m, state);
            if (i % every == 0)
                rows_point(figure, name, i / (hz * ticks) * 1e3, state[coordinate] * mm);
            if (!plant_run(&m.pl, 1))
                return;
        }
        rows_break();
    }
}

static void draw_histories(void)
{
    double paper[MODEL_PARAMETERS];
    attractor_paper(SHAFT_SOFT, 12.47, paper);
    draw_history("13 12.47 x1", paper, 0, 6.0, 12);
    draw_history("13 12.47 x2", paper, 1, 6.0, 12);
    /* The paper's pair at this frequency moves x1 and x3 as one: how long it stays, started from rest. */
    for (double wait = 0.5; wait <= 16.0; wait *= 2.0) {
        struct attractor a;
        if (!attractor_settle(&m, &shaft_bearing, paper, NULL, wait, &a))
            return;
        rows_number("fig 13, 12.47 Hz, from rest: seconds", wait);
        rows_number("  largest x1, mm", a.high[0] * mm);
        rows_number("  largest x3 - largest x1, mm", (a.high[2] - a.high[0]) * mm);
    }
    attractor_paper(SHAFT_SOFT, 18.49, paper);
    draw_history("13 18.49 x1", paper, 0, 6.0, 12);
    draw_history("13 18.49 x2", paper, 1, 6.0, 12);
    for (int proportional = 0; proportional < 2; proportional++) {
        static const double hz[] = {5.0, 15.0, 25.0};
        for (int k = 0; k < 3; k++) {
            char figure[32];
            attractor_paper(SHAFT_HARD, hz[k], paper);
            for (int i = 0; i < 3; i++)
                paper[SHAFT_C1 + i] = proportional && i == 1 ? 278.0 : 139.0;
            snprintf(figure, sizeof figure, "18 C%d %g", proportional + 1, hz[k]);
            draw_history(figure, paper, 0, 1.0, 12);
        }
    }
}

/* ---- figure 16: basins ---- */

static void draw_basin(const char *figure, double hz, int starts)
{
    enum { KINDS = 40 };
    double paper[MODEL_PARAMETERS], state[MODEL_STATES], high[KINDS];
    int count[KINDS] = {0}, period[KINDS], kinds = 0;
    uint64_t seed = 11;
    attractor_paper(SHAFT_MID, hz, paper);
    for (int i = 0; i < starts; i++) {
        struct attractor a;
        int k = 0;
        attractor_start(&seed, 1e-3, state);
        if (!attractor_settle(&m, &shaft_bearing, paper, state, 6.0, &a))
            continue;
        while (k < kinds &&
               !(period[k] == a.period && fabs(high[k] - a.high[0]) < (a.period ? 0.005 : 0.2) * high[k]))
            k++;
        if (k == kinds && kinds < KINDS) {
            high[k] = a.high[0];
            period[k] = a.period;
            kinds++;
        }
        if (k < KINDS && (++count[k] <= 40 || a.high[0] > 1e-4)) /* of a common attractor the first few */
            rows_value(figure, "start", state[0] * mm, state[3], a.high[0] * mm);
    }
    rows_break();
    for (int k = 0; k < kinds; k++) {
        char name[64];
        snprintf(name, sizeof name, "fig %s: period %d, largest x1 %.4f mm: share", figure, period[k],
                 high[k] * mm);
        rows_number(name, (double)count[k] / starts);
    }
}

int main(void)
{
    rows_begin();
    draw_frequencies();
    draw_linear();
    draw_responses();
    draw_chaos("9 25", 25.0, 2.0);
    draw_chaos("9 80", 80.0, 1.0);
    draw_chaos("9 700", 700.0, 0.5);
    draw_histories();
    draw_spectrum();
    draw_basin("16 687", 687.0, 3000);
    draw_basin("16 705", 705.0, 3000);
    return 0;
}
