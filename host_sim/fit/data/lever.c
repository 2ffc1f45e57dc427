/* lever.c - see lever.h. */
#include "host_sim/fit/data/lever.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/unit.h"

enum { LEAST = 16, SMOOTH = 4 /* bins to both sides */, STARTING_ROWS = 1 << 12 };
static const double around = 20.0; /* half widths of the resonance in the fit */
static const double band_most = 0.3;
static const double stands_out = 4.0; /* times the median of the spectrum */

/* ---- rows ---- */

static bool make_room(struct lever_data *d, int rows)
{
    double *x = realloc(d->x, (size_t)rows * sizeof *x);
    d->x = x ? x : d->x;
    double *y = realloc(d->y, (size_t)rows * sizeof *y);
    d->y = y ? y : d->y;
    bool *back = realloc(d->back, (size_t)rows * sizeof *back);
    d->back = back ? back : d->back;
    return x && y && back;
}

/* The columns of the numbers, and factors to SI. */
struct columns {
    int x, y, back;
    double x_SI, y_SI;
    bool tip; /* y is the tip's position: the deflection is what it is above the base */
};

static int column_of(const struct table *t, const char *name, const char *unit, int *column, double *factor)
{
    const char *own = "";
    char why[UNIT_REASON];
    *column = table_find(t, name, &own);
    if (*column < 0)
        return table_wrong(t, 0, "no column %s_%s in the header", name, unit);
    if (!*own)
        return table_wrong(t, *column, "the unit is missing; call the column %s_%s", name, unit);
    if (!table_unit(own, unit, factor, why))
        return table_wrong(t, *column, "column %.40s: %s", t->name[*column], why);
    return 0;
}

/* m2_per_Hz, pm2_per_Hz: a squared length. */
static int density_of(const struct table *t, struct columns *c)
{
    const char *own = "", *rest;
    char length[16] = "", why[UNIT_REASON];
    c->y = table_find(t, "density", &own);
    if (c->y < 0)
        return table_wrong(t, 0, "no column density_m2_per_Hz in the header");
    rest = strstr(own, "2_per_Hz");
    if (rest && rest - own < (ptrdiff_t)sizeof length)
        memcpy(length, own, (size_t)(rest - own));
    if (!rest || rest[8] || !table_unit(length, "m", &c->y_SI, why))
        return table_wrong(t, c->y, "column %.40s: write density_m2_per_Hz, or pm2_per_Hz", t->name[c->y]);
    c->y_SI *= c->y_SI;
    return 0;
}

static int find_columns(const struct table *t, enum lever_kind kind, struct columns *c)
{
    const char *unused = "";
    *c = (struct columns){.back = -1, .x_SI = 1.0, .y_SI = 1.0};
    if (kind == LEVER_SPECTRUM) {
        int status = column_of(t, "frequency", "Hz", &c->x, &c->x_SI);
        return status ? status : density_of(t, c);
    }
    if (t->tabs) {
        c->x = table_find(t, "height (measured)", &unused);
        c->y = table_find(t, "tip position", &unused);
        c->back = table_find(t, "segment", &unused);
        c->tip = true;
        return c->x < 0 || c->y < 0
                   ? table_wrong(t, 0, "no columns `height (measured)` and `tip position` in this .tab")
                   : 0;
    }
    c->back = table_find(t, "retract", &unused);
    int status = column_of(t, "base", "m", &c->x, &c->x_SI);
    return status ? status : column_of(t, "deflection", "m", &c->y, &c->y_SI);
}

static int take_back(const struct table *t, int column, bool *back)
{
    const char *cell = t->cell[column];
    *back = !strcmp(cell, "1") || !strcmp(cell, "True");
    if (*back || !strcmp(cell, "0") || !strcmp(cell, "False"))
        return 0;
    return table_wrong(t, column, "\"%.40s\": write 1 on the way back, else 0", cell);
}

static int take_row(const struct table *t, const struct columns *c, struct lever_data *d)
{
    int i = d->n;
    int status = table_number(t, c->x, &d->x[i]);
    status = status ? status : table_number(t, c->y, &d->y[i]);
    d->back[i] = false;
    if (!status && c->back >= 0)
        status = take_back(t, c->back, &d->back[i]);
    if (status)
        return status;
    d->x[i] *= c->x_SI;
    d->y[i] = d->y[i] * c->y_SI - (c->tip ? d->x[i] : 0.0);
    d->has_back = d->has_back || d->back[i];
    if (d->kind == LEVER_SPECTRUM && i && !(d->x[i] > d->x[i - 1]))
        return table_wrong(t, c->x, "frequency %.9g Hz does not rise; sort the rows", d->x[i]);
    if (d->kind == LEVER_SPECTRUM && !(d->y[i] > 0.0))
        return table_wrong(t, c->y, "a density of %g is not above 0", d->y[i]);
    d->n++;
    return 0;
}

static int read_rows(struct table *t, const struct columns *c, struct lever_data *d)
{
    int status = 0, room = 0;
    for (bool more = true; !status;) {
        status = table_row(t, &more);
        if (status || !more)
            break;
        if (d->n == LEVER_ROWS_MOST)
            return table_wrong(t, -1, "more than %d rows; take fewer", LEVER_ROWS_MOST);
        if (d->n == room) {
            room = room ? 2 * room : STARTING_ROWS;
            if (!make_room(d, room))
                return options_failure(t->usage, "out of memory");
        }
        status = take_row(t, c, d);
    }
    if (!status && d->n < 2 * LEAST)
        return table_wrong(t, -1, "%d rows; %d at least are needed", d->n, 2 * LEAST);
    return status;
}

/* ---- what is seen without a plant ---- */

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median_of(const double *y, int n)
{
    double *sorted = calloc((size_t)n, sizeof *sorted), median = (double)NAN;
    if (!sorted)
        return median;
    memcpy(sorted, y, (size_t)n * sizeof *sorted);
    qsort(sorted, (size_t)n, sizeof *sorted, compare);
    median = sorted[n / 2];
    free(sorted);
    return median;
}

static double smooth(const struct lever_data *d, int i)
{
    double sum = 0.0;
    int n = 0;
    for (int k = i - SMOOTH; k <= i + SMOOTH; k++)
        if (k >= 0 && k < d->n) {
            sum += d->y[k];
            n++;
        }
    return sum / n;
}

/* The area of the spectrum above its white noise, within so many Hz of its peak. */
static double area_of(const struct lever_data *d, double reach, double white)
{
    double area = 0.0;
    for (int i = 1; i < d->n; i++)
        if (fabs(d->x[i] - d->f0_Hz) < reach)
            area += (d->y[i] - white) * (d->x[i] - d->x[i - 1]);
    return area;
}

/* Only rows near the resonance stay. */
static void cut(struct lever_data *d, double reach)
{
    int n = 0;
    for (int i = 0; i < d->n; i++)
        if (fabs(d->x[i] - d->f0_Hz) < reach) {
            d->x[n] = d->x[i];
            d->y[n++] = d->y[i];
        }
    d->n = n;
}

/* Peak, width and area of the resonance. */
static int look_at_spectrum(const struct table *t, struct lever_data *d)
{
    int top = 0, low, high;
    for (int i = 1; i < d->n; i++)
        top = smooth(d, i) > smooth(d, top) ? i : top;
    double peak = smooth(d, top), median = median_of(d->y, d->n);
    if (!(peak > stands_out * median) || top < SMOOTH || top >= d->n - SMOOTH)
        return options_misuse(t->usage, "%s: no resonance stands out of this spectrum", d->path);
    for (low = top; low > 0 && smooth(d, low) > 0.5 * peak;)
        low--;
    for (high = top; high < d->n - 1 && smooth(d, high) > 0.5 * peak;)
        high++;
    double width = d->x[high] - d->x[low];
    d->f0_Hz = 0.5 * (d->x[high] + d->x[low]);
    d->quality = d->f0_Hz / width;
    double reach = fmin(around * width, band_most * d->f0_Hz);
    d->white = 0.0;
    for (int i = 0; i < d->n; i++)
        d->white = fabs(d->x[i] - d->f0_Hz) < reach
                       ? (d->white > 0.0 ? fmin(d->white, smooth(d, i)) : smooth(d, i))
                       : d->white;
    d->white *= 0.5;
    d->square_m2 = area_of(d, 6.0 * width, d->white);
    cut(d, reach);
    if (d->n < LEAST || !(d->square_m2 > 0.0))
        return options_misuse(t->usage, "%s: fewer than %d rows around the resonance; measure longer",
                              d->path, LEAST);
    return 0;
}

/* The deflection where the base is far: the median of the outer quarter. */
static int look_at_curve(const struct table *t, struct lever_data *d)
{
    double least = HUGE_VAL, most = -HUGE_VAL, *far = calloc((size_t)d->n, sizeof *far);
    int n = 0;
    if (!far)
        return options_failure(t->usage, "out of memory");
    for (int i = 0; i < d->n; i++) {
        least = fmin(least, d->x[i]);
        most = fmax(most, d->x[i]);
    }
    for (int i = 0; i < d->n; i++)
        if (d->x[i] > most - 0.25 * (most - least) && !d->back[i])
            far[n++] = d->y[i];
    d->baseline_m = n ? median_of(far, n) : 0.0;
    free(far);
    if (!(most > least))
        return options_misuse(t->usage, "%s: the base does not move in this curve", d->path);
    return 0;
}

static int pass_by(struct table *t, void *context, const char *key, const char *value)
{
    (void)t, (void)context, (void)key, (void)value;
    return 0;
}

int lever_read(const struct usage *u, const char *path, enum lever_kind kind, uint32_t *crc,
               struct lever_set *set)
{
    static struct table t;
    struct columns c;
    struct lever_data *d = &set->data[set->n++];
    *d = (struct lever_data){.kind = kind, .path = path, .widen = 1.0};
    t = (struct table){.usage = u, .path = path, .crc = *crc, .key = pass_by};
    int status = table_open(&t);
    status = status ? status : find_columns(&t, kind, &c);
    status = status ? status : read_rows(&t, &c, d);
    if (!status)
        status = kind == LEVER_SPECTRUM ? look_at_spectrum(&t, d) : look_at_curve(&t, d);
    table_close(&t);
    *crc = t.crc;
    d->side = calloc((size_t)d->n + 1, sizeof *d->side);
    return status ? status : d->side ? 0 : options_failure(u, "out of memory");
}

void lever_free(struct lever_set *set)
{
    for (int i = 0; i < set->n; i++) {
        free(set->data[i].x);
        free(set->data[i].y);
        free(set->data[i].back);
        free(set->data[i].side);
    }
    set->n = 0;
}
