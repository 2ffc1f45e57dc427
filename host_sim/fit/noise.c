/* noise.c - see noise.h. */
#include "host_sim/fit/noise.h"

#include <math.h>

void noise_assume(struct fit_setup *s)
{
    s->noise_known = true;
    for (int c = 0; c < s->data.n; c++)
        for (int i = 0; i < s->data.curve[c].n; i++) {
            struct curve_point *p = &s->data.curve[c].point[i];
            if (p->sigma > 0.0)
                continue;
            s->noise_known = false;
            p->sigma = NOISE_ASSUMED * sqrt(p->re * p->re + p->im * p->im);
        }
}

double noise_estimate(struct fit_setup *s, const double *r)
{
    double sum = 0.0;
    int n = 0;
    if (s->noise_known)
        return 1.0;
    for (int c = 0; c < s->data.n; r += 2 * s->data.curve[c].n, c++)
        for (int i = 0; i + 1 < s->data.curve[c].n; i++)
            for (int k = 0; k < (s->data.curve[c].has_phase ? 2 : 1); k++) {
                if (s->point[c][i].flank || s->point[c][i + 1].flank)
                    continue;
                n++;
                double difference = r[2 * (i + 1) + k] - r[2 * i + k];
                sum += 0.5 * difference * difference;
            }
    double factor = fmax(n ? sqrt(sum / n) : 1.0, NOISE_LEAST / NOISE_ASSUMED);
    for (int c = 0; c < s->data.n; c++)
        for (int i = 0; i < s->data.curve[c].n; i++)
            s->data.curve[c].point[i].sigma *= factor;
    return factor;
}
