/* noise.c - see noise.h. */
#include "firmware/plant/noise.h"

#include <math.h>
#include "models/math/elementary.h"

enum { DEVIATE_BITS = 35, DEGREE = 7 };

/* Coefficients of numerator and denominator, from the constant upwards. */
static double ratio(const double c[DEGREE + 1][2], double x)
{
    double a = c[DEGREE][0], b = c[DEGREE][1];
    for (int i = DEGREE - 1; i >= 0; i--) {
        a = a * x + c[i][0];
        b = b * x + c[i][1];
    }
    return a / b;
}

/* AS 241's third range, tails below e^-25, is never
 * reached: the smallest tail of 35 bits is 2^-36 > e^-25. */
double noise_deviate(uint64_t word)
{
    static const double middle[DEGREE + 1][2] = {
        {3.3871328727963666080e0, 1.0},
        {1.3314166789178437745e+2, 4.2313330701600911252e+1},
        {1.9715909503065514427e+3, 6.8718700749205790830e+2},
        {1.3731693765509461125e+4, 5.3941960214247511077e+3},
        {4.5921953931549871457e+4, 2.1213794301586595867e+4},
        {6.7265770927008700853e+4, 3.9307895800092710610e+4},
        {3.3430575583588128105e+4, 2.8729085735721942674e+4},
        {2.5090809287301226727e+3, 5.2264952788528545610e+3},
    };
    static const double tail[DEGREE + 1][2] = {
        {1.42343711074968357734e0, 1.0},
        {4.63033784615654529590e0, 2.05319162663775882187e0},
        {5.76949722146069140550e0, 1.67638483018380384940e0},
        {3.64784832476320460504e0, 6.89767334985100004550e-1},
        {1.27045825245236838258e0, 1.48103976427480074590e-1},
        {2.41780725177450611770e-1, 1.51986665636164571966e-2},
        {2.27238449892691845833e-2, 5.47593808499534494600e-4},
        {7.74545014278341407640e-4, 1.05075007164441684324e-9},
    };
    int64_t n = (int64_t)(word >> (64 - DEVIATE_BITS)) - (INT64_C(1) << (DEVIATE_BITS - 1));
    double q = ((double)n + 0.5) * 0x1p-35; /* exact, as is the tail's 0.5 - |q| */
    if (fabs(q) <= 0.425)
        return q * ratio(middle, 0.180625 - q * q);
    double x = ratio(tail, sqrt(-logarithm(0.5 - fabs(q))) - 1.6);
    return q < 0.0 ? -x : x;
}

void noise_init(struct noise *n, int i_input, bool straight)
{
    *n = (struct noise){.sequence = (uint64_t)i_input << 32, .hold = 1, .x = 1.0, .straight = straight};
}

static double level_at(const struct noise *n, double x)
{
    return x >= 1.0 ? n->level : n->level_from + (n->level - n->level_from) * x;
}

void noise_leave(struct noise *n)
{
    n->level_from = level_at(n, n->x);
    n->rest *= 1.0 - n->x;
    n->x = 0.0;
}

void noise_aim(struct noise *n, const struct noise_setting *s)
{
    uint64_t sequence = (n->sequence & ~(uint64_t)UINT32_MAX) | s->seed;
    uint32_t hold = s->hold > 0 ? s->hold : 1;
    n->level = s->deviation;
    n->active = n->active || n->level != 0.0;
    if (sequence == n->sequence && hold == n->hold)
        return;
    n->sequence = sequence;
    n->hold = hold;
    n->known = false;
    n->anew = true;
}

void noise_start(struct noise *n, const struct noise_setting *s)
{
    noise_aim(n, s);
    n->x = 1.0;
    n->rest = 0.0;
    n->anew = false;
    n->active = n->level != 0.0;
}

struct noise_setting noise_target(const struct noise *n)
{
    return (struct noise_setting){n->level, n->hold, (uint32_t)n->sequence};
}

/* The cell of a tick: the one at hand, the next, or any. True when it is another one. */
static bool find_cell(struct noise *n, uint64_t tick)
{
    uint64_t inside = tick - n->begin_tick;
    if (n->known && inside < n->hold)
        return false;
    bool follows = n->known && inside == n->hold;
    n->cell = follows ? n->cell + 1 : tick / n->hold;
    n->begin_tick = n->cell * n->hold;
    for (unsigned i = follows; i < 2; i++) {
        n->here = n->next;
        n->next = noise_deviate(noise_word(n->sequence, n->cell + i));
    }
    n->known = true;
    return true;
}

bool noise_add(struct noise *n, const struct noise_span *s, struct segment *e, int i)
{
    bool changed = find_cell(n, s->tick);
    double rise = n->straight ? (n->next - n->here) / n->hold : 0.0;
    double at = (double)(s->tick - n->begin_tick) + s->begin;
    double first = n->here + rise * at, last = first + rise * s->length;
    if (n->anew)
        n->rest = n->value - n->level_from * first;
    n->anew = false;
    first = level_at(n, n->x) * first + n->rest * (1.0 - n->x);
    n->x = s->ramp_end;
    n->value = level_at(n, n->x) * last + n->rest * (1.0 - n->x);
    double slope = (n->value - first) / s->length * s->ticks_per_time;
    e->wave[i].offset += first;
    e->wave[i].slope += slope;
    for (int k = 0; k < 3; k++) {
        e->at[k][i].value += first + (n->value - first) * (0.5 * k);
        e->at[k][i].rate += slope;
    }
    n->active = n->x < 1.0 || n->level != 0.0;
    return changed || slope != 0.0;
}

void noise_rescale(struct noise *n, double factor)
{
    n->level_from *= factor;
    n->level *= factor;
    n->rest *= factor;
    n->value *= factor;
}
