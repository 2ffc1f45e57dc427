/* free_motion.c - see free_motion.h. Integrals over eta are split at eta = 1, the static compression, and taken in
 * variables in which the integrand 1/eta' has no singularity at the turning points; Simpson's rule. */
#include "tests/free_motion.h"

#include <math.h>

/* Extended precision is the point here. */
#pragma GCC diagnostic ignored "-Wdouble-promotion"

enum { N = 4000, HALVINGS = 200 };

/* E of a motion and its turning points; `low` counts only where contact is kept, E <= 0. */
struct free {
    long double energy, low, high;
};

long double free_energy(long double eta, long double rate)
{
    long double contact = eta > 0.0L ? eta * eta * sqrtl(eta) : 0.0L;
    return 0.5L * rate * rate + (4.0L / 15.0L) * contact - (2.0L / 3.0L) * eta;
}

/* The eta in [a, b] where the potential is E. */
static long double turning_point(long double energy, long double a, long double b)
{
    int falls = free_energy(a, 0.0L) > free_energy(b, 0.0L);
    for (int i = 0; i < HALVINGS; i++) {
        long double middle = 0.5L * (a + b);
        if ((free_energy(middle, 0.0L) > energy) == falls)
            a = middle;
        else
            b = middle;
    }
    return 0.5L * (a + b);
}

static long double simpson(long double (*f)(const struct free *, long double), const struct free *m,
                           long double end)
{
    long double sum = f(m, 0.0L) + f(m, end);
    for (int i = 1; i < N; i++)
        sum += (i % 2 ? 4.0L : 2.0L) * f(m, end * i / N);
    return sum * end / (3.0L * N);
}

/* eta = high - d, d = u^2: the speed from d alone, without cancellation. */
static long double upper(const struct free *m, long double u)
{
    long double d = u * u, power = powl(m->high, 2.5L);
    if (u == 0.0L)
        return 2.0L / sqrtl((4.0L / 3.0L) * (m->high * sqrtl(m->high) - 1.0L));
    return 2.0L * u /
           sqrtl((8.0L / 15.0L) * power * -expm1l(2.5L * log1pl(-d / m->high)) - (4.0L / 3.0L) * d);
}

/* eta = low + u^2, contact kept. */
static long double lower(const struct free *m, long double u)
{
    long double d = u * u, power = powl(m->low, 2.5L);
    if (u == 0.0L)
        return 2.0L / sqrtl((4.0L / 3.0L) * (1.0L - m->low * sqrtl(m->low)));
    return 2.0L * u / sqrtl((4.0L / 3.0L) * d - (8.0L / 15.0L) * power * expm1l(2.5L * log1pl(d / m->low)));
}

/* eta from touchdown: (4/3) eta = (v sinh s)^2, v^2 = 2 E, which resolves the start however slow. */
static long double from_touch(const struct free *m, long double s)
{
    long double v = sqrtl(2.0L * m->energy), c = coshl(s), u = 0.5L * sqrtl(3.0L) * v * sinhl(s);
    return sqrtl(3.0L) * u / sqrtl(1.0L - (8.0L / 15.0L) * powl(u, 5) / (v * v * c * c));
}

/* From the deepest point to eta = 1, and on to where the way up ends or contact opens. */
static long double half_contact(const struct free *m)
{
    long double time = simpson(upper, m, sqrtl(m->high - 1.0L));
    if (m->energy <= 0.0L)
        return time + simpson(lower, m, sqrtl(1.0L - m->low));
    return time + simpson(from_touch, m, asinhl(2.0L / sqrtl(6.0L * m->energy)));
}

static struct free at_speed(long double v)
{
    struct free m = {0.5L * v * v, -1.0L, 0.0L};
    m.high = turning_point(m.energy, 1.0L, 10.0L * (1.0L + v));
    return m;
}

double free_period(double eta_max)
{
    struct free m = {free_energy(eta_max, 0.0L), 0.0L, eta_max};
    if (m.energy <= 0.0L) {
        m.low = turning_point(m.energy, 0.0L, 1.0L);
        return (double)(2.0L * half_contact(&m));
    }
    return (double)(2.0L * half_contact(&m) + 3.0L * sqrtl(2.0L * m.energy)); /* flight: 2 v/(2/3) */
}

double free_contact_time(double v)
{
    struct free m = at_speed(v);
    return (double)(2.0L * half_contact(&m));
}

double free_peak(double v)
{
    return (double)at_speed(v).high;
}
