/* sweep_chart.c - the picture of a sweep from its file of rows: amplitudes, phase, time out of contact and peak force over the
 * swept number; up and down, or a colour for each value of the family. Jumps are dashed. */
#include "host_sim/maps/maps.h"
#include "host_sim/maps/sweep/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LINE = 4096, CELLS = 40, LABEL = 160, COLOURS = 6, LEGENDS = 9, KIND = 16 };

/* The file: columns of numbers, one chain after the other. */
struct table {
    size_t n;
    int columns, n_chains;
    double *cell[CELLS]; /* [n] each */
    int *chain;          /* of each row: twice its job, and one more on the way down */
    char (*kind)[KIND];
    char name[CELLS][SCENE_RANGE_NAME];
};

struct picture {
    const struct sweep *s;
    struct table t;
    struct chart c;
    double *x, *y; /* of the line under way */
};

/* ---- reading ---- */

static bool make_table(struct table *t, size_t rows)
{
    bool good = true;
    t->chain = calloc(rows, sizeof *t->chain);
    t->kind = calloc(rows, sizeof *t->kind);
    for (int i = 0; i < CELLS; i++)
        good &= (t->cell[i] = calloc(rows, sizeof(double))) != NULL;
    return good && t->chain && t->kind;
}

static void free_table(struct table *t)
{
    for (int i = 0; i < CELLS; i++)
        free(t->cell[i]);
    free(t->chain);
    free(t->kind);
}

/* run,job,kind,direction and then numbers */
static void read_row(struct table *t, char *line)
{
    char *rest = line;
    (void)strsep(&rest, ",");
    const char *job = strsep(&rest, ","), *kind = strsep(&rest, ","), *direction = strsep(&rest, ",");
    if (!rest)
        return;
    t->chain[t->n] = 2 * atoi(job) + !strcmp(direction, "down");
    snprintf(t->kind[t->n], KIND, "%s", kind);
    for (int i = 0; i < t->columns; i++) {
        const char *text = strsep(&rest, ",");
        t->cell[i][t->n] = text ? strtod(text, NULL) : (double)NAN;
    }
    if (t->chain[t->n] >= t->n_chains)
        t->n_chains = t->chain[t->n] + 1;
    t->n++;
}

static void read_names(struct table *t, const char *columns)
{
    char text[LINE], *rest = text;
    snprintf(text, sizeof text, "%s", columns);
    (void)strsep(&rest, ",");
    (void)strsep(&rest, ",");
    for (char *name; t->columns < CELLS && (name = strsep(&rest, ",")) != NULL; t->columns++)
        snprintf(t->name[t->columns], SCENE_RANGE_NAME, "%s", name);
}

static bool read_table(struct table *t, const char *columns, const char *path)
{
    char line[LINE];
    size_t rows = 1;
    FILE *f = fopen(path, "r");
    if (!f)
        return false;
    while (fgets(line, sizeof line, f))
        rows++;
    read_names(t, columns);
    bool good = make_table(t, rows);
    rewind(f);
    for (bool header = true; good && fgets(line, sizeof line, f); header = false)
        if (!header)
            read_row(t, line);
    (void)fclose(f);
    return good;
}

/* ---- drawing ---- */

/* `name` with its unit in brackets, that prefixed so that `largest` reads well; the factor to it. */
static double label_of(const char *name, const char *unit, double largest, char label[LABEL])
{
    static const char *const prefix[] = {"f", "p", "n", "u", "m", "", "k", "M", "G"};
    int power = largest > 0.0 ? (int)floor(log10(largest) / 3.0) : 0;
    power = power < -5 ? -5 : power > 3 ? 3 : power;
    if (!*unit || !strcmp(unit, "rad")) {
        snprintf(label, LABEL, "%s%s%s%s", name, *unit ? " (" : "", unit, *unit ? ")" : "");
        return 1.0;
    }
    snprintf(label, LABEL, "%s (%s%s)", name, prefix[power + 5], unit);
    return pow(10.0, -3.0 * power);
}

/* What the legend of the first panel calls a chain, or NULL. */
static const char *legend_of(const struct picture *p, int chain, char text[LABEL])
{
    const struct scene_range *f = &p->s->family;
    if (p->c.n_panels > 1)
        return NULL;
    if (!f->n)
        return chain == 0 ? "up" : "down";
    snprintf(text, LABEL, "%.4g", scene_range_value(f, chain / 2));
    bool shown = f->n <= LEGENDS || chain == 0 || chain == 2 * f->n - 2;
    return chain % 2 == 0 && shown ? text : NULL;
}

static enum chart_colour colour_of(const struct picture *p, int chain)
{
    if (!p->s->family.n)
        return chain == 0 ? CHART_BLUE : CHART_RED;
    return (enum chart_colour)(chain / 2 % COLOURS);
}

/* Dashed where each bracket is; a family has its own verticals. */
static void mark_jumps(struct picture *p)
{
    const struct table *t = &p->t;
    for (size_t i = 0; i < t->n && !p->s->family.n; i++) {
        char label[LABEL];
        double x = t->cell[0][i];
        snprintf(label, sizeof label, "%.4g", x);
        if (!strcmp(t->kind[i], "jump_to"))
            chart_marker(&p->c, p->s->range.logarithmic ? log10(x) : x, p->c.n_panels > 1 ? NULL : label,
                         colour_of(p, t->chain[i]));
    }
}

static int column(const struct table *t, const char *begin)
{
    for (int i = 0; i < t->columns; i++)
        if (!strncmp(t->name[i], begin, strlen(begin)))
            return i;
    return -1;
}

static void draw_panel(struct picture *p, int i_y, const char *name, const char *unit, double height)
{
    const struct table *t = &p->t;
    int i_x = p->s->family.n ? 1 : 0;
    double min = (double)INFINITY, max = -(double)INFINITY;
    char label[LABEL], legend[LABEL];
    chart_range_add(&min, &max, t->cell[i_y], t->n);
    double factor = label_of(name, unit, fmax(fabs(min), fabs(max)), label);
    min *= factor, max *= factor;
    chart_range_finish(&min, &max);
    chart_panel(&p->c, label, height, min, max);
    for (int chain = 0; chain < t->n_chains; chain++) {
        size_t n = 0;
        for (size_t i = 0; i < t->n; i++) {
            if (t->chain[i] != chain)
                continue;
            p->x[n] = p->s->range.logarithmic ? log10(t->cell[i_x][i]) : t->cell[i_x][i];
            p->y[n++] = factor * t->cell[i_y][i];
        }
        chart_line(&p->c, p->x, p->y, n, colour_of(p, chain), legend_of(p, chain, legend));
    }
    mark_jumps(p);
}

static void draw_harmonics(struct picture *p, const char *observable, const char *unit)
{
    for (int i = 0; i < p->s->n_harmonics; i++) {
        const struct sweep_harmonic *h = &p->s->harmonic[i];
        char ratio[KIND] = "", name[LABEL];
        if (h->m > 1)
            snprintf(ratio, sizeof ratio, "/%u", (unsigned)h->m);
        snprintf(name, sizeof name, "amplitude of %s, harmonic %u%s", observable, (unsigned)h->n, ratio);
        draw_panel(p, column(&p->t, "amplitude_") + 2 * i, name, unit, i ? 80.0 : 170.0);
        if (i == 0)
            draw_panel(p, column(&p->t, "phase_"), "its phase to the drive", "rad", 80.0);
    }
}

static void draw(struct picture *p, const char *title)
{
    const struct sweep *s = p->s;
    const struct signal *y = &s->scene.model->output_signal[(int)s->scene.observable];
    bool plain = scenes_dimensionless(&s->scene);
    char text[LABEL];
    int n = snprintf(text, sizeof text, "%d points up and down, each settled over %d periods; ", s->range.n,
                     s->settle);
    snprintf(text + n, sizeof text - (size_t)n, s->family.n ? "a colour for each %s" : "dashed: jumps",
             s->family.column);
    chart_begin(&p->c, title, text);
    if (s->range.logarithmic)
        chart_x_range(&p->c, log10(s->range.from), log10(s->range.to));
    else
        chart_x_range(&p->c, s->range.from, s->range.to);
    draw_harmonics(p, y->name, plain || !strcmp(y->unit, "1") ? "" : y->unit);
    if (s->scene.model->n_contacts > 0) {
        draw_panel(p, column(&p->t, "out_of_contact"), "fraction of time out of contact", "", 80.0);
        draw_panel(p, column(&p->t, "peak_force"), "peak contact force", plain ? "" : "N", 80.0);
    }
    snprintf(text, sizeof text, "%s%s", s->range.logarithmic ? "log10 of " : "", s->range.column);
    chart_x_axis(&p->c, text);
}

int sweep_chart(const struct sweep *s, const char *csv)
{
    struct picture p = {.s = s};
    char title[LABEL];
    int status = 0;
    bool good = read_table(&p.t, s->columns, csv);
    p.x = calloc(p.t.n + 1, sizeof *p.x);
    p.y = calloc(p.t.n + 1, sizeof *p.y);
    snprintf(title, sizeof title, "contactplant sweep %.100s",
             s->o.n_words ? s->o.word[0] : s->scene.model->name);
    if (good && p.x && p.y)
        draw(&p, title);
    status = good && p.x && p.y ? maps_finish_chart(&s->o, &p.c)
                                : options_failure(s->o.usage, "--svg: %s cannot be read", csv);
    free(p.x);
    free(p.y);
    free_table(&p.t);
    return status;
}
