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
            *e = (struct sequence){first + part, 2, curve->n, c, -1};
            first += part ? 2 * curve->n : 0;
            if ((part == 0 || curve->has_phase) && q-- == 0)
                return true;
        }
    for (int r = 0; r < s->records.n; r++) {
        *e = (struct sequence){first, 1, s->records.record[r].n, -1, r};
        first += e->n;
        if (q-- == 0)
            return true;
    }
    return false;
}

bool sequence_counts(const struct fit_setup *s, const struct sequence *e, int i)
{
    return e->curve < 0 ? !isnan(s->records.record[e->record].y[i]) : !s->point[e->curve][i].flank;
}

void sequence_name(const struct fit_setup *s, const struct sequence *e, int i, char *text, size_t size)
{
    if (e->curve < 0) {
        const struct record *r = &s->records.record[e->record];
        snprintf(text, size, "%s, %.6g s after its begin", r->path, i * r->step_s);
        return;
    }
    const struct curve *c = &s->data.curve[e->curve];
    snprintf(text, size, "%s:%d, %.6g Hz", c->path, c->point[i].line, c->point[i].frequency_Hz);
}
