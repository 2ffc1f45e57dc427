/* curve.c - see curve.h. */
#include "host_sim/fit/data/curve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/options_nearest.h"
#include "host_sim/cli/unit.h"
#include "host_sim/fit/data/curve_columns.h"
#include "models/math/elementary.h"

enum { ROOM = 64 };

/* ---- lines `# key = value` ---- */

static int find_signal(const struct signal *s, int n, const char *name)
{
    for (int i = 0; i < n; i++)
        if (!strcmp(s[i].name, name))
            return i;
    return -1;
}

static int refuse_name(const struct table *t, const char *what, const char *value, const struct signal *s,
                       int n)
{
    const char *name[MODEL_OUTPUTS + 1];
    for (int i = 0; i < n; i++)
        name[i] = s[i].name;
    return table_wrong(t, -1, "%s \"%.40s\" is not in this model%s", what, value,
                       options_advise(value, strlen(value), name, n, NULL));
}

static int take_output(struct table *t, struct curve *c, const struct model *m, const char *value)
{
    c->derivatives = !strcmp(value, "acceleration");
    c->output = find_signal(m->output_signal, m->n_outputs, c->derivatives ? "velocity" : value);
    return c->output < 0 ? refuse_name(t, "output", value, m->output_signal, m->n_outputs) : 0;
}

static int take_direction(struct table *t, struct curve_file *f, const char *value)
{
    f->direction = !strcmp(value, "up") ? 1 : !strcmp(value, "down") ? -1 : 0;
    return f->direction ? 0 : table_wrong(t, -1, "direction \"%.40s\": it is up or down", value);
}

static int take_number(struct table *t, const char *key, const char *value, const char *unit, double *x)
{
    char why[UNIT_REASON];
    if (!unit_read(value, strlen(value), unit, x, why))
        return table_wrong(t, -1, "%s: %s", key, why);
    if (!(*x > 0.0))
        return table_wrong(t, -1, "%s: %.40s is not above 0", key, value);
    return 0;
}

static int take_key(struct table *t, void *context, const char *key, const char *value)
{
    static const char *const names[] = {"amplitude", "input", "output", "direction", "noise"};
    struct curve_file *f = context;
    const struct model *m = f->scene->model;
    int status = table_key_once(t, key);
    if (status)
        return status;
    if (!strcmp(key, "amplitude")) {
        snprintf(f->amplitude, sizeof f->amplitude, "%s", value);
        f->amplitude_line = t->line;
        return 0;
    }
    if (!strcmp(key, "input")) {
        f->curve.input = find_signal(m->input_signal, m->n_inputs, value);
        return f->curve.input < 0 ? refuse_name(t, "input", value, m->input_signal, m->n_inputs) : 0;
    }
    if (!strcmp(key, "output"))
        return take_output(t, &f->curve, m, value);
    if (!strcmp(key, "direction"))
        return take_direction(t, f, value);
    if (!strcmp(key, "noise"))
        return take_number(t, key, value, "", &f->curve.noise);
    return table_wrong(t, -1, "no key \"%.40s\"%s", key, options_advise(key, strlen(key), names, 5, NULL));
}

/* The amplitude, now that the input is known. Rows of a sweep have the scene's where none is given. */
static int find_amplitude(struct table *t, struct curve_file *f)
{
    const struct model *m = f->scene->model;
    if (f->curve.input < 0)
        f->curve.input = 0;
    if (!*f->amplitude && f->of_sweep)
        f->curve.amplitude = fabs(f->scene->drive[f->curve.input].amplitude);
    if (*f->amplitude || f->column.family >= 0) {
        int here = t->line, status = 0;
        t->line = f->amplitude_line;
        if (*f->amplitude)
            status = take_number(t, "amplitude", f->amplitude, m->input_signal[f->curve.input].unit,
                                 &f->curve.amplitude);
        t->line = here;
        return status;
    }
    if (f->curve.amplitude > 0.0)
        return 0;
    return table_wrong(t, -1,
                       "the amplitude of the drive is not known; write # amplitude = 3 %s above the header",
                       m->input_signal[f->curve.input].unit);
}

/* ---- rows ---- */

static int add_curve(struct table *t, struct curves *all, const struct curve_file *f)
{
    if (all->n == CURVES)
        return table_wrong(t, -1, "more than %d curves; give fewer", CURVES);
    struct curve *c = &all->curve[all->n];
    *c = f->curve;
    c->n = 0;
    c->point = calloc(CURVE_POINTS, sizeof *c->point);
    if (!c->point)
        return options_failure(t->usage, "out of memory");
    all->n++;
    return 0;
}

/* The curve that a row belongs to; a new one where direction or amplitude changes. */
static int choose_curve(struct table *t, struct curves *all, int first, struct curve_file *f,
                        const struct curve_row *row)
{
    struct curve *last = all->n > first ? &all->curve[all->n - 1] : NULL;
    bool turned =
        last && f->of_sweep &&
        (last->down != row->down || last->amplitude < row->amplitude || last->amplitude > row->amplitude);
    if (last && !turned)
        return 0;
    f->curve.down = row->down;
    f->curve.amplitude = row->amplitude;
    return add_curve(t, all, f);
}

static int add_point(struct table *t, struct curve *c, struct curve_file *f, const struct curve_row *row)
{
    const struct curve_point *last = c->n ? &c->point[c->n - 1] : NULL;
    double x = row->point.frequency_Hz;
    if (last && x >= last->frequency_Hz && x <= last->frequency_Hz)
        return table_wrong(t, f->column.frequency, "frequency %.9g Hz is there twice; take one row away", x);
    if (last && c->n == 1)
        f->falling = x < last->frequency_Hz;
    if (last && (x < last->frequency_Hz) != f->falling)
        return table_wrong(t, f->column.frequency,
                           "frequency %.9g Hz is not in order; sort the rows by frequency", x);
    if (c->n == CURVE_POINTS)
        return table_wrong(t, -1, "more than %d points in a curve; take fewer", CURVE_POINTS);
    c->point[c->n] = row->point;
    c->point[c->n++].line = t->line;
    return 0;
}

/* From low to high frequencies. */
static void turn(struct curve *c)
{
    bool falling = c->n > 1 && c->point[1].frequency_Hz < c->point[0].frequency_Hz;
    for (int i = 0; falling && i < c->n / 2; i++) {
        struct curve_point was = c->point[i];
        c->point[i] = c->point[c->n - 1 - i];
        c->point[c->n - 1 - i] = was;
    }
}

static int read_rows(struct table *t, struct curve_file *f, struct curves *all)
{
    int first = all->n, status = 0;
    for (bool more = true; !status;) {
        struct curve_row row;
        status = table_row(t, &more);
        if (status || !more)
            break;
        status = curve_columns_row(t, f, &row);
        if (status || row.skipped)
            continue;
        status = choose_curve(t, all, first, f, &row);
        status = status ? status : add_point(t, &all->curve[all->n - 1], f, &row);
    }
    for (int i = first; i < all->n; i++)
        turn(&all->curve[i]);
    if (!status && all->n == first)
        return table_wrong(t, -1, "no rows below the header: that is no data");
    return status;
}

/* Where no direction is given, that of the rows. */
static void set_direction(const struct curve_file *f, struct curve *c)
{
    if (!f->of_sweep)
        c->down = f->direction ? f->direction < 0 : f->falling;
}

int curves_read(const struct usage *u, const char *path, const struct scene *s, uint32_t *crc,
                struct curves *all)
{
    static struct table t;
    struct curve_file f = {.scene = s, .curve = {.path = path, .input = -1, .output = -1}};
    t = (struct table){.usage = u, .path = path, .crc = *crc, .key = take_key, .context = &f};
    int first = all->n, status = table_open(&t);
    status = status ? status : curve_columns_find(&t, &f);
    status = status ? status : find_amplitude(&t, &f);
    status = status ? status : read_rows(&t, &f, all);
    table_close(&t);
    *crc = t.crc;
    for (int i = first; i < all->n; i++)
        set_direction(&f, &all->curve[i]);
    return status;
}

void curves_free(struct curves *c)
{
    for (int i = 0; i < c->n; i++)
        free(c->curve[i].point);
    c->n = 0;
}
