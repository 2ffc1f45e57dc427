/* stage.c - elements of actuators and sensors; see stage.h. */
#include "firmware/stage/stage.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/hash.h"
#include "firmware/plant/noise.h"
#include "models/math/elementary.h"

#define TWO_PI (2.0 * ELEMENTARY_PI)

/* The first lag of a creep; each further one is sqrt(10) slower. */
#define CREEP_FIRST_S 0.1

/* The fastest pole of a 1/f noise, in corners; each further one is sqrt(10) slower, so its noise has the
 * fourth root of 10 more before the lag. */
#define FLICKER_FIRST  10.0
#define FOURTH_ROOT_10 1.7782794100389228
#define LN_SQRT_10     1.1512925464970228

/* ---- set-up ---- */

/* The values that a part may have. */
static const struct {
    double min_a, max_a, min_b, max_b;
    const char *why;
} range[STAGE_KINDS] = {
    [STAGE_GAIN] = {-1e9, 1e9, 0.0, 0.0, "stage: a gain is -1e9 to 1e9"},
    [STAGE_SLEW] = {1e-18, 1e18, 0.0, 0.0, "stage: a slew rate is 1e-18 to 1e18 a second"},
    [STAGE_HYSTERESIS] = {1e-18, 1e18, 0.0, 1.0,
                          "stage: a hysteresis has a range of 1e-18 to 1e18 and a share of 0 to 1"},
    [STAGE_CREEP] = {0.0, 1.0, 0.0, 0.0, "stage: a creep is 0 to 1 a decade"},
    [STAGE_RESONANCE] = {1e-6, 1e9, 1e-6, 0.999,
                         "stage: a resonance has 1e-6 to 1e9 Hz and a damping ratio of 1e-6 to 0.999"},
    [STAGE_NOISE] = {0.0, 1e9, 0.0, 0.0, "stage: a noise density is 0 to 1e9"},
    [STAGE_FLICKER] = {1e-6, 1e9, 1e-30, 1e9,
                       "stage: noise_corner, of 1/f noise, is 1e-6 to 1e9 Hz and needs a noise_density"},
    [STAGE_DRIFT] = {-1e9, 1e9, 0.0, 0.0, "stage: a drift is -1e9 to 1e9 a second"},
    [STAGE_LAG] = {1e-6, 1e12, 0.0, 0.0, "stage: a lag has a corner of 1e-6 to 1e12 Hz"},
    [STAGE_CLIP] = {0.0, 1e18, 0.0, 0.0, "stage: a clip is 0 to 1e18"},
    [STAGE_QUANTISER] = {1e-18, 1e18, 0.0, 0.0, "stage: a quantum is 1e-18 to 1e18"},
    [STAGE_DELAY] = {0.0, STAGE_DELAY_MAX, 0.0, 0.0, "stage: a delay is 0 to 510 ticks"},
};

const char *stage_refuse(double tick_s, const struct stage_part *part, int n)
{
    int delays = 0;
    if (!(tick_s >= 1e-16 && tick_s <= 1e12))
        return "stage: a tick has 1e-16 to 1e12 s";
    if (n < 0 || n > STAGE_PARTS)
        return "stage: more than 12 elements in a chain";
    for (int i = 0; i < n; i++) {
        const struct stage_part *p = &part[i];
        if ((unsigned)p->kind >= STAGE_KINDS)
            return "stage: no such element";
        if (!(p->a >= range[p->kind].min_a && p->a <= range[p->kind].max_a))
            return range[p->kind].why;
        if (!(p->b >= range[p->kind].min_b && p->b <= range[p->kind].max_b))
            return range[p->kind].why;
        delays += p->kind == STAGE_DELAY;
    }
    return delays > 1 ? "stage: more than one delay in a chain" : NULL;
}

/* Over a tick: deviation e and rate w (over omega) of y'' + 2 zeta omega y' + omega^2 (y - u) = 0, u held:
 * e' = c0 e + c1 w, w' = c2 w - c1 e. */
static void prepare_resonance(double *c, double turns, double zeta)
{
    double damped = sqrt(1.0 - zeta * zeta), whole = turns * damped, cosine, sine;
    double fall = exponential(-TWO_PI * turns * zeta);
    cos_sin_turns(turns_of(whole), &cosine, &sine);
    sine /= damped;
    c[0] = fall * (cosine + zeta * sine);
    c[1] = fall * sine;
    c[2] = fall * (cosine - zeta * sine);
}

static void prepare_hysteresis(double *c, const struct stage_part *p)
{
    for (int i = 0; i < STAGE_PLAYS; i++)
        c[i] = p->a * i / (2 * STAGE_PLAYS);
    c[STAGE_PLAYS] = 1.0 - p->b;
    c[STAGE_PLAYS + 1] = p->b / (STAGE_PLAYS - 1);
}

/* 1 - e^-x, without the loss of digits where x is small. */
static double approached(double x)
{
    return x < 1e-3 ? x * (1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0))) : 1.0 - exponential(-x);
}

/* Lags, each sqrt(10) slower than the one before. */
static void prepare_lags(double *c, double tick_s, double lag_s)
{
    for (int i = 0; i < STAGE_LAGS; i++) {
        c[i] = approached(tick_s / lag_s);
        lag_s *= 3.16227766016837933;
    }
}

static void prepare_creep(double *c, double tick_s, double share)
{
    prepare_lags(c, tick_s, CREEP_FIRST_S);
    c[STAGE_LAGS] = 0.5 * share;
}

/* Words of 16 bits, evenly spread, through lags: each has the variance density^2 corner ln(sqrt(10)), and all
 * together density^2 corner/f. */
static void prepare_flicker(double *c, double tick_s, const struct stage_part *p)
{
    prepare_lags(c, tick_s, 1.0 / (TWO_PI * FLICKER_FIRST * p->a));
    c[STAGE_LAGS] =
        p->b * sqrt(12.0 / (65536.0 * 65536.0 - 1.0) * LN_SQRT_10 * 2.0 / (TWO_PI * FLICKER_FIRST * tick_s));
}

static void prepare(struct stage_element *e, const struct stage_part *p, double tick_s)
{
    memset(e, 0, sizeof *e);
    e->kind = p->kind;
    e->c[0] = p->a;
    if (p->kind == STAGE_RESONANCE)
        prepare_resonance(e->c, p->a * tick_s, p->b);
    else if (p->kind == STAGE_HYSTERESIS)
        prepare_hysteresis(e->c, p);
    else if (p->kind == STAGE_CREEP)
        prepare_creep(e->c, tick_s, p->a);
    else if (p->kind == STAGE_LAG)
        e->c[0] = exponential(-TWO_PI * p->a * tick_s);
    else if (p->kind == STAGE_FLICKER)
        prepare_flicker(e->c, tick_s, p);
    else if (p->kind == STAGE_SLEW || p->kind == STAGE_DRIFT)
        e->c[0] = p->a * tick_s;
    else if (p->kind == STAGE_NOISE)
        e->c[0] = p->a * sqrt(0.5 / tick_s);
}

const char *stage_init(struct stage *s, double tick_s, uint32_t seed, const struct stage_part *part, int n)
{
    const uint64_t tag = UINT64_C(0x7374616700000000); /* other sequences than those of inputs and heat */
    const char *why = stage_refuse(tick_s, part, n);
    if (why)
        return why;
    memset(s, 0, sizeof *s);
    s->n = n;
    s->sequence = tag + (seed & 0xFFFFFFFu);
    for (int i = 0; i < n; i++)
        prepare(&s->element[i], &part[i], tick_s);
    return NULL;
}

/* ---- elements ---- */

static double within(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

static void run_resonance(struct stage_element *e, double *u, uint32_t n)
{
    const double *c = e->c;
    double x = e->x[0], rate = e->x[1];
    for (uint32_t k = 0; k < n; k++) {
        double deviation = x - u[k], slower = c[2] * rate - c[1] * deviation;
        x = u[k] + (c[0] * deviation + c[1] * rate);
        u[k] = x;
        rate = slower;
    }
    e->x[0] = x;
    e->x[1] = rate;
}

/* Prandtl and Ishlinskii: y = sum w_i p_i, p_i <- max(u - r_i, min(u + r_i, p_i)); r_0 = 0. */
static double run_hysteresis(struct stage_element *e, double u)
{
    const double *r = e->c;
    double sum = 0.0;
    for (int i = 1; i < STAGE_PLAYS; i++) {
        e->x[i] = within(e->x[i], u - r[i], u + r[i]);
        sum += e->x[i];
    }
    return r[STAGE_PLAYS] * u + r[STAGE_PLAYS + 1] * sum;
}

/* The last x is the signal at which it was settled: creep follows what has changed since. */
static double run_creep(struct stage_element *e, double u)
{
    double sum = 0.0;
    for (int i = 0; i < STAGE_LAGS; i++) {
        e->x[i] += e->c[i] * ((u - e->x[STAGE_LAGS]) - e->x[i]);
        sum += e->x[i];
    }
    return u + e->c[STAGE_LAGS] * sum;
}

static double run_flicker(struct stage_element *e, uint64_t sequence, uint64_t tick, double u)
{
    double scale = e->c[STAGE_LAGS];
    uint64_t word = 0;
    for (int i = 0; i < STAGE_LAGS; i++) {
        word = i % 4 ? word >> 16 : noise_word(sequence, 4 * tick + (uint64_t)i / 4);
        e->x[i] += e->c[i] * (scale * ((double)(word & 0xFFFFu) - 32767.5) - e->x[i]);
        u += e->x[i];
        scale *= FOURTH_ROOT_10;
    }
    return u;
}

static double run_delay(struct stage *s, const struct stage_element *e, uint64_t tick, double u)
{
    uint32_t whole = (uint32_t)e->c[0], at = (uint32_t)(tick % STAGE_RING);
    double fraction = e->c[0] - whole;
    s->ring[at] = u;
    double newer = s->ring[(at + STAGE_RING - whole) % STAGE_RING];
    if (fraction == 0.0)
        return newer;
    return newer + fraction * (s->ring[(at + STAGE_RING - whole - 1) % STAGE_RING] - newer);
}

/* One value of this tick. */
static double run_one(struct stage *s, int i, uint64_t tick, double u)
{
    struct stage_element *e = &s->element[i];
    uint64_t sequence = s->sequence + ((uint64_t)i << 28);
    switch (e->kind) {
    case STAGE_GAIN:
        return e->c[0] * u;
    case STAGE_SLEW:
        return e->x[0] = within(u, e->x[0] - e->c[0], e->x[0] + e->c[0]);
    case STAGE_HYSTERESIS:
        return run_hysteresis(e, u);
    case STAGE_CREEP:
        return run_creep(e, u);
    case STAGE_RESONANCE:
        run_resonance(e, &u, 1);
        return u;
    case STAGE_NOISE:
        return u + e->c[0] * noise_deviate(noise_word(sequence, tick));
    case STAGE_FLICKER:
        return run_flicker(e, sequence, tick, u);
    case STAGE_DRIFT:
        e->x[0] += 1.0;
        return u + e->c[0] * e->x[0];
    case STAGE_LAG:
        return e->x[0] = u + e->c[0] * (e->x[0] - u);
    case STAGE_CLIP:
        return within(u, -e->c[0], e->c[0]);
    case STAGE_QUANTISER:
        return stage_quantised(u, e->c[0]);
    default:
        return run_delay(s, e, tick, u);
    }
}

/* Gain and resonance, which most piezos are, ask for many ticks at once what they are. */
static void run_element(struct stage *s, int i, double *u, uint32_t n)
{
    struct stage_element *e = &s->element[i];
    double gain = e->c[0];
    if (e->kind == STAGE_RESONANCE)
        run_resonance(e, u, n);
    else if (e->kind == STAGE_GAIN)
        for (uint32_t k = 0; k < n; k++)
            u[k] *= gain;
    else
        for (uint32_t k = 0; k < n; k++)
            u[k] = run_one(s, i, s->tick + k, u[k]);
}

void stage_run_many(struct stage *s, double *u, uint32_t n)
{
    double signal = s->signal;
    for (uint32_t k = 0; k < n; k++) {
        if (!(fabs(u[k]) <= STAGE_LIMIT)) {
            s->refused++;
            u[k] = signal;
        }
        signal = u[k];
    }
    s->signal = signal;
    for (int i = 0; i < s->n; i++)
        run_element(s, i, u, n);
    s->tick += n;
    s->result = u[n - 1];
}

double stage_run(struct stage *s, double u)
{
    stage_run_many(s, &u, 1);
    return u;
}

/* ---- rest and hash ---- */

/* The state in which u passes for ever; the result but for noise and drift. */
static double settle_element(struct stage *s, int i, double u)
{
    struct stage_element *e = &s->element[i];
    memset(e->x, 0, sizeof e->x);
    if (e->kind == STAGE_NOISE || e->kind == STAGE_FLICKER || e->kind == STAGE_DRIFT)
        return u;
    e->x[0] = u;
    for (int k = 1; e->kind == STAGE_HYSTERESIS && k < STAGE_PLAYS; k++)
        e->x[k] = u;
    if (e->kind == STAGE_CREEP) {
        e->x[0] = 0.0;
        e->x[STAGE_LAGS] = u;
    }
    for (int k = 0; e->kind == STAGE_DELAY && k < STAGE_RING; k++)
        s->ring[k] = u;
    return run_one(s, i, s->tick, u);
}

void stage_settle(struct stage *s, double u, uint64_t tick)
{
    s->tick = tick;
    if (!(fabs(u) <= STAGE_LIMIT))
        u = 0.0;
    s->signal = u;
    for (int i = 0; i < s->n; i++)
        u = settle_element(s, i, u);
    s->result = u;
}

uint64_t stage_hash(const struct stage *s, uint64_t hash)
{
    hash = hash_double(hash_double(hash_word(hash, s->tick), s->signal), s->result);
    hash = hash_word(hash_word(hash, s->sequence), s->refused);
    for (int i = 0; i < s->n; i++) {
        const struct stage_element *e = &s->element[i];
        hash = hash_word(hash, e->kind);
        for (int k = 0; k <= STAGE_LAGS; k++)
            hash = hash_double(hash_double(hash, e->c[k]), e->x[k]);
        for (uint32_t k = 0; e->kind == STAGE_DELAY && k <= (uint32_t)e->c[0]; k++)
            hash = hash_double(hash, s->ring[(s->tick + STAGE_RING - 1 - k) % STAGE_RING]);
    }
    return hash;
}
