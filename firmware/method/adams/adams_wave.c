/* adams_wave.c - the inputs' share in a tick of `adams`, in closed form.
 *
 * A force u(s) adds the integrals of (h - s) u(s) to the place and of u(s) to the rate. With M_k the integral
 * of t^k exp(i z t) over 0 <= t <= 1, z = omega h, a wave amplitude cos(theta + omega s) adds the real parts
 * of h^2 (M_0 - M_1) exp(i theta) and h M_0 exp(i theta), and so on with its growth. M_2 comes from its power
 * series; the others follow from it by parts, upwards without cancellation:
 *
 *     M_(k-1) = (exp(i z) - i z M_k)/k */
#include "firmware/method/adams/adams_wave.h"

#include "models/math/elementary.h"

void adams_prepare_series(struct adams *s)
{
    double factorial = 1.0;
    for (int n = 0; n < ADAMS_TERMS; n++) {
        factorial *= n > 0 ? (double)n : 1.0;
        s->series[n] = 1.0 / (factorial * (n + 3));
    }
}

/* a + b i z c, for the integration by parts. */
static struct complex turned(struct complex a, double b, double z, struct complex c)
{
    return (struct complex){a.re - b * z * c.im, a.im + b * z * c.re};
}

static struct complex times(double a, struct complex z)
{
    return (struct complex){a * z.re, a * z.im};
}

static struct complex sum(struct complex a, struct complex b)
{
    return (struct complex){a.re + b.re, a.im + b.im};
}

void adams_moments(const struct adams *s, double z, struct complex *e, struct complex m[3])
{
    double square = -(z * z), even = 0.0, odd = 0.0;
    for (int n = ADAMS_TERMS - 2; n >= 0; n -= 2) {
        even = s->series[n] + square * even;
        odd = s->series[n + 1] + square * odd;
    }
    cos_sin(z, &e->re, &e->im);
    m[2] = (struct complex){even, z * odd};
    m[1] = times(0.5, turned(*e, -1.0, z, m[2]));
    m[0] = turned(*e, -1.0, z, m[1]);
}

static void add(struct adams_response *r, int k, double factor, struct complex z)
{
    r->cosine[k] += factor * z.re;
    r->sine[k] -= factor * z.im;
}

static void respond(const struct adams *s, int i, double h, struct adams_response *r)
{
    const struct wave *w = &s->wave[i];
    double a = w->amplitude, growth = w->growth * h, end = a + growth, turn = w->omega * h;
    double force = s->form.force[i], drag = s->form.drag[i], shift = s->form.shift[i];
    const struct complex begin = {a, 0.0}, rate = {growth, turn * a};
    struct complex e, m[3];
    *r = (struct adams_response){{0.0, 0.0}, {0.0, 0.0}};
    if (a == 0.0 && growth == 0.0)
        return;
    adams_moments(s, turn, &e, m);
    struct complex all = sum(times(a, m[0]), times(growth, m[1]));
    struct complex away = sum(all, times(-1.0, sum(times(a, m[1]), times(growth, m[2]))));
    struct complex there = times(end, e), step = sum(there, times(-1.0, begin));
    struct complex rate_there = turned(times(growth, e), 1.0, turn, there);
    add(r, ADAMS_PLACE, force * h * h, away);
    add(r, ADAMS_RATE, force * h, all);
    add(r, ADAMS_PLACE, drag * h, sum(all, times(-1.0, begin)));
    add(r, ADAMS_RATE, drag, step);
    add(r, ADAMS_PLACE, shift, sum(step, times(-1.0, rate)));
    add(r, ADAMS_RATE, shift / h, sum(rate_there, times(-1.0, rate)));
}

/* Offsets, slopes and the constant force. */
static void push_steadily(const struct adams *s, double h, struct adams_push *push)
{
    double value = s->form.constant, slope = 0.0;
    for (int k = 0; k < s->n_on; k++) {
        int i = s->on[k];
        value += s->form.force[i] * s->wave[i].offset + s->form.drag[i] * s->wave[i].slope;
        slope += s->form.force[i] * s->wave[i].slope;
    }
    push->steady = adams_push_steady(h, value, slope);
}

void adams_push_for(const struct adams *s, double length, struct adams_push *push)
{
    for (int k = 0; k < s->n_on; k++)
        respond(s, s->on[k], length, &push->response[k]);
    push_steadily(s, length, push);
}

static bool same_turn(const struct wave *a, const struct wave *b)
{
    return a->omega == b->omega && a->amplitude == b->amplitude && a->growth == b->growth;
}

void adams_take_waves(struct adams *s, const struct segment *e)
{
    bool same_inputs = s->active == e->active;
    s->n_on = 0;
    s->sloping = false;
    for (int i = 0; e->active >> i != 0; i++) {
        if (!((e->active >> i) & 1u))
            continue;
        bool kept = same_inputs && same_turn(&s->wave[i], &e->wave[i]);
        s->wave[i] = e->wave[i];
        s->on[s->n_on] = i;
        s->force[s->n_on] = s->form.force[i];
        s->sloping |= e->wave[i].slope != 0.0;
        if (!kept)
            respond(s, i, s->h, &s->push.response[s->n_on]);
        s->n_on++;
    }
    s->active = e->active;
    s->kind = s->active & s->modulating ? ADAMS_MODULATED : ADAMS_FORCED;
    if (s->active & s->shifting)
        s->kind = ADAMS_SHIFTED;
    push_steadily(s, s->h, &s->push);
}
