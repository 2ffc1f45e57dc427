/* noise.c - see noise.h. */
#include "host_sim/fit/noise.h"

#include <math.h>
#include "host_sim/fit/levers.h"
#include "host_sim/fit/sequence.h"

void noise_assume(struct fit_setup *s)
{
    s->noise_known = true;
    for (int c = 0; c < s->data.n; c++)
        for (int i = 0; i < s->data.curve[c].n; i++) {
            struct curve_point *p = &s->data.curve[c].point[i];
            if (p->sigma > 0.0)
                continue;
            s->noise_known = false;
            s->data.curve[c].assumed = true;
            p->sigma = NOISE_ASSUMED * sqrt(p->re * p->re + p->im * p->im);
        }
    for (int i = 0; i < s->records.n; i++) {
        struct record *r = &s->records.record[i];
        r->assumed = !(r->noise > 0.0);
        s->noise_known = s->noise_known && !r->assumed;
        r->noise = fmax(r->assumed ? NOISE_ASSUMED * r->size : r->noise, r->floor);
    }
    levers_assume_noise(s);
}

/* Half the mean square of the differences of neighbours in the sequences of a curve or record; 1 without any.
 */
static double variance_of(const struct fit_setup *s, const double *r, int curve, int record)
{
    struct sequence e;
    double sum = 0.0;
    int n = 0;
    for (int q = 0; sequence_nth(s, q, &e); q++)
        for (int i = 0; i + 1 < e.n && e.curve == curve && e.record == record; i++) {
            double difference = r[e.first + (i + 1) * e.step] - r[e.first + i * e.step];
            if (!sequence_counts(s, &e, i) || !sequence_counts(s, &e, i + 1))
                continue;
            sum += 0.5 * difference * difference;
            n++;
        }
    return n ? sum / n : 1.0;
}

void noise_estimate(struct fit_setup *s, const double *r)
{
    for (int c = 0; c < s->data.n; c++)
        if (s->data.curve[c].assumed) {
            double factor = fmax(sqrt(variance_of(s, r, c, -1)), NOISE_LEAST / NOISE_ASSUMED);
            for (int i = 0; i < s->data.curve[c].n; i++)
                s->data.curve[c].point[i].sigma *= factor;
        }
    for (int i = 0; i < s->records.n; i++) {
        struct record *x = &s->records.record[i];
        double factor = fmax(sqrt(variance_of(s, r, -1, i)), NOISE_LEAST * x->size / x->noise);
        x->noise = fmax(x->noise * (x->assumed ? factor : 1.0), x->floor);
    }
    levers_estimate_noise(s, r);
}
