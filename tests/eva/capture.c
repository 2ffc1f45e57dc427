/* capture.c - every operation on a burst of any shape that fits into a small memory, in any state that the
 * seam allows.
 *
 * Nothing is read or written outside the memory, and the seam holds again. All shapes of up to FLOATS
 * floats are taken one by one; the code does not ask how large they are. The operations of the lock-in are
 * proved too. */
#include "firmware/observe/capture.h"

#include "firmware/observe/lockin_fit.h"
#include "tests/eva/angles.h"
#include "tests/eva/seams.h"

enum { FLOATS = 6 };

static float memory[FLOATS];

static void any_capture(struct capture *c, uint32_t n_signals, uint32_t n_samples, uint32_t next)
{
    c->next = next;
    c->state = (enum capture_state)Frama_C_interval(CAPTURE_IDLE, CAPTURE_FULL);
    c->trigger = (enum capture_trigger)Frama_C_interval(0, TRIGGERS - 1);
    c->n_signals = n_signals;
    c->n_samples = n_samples;
    c->pretrigger = eva_uint(0, n_samples);
    c->every = eva_uint(1, UINT32_MAX);
    c->i_tick = eva_uint(0, UINT32_MAX);
    c->filled = eva_uint(0, n_samples);
    c->left = eva_uint(0, n_samples);
    c->trigger_tick = eva_word();
    c->number = eva_uint(0, UINT32_MAX);
}

/* A read-out of this burst or of another one. */
static struct capture_reading any_reading(const struct capture *c, uint32_t next, uint32_t end)
{
    struct capture_reading r = {.next = next, .end = end, .signal = eva_uint(0, c->n_signals - 1)};
    r.number = eva_bool() ? c->number : eva_uint(0, UINT32_MAX);
    return r;
}

static void operations(uint32_t n_signals, uint32_t n_samples, uint32_t next)
{
    struct capture c;
    double signal[MODEL_OUTPUTS];
    uint32_t i, k;
    float value;
    eva_any(signal, sizeof signal);
    any_capture(&c, n_signals, n_samples, next);
    capture_add(&c, memory, signal);
    ASSERT(c.next < n_samples && c.n_samples == n_samples && c.n_signals == n_signals);
    ASSERT(c.filled <= n_samples);
    any_capture(&c, n_signals, n_samples, next);
    capture_trigger_now(&c, (enum capture_trigger)Frama_C_interval(0, TRIGGERS - 1), eva_word());
    ASSERT(c.next < n_samples && c.n_samples == n_samples && c.n_signals == n_signals);
    ASSERT(c.filled <= n_samples);
    /*@ loop unroll 20; */
    for (uint32_t from = 0; from <= n_samples; from++)
        /*@ loop unroll 20; */
        for (uint32_t to = from; to <= n_samples; to++) {
            any_capture(&c, n_signals, n_samples, next);
            struct capture_reading r = any_reading(&c, from, to);
            (void)capture_next(&c, &r, memory, &i, &k, &value);
            ASSERT(r.signal < n_signals && r.next <= to);
        }
}

/* A range that is read lies inside: each count and each
 * begin by itself as far as the burst goes, and all beyond. */
static void read_out(uint32_t n_samples)
{
    struct capture c;
    struct capture_reading r;
    /*@ loop unroll 20; */
    for (uint32_t first = 0; first <= n_samples + 1; first++)
        /*@ loop unroll 20; */
        for (uint32_t count = 0; count <= n_samples + 1; count++) {
            any_capture(&c, 1, n_samples, 0);
            r = any_reading(&c, 0, 0);
            (void)capture_read(&c, &r, first, count);
            ASSERT(r.next <= n_samples && r.end <= n_samples);
        }
    any_capture(&c, 1, n_samples, 0);
    r = any_reading(&c, 0, 0);
    (void)capture_read(&c, &r, eva_uint(n_samples + 1, UINT32_MAX), eva_uint(0, UINT32_MAX));
    ASSERT(r.next <= n_samples && r.end <= n_samples);
    any_capture(&c, 1, n_samples, 0);
    r = any_reading(&c, 0, 0);
    (void)capture_read(&c, &r, eva_uint(0, UINT32_MAX), eva_uint(n_samples + 1, UINT32_MAX));
    ASSERT(r.next <= n_samples && r.end <= n_samples);
}

/* A burst that was armed fits: tried are each burst that could fit, and all longer ones. */
static void arm_by(uint32_t n_signals, uint32_t n_samples, uint32_t most, int trigger)
{
    struct capture c = {.state = CAPTURE_IDLE};
    if (!capture_arm(&c, FLOATS, n_signals, eva_uint(n_samples, most), eva_uint(0, UINT32_MAX),
                     eva_uint(0, UINT32_MAX), (enum capture_trigger)trigger))
        return;
    ASSERT(seam_capture(&c, FLOATS) && c.trigger < TRIGGERS);
}

static void arm(uint32_t n_signals, uint32_t n_samples, uint32_t most)
{
    arm_by(n_signals, n_samples, most, Frama_C_interval(0, TRIGGERS - 1));
    arm_by(n_signals, n_samples, most, Frama_C_interval(TRIGGERS, INT32_MAX));
}

static void lock_in(void)
{
    struct lockin_window w;
    struct lockin_sum sum = {0.0, 0.0};
    struct lockin_tone tone[LOCKIN_TONES];
    double amplitude, phase;
    eva_any(&w, sizeof w);
    lockin_begin(&w, eva_uint(0, UINT32_MAX));
    w.n_ticks = eva_uint(1, UINT32_MAX);
    w.i_tick = eva_uint(0, UINT32_MAX);
    /*@ loop unroll 20; */
    for (uint32_t harmonic = 1; harmonic <= LOCKIN_HARMONICS; harmonic++)
        lockin_add(&sum, harmonic, lockin_weight(&w) * eva_between(-DBL_MAX, DBL_MAX), eva_between(-1.1, 1.1),
                   eva_between(-1.1, 1.1));
    lockin_polar(&sum, eva_between(-DBL_MAX, DBL_MAX), &amplitude, &phase);
    /*@ loop unroll 20; */
    for (int n = 1; n <= LOCKIN_TONES; n++) {
        eva_any(tone, sizeof tone);
        (void)lockin_equal(&w, &tone[0], &tone[n - 1]);
        (void)lockin_fit(&w, tone, n, eva_between(-DBL_MAX, DBL_MAX), &sum);
    }
}

int main(void)
{
    /*@ loop unroll 20; */
    for (uint32_t n_signals = 0; n_signals <= MODEL_OUTPUTS; n_signals++) {
        /*@ loop unroll 20; */
        for (uint32_t n = 0; n <= FLOATS + 1; n++)
            arm(n_signals, n, n);
        arm(n_signals, FLOATS + 2, UINT32_MAX);
        /*@ loop unroll 20; */
        for (uint32_t n = 1; n_signals > 0 && n_signals * n <= FLOATS; n++)
            /*@ loop unroll 20; */
            for (uint32_t next = 0; next < n; next++)
                operations(n_signals, n, next);
    }
    /*@ loop unroll 20; */
    for (uint32_t n = 1; n <= 4; n++)
        read_out(n);
    lock_in();
    return 0;
}
