/* sequence.c - see sequence.h. */
#include "host_sim/fit/sequence.h"

#include <math.h>
#include <stdio.h>

bool sequence_nth(const struct fit_setup *s, int q, struct sequence *e)
{
    int first = 0;
    for (int c = 0; c < s->data.n; c++)
        for (int part = 0; part < 2; part++) {
            const struct curve *curve = &s->data.curve[c];
            *e = (struct sequence){first + part, 2, curve->n, c, -1, -1};
            first += part ? 2 * curve->n : 0;
            if ((part == 0 || curve->has_phase) && q-- == 0)
                return true;
        }
    for (int r = 0; r < s->records.n; r++) {
        *e = (struct sequence){first, 1, s->records.record[r].n, -1, r, -1};
        first += e->n;
        if (q-- == 0)
            return true;
    }
    for (int i = 0; i < s->levers.n; i++) {
        int n = s->levers.data[i].n;
        for (int part = 0; part < LEVER_LAG; part++)
            if (q-- == 0) {
                *e = (struct sequence){first + part, LEVER_LAG, (n - part + LEVER_LAG - 1) / LEVER_LAG,
                                       -1,           -1,        i};
                return true;
            }
        first += n;
    }
    return false;
}

/* The number in its data. */
static int lever_number(const struct fit_setup *s, const struct sequence *e, int i)
{
    int before = s->n_residuals;
    for (int k = e->lever; k < s->levers.n; k++)
        before -= s->levers.data[k].n;
    return e->first - before + i * e->step;
}

bool sequence_counts(const struct fit_setup *s, const struct sequence *e, int i)
{
    if (e->lever >= 0)
        return s->levers.data[e->lever].side[lever_number(s, e, i)] != LEVER_SKIPPED;
    return e->curve < 0 ? !isnan(s->records.record[e->record].y[i]) : !s->point[e->curve][i].flank;
}

void sequence_name(const struct fit_setup *s, const struct sequence *e, int i, char *text, size_t size)
{
    if (e->lever >= 0) {
        const struct lever_data *d = &s->levers.data[e->lever];
        double x = d->x[lever_number(s, e, i)];
        snprintf(text, size, d->kind == LEVER_SPECTRUM ? "%s, %.8g Hz" : "%s, base %.6g m", d->path, x);
        return;
    }
    if (e->curve < 0) {
        const struct record *r = &s->records.record[e->record];
        snprintf(text, size, "%s, %.6g s after its begin", r->path, i * r->step_s);
        return;
    }
    const struct curve *c = &s->data.curve[e->curve];
    snprintf(text, size, "%s:%d, %.6g Hz", c->path, c->point[i].line, c->point[i].frequency_Hz);
}
