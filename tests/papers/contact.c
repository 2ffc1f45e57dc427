/* contact.c - see contact.h. */
#include "tests/papers/contact.h"

#include <math.h>

#define PI 3.14159265358979323846
enum { PANELS = 4000, ROUNDS = 60 };

static double potential(double eta)
{
    return (2.0 / 3.0) * ((eta > 0.0 ? 0.4 * eta * eta * sqrt(eta) : 0.0) - eta);
}

struct free_vibration contact_free(double eta_max)
{
    double energy = potential(eta_max), low = -2.0 * eta_max * eta_max * sqrt(eta_max), high = 1.0;
    for (int i = 0; i < ROUNDS; i++) {
        double middle = 0.5 * (low + high);
        *(potential(middle) > energy ? &low : &high) = middle;
    }
    double centre = 0.5 * (eta_max + high), half = 0.5 * (eta_max - high), time = 0.0, area = 0.0;
    for (int i = 0; i < PANELS; i++) { /* eta = centre + half sin: the ends' singularities cancel */
        double angle = PI * ((i + 0.5) / PANELS - 0.5), eta = centre + half * sin(angle);
        double dt = half * cos(angle) / sqrt(2.0 * (energy - potential(eta)));
        time += dt;
        area += eta > 0.0 ? eta * dt : 0.0;
    }
    return (struct free_vibration){PANELS / time, half, area / time};
}

/* A0 and A1 of eq 46. */
static double force_mean(double a0, double a1, int harmonic)
{
    double sum = 0.0;
    for (int i = 0; i < PANELS / 4; i++) {
        double c = cos(PI * (i + 0.5) / (PANELS / 4)), eta = a0 + a1 * c;
        sum += eta > 0.0 ? eta * sqrt(eta) * (harmonic ? 2.0 * c : 1.0) : 0.0;
    }
    return sum / (PANELS / 4);
}

struct balance contact_balance(double a1)
{
    double low = -a1, high = 1.0;
    for (int i = 0; i < ROUNDS; i++) {
        double middle = 0.5 * (low + high);
        *(force_mean(middle, a1, 0) < 1.0 ? &low : &high) = middle;
    }
    return (struct balance){low, (2.0 / 3.0) * force_mean(low, a1, 1) / a1};
}

/* [(k - W^2)^2 + 4 zeta^2 W^2] a1^2 = xi0^2 W^2 (W^2 + 4 zeta^2), in W^2. */
int contact_balance_omega(double a1, double zeta, double xi0, double omega[2])
{
    double k = contact_balance(a1).stiffness, square = a1 * a1, rest = square - xi0 * xi0;
    double p = 4.0 * zeta * zeta * rest - 2.0 * k * square, q = k * k * square;
    double root = p * p - 4.0 * rest * q;
    int n = 0;
    if (root < 0.0)
        return 0;
    double first = 2.0 * q / (-p + sqrt(root)), second = (-p + sqrt(root)) / (2.0 * rest);
    if (first > 0.0)
        omega[n++] = sqrt(first);
    if (second > 0.0 && isfinite(second))
        omega[n++] = sqrt(second);
    return n;
}

double contact_balance_jump(double zeta, double xi0)
{
    double last = 0.0, omega[2];
    for (double a1 = 0.02; a1 < 8.0; a1 += 0.002) {
        if (contact_balance_omega(a1, zeta, xi0, omega) == 0)
            break;
        if (omega[0] < last)
            return last;
        last = omega[0];
    }
    return (double)NAN;
}

static double unscaled(double cold, double eta)
{
    return exp(-cold * (potential(eta) - potential(1.0)));
}

/* Integral of p eta_+^power over eta > z; the range ends where p has fallen below 1e-30. */
static double integral(double cold, double z, double power)
{
    double top = 2.0, sum = 0.0;
    while (unscaled(cold, top) > 1e-30)
        top += 0.25;
    double bottom = -1.0;
    while (unscaled(cold, bottom) > 1e-30)
        bottom -= 1.0;
    z = fmax(z, bottom);
    double h = (top - z) / (10 * PANELS);
    for (int i = 0; i < 10 * PANELS; i++) {
        double eta = z + h * (i + 0.5);
        sum += unscaled(cold, eta) * (power == 0.0 ? 1.0 : eta > 0.0 ? pow(eta, power) : 0.0);
    }
    return sum * h;
}

struct density contact_density(double phi_over_zeta)
{
    double cold = 2.0 / (PI * phi_over_zeta);
    return (struct density){cold, 1.0 / integral(cold, -HUGE_VAL, 0.0), sqrt(1.0 / cold)};
}

double contact_density_at(const struct density *d, double eta)
{
    return d->scale * unscaled(d->cold, eta);
}

double contact_above(const struct density *d, double z)
{
    return d->scale * integral(d->cold, z, 0.0);
}

double contact_crossings(const struct density *d, double z)
{
    return d->speed / sqrt(2.0 * PI) * contact_density_at(d, z);
}

double contact_mean(const struct density *d, double power)
{
    return d->scale * integral(d->cold, 0.0, power);
}

double contact_deviation(const struct density *d)
{
    double mean = 0.0, square = 0.0, h = 0.0005, p;
    for (double eta = 1.0; (p = h * contact_density_at(d, eta)) > 1e-16 || eta < 2.0; eta += h) {
        mean += p * (eta - 1.0);
        square += p * (eta - 1.0) * (eta - 1.0);
    }
    for (double eta = 1.0 - h; (p = h * contact_density_at(d, eta)) > 1e-16 || eta > 0.0; eta -= h) {
        mean += p * (eta - 1.0);
        square += p * (eta - 1.0) * (eta - 1.0);
    }
    return sqrt(square - mean * mean);
}
