/* device_wire.c - see device_wire.h. */
#include "host_sim/test/bench/device_wire.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/bus/settings.h"

/* ---- what the bus cannot tell ---- */

/* The case makes a sensor lie: what the bus carries is then not the plant's motion. */
static bool is_sensor(const struct action_set *s, int n)
{
    for (int i = 0; i < n; i++)
        if (s[i].index >= SETTING_FIRST + SET_SENSOR_OFFSET && s[i].index <= SETTING_FIRST + SET_SENSOR_SEED)
            return true;
    return false;
}

static bool has_sensor_faults(const struct test_case *c)
{
    bool has = is_sensor(c->plant.set, c->plant.n);
    for (int i = 0; i < c->n_acts; i++)
        has = has || is_sensor(c->act[i].what.set, c->act[i].what.n);
    return has;
}

static const char *signal_untold(const struct device_wire *w, const struct metric_setting *s,
                                 const struct test_case *c)
{
    const struct scene_app *a = &w->plant->scene;
    const struct model *m = a->config.model;
    double every = a->app.setting[s->signal < 2 ? SET_MOTION_EVERY : SET_CONTACT_EVERY];
    bool harmonic = s->kind == METRIC_AMPLITUDE || s->kind == METRIC_PHASE;
    if (metric_is_frequency(m, s->signal))
        return "the bus tells frequencies now and then only";
    if (s->signal >= m->n_outputs)
        return NULL;
    if (s->signal >= DECODE_OUTPUTS)
        return "the bus does not carry this output";
    if (has_sensor_faults(c))
        return "the case makes a sensor lie, and the bus carries what it says";
    if (harmonic && !(s->frequency_Hz * 2.0 * every * a->config.frame_s < 1.0))
        return "its frequency is above half the rate of the samples on the bus";
    return NULL;
}

static const char *untold(const struct device_wire *w, const struct metric_setting *s,
                          const struct test_case *c)
{
    bool whole = !(s->from_s > 0.0) && s->to_s >= c->over_s;
    switch (metric_table[s->kind].of) {
    case OF_CONTACTS:
        return NULL;
    case OF_SIGNAL:
    case OF_TARGET:
        return signal_untold(w, s, c);
    default:
        break;
    }
    if (s->kind == METRIC_SILENCE)
        return "the bus does not tell when a heartbeat was missing";
    if (s->kind == METRIC_HASH)
        return "the bus tells a part of it, now and then only";
    bool counter = s->kind != METRIC_STOPPED && s->kind != METRIC_FAULTS && s->kind != METRIC_RESIDUAL;
    return counter && !whole ? "HEALTH tells counters too seldom for a window" : NULL;
}

/* The input whose command this measurement is about, or -1. */
static int command_of(const struct device_wire *w, const struct metric_setting *s)
{
    const struct model *m = w->plant->scene.config.model;
    enum metric_of of = metric_table[s->kind].of;
    bool is = (of == OF_SIGNAL || of == OF_TARGET) && s->signal >= m->n_outputs &&
              !metric_is_frequency(m, s->signal);
    return is ? s->signal - m->n_outputs : -1;
}

void device_wire_deafen(struct device_wire *w)
{
    for (int i = 0; i < w->plant->n; i++)
        if (command_of(w, &w->plant->measurement[i].set) >= 0)
            w->plant->measurement[i].untold = VERDICT_DEAF;
}

/* ---- messages ---- */

/* The bus could not say this value: a measurement in whose window it fell knows less than its verdict needs.
 */
static void note_beyond(struct measurement *m, double t_s)
{
    if (!m->untold && t_s >= m->set.from_s && t_s <= m->set.to_s)
        m->untold = "a value was beyond the bus's range";
}

static bool is_beyond(enum metric_kind kind, const struct event *e)
{
    return (kind == METRIC_PEAK_FORCE && !e->touch && isnan(e->peak_force)) ||
           (kind == METRIC_IMPACT_SPEED && e->touch && isnan(e->speed));
}

static void take_event(void *context, const struct listen_event *d)
{
    struct device_wire *w = context;
    struct bench_plant *p = w->plant;
    const struct plant *pl = &p->scene.app.plant;
    if (!w->measures || d->tick < w->zero)
        return;
    struct event e = {.tick = d->tick - w->zero,
                      .fraction = d->fraction,
                      .touch = d->touch,
                      .contact = (uint8_t)d->contact,
                      .speed = d->speed,
                      .peak_force = d->peak_force_N};
    double t_s = ((double)e.tick + e.fraction) * pl->tick_s;
    w->not_sent += !d->has_data;
    p->regime = e.touch ? p->regime | 1u << e.contact : p->regime & ~(1u << e.contact);
    for (int k = 0; k < p->n; k++) {
        measurement_switch(&p->measurement[k], t_s, p->regime == 0);
        measurement_event(&p->measurement[k], &e);
        if (is_beyond(p->measurement[k].set.kind, &e))
            note_beyond(&p->measurement[k], t_s);
    }
}

/* Echoes that did not come in this row, or with rows since the one before: commands in whose windows they
 * fall are not known whole. */
static void note_echoes(struct device_wire *w, const struct decode_row *r)
{
    uint64_t before = w->row_tick > w->zero ? w->row_tick : w->zero;
    bool rows = r->tick > before + w->plant->scene.config.substeps;
    for (int k = 0; k < w->plant->n && r->tick > before; k++) {
        struct measurement *q = &w->plant->measurement[k];
        int input = command_of(w, &q->set);
        if (input < 0 || q->untold || !(rows || isnan(r->value[DECODE_OUTPUTS + input])))
            continue;
        double from_s = (double)(before - w->zero) * q->tick_s,
               to_s = (double)(r->tick - w->zero) * q->tick_s;
        if (from_s < q->set.to_s && to_s >= q->set.from_s)
            q->untold = "an echo of its samples is missing: lost on the way, or its frame was skipped";
    }
    w->row_tick = r->tick;
}

/* The last sample of input i; on CAN 0 before any was heard. */
static double command_in(const struct device_wire *w, const struct decode_row *r, int i)
{
    double x = r->value[DECODE_OUTPUTS + i];
    return isnan(x) && !w->echoes ? 0.0 : x;
}

static void take_row(struct device_wire *w, const struct decode_row *r)
{
    struct bench_plant *p = w->plant;
    const struct model *m = p->scene.config.model;
    double value[METRIC_SIGNALS];
    if (!w->measures || r->tick <= w->zero)
        return;
    for (int i = 0; i < METRIC_SIGNALS; i++)
        value[i] = (double)NAN;
    for (int i = 0; i < DECODE_OUTPUTS; i++)
        value[i] = r->value[i];
    for (int i = 0; i < m->n_inputs; i++)
        value[m->n_outputs + i] = command_in(w, r, i);
    if (w->echoes)
        note_echoes(w, r);
    w->now_s = (double)(r->tick - w->zero) * p->scene.app.plant.tick_s;
    for (int k = 0; k < p->n; k++) {
        struct measurement *q = &p->measurement[k];
        enum metric_of of = metric_table[q->set.kind].of;
        if (of != OF_SIGNAL && of != OF_TARGET)
            continue;
        measurement_tick(q, r->tick - w->zero, value);
        if (q->set.signal < DECODE_OUTPUTS && r->beyond >> q->set.signal & 1u)
            note_beyond(q, w->now_s);
    }
}

/* A reading of the metrics of this kind. */
static void take_reading(struct device_wire *w, enum metric_kind kind, double x)
{
    for (int k = 0; k < w->plant->n && w->measures; k++)
        if (w->plant->measurement[k].set.kind == kind)
            measurement_frame(&w->plant->measurement[k], w->now_s, x);
}

static void take_status(struct device_wire *w, const struct message *m)
{
    enum plant_state state = (enum plant_state)m->value[STATUS_STATE];
    enum reaction reaction = (enum reaction)m->value[STATUS_REACTION];
    bool in_session = m->value[SESSION] > 0.0 && state != STATE_OFF && reaction == REACTION_NONE;
    bool by_command = state == STATE_OFF || reaction == REACTION_STOP;
    if (w->was_in_session && !in_session && by_command && w->stopped_s < 0.0 && w->measures)
        w->stopped_s = w->now_s;
    w->was_in_session = in_session;
    if (w->measures)
        w->faults |= (unsigned)m->value[STATUS_FAULTS] & ~(unsigned)FAULT_TIMEOUT;
    take_reading(w, METRIC_FAULTS, metric_faults(w->faults));
}

void device_wire_begin(struct device_wire *w, const struct test_case *c)
{
    const struct app *a = &w->plant->scene.app;
    decode_begin(&w->rows, &a->scene, a->plant.tick_s);
    w->rows.events.take = take_event;
    w->rows.events.context = w;
    w->stopped_s = -1.0;
    for (int i = 0; i < w->plant->n; i++)
        w->plant->measurement[i].untold = untold(w, &w->plant->measurement[i].set, c);
}

void device_wire_take(void *context, const struct frame *f, const struct message *m)
{
    struct device_wire *w = context;
    struct decode_row row;
    (void)f;
    if (m->kind == WIRE_STATUS)
        take_status(w, m);
    if (m->kind == WIRE_EVENT_SUMMARY && w->measures)
        w->not_sent += m->value[SUMMARY_NOT_SENT];
    if (m->kind == WIRE_LEDGER && (int)m->value[LEDGER_ITEM] == LEDGER_RESIDUAL)
        take_reading(w, METRIC_RESIDUAL, fabs(m->value[LEDGER_VALUE]));
    uint64_t events_missing = w->rows.counter[WIRE_EVENT_TIME].missing;
    if (decode_take(&w->rows, m, &row))
        take_row(w, &row);
    if (m->kind == WIRE_EVENT_TIME && w->measures)
        w->not_sent += (double)(w->rows.counter[WIRE_EVENT_TIME].missing - events_missing);
}

bool device_wire_has_counters(const struct device_wire *w)
{
    bool all = true;
    for (int i = 0; i < DIAG_COUNTERS; i++)
        all = all &&
              (w->rows.tally.known[i] || (i > DIAG_RX_FOREIGN && i != DIAG_WATCH_TRIPS)); /* the metrics' */
    return all;
}

/* ---- the verdict ---- */

/* count[DIAG_COUNTERS]: of the case. */
static void take_counters(struct device_wire *w, bool known, uint32_t *count)
{
    for (int i = 0; i < DIAG_COUNTERS; i++)
        count[i] = w->rows.tally.count[i] - w->before[i];
    for (int k = 0; k < w->plant->n; k++) {
        struct measurement *m = &w->plant->measurement[k];
        enum metric_kind kind = m->set.kind;
        enum metric_of of = metric_table[kind].of;
        bool counts = (of == OF_CONTROLLER && kind != METRIC_STOPPED) || kind == METRIC_WATCH;
        if (!counts || m->untold)
            continue;
        m->untold = known ? NULL : "the plant does not tell its counters: HEALTH is off, or lost";
        measurement_frame(m, m->set.to_s,
                          kind == METRIC_MALFORMED ? count[DIAG_RX_FOREIGN] : metric_count(kind, count));
    }
}

void device_wire_judge(struct device_wire *w, const struct test_case *c, bool known, struct bench_result *r)
{
    struct bench_plant *p = w->plant;
    uint32_t count[DIAG_COUNTERS];
    take_reading(w, METRIC_STOPPED, w->stopped_s);
    take_counters(w, known, count);
    snprintf(w->not_heard, sizeof w->not_heard,
             "%.0f contact switches were not told; raise events_per_frame, or give the bus more room",
             w->not_sent);
    uint32_t lost = count[DIAG_RX_DROPPED] + count[DIAG_LOST];
    if (known && c->n_acts && lost) {
        snprintf(
            r->error, sizeof r->error,
            "the plant lost %u frames on the way to it (rx_dropped, lost): a drive or set of the case may "
            "be missing, and the run proves nothing",
            lost);
        r->verdict = VERDICT_ERROR;
    }
    for (int k = 0; k < p->n; k++)
        if (metric_table[p->measurement[k].set.kind].of == OF_CONTACTS && w->not_sent > 0.0)
            p->measurement[k].untold = w->not_heard;
    const struct evidence e = {w->now_s, 0, w->faults, count};
    verdict_judge(&e, c, p->measurement, p->n_judged, r);
}
