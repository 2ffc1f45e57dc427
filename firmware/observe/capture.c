/* capture.c - the ring of a burst; see capture.h. Kept and later samples together are n_samples, so that a
 * full burst begins in the ring where the next sample would go. */
#include "firmware/observe/capture.h"

bool capture_arm(struct capture *c, uint32_t n_floats, uint32_t n_signals, uint32_t n_samples,
                 uint32_t pretrigger, uint32_t every, enum capture_trigger trigger)
{
    if (n_signals == 0 || n_samples == 0 || every == 0 || pretrigger > n_samples)
        return false;
    if ((uint64_t)n_signals * n_samples > n_floats || (unsigned)trigger >= TRIGGERS)
        return false;
    *c = (struct capture){.state = CAPTURE_ARMED,
                          .trigger = trigger,
                          .n_signals = n_signals,
                          .n_samples = n_samples,
                          .pretrigger = pretrigger,
                          .every = every,
                          .i_tick = every - 1,
                          .number = c->number + 1};
    return true;
}

bool capture_wants(const struct capture *c)
{
    return (c->state == CAPTURE_ARMED || c->state == CAPTURE_FILLING) && c->i_tick == c->every - 1;
}

static void store(struct capture *c, float *memory, const double *signal)
{
    float *sample = memory + (uint64_t)c->next * c->n_signals;
    for (uint32_t i = 0; i < c->n_signals; i++)
        sample[i] = (float)signal[i];
    c->next = c->next + 1 == c->n_samples ? 0 : c->next + 1;
    if (c->filled < c->n_samples)
        c->filled++;
}

void capture_add(struct capture *c, float *memory, const double *signal)
{
    if (!capture_wants(c)) {
        c->i_tick++;
        return;
    }
    c->i_tick = 0;
    store(c, memory, signal);
    if (c->state == CAPTURE_FILLING && --c->left == 0)
        c->state = CAPTURE_FULL;
}

void capture_trigger_now(struct capture *c, enum capture_trigger trigger, uint64_t tick)
{
    if (c->state != CAPTURE_ARMED || trigger != c->trigger)
        return;
    if (c->pretrigger > c->filled)
        c->pretrigger = c->filled;
    c->left = c->n_samples - c->pretrigger;
    c->state = c->left == 0 ? CAPTURE_FULL : CAPTURE_FILLING;
    c->trigger_tick = tick;
}

bool capture_read(const struct capture *c, struct capture_reading *r, uint32_t first, uint32_t count)
{
    if (c->state != CAPTURE_FULL || (uint64_t)first + count > c->n_samples)
        return false;
    *r = (struct capture_reading){.number = c->number, .next = first, .end = first + count};
    return true;
}

bool capture_next(const struct capture *c, struct capture_reading *r, const float *memory, uint32_t *signal,
                  uint32_t *sample, float *value)
{
    if (c->state != CAPTURE_FULL || r->number != c->number || r->next == r->end)
        return false;
    uint64_t position = (uint64_t)c->next + r->next;
    if (position >= c->n_samples)
        position -= c->n_samples;
    *signal = r->signal;
    *sample = r->next;
    *value = memory[position * c->n_signals + r->signal];
    if (++r->signal == c->n_signals) {
        r->signal = 0;
        r->next++;
    }
    return true;
}
