/* record.c - see record.h. */
#include "host_sim/fit/data/record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/options_nearest.h"
#include "host_sim/cli/unit.h"

enum { LEAST = 16, TURNS_LEAST = 3 };
static const double uneven = 1e-3; /* share of a step: times that differ by more are not equal */

/* Columns and factors to SI. */
struct file {
    const struct scene *scene;
    struct record record;
    int time, output, drive;
    double time_s, output_SI, drive_SI;
    char noise[64]; /* as it stands in the file */
    int noise_line;
};

static int find_signal(const struct table *t, const char *what, const struct signal *s, int n,
                       const char *name, int *found)
{
    const char *names[MODEL_OUTPUTS];
    for (*found = 0; *found < n; ++*found) {
        names[*found] = s[*found].name;
        if (!strcmp(s[*found].name, name))
            return 0;
    }
    return table_wrong(t, -1, "%s \"%.40s\" is not in this model%s", what, name,
                       options_advise(name, strlen(name), names, n, NULL));
}

static int take_key(struct table *t, void *context, const char *key, const char *value)
{
    static const char *const names[] = {"output", "input", "noise"};
    struct file *f = context;
    const struct model *m = f->scene->model;
    int status = table_key_once(t, key);
    if (status)
        return status;
    if (!strcmp(key, "output"))
        return find_signal(t, "output", m->output_signal, m->n_outputs, value, &f->record.output);
    if (!strcmp(key, "input"))
        return find_signal(t, "input", m->input_signal, m->n_inputs, value, &f->record.input);
    if (strcmp(key, "noise"))
        return table_wrong(t, -1, "no key \"%.40s\"%s", key,
                           options_advise(key, strlen(key), names, 3, NULL));
    snprintf(f->noise, sizeof f->noise, "%s", value);
    f->noise_line = t->line;
    return 0;
}

/* ---- columns ---- */

static int unit_of(const struct table *t, int i, const char *column, const char *unit, double *factor)
{
    char why[UNIT_REASON];
    if (!*column)
        return table_wrong(t, i, "the unit is missing; call the column %s_%s", t->name[i], unit);
    if (!table_unit(column, unit, factor, why))
        return table_wrong(t, i, "column %.40s: %s", t->name[i], why);
    return 0;
}

/* The column of one of these signals: the one that was named, or the first that is there. */
static int find_column(const struct table *t, const struct signal *s, int n, const char *what, int *signal,
                       int *column, double *factor)
{
    const char *unit = "";
    *column = -1;
    for (int i = 0; i < n && *column < 0; i++) {
        if (*signal >= 0 && *signal != i)
            continue;
        *column = table_find(t, s[i].name, &unit);
        if (*column >= 0)
            *signal = i;
    }
    if (*column < 0)
        return table_wrong(t, 0, "no column with the %s; name it as the scene does, %s_%s", what,
                           s[*signal < 0 ? 0 : *signal].name, s[*signal < 0 ? 0 : *signal].unit);
    return unit_of(t, *column, unit, s[*signal].unit, factor);
}

static int find_columns(const struct table *t, struct file *f, bool driven)
{
    const struct model *m = f->scene->model;
    const char *unit = "";
    f->drive = -1;
    f->time = table_find(t, "time", &unit);
    if (f->time < 0)
        return table_wrong(t, 0, "no column time_s in the header");
    int status = unit_of(t, f->time, unit, "s", &f->time_s);
    if (!status)
        status = find_column(t, m->output_signal, m->n_outputs, "motion", &f->record.output, &f->output,
                             &f->output_SI);
    if (!status && driven)
        status =
            find_column(t, m->input_signal, m->n_inputs, "drive", &f->record.input, &f->drive, &f->drive_SI);
    if (!driven)
        f->record.input = -1;
    return status;
}

/* ---- rows ---- */

static int take_row(struct table *t, struct file *f, double *first, double *last)
{
    struct record *r = &f->record;
    double time;
    int status = table_number(t, f->time, &time);
    status = status ? status : table_number(t, f->output, &r->y[r->n]);
    if (!status && f->drive >= 0)
        status = table_number(t, f->drive, &r->u[r->n]);
    if (status)
        return status;
    time *= f->time_s;
    r->y[r->n] *= f->output_SI;
    r->u[r->n] *= f->drive_SI;
    if (r->n && !(time > *last))
        return table_wrong(t, f->time, "time %.9g s does not rise; sort the rows by time", time);
    if (r->n == 1)
        r->step_s = time - *last;
    if (r->n > 1 && fabs(time - *first - r->n * r->step_s) > uneven * r->n * r->step_s)
        return table_wrong(t, f->time, "time %.9g s is not a step of %.9g s on; give equal steps", time,
                           r->step_s);
    *first = r->n ? *first : time;
    *last = time;
    r->n++;
    if (r->n > 1)
        r->step_s = (*last - *first) / (r->n - 1);
    return 0;
}

static int read_rows(struct table *t, struct file *f)
{
    double first = 0.0, last = 0.0;
    int status = 0;
    for (bool more = true; !status;) {
        status = table_row(t, &more);
        if (status || !more)
            break;
        if (f->record.n == RECORD_POINTS)
            return table_wrong(t, -1, "more than %d rows; take fewer", RECORD_POINTS);
        status = take_row(t, f, &first, &last);
    }
    if (!status && f->record.n < LEAST)
        return table_wrong(t, -1, "%d rows; a record has %d at least", f->record.n, LEAST);
    return status;
}

/* ---- what is seen without a plant ---- */

int record_count(const double *y, int n)
{
    int count = 0;
    for (int i = 0; i < n; i++)
        count += !isnan(y[i]);
    return count;
}

static double mean_of(const double *y, int n)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += isnan(y[i]) ? 0.0 : y[i];
    return sum / record_count(y, n);
}

double record_deviation(const double *y, int n)
{
    double mean = mean_of(y, n), sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += isnan(y[i]) ? 0.0 : (y[i] - mean) * (y[i] - mean);
    return sqrt(sum / record_count(y, n));
}

/* Frequency by the rising crossings of the later half, and decay by the size of its two parts. */
static bool estimate(struct record *r)
{
    const double *y = r->y + r->n / 2;
    int n = r->n - r->n / 2, turns = -1;
    double mean = mean_of(y, n), first = 0.0, last = 0.0;
    double level = 0.3 * record_deviation(y, n);
    bool low = false;
    for (int i = 1; i < n; i++) {
        low = low || y[i] < mean - level;
        if (!low || y[i] < mean || y[i - 1] >= mean)
            continue;
        last = i - 1 + (mean - y[i - 1]) / (y[i] - y[i - 1]);
        first = turns < 0 ? last : first;
        turns++;
        low = false;
    }
    if (turns < TURNS_LEAST)
        return false;
    r->frequency_Hz = turns / ((last - first) * r->step_s);
    double early = record_deviation(r->y, r->n / 2), late = record_deviation(y, n);
    r->decay_per_s = fmax(early / late - 1.0, 1e-3) / (0.5 * r->n * r->step_s);
    return true;
}

static int take_noise(struct table *t, struct file *f)
{
    const char *unit = f->scene->model->output_signal[f->record.output].unit;
    char why[UNIT_REASON];
    size_t n = strlen(f->noise);
    bool share = n && f->noise[n - 1] == '%';
    if (!n)
        return 0;
    t->line = f->noise_line;
    if (!unit_read(f->noise, n, share ? "" : unit, &f->record.noise, why))
        return table_wrong(t, -1, "noise: %s", why);
    if (!(f->record.noise > 0.0))
        return table_wrong(t, -1, "noise: %.40s is not above 0", f->noise);
    f->record.noise *= share ? sqrt(2.0) * f->record.size : 1.0;
    return 0;
}

static int conclude(struct table *t, struct file *f, bool driven)
{
    struct record *r = &f->record;
    r->size = record_deviation(r->y, r->n);
    if (!(r->size > 0.0))
        return table_wrong(t, -1, "nothing moves in this record");
    int end = t->line, status = take_noise(t, f);
    t->line = status ? t->line : end;
    if (!status && !driven && !estimate(r))
        return table_wrong(t, -1, "fewer than %d turns in the later half of this record; give a longer one",
                           TURNS_LEAST);
    return status;
}

int records_read(const struct usage *u, const char *path, const struct scene *s, bool driven, uint32_t *crc,
                 struct records *all)
{
    static struct table t;
    struct file f = {
        .scene = s, .record = {.path = path, .input = -1, .output = -1}, .time_s = 1.0, .drive_SI = 1.0};
    if (all->n == RECORDS)
        return options_misuse(u, "%s: more than %d records; give fewer", path, RECORDS);
    t = (struct table){.usage = u, .path = path, .crc = *crc, .key = take_key, .context = &f};
    f.record.y = calloc(RECORD_POINTS, sizeof *f.record.y);
    f.record.u = calloc(RECORD_POINTS, sizeof *f.record.u);
    int status = f.record.y && f.record.u ? table_open(&t) : options_failure(u, "out of memory");
    status = status ? status : find_columns(&t, &f, driven);
    status = status ? status : read_rows(&t, &f);
    status = status ? status : conclude(&t, &f, driven);
    table_close(&t);
    *crc = t.crc;
    all->record[all->n++] = f.record;
    return status;
}

void records_free(struct records *r)
{
    for (int i = 0; i < r->n; i++) {
        free(r->record[i].y);
        free(r->record[i].u);
    }
    r->n = 0;
}
