/* basin_rows.c - the columns of a basin map: start, what became of it, fingerprint, a state of the attractor. */
#include "host_sim/maps/basin/basin.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const char *const groups[] = {"mean", "rms", "end"};
enum { GROUPS = sizeof groups / sizeof groups[0] };

double basin_unit(const struct basin *b, int i, const char **unit)
{
    const struct signal *s = &b->plant.model->state_signal[i];
    if (unit)
        *unit = scenes_dimensionless(&b->scene) ? "1" : s->unit;
    return scale_of(&b->plant.scale, s->quantity);
}

static void append(char *text, const char *format, ...)
{
    size_t n = strlen(text);
    va_list a;
    va_start(a, format);
    vsnprintf(text + n, BASIN_COLUMNS - n, format, a);
    va_end(a);
}

void basin_rows_name(struct basin *b)
{
    const struct model *m = b->plant.model;
    *b->columns = '\0';
    append(b->columns, "start");
    for (int i = 0; i < m->n_states; i++)
        append(b->columns, ",%s", m->state_signal[i].name);
    append(b->columns, ",outcome,period,periods,growth,open,peak_%s",
           m->output_signal[b->plant.observable].name);
    for (int k = 0; k < GROUPS; k++)
        for (int i = 0; i < m->n_states; i++)
            append(b->columns, ",%s_%s", groups[k], m->state_signal[i].name);
}

double basin_rows_peak_unit(const struct basin *b)
{
    return scale_of(&b->plant.scale, b->plant.model->output_signal[b->plant.observable].quantity);
}

void basin_rows_write(const struct basin *b, int start, const double *x, const struct basin_motion *m,
                      FILE *f)
{
    const double *part[GROUPS] = {m->mean, m->rms, m->end};
    int n = b->plant.model->n_states;
    fprintf(f, "%d", start);
    for (int i = 0; i < n; i++)
        fprintf(f, ",%.17g", x[i]);
    fprintf(f, ",%s,%d,%d,%.6g,%.6g,%.9g", basin_outcome_name[m->outcome], m->period, m->periods, m->growth,
            m->open, m->peak * basin_rows_peak_unit(b));
    for (int k = 0; k < GROUPS; k++)
        for (int i = 0; i < n; i++)
            fprintf(f, k == 2 ? ",%.17g" : ",%.9g", part[k][i] * basin_unit(b, i, NULL));
    fputc('\n', f);
}

/* The next number of a row; *at is NULL after a mistake. */
static double number(const char **at)
{
    char *end;
    double x = *at ? strtod(*at, &end) : 0.0;
    if (*at)
        *at = end == *at || (*end != ',' && *end != '\n') ? NULL : end + 1;
    return x;
}

static enum basin_outcome outcome(const char **at)
{
    for (int i = 0; *at && i < BASIN_OUTCOMES; i++) {
        size_t n = strlen(basin_outcome_name[i]);
        if (!strncmp(*at, basin_outcome_name[i], n) && (*at)[n] == ',') {
            *at += n + 1;
            return (enum basin_outcome)i;
        }
    }
    *at = NULL;
    return BASIN_OUTCOMES;
}

bool basin_rows_read(const struct basin *b, const char *line, unsigned *run, int *start, double *x,
                     struct basin_motion *m)
{
    double *part[GROUPS] = {m->mean, m->rms, m->end};
    int n = b->plant.model->n_states, job, used = 0;
    if (sscanf(line, "%8x,%d,%n", run, &job, &used) != 2 || used == 0)
        return false;
    const char *at = line + used;
    *start = (int)number(&at);
    for (int i = 0; i < n; i++)
        x[i] = number(&at);
    m->outcome = outcome(&at);
    m->period = (int)number(&at);
    m->periods = (int)number(&at);
    m->growth = number(&at);
    m->open = number(&at);
    m->peak = number(&at) / basin_rows_peak_unit(b);
    for (int k = 0; k < GROUPS; k++)
        for (int i = 0; i < n; i++)
            part[k][i] = number(&at) / basin_unit(b, i, NULL);
    return at && !*at && *start / BASIN_BLOCK == job;
}
