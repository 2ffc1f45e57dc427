/* shaft_isolas.c - figures 14 to 16 of the shaft-bearing paper, kg = 1.4e6 N/m: the main branch, the isolas
 * and where they are stable, and the basins at 687 and 705 Hz. Prints docs/img/papers/shaft_isolas.csv. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/maps/basin/basin_clusters.h"
#include "host_sim/maps/basin/basin_starts.h"
#include "models/reduced/shaft_mode.h"
#include "tests/papers/response.h"
#include "tests/papers/rows.h"

static const double mm = 1e3, from = 680.0, to = 725.0;
static const double lowest = 670.0, highest = 735.0; /* Hz, range in which an isola is followed */

/* ---- figures 14, 15: branches ---- */

enum { ISOLAS = 40, EACH = 4 /* at most, of one period */ };
struct isola {
    int period, n;
    bool closed;
    struct branch_point *point;
};
static struct isola isola[ISOLAS];
static int n_isolas;
static struct branch_point space[ISOLAS][BRANCH_POINTS];

/* The attractor is on this branch: between two of its points. */
static bool is_on(const struct isola *c, double hz, double high)
{
    for (int i = 1; i < c->n; i++) {
        const struct branch_point *p = &c->point[i - 1], *q = &c->point[i];
        double share = (hz - p->at) / (q->at - p->at);
        if (share >= 0.0 && share <= 1.0 && fabs(p->high + share * (q->high - p->high) - high) < 0.01 * high)
            return true;
    }
    return false;
}

static struct branch branch_at(int period, double hz, const double *state)
{
    struct branch b = {.model = &shaft_bearing,
                       .swept = SHAFT_PAPER_HZ,
                       .turn = period,
                       .unit = 10.0,
                       .from = hz,
                       .step = 0.1,
                       .start = state};
    attractor_paper(SHAFT_MID, hz, b.paper);
    b.ticks = period * attractor_ticks(b.paper);
    return b;
}

static void describe(const struct isola *c)
{
    char name[64];
    double low = HUGE_VAL, high = 0.0, stable = 0.0, length = 0.0;
    for (int i = 1; i < c->n; i++) {
        const struct branch_point *p = &c->point[i - 1], *q = &c->point[i];
        double piece = hypot((q->at - p->at) / 10.0, (q->high - p->high) / 2.54e-4);
        low = fmin(low, q->at);
        high = fmax(high, q->at);
        length += piece;
        stable += q->multiplier < 1.0 ? piece : 0.0;
    }
    snprintf(name, sizeof name, "isola of period %d: from Hz", c->period);
    rows_number(name, low);
    rows_number("  to Hz", high);
    rows_number("  points", c->n);
    rows_number("  share of its length that is stable", stable / length);
    rows_number("  closed", c->closed);
}

/* Upwards from the attractor until it closes; else downwards too. */
static void trace(struct isola *c, double hz, const double *state)
{
    static struct branch_point down[BRANCH_POINTS];
    struct branch b = branch_at(c->period, hz, state);
    b.to = highest;
    b.other = lowest;
    c->n = branch_follow(&b, c->point);
    c->closed =
        c->n > 4 && (branch_returns(&b, c->point, c->n - 1, 0) || branch_returns(&b, c->point, c->n - 2, 0));
    if (c->n == 0 || c->closed)
        return;
    b.to = lowest;
    b.other = highest;
    int n = branch_follow(&b, down);
    if (c->n + n > BRANCH_POINTS)
        return;
    memmove(c->point + n, c->point, (size_t)c->n * sizeof *c->point);
    for (int i = 0; i < n; i++)
        c->point[i] = down[n - 1 - i];
    c->n += n;
}

/* An attractor of a longer period: its isola, once. */
static void follow(void *context, double hz, const struct attractor *a)
{
    int same = 0;
    (void)context;
    for (int i = 0; i < n_isolas; i++) {
        same += isola[i].period == a->period;
        if (isola[i].period == a->period && is_on(&isola[i], hz, a->high[0]))
            return;
    }
    if (a->period < 2 || n_isolas == ISOLAS || same == EACH)
        return;
    struct isola *c = &isola[n_isolas];
    *c = (struct isola){.period = a->period, .point = space[n_isolas]};
    trace(c, hz, a->state);
    if (c->n < 3)
        return;
    n_isolas++;
    describe(c);
}

/* After how many forcing periods this state of the model's comes back; 0: not within n. */
static int least_period(const struct attractor_shaft *s, const double *state, int n)
{
    double x[MODEL_STATES];
    memcpy(x, state, sizeof x);
    for (int k = 1; k <= n; k++) {
        double apart = 0.0;
        if (stroboscope_advance(&s->map, x, NULL) != BASIN_GOOD)
            return 0;
        for (int i = 0; i < s->plant.model->n_states; i++)
            apart = fmax(apart, fabs(x[i] - state[i]));
        if (apart < 1e-5)
            return k;
    }
    return 0;
}

/* A motion of this period near a point of another isola, by Newton's method, and its own isola. */
static void try_near(int period, const struct branch_point *near)
{
    static struct branch_point point[BRANCH_POINTS];
    struct attractor_shaft s;
    struct attractor a = {.period = period};
    double paper[MODEL_PARAMETERS];
    attractor_paper(SHAFT_MID, near->at, paper);
    if (!attractor_open(&s, &shaft_bearing, paper))
        return;
    s.plant.model->paper_state(s.plant.p, s.map.tick[0].at[0], near->x, a.state);
    struct branch b = branch_at(period, near->at, a.state);
    b.to = near->at + 1e-4;
    b.other = near->at - 1e-4;
    b.step = 1e-3;
    if (branch_follow(&b, point) > 0 && fabs(point[0].at - near->at) < 1e-3 &&
        least_period(&s, point[0].x, period) == period) {
        s.plant.model->paper_state(s.plant.p, s.map.tick[0].at[0], point[0].x, a.state);
        a.high[0] = point[0].high;
        follow(NULL, point[0].at, &a);
    }
    attractor_close(&s);
}

/* Isolas that no start finds: from those of the periods beside
 * theirs, as the paper does with its Fourier coefficients. */
static void follow_neighbours(void)
{
    enum { SKIP = 6 /* points of a branch between two tries */, WANTED = 2 };
    int n = n_isolas;
    for (int period = 4; period <= 12; period += 2) {
        int before = n_isolas;
        for (int i = 0; i < n; i++) {
            for (int j = 0;
                 abs(isola[i].period - period) == 1 && j < isola[i].n && n_isolas < before + WANTED;
                 j += SKIP)
                try_near(period, &isola[i].point[j]);
        }
    }
}

/* How often this branch is at this frequency with a stable motion. */
static int count_stable(const struct branch_point *point, int n, double hz)
{
    int count = 0;
    for (int i = 1; i < n; i++)
        count += (point[i - 1].at < hz) != (point[i].at < hz) && point[i].multiplier < 1.0;
    return count;
}

static void draw_branches(void)
{
    static struct branch_point point[BRANCH_POINTS];
    char name[48];
    struct branch b = branch_at(1, from, NULL);
    b.to = to;
    int n = branch_follow(&b, point);
    response_branch("14 x1", "branch", point, n);
    for (int k = 0; k < 2; k++) {
        double hz = k ? 705.0 : 687.0;
        rows_number("Hz", hz);
        rows_number("  stable motions on the main branch", count_stable(point, n, hz));
        for (int i = 0; i < n_isolas; i++) {
            snprintf(name, sizeof name, "  on an isola of period %d", isola[i].period);
            rows_number(name, count_stable(isola[i].point, isola[i].n, hz));
        }
    }
    for (int i = 0; i < n_isolas; i++) {
        snprintf(name, sizeof name, "isola %d", isola[i].period);
        response_branch("14 x1", name, isola[i].point, isola[i].n);
    }
}

static void draw_responses(void)
{
    struct response r = {.figure = "14",
                         .from = from,
                         .to = to,
                         .points = 90,
                         .starts = 100,
                         .span = 1e-3,
                         .seconds = 9.0,
                         .n_coordinates = 1};
    attractor_paper(SHAFT_MID, from, r.paper);
    r.paper[SHAFT_PAPER_MODE] = 3;
    response_theory(&r, "theory");
    response_attractors(&r, &shaft_bearing, "true", follow, NULL);
    response_attractors(&r, &shaft_bearing_mode, "mode", NULL, NULL);
    response_balance(&r, "balance");
}

/* ---- figure 16: basins ---- */

static void report(const char *figure, const struct basin_clusters *c, double unit)
{
    char name[80];
    for (int i = 0; i < c->n; i++) {
        const struct basin_attractor *a = &c->attractor[i];
        double low, high;
        basin_clusters_wilson(a->count, c->total, &low, &high);
        snprintf(name, sizeof name, "fig %s: period %d, largest x1 %.4f mm: starts", figure, a->motion.period,
                 a->motion.peak * unit * mm);
        rows_number(name, a->count);
        rows_number("  share, from", low);
        rows_number("  share, to", high);
        rows_number("  growth a period", a->growth);
    }
    rows_number("  none found", c->escaped + c->trouble);
}

/* 10,000 starts by Latin hypercube, positions within 1 mm, rates within 0.5 m/s; of a common attractor the
 * first few are drawn. */
static void draw_basin(const char *figure, double hz)
{
    enum { STARTS = 10000, BLOCK = 50, DRAWN = 40 };
    static struct basin_clusters c;
    static const struct basin_patience patience = {20000, 1e-8};
    struct attractor_shaft s;
    struct basin_starts starts;
    struct basin_box box;
    double paper[MODEL_PARAMETERS];
    double state[2][MODEL_STATES] = {{-1e-3, -1e-3, -1e-3, -0.5, -0.5, -0.5},
                                     {1e-3, 1e-3, 1e-3, 0.5, 0.5, 0.5}};
    attractor_paper(SHAFT_MID, hz, paper);
    if (!attractor_open(&s, &shaft_bearing, paper))
        return;
    const struct basin_plant *b = &s.plant;
    double unit = scale_of(&b->scale, QUANTITY_LENGTH);
    b->model->state_from_paper(b->p, s.map.tick[0].at[0], state[0], box.low);
    b->model->state_from_paper(b->p, s.map.tick[0].at[0], state[1], box.high);
    basin_clusters_start(&c, b->model);
    if (!basin_starts_make(&starts, STARTS, 6, 11, &box))
        return;
    for (int first = 0; first < STARTS; first += BLOCK) {
        double start[BLOCK][MODEL_STATES] = {{0.0}}, x[BLOCK][MODEL_STATES];
        struct basin_motion motion[BLOCK];
        for (int i = 0; i < BLOCK; i++)
            basin_starts_get(&starts, first + i, start[i]);
        memcpy(x, start, sizeof x);
        if (basin_motion_find(b, &patience, BLOCK, x, motion))
            return;
        for (int i = 0; i < BLOCK; i++) {
            int k = basin_clusters_add(&c, &motion[i]);
            b->model->paper_state(b->p, s.map.tick[0].at[0], start[i], state[0]);
            if (k >= 0 && (c.attractor[k].count <= DRAWN || motion[i].peak * unit > 1e-4))
                rows_value(figure, "start", state[0][0] * mm, state[0][3], motion[i].peak * unit * mm);
        }
    }
    rows_break();
    basin_clusters_finish(&c, NULL);
    report(figure, &c, unit);
    for (int i = 0; i < c.n; i++) {
        struct attractor a = {.period = c.attractor[i].motion.period,
                              .high = {c.attractor[i].motion.peak * unit}};
        b->model->paper_state(b->p, s.map.tick[0].at[0], c.attractor[i].motion.end, a.state);
        follow(NULL, hz, &a);
    }
    basin_starts_free(&starts);
    attractor_close(&s);
}

int main(void)
{
    rows_print_header();
    draw_responses();
    draw_basin("16 687", 687.0);
    draw_basin("16 705", 705.0);
    follow_neighbours();
    draw_branches();
    return 0;
}
