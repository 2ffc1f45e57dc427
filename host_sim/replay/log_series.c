/* log_series.c - see log_series.h. */
#include "host_sim/replay/log_series.h"
#include "models/check.h"

#include <math.h>
#include <string.h>

enum {
    STEPS_MISSING = 4, /* so many times the usual frames between two rows, and rows are missing */
    ROWS_MADE = 1 << 16
};

STATIC_ASSERT((int)DECODE_SIGNALS + (int)DECODE_OUTPUTS <= (int)DECIMATE_COLUMNS, series_fits);

void log_series_begin(struct log_series *s, int n_inputs)
{
    memset(s, 0, sizeof *s);
    s->n_signals = DECODE_OUTPUTS + n_inputs;
    s->step = UINT64_MAX;
    decimate_begin(&s->bins, s->n_signals + DECODE_OUTPUTS);
}

/* Rows without a value in the place of those that are missing before this one. */
static void bridge(struct log_series *s, const struct decode_row *row)
{
    double nothing[DECIMATE_COLUMNS], begin_s = s->bins.last;
    uint64_t frames = row->frame - s->frame, made = frames / s->step;
    made = made < ROWS_MADE ? made : ROWS_MADE;
    for (int k = 0; k < DECIMATE_COLUMNS; k++)
        nothing[k] = (double)NAN;
    for (uint64_t i = 1; i < made; i++)
        decimate_add(&s->bins, begin_s + (row->t_s - begin_s) * (double)i / (double)made, nothing);
}

void log_series_add(struct log_series *s, const struct decode_row *row)
{
    double value[DECIMATE_COLUMNS];
    uint64_t frames = row->frame - s->frame;
    if (s->n && frames && frames < s->step)
        s->step = frames;
    if (s->n && s->step < UINT64_MAX && frames >= STEPS_MISSING * s->step && row->t_s > s->bins.last)
        bridge(s, row);
    memcpy(value, row->value, (size_t)s->n_signals * sizeof *value);
    for (int k = 0; k < DECODE_OUTPUTS; k++) {
        bool beyond = row->beyond >> k & 1u;
        value[s->n_signals + k] = beyond ? 1.0 : (double)NAN;
        s->n_beyond[k] += beyond;
    }
    decimate_add(&s->bins, row->t_s, value);
    s->frame = row->frame;
    s->n++;
}

static double edge(const struct log_series *s, size_t i)
{
    return i < s->bins.n ? s->bins.x[i] : s->bins.last;
}

bool log_series_next(const struct log_series *s, int k, size_t *i, double *from, double *to)
{
    const double *beyond = s->bins.high[s->n_signals + k];
    while (*i < s->bins.n && isnan(beyond[*i]))
        ++*i;
    if (*i == s->bins.n)
        return false;
    *from = edge(s, *i);
    while (*i < s->bins.n && !isnan(beyond[*i]))
        ++*i;
    *to = edge(s, *i);
    return true;
}

double log_series_range(const struct wire_scene *w, int k)
{
    return 8388607.0 * w->lsb[k];
}
