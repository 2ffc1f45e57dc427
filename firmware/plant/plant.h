/* plant.h - a model in motion: state, tick, regime, drives, energy ledger, events. No bus, no clock.
 *
 * Time is an integer tick; one tick is one step of the method (a substep of a frame). The caller owns all
 * memory; struct plant points to nothing in itself, so that a copy of it, with a copy of the scratch
 * memory, is a snapshot. SI is in bus units: times, velocities and frequencies count bus seconds, of which
 * `dilation` pass in a real second.
 *
 *     struct plant pl;
 *     struct plant_config c = {.model = &hertz_rig, .method = &rk4, .tick_s = 1e-5, .dilation = 1.0};
 *     const char *why = plant_init(&pl, &c);
 *     if (!why) {
 *         plant_drive(&pl, RIG_FORCE, 3.0, 225.0, 0.0, 0.1);     // 3 N at 225 Hz, ramped up in 0.1 s
 *         bool good = plant_run(&pl, 50000);                     // 0.5 s
 *         lost = good && pl.counts.switches > 0;
 *     } */
#ifndef FIRMWARE_PLANT_H
#define FIRMWARE_PLANT_H

#include <stdbool.h>
#include <stdint.h>
#include "models/check.h"
#include "firmware/plant/drive.h"
#include "firmware/plant/ledger.h"
#include "firmware/method/method.h"

enum {
    PLANT_PIECES = 8,  /* pieces that switches may cut one segment into; more is counted and run through */
    PLANT_EVENTS = 32, /* contact events kept until taken; more are counted as lost */
    PLANT_STAGES = 4   /* actuators and sensors */
};

#define PLANT_STATE_LIMIT METHOD_STATE_LIMIT

/* An instant of plant time: tick + fraction/65536. */
struct instant {
    uint64_t tick;
    uint32_t fraction;
};

/* A contact switch; SI, so that a later parameter change cannot alter it. */
struct event {
    uint64_t tick;
    double fraction;   /* part of the tick, 0..1 */
    double speed;      /* |rate of the gap|, m/s */
    double peak_force; /* at lift-off: the largest contact force since touchdown, N; at touchdown 0 */
    uint8_t contact;
    bool touch;      /* touchdown, else lift-off */
    const double *x; /* the state at the switch, model units, in plant.event_x; NULL without it */
};

struct plant_counts {
    uint32_t switches;    /* contact switches located */
    uint32_t budget;      /* segments cut into PLANT_PIECES and then run through */
    uint32_t work;        /* times the method reached its own bound on work inside a segment */
    uint32_t residual;    /* switches whose root kept a residual above its bound */
    uint32_t events_lost; /* events overwritten before they were taken */
    uint32_t not_finite;  /* segments refused because the state left the finite numbers */
    uint32_t pieces_max;  /* the most pieces any segment needed */
    uint32_t changes;     /* commands that changed drives, parameters or state; counted by who applies them */
};

struct plant;
struct stages;

/* Actuators and sensors as a plant calls them. An image in which nobody names stage_calls
 * (firmware/stage/stages.h) has no code of them. */
struct plant_stage_calls {
    /* All off. */
    void (*clear)(struct stages *s);
    /* They are at rest at the plant's present drives and outputs. */
    void (*settle)(struct stages *s, struct plant *pl);
    /* The inputs of the segment of this length that begins now: what the actuators make of the drives. False
     * where one is beyond DRIVE_LIMIT: then the input stays. */
    bool (*act)(struct stages *s, struct plant *pl, uint32_t length);
    /* The end of a tick: the sensors take the outputs. */
    void (*sense)(struct stages *s, struct plant *pl);
    /* The results of all stages at the end of the last tick, SI; of one that is off 0. */
    const double *(*results)(const struct stages *s);
    /* In `output`, SI, each output behind which a sensor stands becomes the sensor's. */
    void (*replace)(const struct stages *s, double *output);
    uint64_t (*hash)(const struct stages *s, uint64_t hash);
    /* NULL, or why these settings of an app are refused. */
    const char *(*refuse)(const struct model *m, double tick_s, const double *setting);
    /* Takes settings that were not refused; stages whose settings differ begin anew. */
    void (*change)(struct stages *s, struct plant *pl, const double *setting);
    /* Converters, or both NULL: the codes of two DACs act in the tick that begins now, those of two ADCs are
     * read at the end of the last one. */
    void (*dac)(struct plant *pl, const int16_t *code);
    void (*adc)(const struct plant *pl, int16_t *code);
};

struct plant_config {
    const struct model *model;
    const double *si; /* [n_parameters], or NULL for the defaults */
    const struct method *method;
    double tick_s;   /* bus seconds per tick */
    double dilation; /* bus seconds per real second, >= 1e-6 */
    double tol;      /* for methods that have a tolerance; 0 for their default */
    bool force; /* run even where the method refuses its step (the step guard); the caller must report it */
    /* Books neither energy nor peak force: plant_residual, peak_force and the peak forces of events mean
     * nothing then. The motion has the same bits, for a tenth to a third less work. */
    bool no_ledger;
    double *scratch;                             /* method->n_scratch(model) doubles, or NULL for 0 */
    const struct plant_stage_calls *stage_calls; /* with memory for them in `stages`, or both NULL */
    struct stages *stages;
};

/* Where the energies of a piece come from: the ledger's
 * own rule, the method (struct method_books), or nowhere. */
enum plant_books { BOOKS_OF_LEDGER, BOOKS_OF_METHOD, BOOKS_NONE };

struct plant {
    const struct model *model;
    const struct method *method;
    step_function *step;
    bind_run_function *bind_run; /* NULL: all ticks by `step` */
    double *scratch;
    const struct plant_stage_calls *stage_calls;
    struct stages *stages;
    double tick_s, dilation, tol;
    bool force;
    bool staged; /* a stage is on */
    enum plant_books books;
    double p[MODEL_DERIVED];
    struct scale scale;       /* dilated */
    double h, ticks_per_time; /* model time per tick, and its inverse */
    struct instant now;
    unsigned regime; /* bit i: contact i closed */
    unsigned awake;  /* bit i: drive i may be non-zero: changed since it was last found silent */
    double x[MODEL_STATES];
    struct drive drive[MODEL_INPUTS];
    struct segment segment; /* the current one */
    struct ledger ledger;
    double peak_force; /* since the last touchdown, model units */
    double loss_time; /* model time with every contact open, in this record; 0 for a model without contacts */
    double total_time; /* model time in this record */
    struct event event[PLANT_EVENTS];
    double (
        *event_x)[MODEL_STATES]; /* [PLANT_EVENTS], or NULL: who wants x of events sets it after plant_init */
    uint32_t event_head, n_event;
    struct plant_counts counts;
    double si[MODEL_PARAMETERS]; /* the last: the offsets of all above stay short */
};

/* Sets the state x[n_states], model units. The regime follows from the gaps; ledger and peak force start
 * anew. Nothing is checked: a state that is not finite makes the next plant_advance fail. */
void plant_set_state(struct plant *pl, const double *x);

/* Sets the regime that follows from state, inputs and parameters: a contact is closed where its gap is
 * negative. */
void plant_find_regime(struct plant *pl);

/* The method has prepared, or inputs have changed: who books energies from here on. True: the method could.
 */
bool plant_find_books(struct plant *pl);

/* Sets the state to rest, silences the drives at phase 0 and starts the ledger anew. Tick, events and
 * counts go on. */
void plant_reset(struct plant *pl);

/* Advances to the given instant (fraction below 65536); does nothing when that has passed. Ticks end
 * exactly, and so do ramps. Returns false when the state left the finite numbers or PLANT_STATE_LIMIT:
 * counted in counts.not_finite. Then time and state stand at the last good instant, the drives at the end
 * of the segment that was refused. Reset the plant before going on. Costs one step of the method per tick,
 * and one more for each corner of a drive and each contact switch inside a tick. One call for many ticks
 * costs less than many calls, with equal bits: ticks in which every drive just runs on are done in a loop. */
MUST_CHECK bool plant_advance(struct plant *pl, struct instant to);

/* plant_advance by a number of whole ticks from now instead of an instant. */
MUST_CHECK bool plant_run(struct plant *pl, uint64_t ticks);

/* Looks at a plant at the end of a tick: at its state, inputs, phasors, regime, events and tick. Its times
 * may stand elsewhere. */
typedef void plant_look(void *who, const struct plant *pl);

/* Looks at n ticks of a block from tick `from` on, in which no contact switches. The plant's model, numbers
 * and regime hold in them; the rest of it may stand elsewhere. */
typedef void plant_look_ticks(void *who, const struct plant *pl, const struct method_block *b, uint32_t from,
                              uint32_t n);

/* plant_run from the start of a tick, for callers who look at every tick: calls look(who, pl) at the end
 * of each. `several`: NULL, or called instead for some ticks that it sees together. */
MUST_CHECK bool plant_run_seen(struct plant *pl, uint64_t ticks, plant_look *look, plant_look_ticks *several,
                               void *who);

/* For each of n values plant_sample(pl, i, value, 0) and plant_run(pl, ticks), with equal bits. It costs
 * less where each is held for few ticks and no other input sounds. */
MUST_CHECK bool plant_run_samples(struct plant *pl, int i, const double *value, uint32_t n, uint64_t ticks);

/* Drive i, for a change by the functions of drive.h. Ticks skip a drive that was found silent until this
 * is called. */
static inline struct drive *plant_touch_drive(struct plant *pl, int i)
{
    pl->awake |= 1u << i;
    return &pl->drive[i];
}

/* The fields of a drive, in SI (bus units); V is the input's unit. */
enum drive_field {
    DRIVE_AMPLITUDE,  /* V */
    DRIVE_FREQUENCY,  /* Hz, at least 0 and below half the tick rate */
    DRIVE_PHASE,      /* rad */
    DRIVE_RAMP,       /* s, at least 0: how long the change takes */
    DRIVE_NOISE,      /* V, standard deviation, at least 0 */
    DRIVE_NOISE_HOLD, /* ticks, at most NOISE_HOLD_MAX */
    DRIVE_NOISE_SEED,
    DRIVE_FIELDS
};

/* Starts a ramp of drive i to new values: value[f] for each field f whose bit is set in `given`; the
 * others stay. Without DRIVE_RAMP the change takes what a running ramp has left, else one tick. Values
 * outside the ranges above are an error of the caller (assertion). Does not count in counts.changes; nor
 * do the functions below, but for plant_drives_to_zero. */
void plant_set_drive(struct plant *pl, int i, unsigned given, const double *value);

/* Moves every drive, noise and sample that sounds to zero over ramp_s >= 0 seconds, at least one tick.
 * Counts one change, if any sounded. */
void plant_drives_to_zero(struct plant *pl, double ramp_s);

/* The four harmonic fields of drive i at once. plant_drive goes there over ramp_s. plant_drive_start
 * begins there now, for an initial condition; the ledger starts anew. A frequency with fewer than
 * DRIVE_TICKS_MIN ticks a period runs, but rk4 does not resolve it. */
void plant_drive(struct plant *pl, int i, double amplitude, double frequency_Hz, double phase_rad,
                 double ramp_s);
void plant_drive_start(struct plant *pl, int i, double amplitude, double frequency_Hz, double phase_rad);

/* Noise of input i (firmware/plant/noise.h): goes to this standard deviation, hold in ticks (0 counts as
 * 1) and seed over ramp_s. The harmonic part shares the ramp: one that runs goes on to its target in this
 * time. */
void plant_noise(struct plant *pl, int i, double deviation, uint32_t hold, uint32_t seed, double ramp_s);

/* Sampled command of input i in SI: jumps now (ticks 0), or moves there over whole ticks. A length, as the
 * base, never jumps: there 0 counts as 1 tick. */
void plant_sample(struct plant *pl, int i, double value, uint64_t ticks);

/* Takes out the oldest event; false when there is none. PLANT_EVENTS are kept; then the oldest are
 * overwritten and counted. */
bool plant_take_event(struct plant *pl, struct event *e);

/* Begins a new record: drops all events and sets loss_time and total_time to 0. The app does so in each
 * frame. */
void plant_begin_record(struct plant *pl);

/* -1, 0, 1 as a is before, at or after b. */
int instant_compare(struct instant a, struct instant b);

#endif
