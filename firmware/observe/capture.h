/* capture.h - a triggered burst of all outputs, tick by tick, with pre-trigger, in memory the caller owns.
 *
 * When armed it records into a ring, the first tick and every `every`-th from there. At the trigger it keeps
 * the last `pretrigger` samples and takes the rest. When full, it waits to be read out over the bus, sample
 * by sample. Index 0 is the oldest sample; the trigger fell between sample pretrigger - 1 and sample
 * pretrigger. A trigger waits for nothing: when there were fewer samples before it, pretrigger becomes their
 * number and more are taken after it. */
#ifndef FIRMWARE_CAPTURE_H
#define FIRMWARE_CAPTURE_H

#include <stdbool.h>
#include <stdint.h>

enum capture_state { CAPTURE_IDLE, CAPTURE_ARMED, CAPTURE_FILLING, CAPTURE_FULL };
enum capture_trigger {
    TRIGGER_COMMAND,
    TRIGGER_TOUCHDOWN,
    TRIGGER_LIFTOFF,
    TRIGGER_FIRE,
    TRIGGER_FAULT,
    TRIGGERS
};

struct capture {
    enum capture_state state;
    enum capture_trigger trigger;
    uint32_t n_signals;  /* floats per sample */
    uint32_t n_samples;  /* samples of the burst, <= n_floats / n_signals */
    uint32_t pretrigger; /* samples kept from before the trigger; as many as there were, once it has come */
    uint32_t every;      /* ticks per sample */
    uint32_t i_tick;     /* ticks since the last sample */
    uint32_t next;       /* ring position of the next sample */
    uint32_t filled;     /* samples in the ring, up to n_samples */
    uint32_t left;       /* samples still to take after the trigger */
    uint64_t trigger_tick;
    uint32_t number; /* bursts armed so far */
};

/* A read-out of a burst. It ends when another burst is armed. */
struct capture_reading {
    uint32_t number;    /* number of the burst */
    uint32_t next, end; /* samples: the next, and one past the last */
    uint32_t signal;
};

/* Arms for a burst, in any state, and forgets what was recorded. n_floats: size of the memory that
 * capture_add will be given; n_signals: floats per sample; every: ticks per sample. Returns false and
 * changes nothing when n_signals * n_samples > n_floats, pretrigger > n_samples, there is no such trigger,
 * or n_signals, n_samples or every is 0.
 *
 *             // 4 signals, 100 ticks before lift-off and 900 after it
 *     capture_arm(&c, 4000, 4, 1000, 100, 1, TRIGGER_LIFTOFF); */
bool capture_arm(struct capture *c, uint32_t n_floats, uint32_t n_signals, uint32_t n_samples,
                 uint32_t pretrigger, uint32_t every, enum capture_trigger trigger);

/* True when the next call of capture_add will store its sample: lets the caller skip computing outputs. */
bool capture_wants(const struct capture *c);

/* Call it once per tick while ARMED or FILLING; it stores signal[n_signals], as floats, every `every`-th
 * tick. `memory` is the same in each call, with the n_floats that capture_arm was given. `signal` is read
 * only when capture_wants. */
void capture_add(struct capture *c, float *memory, const double *signal);

/* Reports what happened at this tick. If the burst is ARMED for this trigger, it begins to fill its second
 * part; else nothing happens. Call it before the capture_add of the tick. */
void capture_trigger_now(struct capture *c, enum capture_trigger trigger, uint64_t tick);

/* Begins to read samples first .. first + count - 1, and replaces a read-out that goes on; count 0 ends
 * it. Returns false, and changes nothing, when the burst is not FULL or has fewer samples. */
bool capture_read(const struct capture *c, struct capture_reading *r, uint32_t first, uint32_t count);

/* Takes the next value of a read-out: all signals of a sample, then the next sample. False when none is
 * left or another burst has been armed meanwhile. */
bool capture_next(const struct capture *c, struct capture_reading *r, const float *memory, uint32_t *signal,
                  uint32_t *sample, float *value);

#endif
