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

/* Arms for a burst, in any state; what was recorded is forgotten. False, and nothing changed, when it does not fit
 * into n_floats, pretrigger > n_samples, there is no such trigger, or n_signals, n_samples or every is 0. */
bool capture_arm(struct capture *c, uint32_t n_floats, uint32_t n_signals, uint32_t n_samples,
                 uint32_t pretrigger, uint32_t every, enum capture_trigger trigger);

/* True when the next call of capture_add will store its sample: lets the caller skip computing outputs. */
bool capture_wants(const struct capture *c);

/* One tick. */
void capture_add(struct capture *c, float *memory, const double *signal);

/* Something happened at this tick; begins the second part of the burst if it is what was waited for. */
void capture_trigger_now(struct capture *c, enum capture_trigger trigger, uint64_t tick);

/* Begins to read samples [first, first + count); false when the burst is not full or the range is outside. A read-out
 * still going on is replaced; count 0 ends it. */
bool capture_read(const struct capture *c, struct capture_reading *r, uint32_t first, uint32_t count);

/* The next value of a read-out: signal, sample and value; false when there is none left. */
bool capture_next(const struct capture *c, struct capture_reading *r, const float *memory, uint32_t *signal,
                  uint32_t *sample, float *value);

#endif
