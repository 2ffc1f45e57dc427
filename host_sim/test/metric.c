/* metric.c - the table of metrics, their units, and the signals that they are about. */
#include "host_sim/test/metric.h"

#include <stdio.h>
#include <string.h>
#include "firmware/observe/watch.h"
#include "host_sim/cli/trouble.h"

const struct metric metric_table[METRICS] = {
    [METRIC_CONTACT_LOSS] = {"contact_loss", OF_CONTACTS, "%", "share of time with every contact open"},
    [METRIC_LIFT_OFFS] = {"lift_offs", OF_CONTACTS, "", "contacts that opened"},
    [METRIC_TOUCHDOWNS] = {"touchdowns", OF_CONTACTS, "", "contacts that closed"},
    [METRIC_LAST_LOSS] = {"last_loss", OF_CONTACTS, "s", "plant time when contact was lost last; 0: never"},
    [METRIC_LONGEST_LOSS] = {"longest_loss", OF_CONTACTS, "s", "longest time without contact"},
    [METRIC_PEAK_FORCE] = {"peak_force", OF_CONTACTS, "N",
                           "largest force of the contacts that ended by lift-off"},
    [METRIC_IMPACT_SPEED] = {"impact_speed", OF_CONTACTS, "m/s", "fastest touchdown"},
    [METRIC_MIN] = {"min", OF_SIGNAL, "U", "smallest value"},
    [METRIC_MAX] = {"max", OF_SIGNAL, "U", "largest value"},
    [METRIC_MEAN] = {"mean", OF_SIGNAL, "U", "mean over time"},
    [METRIC_RMS] = {"rms", OF_SIGNAL, "U", "root of the mean square"},
    [METRIC_CHANGE] = {"change", OF_SIGNAL, "U",
                       "largest value less the smallest; of a command: limit cycles"},
    [METRIC_EFFORT] = {"effort", OF_SIGNAL, "U s", "integral of the magnitude"},
    [METRIC_AMPLITUDE] = {"amplitude", OF_SIGNAL, "U", "of the harmonic part at the lockin frequency"},
    [METRIC_PHASE] = {"phase", OF_SIGNAL, "deg", "its phase against cos(2 pi lockin t), t plant time"},
    [METRIC_OVERSHOOT] = {"overshoot", OF_TARGET, "%",
                          "beyond the target, of the way from the window's begin to it"},
    [METRIC_SETTLING] = {"settling", OF_TARGET, "s",
                         "from the window's begin until the signal stays within the band"},
    [METRIC_STEADY_ERROR] = {"steady_error", OF_TARGET, "U",
                             "magnitude of the mean error in the last tenth of the window"},
    [METRIC_IAE] = {"iae", OF_TARGET, "U s", "integral of |error|"},
    [METRIC_ISE] = {"ise", OF_TARGET, "(U)^2 s", "integral of error^2"},
    [METRIC_ITAE] = {"itae", OF_TARGET, "U s^2", "integral of t |error|, t from the window's begin"},
    [METRIC_REFUSED] = {"refused", OF_CONTROLLER, "", "frames and commands that the plant refused"},
    [METRIC_LATE] = {"late", OF_CONTROLLER, "", "commands for an instant that had passed"},
    [METRIC_MISSED] = {"missed", OF_CONTROLLER, "", "frames of an active stream without a sample"},
    [METRIC_LOST] = {"lost", OF_CONTROLLER, "", "frames missing before one that was taken, by COUNTER"},
    [METRIC_MALFORMED] = {"malformed", OF_CONTROLLER, "", "datagrams that are no packet of CAN frames"},
    [METRIC_TIMEOUTS] = {"timeouts", OF_CONTROLLER, "", "times that heartbeats stopped for timeout_frames"},
    [METRIC_SILENCE] = {"silence", OF_CONTROLLER, "s",
                        "longest time of the bus without a heartbeat in a session"},
    [METRIC_STOPPED] = {"stopped", OF_CONTROLLER, "s", "plant time when the controller ended its session"},
    [METRIC_FAULTS] = {"faults", OF_RUN, "", "kinds of faults that the plant latched, beside a time-out"},
    [METRIC_RESIDUAL] = {"residual", OF_RUN, "J", "largest energy that did not balance"},
    [METRIC_WATCH] = {"watch", OF_RUN, "", "times that the scene's watch tripped"},
    [METRIC_HASH] = {"hash", OF_RUN, "", "hash of the plant at the end: equal bits, equal hash"},
};

static const int frequency[] = {MODEL_DRIVE_FREQUENCY, MODEL_EIGENFREQUENCY};
enum { FREQUENCIES = sizeof frequency / sizeof frequency[0] };

/* The eigenfrequency is the last. */
int metric_signals(const struct model *m)
{
    return m->n_outputs + m->n_inputs + FREQUENCIES - !m->eigenfrequency;
}

bool metric_is_frequency(const struct model *m, int i)
{
    return i >= m->n_outputs + m->n_inputs;
}

const struct signal *metric_signal(const struct model *m, int i)
{
    if (metric_is_frequency(m, i))
        return model_observable(m, frequency[i - m->n_outputs - m->n_inputs]);
    return i < m->n_outputs ? &m->output_signal[i] : &m->input_signal[i - m->n_outputs];
}

void metric_signal_name(const struct model *m, int i, char text[METRIC_UNIT])
{
    bool command = i >= m->n_outputs && !metric_is_frequency(m, i);
    snprintf(text, METRIC_UNIT, "%s%s", command ? "command_" : "", metric_signal(m, i)->name);
}

/* The table's unit with U filled in; that of a ratio is nothing,
 * and a power binds a unit of several symbols by brackets. */
void metric_unit(const struct model *m, enum metric_kind kind, int i, char text[METRIC_UNIT])
{
    const char *pattern = metric_table[kind].unit, *unit = i >= 0 ? metric_signal(m, i)->unit : "";
    bool bare = !strcmp(unit, "1"), simple = !strpbrk(unit, "/ ^");
    if (!strcmp(pattern, "(U)^2 s"))
        snprintf(text, METRIC_UNIT, bare ? "%ss" : simple ? "%s^2 s" : "(%s)^2 s", bare ? "" : unit);
    else if (*pattern == 'U')
        snprintf(text, METRIC_UNIT, "%s%s", bare ? "" : unit, pattern + 1 + (bare && pattern[1] == ' '));
    else
        snprintf(text, METRIC_UNIT, "%s", pattern);
}

/* Where the value of signal i is found, in model units; a frequency's in Hz. */
static const double *source_of(const struct metric_block *b, const struct plant *pl, int i)
{
    const struct model *m = pl->model;
    if (metric_is_frequency(m, i))
        return &b->frequency[i - m->n_outputs - m->n_inputs];
    return i < m->n_outputs ? &b->output[i] : &pl->drive[i - m->n_outputs].sample;
}

void metric_block_begin(struct metric_block *b, const struct plant *pl, uint32_t which)
{
    memset(b, 0, sizeof *b);
    for (int i = 0; which >> i; i++) {
        if (!(which >> i & 1u))
            continue;
        b->outputs = b->outputs || i < pl->model->n_outputs;
        if (metric_is_frequency(pl->model, i))
            b->frequencies |= 1u << (i - pl->model->n_outputs - pl->model->n_inputs);
        b->source[b->n_signals++] =
            (struct metric_source){.now = source_of(b, pl, i), .value = b->value[i], .signal = i};
    }
}

NEVER_INLINE void find_units(struct metric_block *b, const struct plant *pl)
{
    b->model = pl->model;
    b->scale = pl->scale;
    for (int j = 0; j < b->n_signals; j++) {
        int i = b->source[j].signal;
        bool is_frequency = metric_is_frequency(pl->model, i);
        b->source[j].unit = is_frequency ? 1.0 : scale_of(&pl->scale, metric_signal(pl->model, i)->quantity);
    }
}

/* A parameter that changes inside the block may change the scale. */
static bool has_units(const struct metric_block *b, const struct plant *pl)
{
    return b->model == pl->model && b->scale.length_m == pl->scale.length_m &&
           b->scale.time_s == pl->scale.time_s && b->scale.force_N == pl->scale.force_N;
}

NEVER_INLINE void read_drives(struct fit_drive *to, const struct plant *pl)
{
    for (int i = 0; i < pl->model->n_inputs; i++) {
        const struct drive *d = &pl->drive[i];
        bool sounds = d->amplitude != 0.0 || d->ramp_left > 0;
        to[i] = (struct fit_drive){d->cosine, d->sine, sounds ? drive_turns_per_tick(d) : 0.0};
    }
}

bool metric_block_add(struct metric_block *b, const struct plant *pl)
{
    int row = b->n++;
    if (row == 0)
        b->first = pl->now.tick;
    if (!has_units(b, pl))
        find_units(b, pl);
    if (b->outputs)
        pl->model->output(pl->p, pl->segment.at[2], pl->x, b->output);
    for (int k = 0; b->frequencies >> k; k++)
        if (b->frequencies >> k & 1u)
            b->frequency[k] = watch_read(pl, frequency[k]);
    for (const struct metric_source *s = b->source, *end = s + b->n_signals; s < end; s++)
        s->value[row] = *s->now * s->unit;
    if (b->tones)
        read_drives(b->drive[row], pl);
    return row + 1 == METRIC_TICKS;
}

double metric_count(enum metric_kind kind, const uint32_t *count)
{
    switch (kind) {
    case METRIC_REFUSED:
        return trouble_refused(count);
    case METRIC_LATE:
        return count[DIAG_LATE];
    case METRIC_MISSED:
        return count[DIAG_STREAM_MISSED];
    case METRIC_LOST:
        return count[DIAG_LOST];
    case METRIC_TIMEOUTS:
        return count[DIAG_TIMEOUTS];
    default:
        return count[DIAG_WATCH_TRIPS];
    }
}

double metric_faults(unsigned faults)
{
    double n = 0.0;
    for (unsigned bits = faults & ~(unsigned)FAULT_TIMEOUT; bits; bits &= bits - 1)
        n += 1.0;
    return n;
}
