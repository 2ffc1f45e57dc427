/* curve_columns.c - see curve_columns.h. */
#include "host_sim/fit/data/curve_columns.h"

#include <math.h>
#include <string.h>
#include "host_sim/cli/unit.h"
#include "models/math/elementary.h"

#define TURN_RAD (2.0 * ELEMENTARY_PI)

const char *curve_name(const struct curve *c, const struct model *m)
{
    return c->derivatives ? "acceleration" : m->output_signal[c->output].name;
}

const char *curve_unit(const struct curve *c, const struct model *m)
{
    return c->derivatives ? "m/s^2" : m->output_signal[c->output].unit;
}

static int unit_of(const struct table *t, int i, const char *column, const char *unit, double *factor)
{
    char why[UNIT_REASON];
    if (!*column)
        return table_wrong(t, i, "the unit is missing; call the column %s_..", t->name[i]);
    if (!table_unit(column, unit, factor, why))
        return table_wrong(t, i, "column %.40s: %s", t->name[i], why);
    return 0;
}

/* The output that is measured in this unit. */
static int guess_output(const struct table *t, int i, const char *column, struct curve_file *f)
{
    static const char *const kinds[] = {"displacement", "velocity", "contact_force", "acceleration"};
    const struct model *m = f->scene->model;
    char why[UNIT_REASON];
    double factor;
    if (!*column)
        return unit_of(t, i, column, "m", &factor);
    for (int k = 0; k < 4; k++) {
        bool last = k == 3;
        for (int o = 0; o < m->n_outputs; o++) {
            if (strcmp(m->output_signal[o].name, last ? "velocity" : kinds[k]) ||
                !table_unit(column, last ? "m/s^2" : m->output_signal[o].unit, &factor, why))
                continue;
            f->curve.output = o;
            f->curve.derivatives = last;
            return 0;
        }
    }
    return table_wrong(t, i,
                       "column %.40s: no output has this unit; give m, m/s, N or m/s^2 with a prefix, as "
                       "amplitude_um or amplitude_m_per_s",
                       t->name[i]);
}

/* Amplitude, phase and sigma. */
static int find_polar(const struct table *t, struct curve_file *f)
{
    struct curve_column *c = &f->column;
    const struct model *m = f->scene->model;
    const char *amplitude = "", *phase = "", *sigma = "";
    c->amplitude = table_find(t, f->of_sweep ? "amplitude_1" : "amplitude", &amplitude);
    c->phase = table_find(t, f->of_sweep ? "phase_1" : "phase", &phase);
    if (c->amplitude < 0)
        return table_wrong(t, 0, "no column amplitude_.., and none re_.. and im_..; name what was measured");
    if (f->of_sweep && f->curve.output < 0)
        f->curve.output = f->scene->observable;
    int status = f->curve.output < 0 ? guess_output(t, c->amplitude, amplitude, f) : 0;
    status =
        status ? status : unit_of(t, c->amplitude, amplitude, curve_unit(&f->curve, m), &c->amplitude_SI);
    if (!status && c->phase >= 0)
        status = unit_of(t, c->phase, phase, "rad", &c->phase_rad);
    c->sigma = table_find(t, "sigma", &sigma);
    if (!status && c->sigma >= 0)
        status = unit_of(t, c->sigma, sigma, curve_unit(&f->curve, m), &c->sigma_SI);
    f->curve.has_phase = c->phase >= 0;
    return status;
}

/* re and im of the response over the drive: "m_per_N". */
static int find_complex(const struct table *t, struct curve_file *f)
{
    struct curve_column *c = &f->column;
    const struct model *m = f->scene->model;
    const char *re = "", *im = "";
    char above[TABLE_LINE / 16], unit[CURVE_VALUE];
    c->re = table_find(t, "re", &re);
    c->im = table_find(t, "im", &im);
    if (c->re < 0 || c->im < 0)
        return table_wrong(t, c->re < 0 ? c->im : c->re, "re_.. and im_.. go together");
    if (strcmp(re, im))
        return table_wrong(t, c->im, "re_.. and im_.. have different units");
    const char *per = strstr(re, "_per_");
    for (const char *next = per; next; next = strstr(next + 1, "_per_"))
        per = next;
    if (!per || per - re >= (long)sizeof above)
        return table_wrong(t, c->re, "column %.40s: give the output over the drive, as re_m_per_N",
                           t->name[c->re]);
    snprintf(above, sizeof above, "%.*s", (int)(per - re), re);
    int status = f->curve.output < 0 ? guess_output(t, c->re, above, f) : 0;
    const char *input = m->input_signal[f->curve.input < 0 ? 0 : f->curve.input].unit;
    snprintf(unit, sizeof unit, "%s", curve_unit(&f->curve, m));
    status = status ? status : unit_of(t, c->re, above, unit, &c->ratio_SI);
    double below = 1.0;
    status = status ? status : unit_of(t, c->re, per + 5, input, &below);
    c->ratio_SI /= below;
    f->curve.has_phase = true;
    return status;
}

/* A sweep's rows say how they are swept, and over what. */
static int find_sweep(const struct table *t, struct curve_file *f)
{
    const struct model *m = f->scene->model;
    const char *unit;
    f->column.direction = table_find(t, "direction", &unit);
    for (int i = 0; i < m->n_inputs; i++) {
        char name[CURVE_VALUE];
        snprintf(name, sizeof name, "%s.frequency", m->input_signal[i].name);
        if (table_find(t, name, &unit) >= 0) {
            f->curve.input = i;
            f->column.frequency = table_find(t, name, &unit);
        }
        snprintf(name, sizeof name, "%s.amplitude", m->input_signal[i].name);
        if (table_find(t, name, &unit) >= 0)
            f->column.family = table_find(t, name, &unit);
    }
    if (f->column.frequency < 0 || f->column.direction < 0)
        return table_wrong(t, 0, "rows of a sweep over something else than a drive's frequency");
    f->column.frequency_Hz = 1.0;
    return 0;
}

int curve_columns_find(struct table *t, struct curve_file *f)
{
    const char *unit;
    f->column = (struct curve_column){-1, -1, -1, -1, -1, -1, -1, -1, -1, 1.0, 1.0, 1.0, 1.0, 1.0};
    f->column.kind = table_find(t, "kind", &unit);
    f->of_sweep = f->column.kind >= 0 && table_find(t, "job", &unit) >= 0;
    if (f->of_sweep) {
        int status = find_sweep(t, f);
        return status ? status : find_polar(t, f);
    }
    f->column.kind = -1;
    f->column.frequency = table_find(t, "frequency", &unit);
    if (f->column.frequency < 0)
        return table_wrong(t, 0, "no column frequency_Hz in the header");
    int status = unit_of(t, f->column.frequency, unit, "Hz", &f->column.frequency_Hz);
    if (status)
        return status;
    const char *re, *im;
    bool is_complex = table_find(t, "re", &re) >= 0 || table_find(t, "im", &im) >= 0;
    return is_complex ? find_complex(t, f) : find_polar(t, f);
}

/* ---- rows ---- */

static int take_polar(const struct table *t, const struct curve_file *f, struct curve_point *p)
{
    const struct curve_column *c = &f->column;
    double amplitude, phase = 0.0, cosine, sine;
    int status = table_number(t, c->amplitude, &amplitude);
    status = status || c->phase < 0 ? status : table_number(t, c->phase, &phase);
    if (status)
        return status;
    if (!(amplitude > 0.0))
        return table_wrong(t, c->amplitude, "an amplitude that is not above 0; take this row away");
    phase *= c->phase_rad;
    if (fabs(phase) > TURN_RAD + 1e-3)
        return table_wrong(t, c->phase, "%s rad looks like degrees; call the column phase_deg",
                           t->cell[c->phase]);
    cos_sin(phase, &cosine, &sine);
    p->re = amplitude * c->amplitude_SI * cosine;
    p->im = amplitude * c->amplitude_SI * sine;
    return 0;
}

static int take_complex(const struct table *t, const struct curve_file *f, double drive,
                        struct curve_point *p)
{
    int status = table_number(t, f->column.re, &p->re);
    status = status ? status : table_number(t, f->column.im, &p->im);
    p->re *= f->column.ratio_SI * drive;
    p->im *= f->column.ratio_SI * drive;
    if (!status && !(fabs(p->re) + fabs(p->im) > 0.0))
        return table_wrong(t, f->column.re, "a response of 0; take this row away");
    return status;
}

static int take_sigma(const struct table *t, const struct curve_file *f, struct curve_point *p)
{
    p->sigma = f->curve.noise * sqrt(p->re * p->re + p->im * p->im);
    if (f->column.sigma < 0)
        return 0;
    int status = table_number(t, f->column.sigma, &p->sigma);
    p->sigma *= f->column.sigma_SI;
    if (!status && !(p->sigma > 0.0))
        return table_wrong(t, f->column.sigma, "a standard deviation that is not above 0");
    return status;
}

/* A sweep's row says more than a curve's. */
static int take_sweep(const struct table *t, const struct curve_file *f, struct curve_row *row)
{
    row->skipped = strcmp(t->cell[f->column.kind], "point") != 0;
    row->down = !strcmp(t->cell[f->column.direction], "down");
    if (row->skipped || f->column.family < 0)
        return 0;
    return table_number(t, f->column.family, &row->amplitude);
}

int curve_columns_row(const struct table *t, const struct curve_file *f, struct curve_row *row)
{
    *row = (struct curve_row){.amplitude = f->curve.amplitude};
    int status = f->of_sweep ? take_sweep(t, f, row) : 0;
    if (status || row->skipped)
        return status;
    status = table_number(t, f->column.frequency, &row->point.frequency_Hz);
    row->point.frequency_Hz *= f->column.frequency_Hz;
    if (!status && !(row->point.frequency_Hz > 0.0))
        return table_wrong(t, f->column.frequency, "a frequency that is not above 0");
    if (!status)
        status = f->column.re >= 0 ? take_complex(t, f, row->amplitude, &row->point)
                                   : take_polar(t, f, &row->point);
    return status ? status : take_sigma(t, f, &row->point);
}
