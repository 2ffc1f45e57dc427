/* test_capture.c - the burst capture against a list of everything that was offered; timing histograms. */
#include "tests/unit/test.h"

#include <string.h>
#include "firmware/observe/capture.h"
#include "firmware/observe/timing.h"

enum { FLOATS = 16, GUARD = 4, TICKS = 60 };

struct burst {
    uint32_t n_signals, n_samples, pretrigger, every;
    uint32_t trigger; /* ticks before the trigger */
};

/* Signal i at tick k: exact in a float. */
static double value_at(uint32_t tick, uint32_t i)
{
    return 100.0 * tick + i;
}

static void add_sample(struct capture *c, float *memory, uint32_t tick)
{
    double signal[2] = {value_at(tick, 0), value_at(tick, 1)};
    capture_add(c, memory, signal);
}

/* Ticks of the burst's samples, from the list of all
 * multiples of `every`. Returns how many precede the trigger. */
static uint32_t reference(const struct burst *b, uint32_t *tick)
{
    uint32_t before = 0, kept, first;
    while (before * b->every < b->trigger)
        before++;
    kept = before < b->pretrigger ? before : b->pretrigger;
    first = before - kept;
    for (uint32_t i = 0; i < b->n_samples; i++)
        tick[i] = (first + i) * b->every;
    return kept;
}

/* Number of deviations from the reference in one burst. */
static int run_burst(const struct burst *b)
{
    struct capture c = {0};
    struct capture_reading r = {0};
    float memory[FLOATS + GUARD];
    uint32_t expected[FLOATS], signal, sample, tick = 0;
    float value;
    uint32_t kept = reference(b, expected), last = expected[b->n_samples - 1];
    uint32_t n_floats = b->n_signals * b->n_samples;
    memset(memory, 0x7f, sizeof memory);
    int wrong =
        !capture_arm(&c, n_floats, b->n_signals, b->n_samples, b->pretrigger, b->every, TRIGGER_LIFTOFF);
    for (; tick < b->trigger; tick++) {
        wrong += capture_wants(&c) != (tick % b->every == 0) || c.state != CAPTURE_ARMED;
        add_sample(&c, memory, tick);
    }
    capture_trigger_now(&c, TRIGGER_LIFTOFF, tick);
    wrong += c.trigger_tick != b->trigger || c.pretrigger != kept;
    for (; kept < b->n_samples && tick <= last; tick++) {
        wrong += c.state != CAPTURE_FILLING || capture_read(&c, &r, 0, 1);
        wrong += capture_wants(&c) != (tick % b->every == 0);
        add_sample(&c, memory, tick);
    }
    wrong += c.state != CAPTURE_FULL || capture_wants(&c) || c.filled > b->n_samples;
    for (uint32_t i = 0; i < 5; i++) /* a full burst takes nothing more */
        add_sample(&c, memory, tick + i);
    wrong += !capture_read(&c, &r, 0, b->n_samples);
    for (uint32_t i = 0; i < n_floats; i++) {
        wrong += !capture_next(&c, &r, memory, &signal, &sample, &value);
        wrong += signal != i % b->n_signals || sample != i / b->n_signals;
        wrong += (double)value != value_at(expected[i / b->n_signals], i % b->n_signals);
    }
    wrong += capture_next(&c, &r, memory, &signal, &sample, &value);
    static const unsigned char UNTOUCHED[4] = {0x7f, 0x7f, 0x7f, 0x7f};
    for (uint32_t i = n_floats; i < FLOATS + GUARD; i++)
        wrong += memcmp(&memory[i], UNTOUCHED, sizeof UNTOUCHED) != 0;
    return wrong;
}

TEST(capture_exhaustive)
{
    int bursts = 0, wrong = 0;
    for (uint32_t n = 1; n <= 8; n++)
        for (uint32_t pretrigger = 0; pretrigger <= n; pretrigger++)
            for (uint32_t every = 1; every <= 3; every++)
                for (uint32_t trigger = 0; trigger <= TICKS; trigger++)
                    for (uint32_t n_signals = 1; n_signals <= 2; n_signals++, bursts++)
                        wrong += run_burst(&(struct burst){n_signals, n, pretrigger, every, trigger}) != 0;
    check_int("bursts tried", bursts, 44 * 3 * (TICKS + 1) * 2);
    check_int("bursts that differ from the list of all samples", wrong, 0);
}

TEST(capture_refusals)
{
    struct capture c, before;
    memset(&c, 0, sizeof c);
    check_true("fits exactly", capture_arm(&c, 12, 3, 4, 2, 5, TRIGGER_FIRE));
    before = c;
    check_true("refused: one float short", !capture_arm(&c, 11, 3, 4, 2, 5, TRIGGER_FIRE));
    check_true("refused: product beyond 32 bits", !capture_arm(&c, 12, 65536, 65536, 2, 5, TRIGGER_FIRE));
    check_true("refused: pretrigger > n_samples", !capture_arm(&c, 12, 3, 4, 5, 5, TRIGGER_FIRE));
    check_true("refused: no signals", !capture_arm(&c, 12, 0, 4, 2, 5, TRIGGER_FIRE));
    check_true("refused: no samples", !capture_arm(&c, 12, 3, 0, 0, 5, TRIGGER_FIRE));
    check_true("refused: every 0", !capture_arm(&c, 12, 3, 4, 2, 0, TRIGGER_FIRE));
    check_true("refused: no such trigger", !capture_arm(&c, 12, 3, 4, 2, 5, TRIGGERS));
    check_true("refused: no memory", !capture_arm(&c, 0, 3, 4, 2, 5, TRIGGER_FIRE));
    check_int("a refusal changes nothing", memcmp(&c, &before, sizeof c), 0);
}

TEST(capture_triggers)
{
    struct capture c = {0};
    struct capture_reading r = {0};
    float memory[8], value;
    uint32_t signal, sample;
    memset(&c, 0, sizeof c);
    capture_trigger_now(&c, TRIGGER_COMMAND, 1);
    check_int("idle: a trigger does nothing", c.state, CAPTURE_IDLE);
    check_true("idle: wants nothing", !capture_wants(&c));
    check_true("idle: nothing to read",
               !capture_read(&c, &r, 0, 0) && !capture_next(&c, &r, memory, &signal, &sample, &value));
    check_true("armed for touchdown", capture_arm(&c, 8, 2, 4, 1, 1, TRIGGER_TOUCHDOWN));
    for (int t = 0; t < TRIGGERS; t++)
        if (t != TRIGGER_TOUCHDOWN)
            capture_trigger_now(&c, (enum capture_trigger)t, 7);
    check_int("other triggers do nothing", c.state, CAPTURE_ARMED);
    add_sample(&c, memory, 0);
    capture_trigger_now(&c, TRIGGER_TOUCHDOWN, 1);
    check_int("the right one begins the second part", c.state, CAPTURE_FILLING);
    add_sample(&c, memory, 1);
    capture_trigger_now(&c, TRIGGER_TOUCHDOWN, 2);
    check_int("a second one changes nothing: tick", (int64_t)c.trigger_tick, 1);
    check_int("... samples left", c.left, 2);
    check_true("armed again while filling", capture_arm(&c, 8, 2, 4, 4, 1, TRIGGER_FAULT));
    for (uint32_t k = 10; k < 16; k++)
        add_sample(&c, memory, k);
    capture_trigger_now(&c, TRIGGER_FAULT, 16);
    check_int("pretrigger = n_samples: full at the trigger", c.state, CAPTURE_FULL);
    check_true("... readable",
               capture_read(&c, &r, 0, 4) && capture_next(&c, &r, memory, &signal, &sample, &value));
    check_near("... oldest sample is of tick 12", (double)value, value_at(12, 0), 0.0);
    check_true("armed again while being read", capture_arm(&c, 8, 2, 4, 4, 1, TRIGGER_FAULT));
    check_true("... the read-out is over", !capture_next(&c, &r, memory, &signal, &sample, &value));
    for (uint32_t k = 20; k < 26; k++)
        add_sample(&c, memory, k);
    capture_trigger_now(&c, TRIGGER_FAULT, 26);
    check_true("... and stays over when the next burst is full",
               c.state == CAPTURE_FULL && !capture_next(&c, &r, memory, &signal, &sample, &value));
}

TEST(capture_read)
{
    struct capture c = {0};
    struct capture_reading r = {0};
    float memory[8], value;
    uint32_t signal, sample;
    int wrong = !capture_arm(&c, 8, 2, 4, 0, 1, TRIGGER_COMMAND);
    add_sample(&c, memory, 0);
    capture_trigger_now(&c, TRIGGER_COMMAND, 1);
    for (uint32_t k = 1; k <= 4; k++)
        add_sample(&c, memory, k);
    for (uint32_t first = 0; first <= 6; first++)
        for (uint32_t count = 0; count <= 6; count++) {
            wrong += capture_read(&c, &r, first, count) != (first + count <= 4);
            for (uint32_t i = 0; first + count <= 4 && i < 2 * count; i++) {
                wrong += !capture_next(&c, &r, memory, &signal, &sample, &value);
                wrong += sample != first + i / 2 || signal != i % 2;
                wrong += (double)value != value_at(1 + sample, signal);
            }
            wrong += capture_next(&c, &r, memory, &signal, &sample, &value);
        }
    check_int("ranges of a read-out, deviations", wrong, 0);
    check_true("refused: a range that wraps around", !capture_read(&c, &r, 1, UINT32_MAX));
    check_true("begun", capture_read(&c, &r, 0, 4) && capture_next(&c, &r, memory, &signal, &sample, &value));
    check_true("replaced within a sample",
               capture_read(&c, &r, 2, 1) && capture_next(&c, &r, memory, &signal, &sample, &value));
    check_int("... sample", sample, 2);
    check_int("... signal", signal, 0);
    check_true("a refused range leaves the read-out", !capture_read(&c, &r, 4, 1));
    check_true("... which goes on", capture_next(&c, &r, memory, &signal, &sample, &value));
    check_int("... which goes on", signal, 1);
    check_int("... which goes on", sample, 2);
    check_true("begun again", capture_read(&c, &r, 0, 4));
    c.state = CAPTURE_IDLE;
    check_true("stopped: the read-out is over", !capture_next(&c, &r, memory, &signal, &sample, &value));
}

TEST(timing_histogram)
{
    struct histogram h;
    int wrong = 0;
    memset(&h, 0, sizeof h);
    histogram_add(&h, 0, 1);
    wrong += h.bin[0] != 1 || h.max_us != 0;
    for (uint32_t k = 1; k < TIMING_BINS; k++) {
        histogram_add(&h, UINT32_C(1) << (k - 1), 10 * k);
        histogram_add(&h, (UINT32_C(1) << k) - 1, 10 * k + 1);
        wrong += h.bin[k] != 2;
    }
    check_int("bins that do not hold [2^(k-1), 2^k)", wrong, 0);
    check_int("maximum", h.max_us, (1 << 19) - 1);
    check_int("... at its frame", (int64_t)h.max_frame, 191);
    histogram_add(&h, (1 << 19) - 1, 500);
    check_int("an equal one keeps the first frame", (int64_t)h.max_frame, 191);
    histogram_add(&h, 1 << 19, 600);
    histogram_add(&h, UINT32_MAX, 700);
    check_int("last bin holds everything above", h.bin[TIMING_BINS - 1], 5);
    check_int("largest maximum", h.max_us, UINT32_MAX);
    check_int("... at its frame", (int64_t)h.max_frame, 700);
}
