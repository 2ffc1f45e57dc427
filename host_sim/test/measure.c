/* measure.c - see measure.h. Sums over a window of ticks, contact switches and bus frames give the value. */
#include "host_sim/test/measure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/cli/ticks.h"
#include "models/math/elementary.h"

#define TAIL 0.1 /* the steady error's share of the window */

static bool is(const struct measurement *m, enum metric_of of)
{
    return metric_table[m->set.kind].of == of;
}

/* ---- ticks ---- */

static bool is_fit(enum metric_kind k)
{
    return k == METRIC_AMPLITUDE || k == METRIC_PHASE;
}

/* The window in ticks; a lock-in's ends with a whole period. */
static void find_window(struct measurement *m)
{
    double to = ticks_in(m->set.to_s, m->tick_s);
    double period = m->set.frequency_Hz > 0.0 ? 1.0 / (m->set.frequency_Hz * m->tick_s) : 0.0;
    m->from = ticks_begun(m->set.from_s, m->tick_s);
    if (is_fit(m->set.kind))
        to = (double)m->from + floor(ticks_in(to - (double)m->from, period)) * period;
    m->to = ticks_ended(to, 1.0);
}

static void add_error(struct measurement *m, double x, double since_s, double half_s, double dt)
{
    struct metric_sums *s = &m->sum;
    double e = x - m->set.target, before = s->last - m->set.target;
    double length = (double)(m->to - m->from) * m->tick_s;
    s->error += half_s * (fabs(before) + fabs(e));
    s->error_square += half_s * (before * before + e * e);
    s->error_time += half_s * ((since_s - dt) * fabs(before) + since_s * fabs(e));
    if (since_s - dt >= (1.0 - TAIL) * length - 0.5 * m->tick_s) {
        s->tail += half_s * (before + e);
        s->tail_s += dt;
    }
}

/* Trapezoids from sample to sample. */
static void add_sums(struct measurement *m, double x, uint64_t tick)
{
    struct metric_sums *s = &m->sum;
    double t = (double)tick * m->tick_s;
    double dt = (double)(tick - s->last_tick) * m->tick_s, half_s = 0.5 * dt;
    if (s->n == 0) {
        s->first_s = t;
        s->start = x;
        s->outside_s = -1.0;
    } else if (is(m, OF_TARGET)) {
        add_error(m, x, t - s->first_s, half_s, dt);
    } else {
        s->integral += half_s * (s->last + x);
        s->square += half_s * (s->last * s->last + x * x);
        s->magnitude += half_s * (fabs(s->last) + fabs(x));
    }
    if (is(m, OF_TARGET) && fabs(x - m->set.target) > m->set.band)
        s->outside_s = t;
    s->last = x;
    s->last_s = t;
    s->last_tick = tick;
    s->apart_s = dt;
}

/* A value that is not between the extremes so far. */
static void add_extreme(struct measurement *m, double x, uint64_t tick)
{
    struct metric_sums *s = &m->sum;
    if (s->n == 0 || x < s->least)
        s->least = x, s->least_s = (double)tick * m->tick_s;
    if (s->n == 0 || x > s->most)
        s->most = x, s->most_s = (double)tick * m->tick_s;
}

/* Those that are only extremes have no sums: a case has many of them, and each costs in each tick. */
static bool has_sums(enum metric_kind k)
{
    return k != METRIC_MIN && k != METRIC_MAX && k != METRIC_CHANGE;
}

bool measurement_is_tone(const struct measurement *m)
{
    return is_fit(m->set.kind);
}

bool measurement_reads(const struct measurement *m)
{
    return is(m, OF_SIGNAL) || is(m, OF_TARGET);
}

static void add_value(struct measurement *m, double x, uint64_t tick, const struct fit_drive *drive)
{
    if (is_fit(m->set.kind))
        fit_add(&m->fit, ((double)(tick - m->from) + 0.5) / ((double)(m->to - m->from) + 1.0),
                turns_of(m->set.frequency_Hz * ((double)tick * m->tick_s)), x, drive);
    if (has_sums(m->set.kind))
        add_sums(m, x, tick);
    add_extreme(m, x, tick);
    m->sum.n++;
}

/* Values between the extremes so far, at the begin of x[n]; a NaN is none. */
static int count_between(const struct metric_sums *s, const double *x, int n)
{
    double least = s->least, most = s->most;
    int i = 0;
    if (s->n > 0)
        while (i < n && x[i] >= least && x[i] <= most)
            i++;
    return i;
}

void measurement_ticks(struct measurement *m, uint64_t first, int n, const double *value,
                       const struct fit_drive (*drive)[MODEL_INPUTS])
{
    int begin = first < m->from ? (int)fmin((double)n, (double)(m->from - first)) : 0;
    if (first > m->to)
        return;
    n = (uint64_t)n > m->to - first ? (int)(m->to - first) + 1 : n;
    for (int i = begin; i < n; i++) {
        int between = has_sums(m->set.kind) ? 0 : count_between(&m->sum, value + i, n - i);
        m->sum.n += (uint64_t)between;
        i += between;
        if (i < n && !isnan(value[i]))
            add_value(m, value[i], first + (uint64_t)i, drive ? drive[i] : NULL);
    }
}

void measurement_tick(struct measurement *m, uint64_t tick, const double *value)
{
    if (measurement_reads(m))
        measurement_ticks(m, tick, 1, &value[m->set.signal], NULL);
}

void measurement_begin(struct measurement *m, const struct metric_setting *s, double tick_s, bool all_open)
{
    memset(m, 0, sizeof *m);
    m->set = *s;
    m->tick_s = tick_s;
    m->open = all_open;
    find_window(m);
}

/* ---- contact switches ---- */

/* Every contact was open from open_s until t. */
static void book_loss(struct measurement *m, double t)
{
    double begin = fmax(m->open_s, m->set.from_s), end = fmin(t, m->set.to_s);
    if (!(end > begin))
        return;
    m->lost_s += end - begin;
    m->last_loss_s = end;
    if (end - begin > m->longest_s) {
        m->longest_s = end - begin;
        m->longest_end_s = end;
    }
}

void measurement_switch(struct measurement *m, double t, bool all_open)
{
    if (!is(m, OF_CONTACTS))
        return;
    if (m->open && !all_open)
        book_loss(m, t);
    if (!m->open && all_open)
        m->open_s = t;
    m->open = all_open;
}

void measurement_event(struct measurement *m, const struct event *e)
{
    double t = ((double)e->tick + e->fraction) * m->tick_s, size = 0.0;
    enum metric_kind k = m->set.kind;
    if (t < m->set.from_s || t > m->set.to_s)
        return;
    if ((k == METRIC_TOUCHDOWNS && e->touch) || (k == METRIC_LIFT_OFFS && !e->touch)) {
        m->count += 1.0;
        m->when_s = t;
    }
    if (k == METRIC_IMPACT_SPEED && e->touch)
        size = e->speed;
    if (k == METRIC_PEAK_FORCE && !e->touch)
        size = e->peak_force;
    if (size > m->peak) {
        m->peak = size;
        m->when_s = t;
    }
}

/* ---- bus frames ---- */

/* Sizes count by the largest one in the window, counts by what came in it. */
static bool is_size(enum metric_kind k)
{
    return k == METRIC_FAULTS || k == METRIC_SILENCE || k == METRIC_RESIDUAL;
}

void measurement_frame(struct measurement *m, double t, double x)
{
    if (m->set.kind == METRIC_STOPPED) {
        m->stopped_s = x;
        return;
    }
    if (t > m->set.to_s + 0.5 * m->tick_s)
        return;
    if (m->set.from_s > 0.0 && t <= m->set.from_s) {
        m->before = x;
        return;
    }
    double now = is_size(m->set.kind) ? fmax(m->count, x) : x - m->before;
    if (now > m->count)
        m->when_s = t;
    m->count = now;
    m->n_frames++;
}

/* ---- values ---- */

static struct metric_value at(double value, double when_s)
{
    return (struct metric_value){.known = true, .value = value, .when_s = when_s};
}

static struct metric_value contact_value(struct measurement *m, double now)
{
    double end = fmin(now, m->set.to_s), length = end - m->set.from_s;
    if (m->open)
        book_loss(m, now);
    if (!(length > 0.0))
        return (struct metric_value){.known = false};
    switch (m->set.kind) {
    case METRIC_CONTACT_LOSS:
        return at(100.0 * m->lost_s / length, m->last_loss_s);
    case METRIC_LAST_LOSS:
        return at(m->last_loss_s, m->last_loss_s);
    case METRIC_LONGEST_LOSS:
        return at(m->longest_s, m->longest_end_s);
    case METRIC_PEAK_FORCE:
    case METRIC_IMPACT_SPEED:
        return at(m->peak, m->when_s);
    default:
        return at(m->count, m->when_s);
    }
}

static struct metric_value fit_value(const struct measurement *m)
{
    double amplitude, phase_deg;
    if (!(m->set.frequency_Hz * m->tick_s < 0.5))
        return (struct metric_value){.note = "lockin is above half the rate of ticks"};
    enum lockin_verdict verdict = fit_solve(&m->fit, m->set.frequency_Hz * m->tick_s,
                                            (double)(m->to - m->from), &amplitude, &phase_deg);
    if (verdict == LOCKIN_SHORT)
        return (struct metric_value){.note = "its window holds no period of lockin"};
    if (verdict == LOCKIN_CLOSE)
        return (struct metric_value){.note = "another drive is too near lockin"};
    return at(m->set.kind == METRIC_AMPLITUDE ? amplitude : phase_deg, m->sum.last_s);
}

static struct metric_value signal_value(const struct measurement *m)
{
    const struct metric_sums *s = &m->sum;
    double length = s->last_s - s->first_s;
    if (is_fit(m->set.kind) && s->n > 0)
        return fit_value(m);
    if (s->n < 2)
        return (struct metric_value){.known = false};
    switch (m->set.kind) {
    case METRIC_MIN:
        return at(s->least, s->least_s);
    case METRIC_MAX:
        return at(s->most, s->most_s);
    case METRIC_MEAN:
        return at(s->integral / length, s->last_s);
    case METRIC_RMS:
        return at(sqrt(s->square / length), s->last_s);
    case METRIC_CHANGE:
        return at(s->most - s->least, fmax(s->least_s, s->most_s));
    default:
        return at(s->magnitude, s->last_s);
    }
}

/* Settling of what was inside its band all the time, and
 * overshoot of what begins at the target, tell nothing. */
static struct metric_value target_value(const struct measurement *m)
{
    const struct metric_sums *s = &m->sum;
    double way = m->set.target - s->start;
    struct metric_value v = {.known = false};
    if (s->n < 2)
        return v;
    switch (m->set.kind) {
    case METRIC_OVERSHOOT:
        if (fabs(way) <= m->set.band)
            return v;
        return way > 0.0 ? at(100.0 * fmax(0.0, (s->most - m->set.target) / way), s->most_s)
                         : at(100.0 * fmax(0.0, (s->least - m->set.target) / way), s->least_s);
    case METRIC_SETTLING:
        if (s->outside_s < 0.0)
            return v;
        v = at(s->outside_s + s->apart_s - s->first_s, s->outside_s);
        if (s->outside_s >= s->last_s) {
            v.value = (double)INFINITY;
            snprintf(v.note, sizeof v.note, "it never settled");
        }
        return v;
    case METRIC_STEADY_ERROR:
        return s->tail_s > 0.0 ? at(fabs(s->tail / s->tail_s), s->last_s) : v;
    case METRIC_IAE:
        return at(s->error, s->last_s);
    case METRIC_ISE:
        return at(s->error_square, s->last_s);
    default:
        return at(s->error_time, s->last_s);
    }
}

void measurement_end(struct measurement *m, double now, uint64_t hash, struct metric_value *v)
{
    if (is(m, OF_CONTACTS))
        *v = contact_value(m, now);
    else if (is(m, OF_SIGNAL))
        *v = signal_value(m);
    else if (is(m, OF_TARGET))
        *v = target_value(m);
    else if (m->set.kind == METRIC_HASH)
        *v = (struct metric_value){.known = true, .when_s = now, .hash = hash};
    else if (m->set.kind == METRIC_STOPPED)
        *v = (struct metric_value){
            .known = m->stopped_s >= m->set.from_s, .value = m->stopped_s, .when_s = m->stopped_s};
    else
        *v = (struct metric_value){.known = m->n_frames > 0, .value = m->count, .when_s = m->when_s};
}
