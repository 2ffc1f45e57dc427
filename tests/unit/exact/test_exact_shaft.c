/* test_exact_shaft.c - method exact on the shaft: stored trajectories, any step, chatter, modes.
 *
 * The cases s4_* of tests/data/model_trajectories.txt are multi-precision results, trusted to 1e-15; `growth`
 * is by how much a rounding error at the start has grown at the end. */
#include "tests/unit/test.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "models/shaft_bearing.h"
#include "tests/fixture/gap_oscillator.h"
#include "tests/fixture/paper.h"

enum { SAMPLES = 12, EVENTS = 64, LINE = 256 };

struct reference {
    char name[64];
    double paper[MODEL_PARAMETERS], growth, start[6], t[SAMPLES], state[SAMPLES][6];
    double event_t[4][EVENTS];
    int event_touch[4][EVENTS], n_events[4], n_samples, total;
};

static void read_row(const char *text, double *x)
{
    char *end;
    for (int k = 0; k < 6; k++, text = end)
        x[k] = strtod(text, &end);
}

/* 1 at the end of a shaft's case. */
static int read_line(struct reference *r, const char *line)
{
    char word[64];
    double a, b;
    int c, n;
    if (sscanf(line, "case %63s", r->name) == 1) {
        paper_defaults(&shaft_bearing, r->paper);
        r->n_samples = 0;
        memset(r->n_events, 0, sizeof r->n_events);
    } else if (sscanf(line, "parameter %63s %lf", word, &a) == 2 && paper_index(&shaft_bearing, word) >= 0) {
        r->paper[paper_index(&shaft_bearing, word)] = a;
    } else if (sscanf(line, "growth %lf", &r->growth) != 1 && strncmp(line, "start ", 6) == 0) {
        read_row(line + 6, r->start);
    } else if (sscanf(line, "sample %lf%n", &a, &n) == 1 && r->n_samples < SAMPLES) {
        r->t[r->n_samples] = a;
        read_row(line + n, r->state[r->n_samples++]);
    } else if (sscanf(line, "event %lf %63s %lf %d", &a, word, &b, &c) == 4 && c < 4 &&
               r->n_events[c] < EVENTS) {
        r->event_t[c][r->n_events[c]] = a;
        r->event_touch[c][r->n_events[c]++] = strcmp(word, "touchdown") == 0;
    } else if (sscanf(line, "events %d", &c) == 1) {
        r->total = c;
    }
    return strncmp(line, "end", 3) == 0 && strncmp(r->name, "s4_", 3) == 0;
}

/* The paper's case on method exact. */
static void start(struct gap_run *run, const double *paper, double tick_s, const double *state)
{
    double si[MODEL_PARAMETERS], x[MODEL_STATES], p[MODEL_DERIVED];
    struct harmonic drive[MODEL_INPUTS];
    struct scale scale;
    shaft_bearing.from_paper(paper, si, drive);
    paper_prepare(&shaft_bearing, paper, si, p, &scale);
    shaft_bearing.state_from_paper(p, NULL, state, x);
    gap_start(run, &shaft_bearing, &exact, si, drive, tick_s, x);
}

struct comparison {
    const struct reference *r;
    double time_error;
    int seen[4], wrong;
};

static void compare_event(void *context, const struct plant *pl, const struct event *e)
{
    struct comparison *c = context;
    int i = c->seen[e->contact]++;
    if (i >= c->r->n_events[e->contact])
        return;
    double t = ((double)e->tick + e->fraction) * pl->tick_s;
    c->time_error = fmax(c->time_error, fabs(t - c->r->event_t[e->contact][i]));
    c->wrong += e->touch != c->r->event_touch[e->contact][i];
}

static void check_case(const struct reference *r, double finest)
{
    static struct gap_run run;
    struct comparison c = {.r = r};
    double max[6] = {0}, error = 0.0, state[6];
    double spacing = r->t[r->n_samples - 1] / r->n_samples;
    uint64_t steps = (uint64_t)ceil(spacing / finest);
    for (int i = 0; i < r->n_samples; i++)
        for (int k = 0; k < 6; k++)
            max[k] = fmax(max[k], fabs(r->state[i][k]));
    start(&run, r->paper, spacing / (double)steps, r->start);
    for (int i = 0; i < r->n_samples; i++) {
        gap_advance(&run, steps, compare_event, &c);
        paper_now(&run.plant, state);
        for (int k = 0; k < 6; k++)
            error = fmax(error, fabs(state[k] - r->state[i][k]) / max[k]);
    }
    check_below(check_name("%s, tick %.2e s: worst state error over its maximum", r->name, finest), error,
                5e-14 * fmax(r->growth, 30.0));
    check_int("contact switches", run.n_events, r->total);
    check_int("switches of the wrong kind", c.wrong, 0);
    /* unit of time: the fastest mode's 1/omega */
    check_below("worst instant of a switch, model time", c.time_error / run.plant.scale.time_s,
                3e-13 * fmax(r->growth, 30.0));
    check_int("roots with a residual", run.plant.counts.residual + run.plant.counts.budget, 0);
}

/* Ticks over one and a half decades: the error does not depend on them. */
TEST(exact_shaft_reference)
{
    static const double tick[5] = {2.4e-4, 1.2e-4, 4e-5, 1.6e-5, 8e-6};
    static struct reference r;
    char line[LINE];
    int cases = 0;
    FILE *f = fopen("tests/data/model_trajectories.txt", "r");
    check_true("tests/data/model_trajectories.txt is there (run from the project's top folder)", f != NULL);
    while (f && fgets(line, sizeof line, f)) {
        if (!read_line(&r, line))
            continue;
        cases++;
        for (int i = 0; i < 5; i++)
            check_case(&r, tick[i]);
    }
    check_int("reference cases of the shaft", cases, 5);
    if (f)
        fclose(f);
}

enum { PER_TICK = 32, FINER = 16 };
struct switches {
    double t[PER_TICK];
    int contact[PER_TICK], n;
};

static void note_event(void *context, const struct plant *pl, const struct event *e)
{
    struct switches *s = context;
    if (s->n < PER_TICK) {
        s->t[s->n] = ((double)e->tick + e->fraction) * pl->tick_s;
        s->contact[s->n++] = e->contact;
    }
}

struct harvest {
    int switches, missed, invented, other;
    double t, x; /* worst differences */
};

/* Each tick again in 16 from the same state: what one finds the other must find. That way the comparison does
 * not suffer from the chaos of the motion. */
static struct harvest compare_ticks(double c, double hertz, double newton, int per_period, int ticks)
{
    static struct gap_run coarse, fine;
    struct harvest h = {0};
    double paper[MODEL_PARAMETERS];
    const double start_at[6] = {2.286e-4, 0, 0, 0, 0, 0};
    paper_defaults(&shaft_bearing, paper);
    for (int i = 0; i < 3; i++)
        paper[SHAFT_C1 + i] = c;
    paper[paper_index(&shaft_bearing, "freq_hz")] = hertz;
    paper[paper_index(&shaft_bearing, "p2")] = newton;
    start(&coarse, paper, 1.0 / hertz / per_period, start_at);
    start(&fine, paper, 1.0 / hertz / per_period / FINER, start_at);
    for (int i = 0; i < ticks; i++) {
        struct switches a = {.n = 0}, b = {.n = 0};
        plant_set_state(&fine.plant, coarse.plant.x);
        gap_advance(&coarse, 1, note_event, &a);
        gap_advance(&fine, FINER, note_event, &b);
        h.switches += b.n;
        h.missed += a.n < b.n;
        h.invented += a.n > b.n;
        for (int k = 0; a.n == b.n && k < a.n; k++) {
            h.t = fmax(h.t, fabs(a.t[k] - b.t[k]));
            h.other += a.contact[k] != b.contact[k];
        }
        for (int k = 0; k < 6; k++)
            h.x = fmax(h.x, fabs(coarse.plant.x[k] - fine.plant.x[k]));
    }
    check_int("roots with a residual, budgets", coarse.plant.counts.residual + coarse.plant.counts.budget, 0);
    return h;
}

static void check_harvest(const char *name, struct harvest h, int at_least)
{
    check_above(name, h.switches, at_least);
    check_int("ticks with a switch missed", h.missed, 0);
    check_int("ticks with a switch invented", h.invented, 0);
    check_int("switches in another order", h.other, 0);
    check_below("worst difference of an instant, s", h.t, 1e-12);
    check_below("worst difference of a state, gaps", h.x, 1e-13);
}

/* Impacts that follow each other ever faster, ticks as coarse as allowed (2.05 rad of the fastest mode). */
TEST(exact_shaft_chatter)
{
    /* about 190 switches a forcing period */
    check_harvest("chatter, 10 periods at 0.25 ms", compare_ticks(139.0, 5.0, 25.0, 800, 8000), 1500);
    check_harvest("chatter, 10 periods at 0.1 ms", compare_ticks(139.0, 5.0, 25.0, 2000, 20000), 1500);
    check_harvest("chaos, 200 N", compare_ticks(4.0, 25.0, 200.0, 160, 60000), 15000);
    check_harvest("chaos, 700 Hz", compare_ticks(4.0, 700.0, 25.0, 6, 6000), 1000);
}

static void count_pairs(void *context, const struct plant *pl, const struct event *e)
{
    double *last = context;
    double t = ((double)e->tick + e->fraction) * pl->tick_s;
    /* positive and negative sides apart: contacts 0 and 2, 1 and 3 */
    int side = e->contact & 1;
    if (last[side] >= 0.0) {
        last[2] = fmax(last[2], fabs(t - last[side]));
        last[side] = -1.0;
        last[3] += 1.0;
    } else {
        last[side] = t;
    }
}

/* A symmetric shaft hits with both ends at the same instant: two switches each time. */
TEST(exact_shaft_together)
{
    static struct gap_run run;
    double paper[MODEL_PARAMETERS], last[4] = {-1.0, -1.0, 0.0, 0.0};
    const double start_at[6] = {0, 0, 0, 0.3, 0.3, 0.3};
    paper_defaults(&shaft_bearing, paper);
    paper[paper_index(&shaft_bearing, "p2")] = 0.0;
    start(&run, paper, 1e-4, start_at);
    gap_advance(&run, 50, count_pairs, last);
    check_above("pairs of switches", last[3], 7.0);
    check_int("switches without a partner", run.n_events - 2 * (int)last[3], 0);
    check_below("time between partners, s", last[2], 1e-15);
    check_below("pieces of the worst tick", run.plant.counts.pieces_max, 5);
}

/* det(P - z) of a 6 x 6 real matrix by elimination. */
static double complex determinant(double p[6][6], double complex z)
{
    double complex a[6][6], det = 1.0;
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            a[i][j] = p[i][j] - (i == j ? z : 0.0);
    for (int k = 0; k < 6; k++) {
        int best = k;
        for (int i = k + 1; i < 6; i++)
            best = cabs(a[i][k]) > cabs(a[best][k]) ? i : best;
        for (int j = 0; j < 6; j++) {
            double complex swap = a[k][j];
            a[k][j] = a[best][j];
            a[best][j] = best == k ? a[k][j] : swap;
        }
        det *= best == k ? a[k][k] : -a[k][k];
        for (int i = k + 1; i < 6; i++)
            for (int j = 5; j >= k; j--)
                a[i][j] -= a[i][k] / a[k][k] * a[k][j];
    }
    return det;
}

/* The state after one tick from x, through the method itself, in a given regime. */
static void one_tick(const struct model *m, const double *p, double *scratch, double h, unsigned regime,
                     double *x)
{
    struct segment e;
    struct crossing c;
    memset(&e, 0, sizeof e);
    e.length = h;
    check_int("a tick without a switch", exact.bind(m)(m, p, scratch, &e, regime, x, &c), STEP_END);
}

/* Eigenvalue of the motion in a regime near this frequency: a root of det(P - e^{lambda h}) by secants. */
static double complex eigenvalue(double c, unsigned regime, const double *far, double hertz)
{
    static double scratch[METHOD_SCRATCH];
    double paper[MODEL_PARAMETERS], si[MODEL_PARAMETERS], p[MODEL_DERIVED], matrix[6][6], base[6];
    struct scale scale;
    paper_defaults(&shaft_bearing, paper);
    for (int i = 0; i < 3; i++)
        paper[SHAFT_C1 + i] = c;
    paper_prepare(&shaft_bearing, paper, si, p, &scale);
    double h = 1e-4 / scale.time_s;
    exact.prepare(&shaft_bearing, p, h, 0.0, scratch);
    memcpy(base, far, sizeof base);
    one_tick(&shaft_bearing, p, scratch, h, regime, base);
    for (int k = 0; k < 6; k++) {
        double x[6];
        memcpy(x, far, sizeof x);
        x[k] += 0.0625;
        one_tick(&shaft_bearing, p, scratch, h, regime, x);
        for (int i = 0; i < 6; i++)
            matrix[i][k] = (x[i] - base[i]) / 0.0625;
    }
    double complex l0 = 2.0 * M_PI * hertz * scale.time_s * (-0.01 + (double complex)I),
                   l1 = l0 * (1.0 + 1e-3);
    for (int i = 0; i < 30 && l0 != l1; i++) {
        double complex f0 = determinant(matrix, cexp(l0 * h)), f1 = determinant(matrix, cexp(l1 * h));
        double complex next = f1 == f0 ? l1 : l1 - f1 * (l1 - l0) / (f1 - f0);
        l0 = l1;
        l1 = next;
    }
    return l1 / scale.time_s;
}

/* Published eigenfrequencies and damping (shaft in its bearings with open and closed gaps). */
TEST(exact_shaft_modes)
{
    static const double open[3] = {17.976663229487094, 25.431242515941566, 699.8748849627839};
    static const double closed[3] = {451.11005414569934, 1187.8249399564304, 1302.6623023476936};
    static const double damping[3] = {0.0211, 0.0199, 0.00054};
    const double inside[6] = {0, 0, 0, 0, 0, 0}, beyond[6] = {3, 3, 3, 0, 0, 0};
    for (int k = 0; k < 3; k++) {
        double complex l = eigenvalue(0.0, 0, inside, open[k]);
        check_near("open gaps, undamped, Hz", cabs(l) / (2.0 * M_PI), open[k], 1e-9 * open[2]);
        l = eigenvalue(4.0, 0, inside, open[k]);
        check_near("open gaps, damping ratio", -creal(l) / cabs(l), damping[k], 6e-5);
        l = eigenvalue(0.0, 5, beyond, closed[k]);
        check_near("closed gaps, undamped, Hz", cabs(l) / (2.0 * M_PI), closed[k], 1e-9 * closed[2]);
    }
}

/* ---- the same shaft with its first two masses in each other's place ---- */

static const int place[6] = {1, 0, 2, 4, 3, 5};

static void swapped_gap(const double *p, const struct input *u, const double *x, struct input *gap)
{
    double y[6];
    for (int k = 0; k < 6; k++)
        y[place[k]] = x[k];
    shaft_bearing.gap(p, u, y, gap);
}

static bool swapped_linear(const double *p, unsigned regime, struct linear *l)
{
    struct linear own;
    bool exists = shaft_bearing.linear(p, regime, &own);
    *l = own;
    for (int i = 0; i < 6; i++) {
        l->c[i] = own.c[place[i]];
        for (int k = 0; k < 6; k++)
            l->a[i][k] = own.a[place[i]][place[k]];
        for (int k = 0; k < 3; k++)
            l->b[i][k] = own.b[place[i]][k];
    }
    return exists;
}

/* A tick of free motion with its switches, which are counted. */
static int free_tick(const struct model *m, const double *p, double *scratch, double h, unsigned *regime,
                     double *x)
{
    struct segment e = {.length = h};
    struct crossing c;
    int switches = 0;
    while (exact.bind(m)(m, p, scratch, &e, *regime, x, &c) == STEP_SWITCH) {
        segment_tail(&e, m->n_inputs, c.done);
        *regime ^= 1u << c.contact;
        switches++;
    }
    return switches;
}

/* A wall at the middle position is seen as one at an end is. */
TEST(exact_shaft_wall_in_the_middle)
{
    enum { TICKS = 40 };
    static double scratch[2][METHOD_SCRATCH];
    struct model swapped = shaft_bearing;
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], error = 0.0;
    double x[2][MODEL_STATES] = {{0.3, 0.1, -0.2, 4.0, 1.0, -2.0}, {0.1, 0.3, -0.2, 1.0, 4.0, -2.0}};
    unsigned regime[2] = {0, 0};
    int switches[2] = {0, 0};
    struct scale scale;
    swapped.gap = swapped_gap;
    swapped.linear = swapped_linear;
    for (int i = 0; i < shaft_bearing.n_parameters; i++)
        si[i] = shaft_bearing.parameter[i].initial;
    shaft_bearing.prepare(si, p, &scale);
    double h = 2.0 / shaft_bearing.eigenfrequency(p);
    exact.prepare(&shaft_bearing, p, h, 0.0, scratch[0]);
    exact.prepare(&swapped, p, h, 0.0, scratch[1]);
    for (int i = 0; i < TICKS; i++) {
        switches[0] += free_tick(&shaft_bearing, p, scratch[0], h, &regime[0], x[0]);
        switches[1] += free_tick(&swapped, p, scratch[1], h, &regime[1], x[1]);
        for (int k = 0; k < 6; k++)
            error = fmax(error, fabs(x[1][k] - x[0][place[k]]));
    }
    check_is("switches", switches[0], >=, 20);
    check_int("switches of the other", switches[1], switches[0]);
    check_below("states", error, 1e-10);
}
