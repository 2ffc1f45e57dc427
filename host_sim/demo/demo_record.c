/* demo_record.c - see demo_record.h. */
#include "host_sim/demo/demo_record.h"
#include "host_sim/cli/files.h"
#include "models/hertz_rig.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const demo_phase_name[DEMO_PHASES] = {"rest", "slow drive", "control", "fast base", "silence"};

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
    double row[DEMO_COLUMNS], t_s = (double)l->tick * r->tick_s;
    if (r->n_rows == DEMO_ROWS || isnan(r->tick_s) || isnan(l->displacement_m))
        return;
    row[DEMO_TIME] = t_s;
    row[DEMO_PHASE] = r->phase;
    demo_recent_range(&r->displacement, &row[DEMO_DISPLACEMENT], &row[DEMO_DISPLACEMENT + 1]);
    demo_recent_range(&r->penetration, &row[DEMO_PENETRATION], &row[DEMO_PENETRATION + 1]);
    demo_recent_range(&r->force, &row[DEMO_FORCE], &row[DEMO_FORCE + 1]);
    row[DEMO_COMMAND] = r->command_N;
    row[DEMO_SLOW_N] = demo_ramp_at(&r->slow, t_s);
    row[DEMO_BASE_M] = demo_ramp_at(&r->base, t_s);
    row[DEMO_LOSS] = loss;
    row[DEMO_AGE] = l->health[DIAG_COMMAND_AGE_FRAMES];
    row[DEMO_REACTION] = l->reaction != REACTION_NONE;
    for (int i = 0; i < DEMO_COLUMNS; i++)
        r->column[i][r->n_rows] = row[i];
    r->n_rows++;
}

static void take_event(void *context, const struct listen_event *e)
{
    struct demo_record *r = context;
    if (e->touch || !isnan(r->first_loss_s))
        return;
    r->first_loss_s = ((double)e->tick + e->fraction) * r->tick_s;
    r->first_loss_N = demo_ramp_at(&r->slow, r->first_loss_s);
}

void demo_record_init(struct demo_record *r)
{
    memset(r, 0, sizeof *r);
    r->events = (struct listen_events){.take = take_event, .context = r};
    r->tick_s = r->command_N = r->first_loss_s = r->first_loss_N = (double)NAN;
    r->reaction_begin_s = r->reaction_end_s = (double)NAN;
    for (int i = 0; i < DEMO_RECENT; i++)
        r->displacement.value[i] = r->penetration.value[i] = r->force.value[i] = (double)NAN;
    for (int k = 0; k < DEMO_BURST_SIGNALS; k++)
        for (int i = 0; i < DEMO_BURST; i++)
            r->burst[k][i] = (double)NAN;
}

static void take_burst(struct demo_record *r, const struct message *m)
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

static void take_status(struct demo_record *r, const struct latest *l)
{
    if (l->reaction == REACTION_NONE || r->reaction_frame)
        return;
    r->reaction_frame = l->frame;
    r->reaction_begin_s = (double)l->tick * r->tick_s;
    ramp_to_zero(&r->slow, r->reaction_begin_s);
    ramp_to_zero(&r->base, r->reaction_begin_s);
}

/* The echo of a ramp is the time it has left. */
static void take_echo(struct demo_record *r, const struct latest *l, const struct message *m)
{
    double t_s = (double)l->tick * r->tick_s;
    bool ramp = m->value[DRIVE_ECHO_CHANNEL] == RIG_FORCE && m->value[DRIVE_ECHO_FIELD] == ARM_RAMP;
    if (ramp && m->value[DRIVE_ECHO_VALUE] == 0.0 && r->reaction_frame && isnan(r->reaction_end_s))
        r->reaction_end_s = t_s;
}

void demo_record_take(struct demo_record *r, const struct latest *latest, const struct message *m)
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
        take_status(r, latest);
        break;
    case WIRE_DRIVE_ECHO:
        take_echo(r, latest, m);
        break;
    case WIRE_EVENT_TIME:
    case WIRE_EVENT_DATA:
        listen_events_take(&r->events, m, latest->tick);
        break;
    case WIRE_EVENT_SUMMARY:
        add_row(r, latest, m->value[SUMMARY_LOSS]);
        break;
    case WIRE_CAPTURE_DATA:
        take_burst(r, m);
        break;
    default:
        break;
    }
}

bool demo_burst_complete(const struct demo_record *r)
{
    return r->n_burst == DEMO_BURST_SIGNALS * DEMO_BURST;
}

/* Names and formats of the columns; NaN is an empty field. */
static const char *const csv[DEMO_COLUMNS][2] = {
    {"plant_time_s", "%.6f"},        {"phase", NULL},
    {"displacement_min_m", "%.6e"},  {"displacement_max_m", "%.6e"},
    {"penetration_min_m", "%.6e"},   {"penetration_max_m", "%.6e"},
    {"contact_force_min_N", "%.5f"}, {"contact_force_max_N", "%.5f"},
    {"control_force_N", "%.5f"},     {"slow_drive_amplitude_N", "%.5f"},
    {"base_amplitude_m", "%.6e"},    {"contact_loss_1", "%.5f"},
    {"command_age_frames", "%.0f"},  {"reaction", "%.0f"}};

static void put(FILE *f, int column, double value)
{
    if (column > 0)
        fputc(',', f);
    if (column == DEMO_PHASE)
        fputs(demo_phase_name[(int)value], f);
    else if (!isnan(value))
        fprintf(f, csv[column][1], value);
}

bool demo_write_csv(const struct demo_record *r, const char *path, char *why)
{
    FILE *f = files_compose(path);
    if (!f) {
        snprintf(why, DEMO_REASON, "cannot write %s: %s", path, strerror(errno));
        return false;
    }
    for (int k = 0; k < DEMO_COLUMNS; k++)
        fprintf(f, "%s%s", k ? "," : "", csv[k][0]);
    for (int i = 0; i < r->n_rows; i++) {
        fputc('\n', f);
        for (int k = 0; k < DEMO_COLUMNS; k++)
            put(f, k, r->column[k][i]);
    }
    fputc('\n', f);
    bool good = files_finish(f, true);
    if (!good)
        snprintf(why, DEMO_REASON, "%s could not be written completely: %s", path, files_unwritten(errno));
    return good;
}
