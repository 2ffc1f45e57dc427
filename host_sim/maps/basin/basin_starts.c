/* basin_starts.c - starts spread over a box by Latin hypercube. */
#include "host_sim/maps/basin/basin_starts.h"

#include <stdlib.h>
#include "firmware/plant/noise.h"

/* Sequences of noise_word that no input uses: their numbers are above 2^40. */
enum { SHUFFLE = 1 << 8, PLACE = 1 << 9 };

static uint64_t sequence(const struct basin_starts *s, int kind, int state)
{
    return ((uint64_t)(kind + state) << 32) + s->seed;
}

/* A permutation by Fisher and Yates. The odds of the n places are equal to n/2^32. */
static void shuffle(const struct basin_starts *s, int state)
{
    int32_t *a = &s->stratum[(size_t)state * (size_t)s->n];
    for (int i = 0; i < s->n; i++)
        a[i] = i;
    for (int i = s->n - 1; i > 0; i--) {
        uint64_t word = noise_word(sequence(s, SHUFFLE, state), (uint64_t)i) >> 32;
        int j = (int)((word * (uint64_t)(i + 1)) >> 32);
        int32_t keep = a[i];
        a[i] = a[j];
        a[j] = keep;
    }
}

bool basin_starts_make(struct basin_starts *s, int n, int n_states, uint32_t seed,
                       const struct basin_box *box)
{
    *s = (struct basin_starts){.n = n, .n_states = n_states, .seed = seed, .box = *box};
    s->stratum = malloc((size_t)n * (size_t)n_states * sizeof *s->stratum);
    for (int k = 0; k < n_states && s->stratum; k++)
        shuffle(s, k);
    return s->stratum != NULL;
}

void basin_starts_free(struct basin_starts *s)
{
    free(s->stratum);
}

void basin_starts_get(const struct basin_starts *s, int i, double *x)
{
    for (int k = 0; k < s->n_states; k++) {
        double place = (double)(noise_word(sequence(s, PLACE, k), (uint64_t)i) >> 11) * 0x1p-53;
        double share = (s->stratum[(size_t)k * (size_t)s->n + (size_t)i] + place) / s->n;
        x[k] = s->box.low[k] + share * (s->box.high[k] - s->box.low[k]);
    }
}
