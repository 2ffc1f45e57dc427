/* stages.c - see stages.h. */
#include "firmware/stage/stages.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/hash.h"
#include "firmware/plant/plant_report.h"
#include "models/math/elementary.h"

/* ---- settings ---- */

static int place(const double *own)
{
    return (int)own[STAGE_AT];
}

/* The elements of one stage from its settings; returns their number. */
static int list_parts(const double *own, struct stage_part *part)
{
    static const struct {
        enum stage_setting a, b;
        enum stage_kind kind;
    } order[] = {
        {STAGE_SET_SLEW, STAGE_SET_SLEW, STAGE_SLEW},
        {STAGE_SET_RANGE, STAGE_SET_SHARE, STAGE_HYSTERESIS},
        {STAGE_SET_CREEP, STAGE_SET_CREEP, STAGE_CREEP},
        {STAGE_SET_RESONANCE, STAGE_SET_DAMPING, STAGE_RESONANCE},
        {STAGE_SET_NOISE, STAGE_SET_NOISE, STAGE_NOISE},
        {STAGE_SET_CORNER, STAGE_SET_NOISE, STAGE_FLICKER},
        {STAGE_SET_DRIFT, STAGE_SET_DRIFT, STAGE_DRIFT},
        {STAGE_SET_LAG, STAGE_SET_LAG, STAGE_LAG},
        {STAGE_SET_CLIP, STAGE_SET_CLIP, STAGE_CLIP},
        {STAGE_SET_QUANTUM, STAGE_SET_QUANTUM, STAGE_QUANTISER},
        {STAGE_SET_DELAY, STAGE_SET_DELAY, STAGE_DELAY},
    };
    int n = 0;
    part[n++] = (struct stage_part){STAGE_GAIN, own[STAGE_SET_GAIN], 0.0};
    for (unsigned i = 0; i < sizeof order / sizeof order[0]; i++)
        if (own[order[i].a] != 0.0)
            part[n++] = (struct stage_part){order[i].kind, own[order[i].a],
                                            order[i].b != order[i].a ? own[order[i].b] : 0.0};
    return n;
}

const char *stages_build(struct stage *s, double tick_s, double seed, int slot, const double *own)
{
    struct stage_part part[STAGE_PARTS];
    int n = list_parts(own, part);
    return stage_init(s, tick_s, (uint32_t)slot << 16 | (uint32_t)(int)seed, part, n);
}

static const char *refuse(const struct model *m, double tick_s, const double *setting)
{
    struct stage_part part[STAGE_PARTS];
    for (int i = 0; i < STAGE_SLOTS; i++) {
        const double *own = &setting[SET_STAGE + STAGE_SETTINGS * i];
        int at = place(own);
        if (at == 0)
            continue;
        if (at <= MODEL_INPUTS ? at > m->n_inputs : at - MODEL_INPUTS > m->n_outputs)
            return at <= MODEL_INPUTS ? "stage: the model has fewer inputs"
                                      : "stage: the model has fewer outputs";
        for (int k = 0; k < i; k++)
            if (place(&setting[SET_STAGE + STAGE_SETTINGS * k]) == at)
                return "stage: two stages at one signal; switch one of them off";
        const char *why = stage_refuse(tick_s, part, list_parts(own, part));
        if (why)
            return why;
    }
    return NULL;
}

/* ---- signals ---- */

static double input_unit(const struct plant *pl, int i)
{
    return scale_of(&pl->scale, pl->model->input_signal[i].quantity);
}

/* The drive now, model units. */
static double drive_now(const struct drive *d)
{
    double cosine, sine;
    if (!drive_active(d))
        return 0.0;
    cos_sin_turns(d->carrier + d->offset, &cosine, &sine);
    return d->sample + d->amplitude * cosine + (d->noise.active ? d->noise.value : 0.0);
}

/* Stage i begins anew where its signal is now. */
static void settle_one(struct stages *s, int i, const struct plant *pl, const double *output)
{
    int at = place(&s->setting[STAGE_SETTINGS * i]);
    bool acts = at <= MODEL_INPUTS;
    double signal =
        acts ? drive_now(&pl->drive[at - 1]) * input_unit(pl, at - 1) : output[at - 1 - MODEL_INPUTS];
    stage_settle(&s->stage[i], signal, pl->now.tick);
    s->from[i] = s->result[i] = s->stage[i].result;
}

/* The input behind actuator i has its result. */
static void give(const struct stages *s, int i, struct plant *pl)
{
    int input = place(&s->setting[STAGE_SETTINGS * i]) - 1;
    if (input >= MODEL_INPUTS)
        return;
    pl->segment.at[2][input] = (struct input){s->result[i] / input_unit(pl, input), 0.0};
    pl->segment.active |= 1u << input;
}

/* The stages of these bits. Actuators first: outputs follow from inputs. */
static void settle_some(struct stages *s, struct plant *pl, unsigned some)
{
    double output[MODEL_OUTPUTS] = {0.0};
    for (int pass = 0; pass < 2; pass++) {
        if (pass == 1)
            plant_output(pl, output);
        for (int i = 0; i < STAGE_SLOTS; i++) {
            int at = place(&s->setting[STAGE_SETTINGS * i]);
            if (at == 0 || (at > MODEL_INPUTS) != (pass == 1))
                continue;
            if ((some >> i) & 1u)
                settle_one(s, i, pl, output);
            give(s, i, pl);
        }
    }
}

static void settle(struct stages *s, struct plant *pl)
{
    settle_some(s, pl, (1u << STAGE_SLOTS) - 1u);
}

/* The input of a segment on the line from the result before to the one now. */
static void lead(const struct stages *s, int i, struct plant *pl, int input, uint32_t length)
{
    struct segment *e = &pl->segment;
    double unit = input_unit(pl, input), begin = (double)pl->now.fraction / TICK_FRACTIONS;
    double rise = (s->result[i] - s->from[i]) / unit, first = s->from[i] / unit + rise * begin;
    double last = first + rise * ((double)length / TICK_FRACTIONS), slope = rise * pl->ticks_per_time;
    e->wave[input] = (struct wave){.cosine = 1.0, .offset = first, .slope = slope};
    e->at[0][input] = (struct input){first, slope};
    e->at[1][input] = (struct input){0.5 * (first + last), slope};
    e->at[2][input] = (struct input){last, slope};
    e->active |= 1u << input;
    e->changed = true;
}

/* A new tick of the actuator before an input that excite
 * has just filled in. False: beyond what a model bears. */
static bool run_actuator(struct stages *s, int i, const struct plant *pl, int input)
{
    bool sounds = ((pl->awake >> input) & 1u) != 0;
    double unit = input_unit(pl, input), signal = sounds ? pl->segment.at[0][input].value * unit : 0.0;
    double result = stage_run(&s->stage[i], signal);
    bool good = fabs(result) <= DRIVE_LIMIT * unit;
    s->from[i] = s->result[i];
    s->result[i] = good ? result : s->from[i];
    return good;
}

static bool act(struct stages *s, struct plant *pl, uint32_t length)
{
    bool good = true;
    for (int i = 0; i < STAGE_SLOTS; i++) {
        int at = place(&s->setting[STAGE_SETTINGS * i]), input = at - 1;
        if (at == 0 || at > MODEL_INPUTS)
            continue;
        if (pl->now.fraction == 0)
            good &= run_actuator(s, i, pl, input);
        lead(s, i, pl, input, length);
    }
    return good;
}

/* No tick is quiet: the next one must ask the stages, too. Without a sensor nobody asks for the outputs. */
static void sense(struct stages *s, struct plant *pl)
{
    double output[MODEL_OUTPUTS];
    bool known = false;
    for (int i = 0; i < STAGE_SLOTS; i++) {
        int at = place(&s->setting[STAGE_SETTINGS * i]);
        if (at <= MODEL_INPUTS)
            continue;
        if (!known)
            plant_output(pl, output);
        known = true;
        s->result[i] = stage_run(&s->stage[i], output[at - 1 - MODEL_INPUTS]);
    }
    pl->segment.changed = true;
}

/* ---- what others see ---- */

static const double *results(const struct stages *s)
{
    return s->result;
}

static void replace(const struct stages *s, double *output)
{
    for (int i = 0; i < STAGE_SLOTS; i++) {
        int at = place(&s->setting[STAGE_SETTINGS * i]);
        if (at > MODEL_INPUTS)
            output[at - 1 - MODEL_INPUTS] = s->result[i];
    }
}

static uint64_t hash(const struct stages *s, uint64_t hash)
{
    for (int i = 0; i < STAGE_SLOTS; i++)
        if (place(&s->setting[STAGE_SETTINGS * i]) > 0)
            hash = stage_hash(&s->stage[i], hash_double(hash, s->from[i]));
    return hash;
}

static bool equal(const double *a, const double *b, int n)
{
    for (int i = 0; i < n; i++)
        if (a[i] != b[i])
            return false;
    return true;
}

static void clear(struct stages *s)
{
    memset(s, 0, sizeof *s);
}

/* Inputs have their drives' own values again; excite must look at each of them. */
static void release(const struct stages *s, struct plant *pl)
{
    for (int i = 0; i < STAGE_SLOTS; i++) {
        int input = place(&s->setting[STAGE_SETTINGS * i]) - 1;
        if (input < 0 || input >= MODEL_INPUTS)
            continue;
        pl->segment.at[2][input] = (struct input){drive_now(plant_touch_drive(pl, input)), 0.0};
    }
    pl->segment.changed = true;
}

/* The settings in force become these. Returns the stages whose settings differ: bit i for stage i. */
static unsigned take(struct stages *s, const double *now)
{
    unsigned differs = 0;
    bool seed = now[STAGE_SLOTS * STAGE_SETTINGS] != s->setting[STAGE_SLOTS * STAGE_SETTINGS];
    for (int i = 0; i < STAGE_SLOTS; i++) {
        const double *own = &now[STAGE_SETTINGS * i];
        bool same = equal(own, &s->setting[STAGE_SETTINGS * i], STAGE_SETTINGS);
        differs |= (unsigned)(!same || (seed && place(own) > 0)) << i;
    }
    memcpy(s->setting, now, sizeof s->setting);
    return differs;
}

/* The stages of these bits begin anew. */
static void begin(struct stages *s, struct plant *pl, unsigned some)
{
    pl->staged = false;
    for (int i = 0; i < STAGE_SLOTS; i++) {
        const double *own = &s->setting[STAGE_SETTINGS * i];
        bool on = place(own) > 0;
        pl->staged |= on;
        if (!on)
            s->from[i] = s->result[i] = 0.0;
        if (!on || !((some >> i) & 1u))
            continue;
        const char *why = stages_build(&s->stage[i], pl->tick_s / pl->dilation,
                                       s->setting[STAGE_SLOTS * STAGE_SETTINGS], i, own);
        ASSERT(!why); /* `refuse` has asked */
    }
}

/* A change of settings may move an input: the difference
 * in stored energy is booked as that of a parameter. */
static void change(struct stages *s, struct plant *pl, const double *setting)
{
    double now[STAGE_SLOTS * STAGE_SETTINGS + 1], before = plant_energy(pl);
    memcpy(now, &setting[SET_STAGE], sizeof now - sizeof *now);
    now[STAGE_SLOTS * STAGE_SETTINGS] = setting[SET_SENSOR_SEED];
    if (equal(now, s->setting, STAGE_SLOTS * STAGE_SETTINGS + 1))
        return;
    release(s, pl);
    unsigned some = take(s, now);
    begin(s, pl, some);
    settle_some(s, pl, some);
    plant_find_regime(pl);
    ledger_rescale(&pl->ledger, 1.0, (plant_energy(pl) - before) / pl->scale.energy_J);
}

const struct plant_stage_calls stages_for_plants = {clear, settle, act,    sense, results, replace,
                                                    hash,  refuse, change, NULL,  NULL};
