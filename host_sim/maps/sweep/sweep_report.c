/* sweep_report.c - the report of a sweep from its rows: response curves, and its jumps one by one. */
#include "host_sim/maps/sweep/sweep.h"
#include "host_sim/report/html.h"
#include "host_sim/report/html_scene.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { JUMPS_DRAWN = 6, POINTS_AROUND = 6 };

#define AT(member) offsetof(struct sweep_result, member)

struct report {
    const struct sweep *s;
    const struct sweep_result *row;
    struct rows_table t;
    struct html h;
    double *x, *y; /* [t.n] points of a line */
};

static double value_at(const struct report *p, int i, size_t offset)
{
    double value;
    memcpy(&value, (const char *)&p->row[i] + offset, sizeof value);
    return value;
}

/* The rows of a chain from index `from` to before `to`, as a line with its points. */
static void put_chain(struct report *p, int chain, size_t offset, int from, int to)
{
    char text[SWEEP_LABEL];
    const char *name = sweep_chain_name(p->s, chain, text);
    size_t n = 0;
    for (int i = from; i < to; i++) {
        if (sweep_chain_of(&p->t, p->row, i) != chain)
            continue;
        p->x[n] = p->row[i].value;
        p->y[n++] = value_at(p, i, offset);
    }
    if (!n)
        return;
    html_line(&p->h, HTML_LINE, name, n, p->x, p->y);
    html_line(&p->h, HTML_POINTS, name, n, p->x, p->y);
}

static void begin_chart(struct report *p, size_t offset, const char *name)
{
    const struct rows_column *c = rows_find(&p->s->m.rows, offset);
    html_chart(&p->h, name ? name : c->meaning, c->unit, p->s->range.words, p->s->range.unit);
}

static int chains(const struct report *p)
{
    return p->s->family.values.n ? 2 * p->s->family.values.n : 2;
}

static void put_curve(struct report *p, size_t offset, const char *name)
{
    begin_chart(p, offset, name);
    for (int chain = 0; chain < chains(p); chain++)
        put_chain(p, chain, offset, 0, p->t.n);
    for (int i = 0; i < p->t.n && !p->s->family.values.n; i++)
        if (p->row[i].kind == SWEEP_TO)
            html_marker(&p->h, p->row[i].value, "%.6g", p->row[i].value);
}

static void put_curves(struct report *p)
{
    const struct sweep *s = p->s;
    char name[SWEEP_LABEL];
    for (int i = 0; i < s->n_harmonics; i++) {
        sweep_name_harmonic(s, i, name);
        put_curve(p, AT(measured.amplitude) + (size_t)i * sizeof(double), name);
        if (i == 0)
            put_curve(p, AT(measured.phase), "its phase to the drive");
    }
    if (s->m.scene.model->n_contacts > 0) {
        put_curve(p, AT(measured.out_of_contact), NULL);
        put_curve(p, AT(measured.peak_force), NULL);
    }
}

static int count(const struct report *p, enum sweep_kind kind)
{
    int n = 0;
    for (int i = 0; i < p->t.n; i++)
        n += p->row[i].kind == kind;
    return n;
}

static void put_jumps(struct report *p)
{
    const size_t first = AT(measured.amplitude);
    const char *unit = rows_find(&p->s->m.rows, first)->unit;
    char title[SWEEP_LABEL], columns[SWEEP_LABEL], text[SWEEP_LABEL];
    snprintf(columns, sizeof columns, "chain,%s from,to,amplitude before (%s),behind (%s)",
             p->s->range.column, unit, unit);
    html_table(&p->h, "Jumps", columns);
    for (int i = 0; i < p->t.n; i++) {
        if (!sweep_is_jump(p->row, i))
            continue;
        html_row(&p->h, false);
        html_cell(&p->h, "%s", sweep_chain_name(p->s, sweep_chain_of(&p->t, p->row, i), text));
        for (size_t k = 0; k < 4; k++)
            html_cell(&p->h, "%.9g", value_at(p, i - 1 + (int)k % 2, k < 2 ? AT(value) : first));
    }
    for (int i = 0, drawn = 0; i < p->t.n && drawn < JUMPS_DRAWN; i++) {
        if (!sweep_is_jump(p->row, i))
            continue;
        snprintf(title, sizeof title, "around the jump at %.6g, %s", p->row[i].value,
                 sweep_chain_name(p->s, sweep_chain_of(&p->t, p->row, i), text));
        begin_chart(p, first, title);
        put_chain(p, sweep_chain_of(&p->t, p->row, i), first, i > POINTS_AROUND ? i - POINTS_AROUND : 0,
                  i + POINTS_AROUND < p->t.n ? i + POINTS_AROUND : p->t.n);
        html_marker(&p->h, p->row[i].value, "%.9g", p->row[i].value);
        drawn++;
    }
}

static void put_words(struct report *p)
{
    const struct sweep *s = p->s;
    int jumps = count(p, SWEEP_TO), loose = count(p, SWEEP_UNSETTLED), escaped = count(p, SWEEP_ESCAPED);
    html_words(&p->h, "%s by method %s: %s from %.9g to %.9g in %d points, up and down.",
               s->m.scene.model->name, s->m.method->name, s->range.column, s->range.values.from,
               s->range.values.to, s->range.values.n);
    if (jumps)
        html_words(&p->h, "Jumps located by bisection: %d.", jumps);
    else
        html_words(&p->h, loose ? "No jump was found where points settled." : "No jump was found.");
    if (loose)
        html_words(&p->h, "%d points did not settle.", loose);
    if (escaped)
        html_words(&p->h, "The motion escaped at %d points.", escaped);
}

static const char *write_report(struct report *p)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    put_words(p);
    put_curves(p);
    if (count(p, SWEEP_TO))
        put_jumps(p);
    scenes_resolve(&p->s->m.scene, si, drive);
    html_scene(&p->h, &p->s->m.scene, p->s->m.scene.model, si);
    return html_end(&p->h);
}

int sweep_check_report(const struct sweep *s)
{
    const struct options *o = &s->m.o;
    if (!options_given(o, "report"))
        return 0;
    if (!options_given(o, "out") || options_given(o, "shard"))
        return options_misuse(o->usage,
                              "--report is made from a whole file of rows; give --out, and no --shard");
    return 0;
}

int sweep_report(const struct sweep *s, int argc, char **argv)
{
    struct report p = {.s = s};
    const char *path = options_text(&s->m.o, "report", 0), *why = NULL;
    int status = rows_load(&s->m.o, &s->m.rows, options_text(&s->m.o, "out", 0), &p.t);
    p.row = (const void *)p.t.row;
    p.x = calloc(2 * (size_t)p.t.n + 1, sizeof *p.x);
    p.y = p.x + p.t.n;
    if (!status && p.x && !(why = html_begin(&p.h, path, "sweep", s->m.name, argc, argv)))
        why = write_report(&p);
    if (!status && (why || !p.x))
        status =
            options_failure(s->m.o.usage, "--report %s cannot be written: %s", path, why ? why : "no memory");
    free(p.x);
    rows_free(&p.t);
    return status;
}
