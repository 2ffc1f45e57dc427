/* plant.h - what a model does now: state, tick, regime, drives, energy ledger, events. No bus, no clock.
 *
 * Time is an integer tick; one tick is one step of the method (a substep of a frame). The caller owns all memory. */
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

/* A state larger than this many model units (the contact's own length) is trouble, not motion. */
#define PLANT_STATE_LIMIT 1e12

/* An instant of plant time: tick + fraction/65536. */
struct instant {
    uint64_t tick;
    uint32_t fraction;
};

/* A contact switch; SI, so that a later parameter change cannot alter it. */
struct event {
    uint64_t tick;
    double fraction;   /* of a tick, [0, 1] */
    double speed;      /* |rate of the gap|, m/s */
    double peak_force; /* at lift-off: the largest contact force since touchdown, N; at touchdown 0 */
    uint8_t contact;
    bool touch;             /* touchdown, else lift-off */
    double x[MODEL_STATES]; /* model units, at the switch */
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

/* Actuators and sensors as a plant calls them. An image in which nobody names stage_calls (firmware/stage/stages.h) has
 * no code of them. */
struct plant_stage_calls {
    /* All off. */
    void (*clear)(struct stages *s);
    /* They are at rest at the plant's present drives and outputs. */
    void (*settle)(struct stages *s, struct plant *pl);
    /* The inputs of the segment of this length that begins now: what the actuators make of the drives. False where one
     * is beyond DRIVE_LIMIT: then the input stays. */
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
};

struct plant_config {
    const struct model *model;
    const double *si; /* [n_parameters], or NULL for the defaults */
    const struct method *method;
    double tick_s;   /* bus seconds per tick */
    double dilation; /* bus seconds per real second, >= 1e-6 */
    double tol;      /* for methods that have a tolerance; 0 for their default */
    bool force;      /* run even where the method refuses its step (the step guard); whoever does says so */
    /* Books neither energy nor peak force: plant_residual, peak_force and the peak forces of events mean nothing then.
     * The motion has the same bits, for a tenth to a third less work. */
    bool no_ledger;
    double *scratch;                             /* method->n_scratch(model) doubles, or NULL for 0 */
    const struct plant_stage_calls *stage_calls; /* with memory for them in `stages`, or both NULL */
    struct stages *stages;
};

/* Where the energies of a piece come from: the ledger's own rule, the method (struct method_books), or nowhere. */
enum plant_books { BOOKS_OF_LEDGER, BOOKS_OF_METHOD, BOOKS_NONE };

struct plant {
    const struct model *model;
    const struct method *method;
    step_function *step;
    double *scratch;
    const struct plant_stage_calls *stage_calls;
    struct stages *stages;
    double tick_s, dilation, tol;
    bool force;
    bool staged; /* a stage is on */
    enum plant_books books;
    double si[MODEL_PARAMETERS];
    double p[MODEL_DERIVED];
    struct scale scale;       /* dilated */
    double h, ticks_per_time; /* model time per tick, and its inverse */
    struct instant now;
    unsigned regime; /* bit i: contact i closed */
    double x[MODEL_STATES];
    struct drive drive[MODEL_INPUTS];
    unsigned awake;         /* bit i: drive i has not been seen silent since it was last told something */
    struct segment segment; /* the current one */
    struct ledger ledger;
    double peak_force; /* since the last touchdown, model units */
    double loss_time; /* model time with every contact open, in this record; 0 for a model without contacts */
    double total_time; /* model time in this record */
    struct event event[PLANT_EVENTS];
    uint32_t event_head, n_event;
    struct plant_counts counts;
};

/* Everything from a configuration. NULL, or the reason for a refusal (then *pl is not to be used). */
MUST_CHECK const char *plant_init(struct plant *pl, const struct plant_config *c);

/* SI parameters against their ranges and each other: NULL, or a reason. *which is the parameter's index or -1. */
MUST_CHECK const char *plant_check(const struct model *m, const double *si, int *which);

/* Would plant_change take these? NULL, or the reason. */
MUST_CHECK const char *plant_accepts(const struct plant *pl, const double *si);

/* New SI parameters now: position and velocity in metres and metres per second go on, the change of stored energy is
 * booked as work of the parameter change. NULL, or the reason for a refusal that changed nothing. */
MUST_CHECK const char *plant_change(struct plant *pl, const double *si);

/* Would plant_promote go to this model from these parameters? NULL, or the reason. */
MUST_CHECK const char *plant_could_climb(const struct plant *pl, const struct model *to, const double *si);

/* From a reduced model to the full model that it stands for, now: position and velocity in SI go on to the last bit (reduced and full model
 * have the same units), drives with their phase, SI parameters, tick and counts too; the regime follows from the gaps, the
 * method prepares itself for the new model, and the difference in stored energy is booked as plant_change books it. The
 * scratch memory must do for both models. Costs what plant_change costs. NULL, or the reason for a refusal that changed nothing. */
MUST_CHECK const char *plant_promote(struct plant *pl, const struct model *to);

/* A state of the caller's choice, model units; the regime follows from the gaps, the ledger starts anew. */
void plant_set_state(struct plant *pl, const double *x);

/* The regime that follows from state, inputs and parameters: a contact is closed where its gap is negative. */
void plant_find_regime(struct plant *pl);

/* State to rest, drives silent, ledger anew; the tick goes on. */
void plant_reset(struct plant *pl);

/* To the given instant; ticks end exactly. False when the state left the finite numbers: then time and state
 * stand at the last good instant (the drives at the end of the segment that was refused). */
MUST_CHECK bool plant_advance(struct plant *pl, struct instant to);

/* Whole ticks from now on: plant_advance for those who count. */
MUST_CHECK bool plant_run(struct plant *pl, uint64_t ticks);

/* Looks at a plant at the end of a tick: at its state, inputs, phasors, regime, events and tick. Its times may
 * stand earlier. */
typedef void plant_look(void *who, const struct plant *pl);

/* plant_run from the start of a tick, for those who look at every tick: calls look(who, pl) at the end of each. */
MUST_CHECK bool plant_run_seen(struct plant *pl, uint64_t ticks, plant_look *look, void *who);

/* Drive i, to tell it something: a drive that was seen silent is passed by in each tick until this is called. */
static inline struct drive *plant_touch_drive(struct plant *pl, int i)
{
    pl->awake |= 1u << i;
    return &pl->drive[i];
}

/* What can be set of a drive, in SI (bus units): V is the input's unit. */
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

/* Drive i goes to new values: bit f of `given` for each field f that changes, the others stay. Without DRIVE_RAMP a ramp
 * that runs goes on in the time it has left. */
void plant_set_drive(struct plant *pl, int i, unsigned given, const double *value);

/* Every drive and sample that sounds goes to zero over ramp_s, or one tick; counted in counts.changes. */
void plant_drives_to_zero(struct plant *pl, double ramp_s);

/* Drive i in SI (bus units): amplitude, Hz (at least 0, below half the tick rate; DRIVE_TICKS_MIN a period and more are sound),
 * rad, and a ramp in s (at least 0); see drive.h. start: now and without a ramp. */
void plant_drive(struct plant *pl, int i, double amplitude, double frequency_Hz, double phase_rad,
                 double ramp_s);
void plant_drive_start(struct plant *pl, int i, double amplitude, double frequency_Hz, double phase_rad);

/* Noise of input i (firmware/plant/noise.h): standard deviation in SI (at least 0), hold in ticks, seed, and a ramp in s (at
 * least 0), which the harmonic drive shares. */
void plant_noise(struct plant *pl, int i, double deviation, uint32_t hold, uint32_t seed, double ramp_s);

/* Sampled command of input i in SI: jumps now (ticks 0) or moves there over whole ticks. The base
 * never jumps: 0 counts as 1 tick. */
void plant_sample(struct plant *pl, int i, double value, uint64_t ticks);

/* Outputs now, SI, in the order of the model's output table. */
void plant_output(const struct plant *pl, double *output);

/* The value of output `name` now, SI; NaN when the model has no such output. Where a stage is on, stage_0 to stage_3 are
 * their results at the end of the last tick; of one that is off 0. */
double plant_read(const struct plant *pl, const char *name);

/* Takes the oldest event; false when there is none. */
bool plant_take_event(struct plant *pl, struct event *e);

/* Begins a new record: no event is kept, loss_time and total_time are 0. */
void plant_begin_record(struct plant *pl);

/* Stored energy now, and what the ledger cannot account for; J. */
double plant_energy(const struct plant *pl);
double plant_residual(const struct plant *pl);

/* The energy that did not balance since the last call, over all that flowed since then and swings. Not counted: what the
 * rounding of the stored energy may be, and what a method may do that errs by the tolerance of the largest motion so far.
 * *residual_J is the residual then, and now. */
double plant_imbalance(struct plant *pl, double *residual_J);

/* FNV-1a over the bits of tick, regime, parameters, state, drives and ledger, in a fixed order. */
uint64_t plant_hash(const struct plant *pl);

/* Seconds of bus time: tick * tick_s, computed. */
double plant_time(const struct plant *pl);

/* -1, 0, 1 as a is before, at or after b. */
int instant_compare(struct instant a, struct instant b);

#endif
