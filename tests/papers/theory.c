/* theory.c - see theory.h. */
#include "tests/papers/theory.h"

#include <math.h>

struct slow theory_slow(const struct model *averaged, const double *paper, double scale)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct harmonic drive[MODEL_INPUTS];
    struct scale unit;
    struct polynomial_form f;
    averaged->from_paper(paper, si, drive);
    averaged->prepare(si, p, &unit);
    averaged->polynomial_form(p, &f);
    const double *c = f.constant; /* in x; below in x - 1 */
    double force = c[0] + c[1] + c[2] + c[3], slope = c[1] + 2.0 * c[2] + 3.0 * c[3],
           bend = c[2] + 3.0 * c[3];
    return (struct slow){f.damping, -slope, -bend / scale, -c[3] / (scale * scale), -scale * force};
}

/* x^3 + 3 a x^2 + 3 b x + c by the trigonometric formula or Cardano's, each polished by Newton. */
int theory_roots(const double *c, double *root)
{
    double a = c[2] / (3.0 * c[3]), b = c[1] / (3.0 * c[3]), d = c[0] / c[3];
    double p = a * a - b, q = a * a * a - 1.5 * a * b + 0.5 * d; /* y^3 - 3 p y + 2 q, y = x + a */
    int n = 1;
    if (q * q < p * p * p) {
        double size = 2.0 * sqrt(p), angle = acos(-q / (p * sqrt(p)));
        n = 3;
        for (int k = 0; k < 3; k++)
            root[k] = size * cos((angle + 2.0 * (k == 0 ? 1 : k == 1 ? 2 : 0) * acos(-1.0)) / 3.0) - a;
    } else {
        double t = -copysign(cbrt(fabs(q) + sqrt(q * q - p * p * p)), q);
        root[0] = (t != 0.0 ? t + p / t : 0.0) - a;
    }
    return n; /* the angle, in [0, pi], makes them ascend */
}

/* Amplitudes from the cubic in their square. */
static int amplitudes(const double *c, double *amplitude)
{
    double square[3];
    int n = 0, found = theory_roots(c, square);
    for (int i = 0; i < found; i++)
        if (square[i] > 0.0)
            amplitude[n++] = sqrt(square[i]);
    return n;
}

int theory_rig(const struct slow *s, double drive, double omega, double *amplitude)
{
    double w = omega, w3 = w * w * w, lambda = s->w2 - w * w, alpha = s->damping;
    double A = -0.5 * alpha;
    double B = lambda / (2.0 * w) - alpha * alpha / (8.0 * w) - lambda * lambda / (8.0 * w3) -
               s->quadratic * s->constant / w3;
    double C = -(5.0 * s->quadratic * s->quadratic / (12.0 * w3) - 3.0 * s->cubic / (8.0 * w));
    double H1 = lambda * drive / (8.0 * w3) - drive / (2.0 * w), H2 = alpha * drive / (8.0 * w * w);
    const double c[4] = {-(H1 * H1 + H2 * H2), A * A + B * B, 2.0 * B * C, C * C};
    return amplitudes(c, amplitude);
}

struct tip_theory theory_tip(const struct slow *s)
{
    return (struct tip_theory){sqrt(s->w2),
                               10.0 * s->quadratic * s->quadratic / (3.0 * s->w2) - 3.0 * s->cubic,
                               2.0 * s->quadratic * s->constant / s->w2, s->damping};
}

int theory_tip_amplitude(const struct tip_theory *t, double drive, double detuning, double *amplitude)
{
    double shift = 2.0 * t->w1 * detuning + t->rho_l, bend = 0.25 * t->rho_n, loss = t->damping * t->w1;
    const double c[4] = {-drive * drive, shift * shift + loss * loss, 2.0 * shift * bend, bend * bend};
    return amplitudes(c, amplitude);
}

double theory_tip_peak(const struct tip_theory *t, double drive, double *amplitude)
{
    *amplitude = drive / (t->damping * t->w1);
    return -(t->rho_l + 0.25 * t->rho_n * *amplitude * *amplitude) / (2.0 * t->w1);
}

double theory_tip_side(const struct tip_theory *t, double drive, double a, double sign)
{
    double loss = t->damping * t->w1, root = drive * drive / (a * a) - loss * loss;
    return (sign * sqrt(root > 0.0 ? root : 0.0) - t->rho_l - 0.25 * t->rho_n * a * a) / (2.0 * t->w1);
}

/* The side towards which the curve bends turns where s^3 - s^4/peak^2 = (2 f/rho_n)^2, s = a^2: that rises up
 * to 3/4 of peak^2 and falls to 0 at peak^2. */
bool theory_tip_turns(const struct tip_theory *t, double drive, double turn[2])
{
    double peak = drive / (t->damping * t->w1), square = peak * peak, top = 0.75 * square;
    double least = 2.0 * drive / t->rho_n * (2.0 * drive / t->rho_n);
    if (!(0.25 * top * top * top > least))
        return false;
    for (int i = 0; i < 2; i++) {
        double below = i ? square : 0.0, above = top;
        for (int k = 0; k < 100; k++) {
            double s = 0.5 * (below + above);
            *(s * s * s * (1.0 - s / square) < least ? &below : &above) = s;
        }
        turn[i] = sqrt(above);
    }
    return true;
}

int theory_tip_jumps(const struct tip_theory *t, double drive, double jump[2])
{
    double turn[2], sign = t->rho_n > 0.0 ? -1.0 : 1.0;
    if (!theory_tip_turns(t, drive, turn))
        return 0;
    double first = theory_tip_side(t, drive, turn[0], sign),
           second = theory_tip_side(t, drive, turn[1], sign);
    jump[0] = fmin(first, second);
    jump[1] = fmax(first, second);
    return 1;
}

/* Mean over the fast motion of (1 + (2/3)(x + a cos))_+^{power}. */
static double mean(double x, double a, double power)
{
    enum { POINTS = 4096 };
    double sum = 0.0;
    for (int i = 0; i < POINTS; i++) {
        double eta = 1.0 + (2.0 / 3.0) * (x + a * cos(acos(-1.0) * (i + 0.5) / POINTS));
        sum += eta > 0.0 ? pow(eta, power) : 0.0;
    }
    return sum / POINTS;
}

double theory_mean_force(double a, double *shift)
{
    double low = -1.5 - fabs(a), high = 0.0;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        *(mean(middle, a, 1.5) < 1.0 ? &low : &high) = middle;
    }
    *shift = 0.5 * (low + high);
    return sqrt(mean(*shift, a, 0.5));
}
