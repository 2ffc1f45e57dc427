/* demo_record.c - what was heard on the bus, as rows of ten frames, and the numbers of the summary from them. */
#include "host_sim/demo/demo.h"
#include "models/hertz_rig.h"

#include <math.h>
#include <string.h>

const char *const demo_phase_name[DEMO_PHASES] = {"rest", "slow drive", "control", "fast base", "silence"};

void demo_record_init(struct demo_record *r)
{
    memset(r, 0, sizeof *r);
    r->tick_s = r->command_N = r->first_loss_s = r->first_loss_N = r->reaction_end_s = (double)NAN;
    for (int i = 0; i < DEMO_RECENT; i++)
        r->displacement.value[i] = r->penetration.value[i] = r->force.value[i] = (double)NAN;
    for (int k = 0; k < DEMO_BURST_SIGNALS; k++)
        for (int i = 0; i < DEMO_BURST; i++)
            r->burst[k][i] = (double)NAN;
}

static void recent_add(struct demo_recent *recent, double value)
{
    recent->value[recent->next] = value;
    recent->next = (recent->next + 1) % DEMO_RECENT;
}

void demo_recent_range(const struct demo_recent *recent, double *min, double *max)
{
    *min = *max = (double)NAN;
    for (int i = 0; i < DEMO_RECENT; i++) {
        *min = fmin(*min, recent->value[i]); /* fmin and fmax pass over NaN */
        *max = fmax(*max, recent->value[i]);
    }
}

double demo_ramp_at(const struct demo_ramp *ramp, double t_s)
{
    double done = ramp->length_s > 0.0 ? (t_s - ramp->begin_s) / ramp->length_s : 1.0;
    return ramp->from + (ramp->to - ramp->from) * fmin(fmax(done, 0.0), 1.0);
}

static void add_row(struct demo_record *r, const struct latest *l, double loss)
{
    if (r->n_rows == DEMO_ROWS || isnan(r->tick_s) || isnan(l->displacement_m))
        return;
    struct demo_row *row = &r->row[r->n_rows++];
    row->t_s = (double)l->tick * r->tick_s;
    row->phase = r->phase;
    demo_recent_range(&r->displacement, &row->displacement_min, &row->displacement_max);
    demo_recent_range(&r->penetration, &row->penetration_min, &row->penetration_max);
    demo_recent_range(&r->force, &row->force_min, &row->force_max);
    row->command_N = r->command_N;
    row->drive_N = demo_ramp_at(&r->drive, row->t_s);
    row->base_m = demo_ramp_at(&r->base, row->t_s);
    row->loss = loss;
    row->age_frames = l->health[DIAG_COMMAND_AGE_FRAMES];
    row->reaction = l->reaction;
}

static void hear_event(struct demo_record *r, const struct latest *l, const struct message *m)
{
    if (m->value[EVENT_TOUCH] > 0.0 || !isnan(r->first_loss_s))
        return;
    /* the message has the tick's low bits; an event is never older than a few frames */
    double tick = (double)l->tick, low = m->value[EVENT_TIME_TICK];
    const struct field *f = &wire_layout(WIRE_EVENT_TIME)->field[EVENT_TIME_TICK];
    double span = ldexp(1.0, f->bits);
    tick += remainder(low - tick, span);
    r->first_loss_s = (tick + m->value[EVENT_TIME_FRACTION]) * r->tick_s;
    r->first_loss_N = demo_ramp_at(&r->drive, r->first_loss_s);
}

static void hear_burst(struct demo_record *r, const struct message *m)
{
    double signal = m->value[CAPTURE_DATA_SIGNAL], sample = m->value[CAPTURE_DATA_SAMPLE];
    if (!(signal < DEMO_BURST_SIGNALS && sample < DEMO_BURST))
        return;
    double *place = &r->burst[(int)signal][(int)sample];
    r->n_burst += isnan(*place) && !isnan(m->value[CAPTURE_DATA_VALUE]);
    *place = m->value[CAPTURE_DATA_VALUE];
}

static void ramp_to_zero(struct demo_ramp *ramp, double t_s)
{
    *ramp = (struct demo_ramp){demo_ramp_at(ramp, t_s), 0.0, t_s, 1e-3 * DEMO_REACTION_RAMP_MS};
}

static void hear_status(struct demo_record *r, const struct latest *l)
{
    if (l->reaction == REACTION_NONE || r->reaction_frame)
        return;
    r->reaction_frame = l->frame;
    r->reaction_begin_s = (double)l->tick * r->tick_s;
    ramp_to_zero(&r->drive, r->reaction_begin_s);
    ramp_to_zero(&r->base, r->reaction_begin_s);
}

/* The echo of a ramp is the time it has left. */
static void hear_echo(struct demo_record *r, const struct latest *l, const struct message *m)
{
    double t_s = (double)l->tick * r->tick_s;
    bool ramp = m->value[DRIVE_ECHO_CHANNEL] == RIG_FORCE && m->value[DRIVE_ECHO_FIELD] == ARM_RAMP;
    if (ramp && m->value[DRIVE_ECHO_VALUE] == 0.0 && r->reaction_frame && isnan(r->reaction_end_s))
        r->reaction_end_s = t_s;
}

void demo_record_hear(struct demo_record *r, const struct latest *latest, const struct message *m)
{
    switch (m->kind) {
    case WIRE_MOTION:
        recent_add(&r->displacement, m->value[MOTION_DISPLACEMENT]);
        break;
    case WIRE_CONTACT:
        recent_add(&r->penetration, m->value[CONTACT_PENETRATION]);
        recent_add(&r->force, m->value[CONTACT_FORCE]);
        break;
    case WIRE_STATUS:
        hear_status(r, latest);
        break;
    case WIRE_DRIVE_ECHO:
        hear_echo(r, latest, m);
        break;
    case WIRE_EVENT_TIME:
        hear_event(r, latest, m);
        break;
    case WIRE_EVENT_SUMMARY:
        add_row(r, latest, m->value[SUMMARY_LOSS]);
        break;
    case WIRE_CAPTURE_DATA:
        hear_burst(r, m);
        break;
    default:
        break;
    }
}

bool demo_burst_complete(const struct demo_record *r)
{
    return r->n_burst == DEMO_BURST_SIGNALS * DEMO_BURST;
}

/* Mean of the loss over the last `seconds` of a phase; NaN when the phase has no row. */
static double loss_at_end(const struct demo_record *r, enum demo_phase phase, double seconds)
{
    double sum = 0.0, end = (double)NAN;
    int n = 0;
    for (int i = r->n_rows - 1; i >= 0; i--) {
        const struct demo_row *row = &r->row[i];
        if (row->phase != phase)
            continue;
        end = isnan(end) ? row->t_s : end;
        if (row->t_s <= end - seconds)
            break;
        sum += row->loss;
        n++;
    }
    return n ? sum / n : (double)NAN;
}

static void measure_row(const struct demo_row *row, struct demo_result *m)
{
    if (row->phase == DEMO_CONTROL) {
        m->force_peak_N = fmax(m->force_peak_N, row->command_N);
        m->force_held_N = row->command_N;
        m->penetration_held = row->penetration_min;
    }
    if (row->phase == DEMO_FAST) {
        m->loss_fast = fmax(m->loss_fast, row->loss);
        m->force_fast_N = row->command_N;
        m->base_m = row->base_m;
        if (row->loss > 0.0 && isnan(m->fast_begin_s))
            m->fast_begin_s = row->t_s;
        m->force_fast_peak_N = fmax(m->force_fast_peak_N, row->command_N);
        if (row->loss > 0.0)
            m->fast_lost_s = row->t_s - m->fast_begin_s;
    }
}

void demo_measure(const struct demo_record *r, struct demo_result *m)
{
    const double settled_s = 0.3; /* of a phase's end: what it came to */
    const double none = (double)NAN;
    *m = (struct demo_result){.first_loss_s = r->first_loss_s, .first_loss_N = r->first_loss_N};
    m->loss_fast = m->fast_begin_s = m->fast_lost_s = m->base_m = none;
    m->force_peak_N = m->force_held_N = m->penetration_held = none;
    m->force_fast_peak_N = m->force_fast_N = none;
    m->reaction_frames = m->reaction_begin_s = m->reaction_s = none;
    m->loss_before = loss_at_end(r, DEMO_DRIVE, settled_s);
    m->loss_controlled = loss_at_end(r, DEMO_CONTROL, settled_s);
    m->loss_fast_end = loss_at_end(r, DEMO_FAST, settled_s);
    for (int i = 0; i < r->n_rows; i++)
        measure_row(&r->row[i], m);
    if (r->reaction_frame) {
        m->reaction_frames = (double)(r->reaction_frame - r->heartbeat_frame);
        m->reaction_begin_s = r->reaction_begin_s;
        m->reaction_s = r->reaction_end_s - r->reaction_begin_s;
    }
}
