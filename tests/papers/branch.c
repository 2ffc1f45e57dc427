/* branch.c - see branch.h. */
#include "tests/papers/branch.h"

#include <math.h>
#include <string.h>

enum { SIZE = MODEL_STATES + 1, NEWTON = 12, BISECTIONS = 30, SQUARINGS = 26 };
static const double tolerance = 1e-12, difference = 1e-6, accurate = 1e-9;
static const double finest = 1e-7; /* share of the largest step below which a branch ends */

/* Where a branch stands: the state at the period's start, then the swept parameter in its unit. */
struct place {
    double y[SIZE];
    double tangent[SIZE];
    double map[MODEL_STATES][MODEL_STATES];
};

static double period(const struct branch *b, double at)
{
    return b->turn / at;
}

/* Position and rate of the coordinate that is watched, rate per tick. */
static void watched(const struct branch *b, const struct motion *m, double h, double *position)
{
    double state[MODEL_STATES];
    const double *from = b->coordinate < 0 ? m->pl.x : state;
    int k = b->coordinate < 0 ? 0 : b->coordinate;
    motion_state(m, state);
    position[0] = from[k];
    position[1] = h * from[k + b->model->n_states / 2];
}

/* Extremes of the coordinate over a period. */
static bool watch(const struct branch *b, struct motion *m, double h, struct branch_point *seen)
{
    double before[2], now[2];
    seen->high = -HUGE_VAL;
    seen->low = HUGE_VAL;
    watched(b, m, h, before);
    for (int i = 0; i < b->ticks; i++) {
        if (!plant_run(&m->pl, 1))
            return false;
        watched(b, m, h, now);
        double x = now[0];
        if (before[1] * now[1] <
            0.0) { /* an extreme inside the tick: Hermite's cubic where the rate's chord is 0 */
            double s = before[1] / (before[1] - now[1]), r = 1.0 - s;
            x = r * r * ((1.0 + 2.0 * s) * before[0] + s * before[1]) +
                s * s * ((1.0 + 2.0 * r) * now[0] - r * now[1]);
        }
        seen->high = fmax(seen->high, x);
        seen->low = fmin(seen->low, x);
        memcpy(before, now, sizeof before);
    }
    seen->loss = m->pl.loss_time / m->pl.total_time;
    return true;
}

/* A plant with the swept parameter of y, ready for any
 * state: after a period its drives are where they were. */
static bool set_up(const struct branch *b, const double *y, struct motion *m)
{
    double paper[MODEL_PARAMETERS], at = y[b->model->n_states] * b->unit;
    memcpy(paper, b->paper, sizeof paper);
    paper[b->swept] = at;
    return at > 0.0 && motion_start(m, b->model, paper, period(b, at) / b->ticks, tolerance, NULL) == NULL;
}

/* The model's state after one period. */
static bool run(const struct branch *b, struct motion *m, const double *y, double *end)
{
    plant_set_state(&m->pl, y);
    bool good = plant_run(&m->pl, (uint64_t)b->ticks);
    memcpy(end, m->pl.x, sizeof m->pl.x);
    return good;
}

/* Solves a x = r by elimination with pivots; r becomes x, and *sign the sign of the determinant. */
static bool solve_signed(int n, double a[SIZE][SIZE], double *r, int *sign)
{
    *sign = 1;
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int i = k + 1; i < n; i++)
            best = fabs(a[i][k]) > fabs(a[best][k]) ? i : best;
        if (!(fabs(a[best][k]) > 0.0))
            return false;
        for (int j = 0; j < n; j++) {
            double swap = a[k][j];
            a[k][j] = a[best][j];
            a[best][j] = swap;
        }
        double swap = r[k];
        r[k] = r[best];
        r[best] = swap;
        *sign *= ((best != k) != (a[k][k] < 0.0)) ? -1 : 1;
        for (int i = 0; i < n; i++) {
            double share = i == k ? 0.0 : a[i][k] / a[k][k];
            for (int j = k; j < n; j++)
                a[i][j] -= share * a[k][j];
            r[i] -= share * r[k];
        }
    }
    for (int k = 0; k < n; k++)
        r[k] /= a[k][k];
    return true;
}

static bool solve(int n, double a[SIZE][SIZE], double *r)
{
    int sign;
    return solve_signed(n, a, r, &sign);
}

/* On which side of a multiplier 1: the sign of det(map - 1). */
static int side(int n, double map[MODEL_STATES][MODEL_STATES])
{
    double a[SIZE][SIZE], r[SIZE] = {0.0};
    int sign = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            a[i][j] = map[i][j] - (i == j ? 1.0 : 0.0);
    return solve_signed(n, a, r, &sign) ? sign : 0;
}

/* Residual of periodicity and its derivatives by the state and the parameter; p->map on the way. */
static bool linearise(const struct branch *b, struct place *p, double *residual, double a[SIZE][SIZE])
{
    int n = b->model->n_states;
    static struct motion m;
    double end[MODEL_STATES], moved[MODEL_STATES], y[SIZE];
    if (!set_up(b, p->y, &m) || !run(b, &m, p->y, end))
        return false;
    for (int j = 0; j <= n; j++) {
        memcpy(y, p->y, sizeof y);
        y[j] += difference;
        if ((j == n && !set_up(b, y, &m)) || !run(b, &m, y, moved))
            return false;
        for (int i = 0; i < n; i++) {
            a[i][j] = (moved[i] - end[i]) / difference;
            if (j < n)
                p->map[i][j] = a[i][j];
            if (i == j)
                a[i][j] -= 1.0;
        }
    }
    for (int i = 0; i < n; i++)
        residual[i] = end[i] - p->y[i];
    return true;
}

static double along(int n, const double *a, const double *b)
{
    double sum = 0.0;
    for (int k = 0; k < n; k++)
        sum += a[k] * b[k];
    return sum;
}

static double norm(int n, const double *v)
{
    return sqrt(along(n, v, v));
}

/* Newton in the plane across `direction` through p->y; then the tangent there, pointing on. */
static bool correct(const struct branch *b, struct place *p, const double *direction)
{
    int n = b->model->n_states;
    double a[SIZE][SIZE], step[SIZE];
    for (int i = 0; i < NEWTON; i++) {
        if (!linearise(b, p, step, a))
            return false;
        memcpy(a[n], direction, SIZE * sizeof *direction);
        step[n] = 0.0;
        if (!solve(n + 1, a, step))
            return false;
        for (int k = 0; k <= n; k++)
            p->y[k] -= step[k];
        if (norm(n + 1, step) < accurate) {
            if (!linearise(b, p, step, a))
                return false;
            memcpy(a[n], direction, SIZE * sizeof *direction);
            memset(p->tangent, 0, sizeof p->tangent);
            p->tangent[n] = 1.0;
            if (!solve(n + 1, a, p->tangent))
                return false;
            double size = norm(n + 1, p->tangent);
            for (int k = 0; k <= n; k++)
                p->tangent[k] /= size;
            return true;
        }
    }
    return false;
}

static bool step_from(const struct branch *b, const struct place *p, double length, struct place *next)
{
    *next = *p;
    for (int k = 0; k <= b->model->n_states; k++)
        next->y[k] += length * p->tangent[k];
    return correct(b, next, p->tangent);
}

/* Spectral radius by repeated squaring. */
static double radius(int n, double map[MODEL_STATES][MODEL_STATES])
{
    double m[MODEL_STATES][MODEL_STATES], square[MODEL_STATES][MODEL_STATES], log_size = 0.0;
    memcpy(m, map, sizeof m);
    for (int s = 0; s < SQUARINGS; s++) {
        double size = 0.0;
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++) {
                square[i][j] = 0.0;
                for (int k = 0; k < n; k++)
                    square[i][j] += m[i][k] * m[k][j];
                size = fmax(size, fabs(square[i][j]));
            }
        }
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                m[i][j] = square[i][j] / size;
        log_size = 2.0 * log_size + log(size);
    }
    return exp(log_size / (1 << SQUARINGS));
}

static void describe(const struct branch *b, struct place *p, struct branch_point *point)
{
    static struct motion m;
    int n = b->model->n_states;
    double h = period(b, p->y[n] * b->unit) / b->ticks;
    *point = (struct branch_point){.at = p->y[n] * b->unit, .multiplier = radius(n, p->map)};
    memcpy(point->x, p->y, (size_t)n * sizeof *p->y);
    if (!set_up(b, p->y, &m))
        return;
    plant_set_state(&m.pl, p->y);
    (void)watch(b, &m, h, point);
}

/* The place where a multiplier is 1, between p and a step
 * of this length from it, as near as Newton's method comes. */
static void find_critical(const struct branch *b, const struct place *p, double length,
                          struct place *critical)
{
    int n = b->model->n_states;
    struct place start = *p, trial;
    double low = 0.0, high = length;
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (low + high);
        if (!step_from(b, p, middle, &trial))
            return;
        *critical = trial;
        *(side(n, trial.map) == side(n, start.map) ? &low : &high) = middle;
    }
}

static bool begin(const struct branch *b, struct place *p)
{
    static struct motion m;
    enum { SETTLE = 400 };
    int n = b->model->n_states;
    double direction[SIZE] = {0.0};
    p->y[n] = b->from / b->unit;
    if (!set_up(b, p->y, &m) || (!b->start && !plant_run(&m.pl, (uint64_t)b->ticks * SETTLE)))
        return false;
    memcpy(p->y, m.pl.x, (size_t)n * sizeof *p->y);
    if (b->start)
        b->model->state_from_paper(m.pl.p, m.pl.segment.at[2], b->start, p->y);
    direction[n] = b->to > b->from ? 1.0 : -1.0;
    return correct(b, p, direction);
}

bool branch_returns(const struct branch *b, const struct branch_point *point, int i, int j)
{
    enum { FEATURES = 4 };
    double f[4][FEATURES], chord[FEATURES], back[FEATURES], first[FEATURES];
    const struct branch_point *p[] = {&point[j], &point[j + 1], &point[i - 1], &point[i]};
    for (int k = 0; k < 4; k++) {
        f[k][0] = p[k]->at / b->unit;
        f[k][1] = p[k]->high / point[0].high;
        f[k][2] = p[k]->low / point[0].high;
        f[k][3] = p[k]->loss;
    }
    for (int k = 0; k < FEATURES; k++) {
        first[k] = f[1][k] - f[0][k];
        chord[k] = f[3][k] - f[2][k];
        back[k] = f[0][k] - f[2][k];
    }
    double length = norm(FEATURES, chord), share = along(FEATURES, chord, back) / (length * length);
    for (int k = 0; k < FEATURES; k++)
        back[k] -= share * chord[k];
    return share > 0.0 && share <= 1.0 && norm(FEATURES, back) < 0.3 * length &&
           along(FEATURES, first, chord) > 0.7 * length * norm(FEATURES, first);
}

/* Any of its points: a branch may pass a crossing, and go round on what it meets there. */
static bool closes(const struct branch *b, const struct branch_point *point, int i)
{
    bool found = false;
    for (int j = 0; j < i - 3 && b->start && !found; j++)
        found = branch_returns(b, point, i, j);
    return found;
}

int branch_follow(const struct branch *b, struct branch_point *point)
{
    struct place p, next, critical;
    int n = b->model->n_states, count = 0;
    double length = 0.1 * b->step, back = b->other > 0.0 ? b->other : b->from;
    double low = fmin(back, b->to), high = fmax(back, b->to);
    if (!begin(b, &p))
        return 0;
    /* The first tangent may point either way along the branch. */
    if ((b->to - b->from) * p.tangent[n] < 0.0)
        for (int k = 0; k <= n; k++)
            p.tangent[k] = -p.tangent[k];
    describe(b, &p, &point[count++]);
    bool closed = false;
    while (count < BRANCH_POINTS - 1 && length > finest * b->step && !closed) {
        if (!step_from(b, &p, length, &next) || along(n + 1, next.tangent, p.tangent) < 0.9) {
            length *= 0.5;
            continue;
        }
        bool special = side(n, next.map) != side(n, p.map);
        if (special) {
            critical = next;
            find_critical(b, &p, length, &critical);
            describe(b, &critical, &point[count]);
            point[count].fold = next.tangent[n] * p.tangent[n] < 0.0;
            point[count].crossing = !point[count].fold;
            count++;
        }
        p = next;
        describe(b, &p, &point[count++]);
        if (p.y[n] * b->unit < low - 1e-9 || p.y[n] * b->unit > high + 1e-9)
            break;
        closed = closes(b, point, count - 1) || (special && closes(b, point, count - 2));
        length = fmin(1.5 * length, b->step);
    }
    return count;
}

static double nearest(const struct branch_point *point, int n, double near, bool fold)
{
    double best = (double)NAN;
    for (int i = 0; i < n; i++) {
        if ((fold ? point[i].fold : point[i].crossing) && !(fabs(point[i].at - near) >= fabs(best - near)))
            best = point[i].at;
    }
    return best;
}

double branch_fold(const struct branch_point *point, int n, double near)
{
    return nearest(point, n, near, true);
}

double branch_crossing(const struct branch_point *point, int n, double near)
{
    return nearest(point, n, near, false);
}
