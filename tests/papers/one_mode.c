/* one_mode.c - see one_mode.h. */
#include "tests/papers/one_mode.h"

#include <math.h>
#include <string.h>
#include "models/reduced/shaft_mode.h"
#include "models/shaft_bearing.h"
#include "tests/papers/motion.h"

bool one_mode_open(struct attractor_shaft *s, const double *paper, int mode)
{
    double kept[MODEL_PARAMETERS];
    memcpy(kept, paper, sizeof kept);
    kept[SHAFT_PAPER_MODE] = mode;
    return attractor_open(s, &shaft_bearing_mode, kept);
}

void one_mode_start(uint64_t *seed, double span, double *state)
{
    attractor_start(seed, span, state);
    state[1] = state[3];
}

struct one_mode one_mode_of(const double *paper, int mode)
{
    struct one_mode m = {.contact = {paper[SHAFT_KG1], 0.0, paper[SHAFT_KG3]},
                         .gap = {paper[SHAFT_G1], 0.0, paper[SHAFT_G3]}};
    double hz[3], shape[3][3];
    attractor_modes(paper, 0.0, hz, shape);
    const double *s = shape[mode - 1];
    double size = copysign(fmax(fabs(s[0]), fabs(s[2])), s[0]), w = MOTION_TWO_PI * hz[mode - 1];
    for (int i = 0; i < 3; i++) {
        m.shape[i] = s[i] / size;
        m.mass += paper[SHAFT_M1 + i] * m.shape[i] * m.shape[i];
        m.damping += paper[SHAFT_C1 + i] * m.shape[i] * m.shape[i];
        m.force += paper[SHAFT_PAPER_P1 + i] * m.shape[i];
    }
    m.stiffness = w * w * m.mass;
    return m;
}

double one_mode_share(double amplitude, double gap)
{
    double r = gap / fabs(amplitude);
    return r < 1.0 ? 1.0 - (2.0 / acos(-1.0)) * (asin(r) + r * sqrt(1.0 - r * r)) : 0.0;
}

static double stiffness_at(const struct one_mode *m, double amplitude)
{
    double k = m->stiffness;
    for (int i = 0; i < 3; i++)
        k += m->shape[i] * m->shape[i] * m->contact[i] * one_mode_share(m->shape[i] * amplitude, m->gap[i]);
    return k;
}

/* M^2 s^2 - 2 b s + K^2 - (F/a)^2 = 0, s = w^2: b, and b^2 - M^2 (K^2 - (F/a)^2). */
static double balance_parts(const struct one_mode *m, double amplitude, double *b)
{
    double k = stiffness_at(m, amplitude), push = m->force / amplitude;
    *b = k * m->mass - 0.5 * m->damping * m->damping;
    return *b * *b - m->mass * m->mass * (k - push) * (k + push);
}

int one_mode_balance(const struct one_mode *m, double amplitude, double hz[2])
{
    double b, square = balance_parts(m, amplitude, &b);
    int n = 0;
    for (int sign = 1; sign >= -1 && square >= 0.0; sign -= 2) {
        double s = (b + sign * sqrt(square)) / (m->mass * m->mass);
        if (s > 0.0)
            hz[n++] = sqrt(s) / MOTION_TWO_PI;
    }
    return n;
}

double one_mode_peak(const struct one_mode *m, double *hz)
{
    double b, low = 0.1 * fabs(m->force) / stiffness_at(m, HUGE_VAL), high = low, both[2];
    while (balance_parts(m, high, &b) > 0.0)
        high *= 2.0;
    for (int i = 0; i < 100; i++) {
        double middle = 0.5 * (low + high);
        *(balance_parts(m, middle, &b) > 0.0 ? &low : &high) = middle;
    }
    int n = one_mode_balance(m, low, both);
    *hz = n > 0 ? both[0] : (double)NAN;
    return low;
}

double one_mode_reach(const struct one_mode *m)
{
    return fmin(m->gap[0] / fabs(m->shape[0]), m->gap[2] / fabs(m->shape[2]));
}

/* Below zero where the force is more than the motion of this amplitude takes. */
static double excess(const struct one_mode *m, double hz, double amplitude)
{
    double w = MOTION_TWO_PI * hz;
    return amplitude * hypot(stiffness_at(m, amplitude) - m->mass * w * w, m->damping * w) - fabs(m->force);
}

int one_mode_amplitudes(const struct one_mode *m, double hz, double amplitude[3])
{
    enum { STEPS = 4000 };
    double at, knee = one_mode_reach(m), beyond = one_mode_peak(m, &at) - knee, low = knee;
    int n = 0;
    if (excess(m, hz, knee) >= 0.0)
        amplitude[n++] = fabs(m->force) * knee / (excess(m, hz, knee) + fabs(m->force));
    for (int i = 0; i <= STEPS && beyond > 0.0 && n < 3; i++) {
        double next = knee + beyond * pow(10.0, 1e-3 - 8.0 * (1.0 - (double)i / STEPS)), high = next;
        bool negative = excess(m, hz, low) < 0.0;
        if (negative != (excess(m, hz, high) < 0.0)) {
            for (int k = 0; k < 60; k++) {
                double middle = 0.5 * (low + high);
                *((excess(m, hz, middle) < 0.0) == negative ? &low : &high) = middle;
            }
            amplitude[n++] = low;
        }
        low = next;
    }
    return n;
}
