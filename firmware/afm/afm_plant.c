/* afm_plant.c - see afm_plant.h. */
#include "firmware/afm/afm_plant.h"

#include <string.h>
#include "firmware/afm/codes.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "firmware/stage/stages.h"
#include "models/math/elementary.h"

/* The plant's scratch memory, and what it has in the place of stages. */
struct afm {
    struct station station;
    struct stage piezo, sensor;
    bool begun;                      /* else nothing runs */
    double h;                        /* model time of a plant's tick */
    double si[AFM_PLANT_PARAMETERS]; /* in force */
    double stage[STAGE_SLOTS * STAGE_SETTINGS + 1];
    struct method_books books;
    uint32_t period, in_period;   /* samples in a period of the lever, and those of this one */
    double peak_N, peak_before_N; /* largest contact force in this period, and the one before */
    double cycle[STAGE_SLOTS];    /* last one of peak force, SI, in the place of results of stages */
};
STATIC_ASSERT(sizeof(struct afm) <= METHOD_SCRATCH * sizeof(double), an_afm_fits);
STATIC_ASSERT((int)AFM_PLANT_PARAMETERS <= (int)MODEL_PARAMETERS, its_parameters_fit);

/* Prepared numbers beside the lever's. */
enum { STATES = AFM_PLANT_CRASHES + 1 };
#define GIGA 1e9 /* a state stays small */

enum { P_TICKS = LEVER_DERIVED, P_TONE, P_SWINGS, P_NUMBERS };
STATIC_ASSERT((int)P_NUMBERS <= (int)MODEL_DERIVED, its_numbers_fit);

static const struct parameter parameters[AFM_PLANT_PARAMETERS] = {
    LEVER_ROWS,
    STATION_ROWS,
    {"scan", "1", 0.0, 1.0, 0.0, "1: an image begins, 0: it ends"},
    {"ramp_speed_m_per_s", "m/s", 0.0, 1.0, 0.0, "an approach begins with this speed; 0: it turns back"},
    {"ramp_dwell_s", "s", 0.0, 1e3, 0.0, "of an approach, at its turn"},
    CODES_ROW_DITHER,
    CODES_ROW_Z,
    CODES_ROW_DEFLECTION,
};

static const struct signal inputs[AFM_PLANT_INPUTS] = {
    {"force", "N", "on the tip, beside the tones", QUANTITY_FORCE, NULL},
    {"z", "m", "of the base, where no loop or approach sets it", QUANTITY_LENGTH, NULL},
    {"x", "m", "place over the surface, where no image does", QUANTITY_LENGTH, NULL},
    {"y", "m", "the same along y", QUANTITY_LENGTH, NULL},
};

static const struct signal outputs[AFM_PLANT_OUTPUTS] = {
    {"displacement", "m", "deflection of the lever, as the sensor reads it", QUANTITY_LENGTH, NULL},
    {"velocity", "m/s", "of the tip against the base", QUANTITY_VELOCITY, NULL},
    {"penetration", "m", "indentation of the sample, 0 apart", QUANTITY_LENGTH, NULL},
    {"contact_force", "N", "largest of the last one to two periods of the lever; 0: open", QUANTITY_FORCE,
     NULL},
    {"amplitude", "m", "of the first tone, by the station's lock-in", QUANTITY_LENGTH, NULL},
    {"phase", "deg", "its phase; -90 at the free resonance", QUANTITY_RATIO, NULL},
    {"height", "m", "true place of the base over its start", QUANTITY_LENGTH, NULL},
    {"error", "m", "of the z loop: how much the tip is too far away", QUANTITY_LENGTH, NULL},
    {"frequency_shift", "Hz", "of the tone, from f0 of the lever", QUANTITY_FREQUENCY, NULL},
    {"crashes", "1", "so far", QUANTITY_RATIO, NULL},
    {"adhesion", "N", "of the last cycle of peak_force, 0: not found", QUANTITY_FORCE, NULL},
    {"modulus", "Pa", "of the last cycle of peak_force, 0: not found", QUANTITY_RATIO, NULL},
};

/* ---- the model ---- */

static struct station_config config_of(const double *si)
{
    return (struct station_config){.si = si, .number = si + AFM_PLANT_NUMBERS};
}

/* The lever over a surface that is so high where it begins, with one of its materials. */
static const char *check_lever(const double *si, double surface_m, int *which)
{
    double lower[LEVER_PARAMETERS];
    memcpy(lower, si, sizeof lower);
    lower[LEVER_HEIGHT] -= surface_m;
    const char *why = plant_check(&afm_lever, lower, which);
    if (why && *which < 0)
        *which = LEVER_HEIGHT;
    return why;
}

/* The force for 1 V of dither: at its resonance the free lever moves by the gain. */
static double dither_N_per_V(const double *si)
{
    return si[AFM_PLANT_DITHER_GAIN] * (si[LEVER_K] / si[LEVER_Q]);
}

/* No code moves an input further than a drive can. */
static const char *check_codes(const double *si, int *which)
{
    const double most_V = 32768.0 * CODES_VOLT;
    double p[MODEL_DERIVED];
    struct scale s;
    afm_lever.prepare(si, p, &s);
    *which = AFM_PLANT_DITHER_GAIN;
    if (dither_N_per_V(si) * most_V > DRIVE_LIMIT * s.force_N)
        return "is too large for this lever: give less, or a larger range_m";
    *which = AFM_PLANT_Z_GAIN;
    if (si[AFM_PLANT_Z_GAIN] * most_V > DRIVE_LIMIT * s.length_m)
        return "is too large for range_m: give less, or a larger range_m";
    return NULL;
}

const char *afm_plant_check(const double *si, int *which)
{
    struct station_config c = config_of(si);
    struct surface s;
    double second[LEVER_PARAMETERS];
    const char *why = station_check(&c, which);
    *which += AFM_PLANT_NUMBERS;
    if (why)
        return why;
    *which = -1;
    why = afm_lever.check(si);
    if (!why && station_second(&c, second)) {
        *which = AFM_PLANT_NUMBERS + STATION_MAP;
        why = afm_lever.check(second);
    }
    if (why)
        return why;
    *which = AFM_PLANT_SCAN;
    if (si[AFM_PLANT_SCAN] != 0.0 && si[AFM_PLANT_SCAN] != 1.0)
        return "must be 0 or 1";
    why = check_codes(si, which);
    if (why)
        return why;
    station_surface(&s, &c);
    return check_lever(si, surface_height(&s, 0.0, 0.0), which);
}

static const char *check(const double *si)
{
    int which;
    return afm_plant_check(si, &which);
}

/* The lever over its stiffer material, which the step must bear; and the station's sample. */
static void prepare(const double *si, double *p, struct scale *scale)
{
    struct station_config c = config_of(si);
    double second[LEVER_PARAMETERS], q[MODEL_DERIVED] = {0.0};
    struct modal_form f, g;
    const double *n = c.number;
    afm_lever.prepare(si, p, scale);
    if (station_second(&c, second)) {
        struct scale same;
        afm_lever.prepare(second, q, &same);
        afm_lever.modal_form(p, &f);
        afm_lever.modal_form(q, &g);
        if (g.stiffest > f.stiffest)
            memcpy(p, q, LEVER_DERIVED * sizeof *p);
    }
    double tone = n[STATION_FREQUENCY] > 0.0 ? n[STATION_FREQUENCY] : si[LEVER_F0];
    p[P_TICKS] = n[STATION_TICKS];
    p[P_SWINGS] = station_swings(n);
    p[P_TONE] = n[STATION_DRIVE] > 0.0 && !station_swings(n)
                    ? (tone + n[STATION_DART_DISTANCE]) * scale->time_s
                    : 0.0;
}

static void rest(const double *p, double *x)
{
    (void)p;
    memset(x, 0, STATES * sizeof *x);
}

static double eigenfrequency(const double *p)
{
    return afm_lever.eigenfrequency(p);
}

static void gap(const double *p, const struct input *u, const double *x, struct input *g)
{
    (void)p, (void)u;
    *g = (struct input){-x[AFM_PLANT_CONTACT_FORCE], 0.0};
}

static double energy(const double *p, const struct input *u, const double *x)
{
    (void)p, (void)u, (void)x;
    return 0.0;
}

/* A state is what a reading has in model units. Without a tone, amplitude and phase have the place of
 * adhesion and modulus: a swing of z has no tone. */
static void output(const double *p, const struct input *u, const double *x, double *value)
{
    (void)u;
    memcpy(value, x, STATES * sizeof *x);
    value[AFM_PLANT_ADHESION] = value[AFM_PLANT_MODULUS] = 0.0;
    if (p[P_SWINGS] == 0.0)
        return;
    value[AFM_PLANT_ADHESION] = x[AFM_PLANT_AMPLITUDE];
    value[AFM_PLANT_MODULUS] = x[AFM_PLANT_PHASE] * GIGA;
    value[AFM_PLANT_AMPLITUDE] = value[AFM_PLANT_PHASE] = 0.0;
}

static const int side[] = {-1};

const struct model afm_plant = {
    .name = "microscope",
    .title = "a whole AFM: lever, sample, lock-ins, loops, raster and approach (docs/guide/afm_bus.md)",
    .n_states = STATES,
    .n_inputs = AFM_PLANT_INPUTS,
    .n_outputs = AFM_PLANT_OUTPUTS,
    .n_contacts = 1,
    .n_parameters = AFM_PLANT_PARAMETERS,
    .state_signal = outputs,
    .input_signal = inputs,
    .output_signal = outputs,
    .contact_side = side,
    .parameter = parameters,
    .check = check,
    .prepare = prepare,
    .rest = rest,
    .eigenfrequency = eigenfrequency,
    .gap = gap,
    .energy = energy,
    .output = output,
};

/* ---- one sample ---- */

const struct station *afm_plant_station(const double *scratch)
{
    return &((const struct afm *)(const void *)scratch)->station;
}

/* The largest contact force of this period and the one before. */
static double recent_force(struct afm *a, double force_N)
{
    if (force_N > a->peak_N)
        a->peak_N = force_N;
    double largest = a->peak_N > a->peak_before_N ? a->peak_N : a->peak_before_N;
    if (++a->in_period >= a->period) {
        a->in_period = 0;
        a->peak_before_N = a->peak_N;
        a->peak_N = 0.0;
    }
    return largest;
}

/* Amplitude and phase of the tone, or what the last cycle of a swing says. */
static void read_tone(struct afm *a, double each, double *x)
{
    const struct station *s = &a->station;
    const struct force_cycle *c = &s->swing.cycle;
    memset(a->cycle, 0, sizeof a->cycle);
    if (station_swings(s->number)) {
        const double cycle[STAGE_SLOTS] = {c->snap_in_N, c->baseline_N, c->deformation_m, c->work_J};
        memcpy(a->cycle, cycle, sizeof cycle);
        x[AFM_PLANT_AMPLITUDE] = c->adhesion_N / s->microscope.force_N;
        x[AFM_PLANT_PHASE] = c->fitted ? c->modulus_Pa / GIGA : 0.0;
        return;
    }
    x[AFM_PLANT_AMPLITUDE] = s->lockin[0].amplitude * each;
    x[AFM_PLANT_PHASE] = demodulator_phase(&s->lockin[0]) * (180.0 / ELEMENTARY_PI);
}

/* The readings after a sample, model units. */
static void read(struct afm *a, double force_N, double *x)
{
    const struct station *s = &a->station;
    const struct microscope *m = &s->microscope;
    const struct input u[MODEL_INPUTS] = {[LEVER_Z] = m->base};
    double lever[MODEL_OUTPUTS], each = 1.0 / m->length_m;
    afm_lever.output(m->p[m->material], u, m->x, lever);
    x[AFM_PLANT_DISPLACEMENT] = s->out.deflection_m * each;
    x[AFM_PLANT_VELOCITY] = lever[AFM_PLANT_VELOCITY];
    x[AFM_PLANT_PENETRATION] = lever[AFM_PLANT_PENETRATION];
    x[AFM_PLANT_CONTACT_FORCE] = force_N / m->force_N;
    read_tone(a, each, x);
    x[AFM_PLANT_HEIGHT] = s->out.z_m * each;
    x[AFM_PLANT_ERROR] = s->error_m * each;
    x[AFM_PLANT_SHIFT] = (s->frequency_Hz - s->f0_Hz) / s->f0_Hz; /* 1/w1 is the unit of time */
    x[AFM_PLANT_CRASHES] = m->n_crashes;
}

static void run_stage(void *stage, double *value, uint32_t n)
{
    stage_run_many(stage, value, n);
}

/* All pointers: this memory may have been moved, or come back from bytes. */
static void find_pointers(struct afm *a)
{
    struct microscope *m = &a->station.microscope;
    m->piezo = (struct microscope_stage){a->piezo.n > 0 ? run_stage : NULL, &a->piezo};
    m->sensor = (struct microscope_stage){a->sensor.n > 0 ? run_stage : NULL, &a->sensor};
}

void afm_plant_forget_pointers(double *scratch)
{
    struct microscope *m = &((struct afm *)(void *)scratch)->station.microscope;
    m->piezo = m->sensor = (struct microscope_stage){NULL, NULL};
}

static bool run_sample(struct afm *a, const struct segment *e, double *x)
{
    const struct microscope *m = &a->station.microscope;
    const struct microscope_in in = {.force_N = e->at[0][AFM_PLANT_FORCE].value * m->force_N,
                                     .z_m = e->at[2][AFM_PLANT_Z].value * m->length_m,
                                     .x_m = e->at[2][AFM_PLANT_X].value * m->length_m,
                                     .y_m = e->at[2][AFM_PLANT_Y].value * m->length_m};
    find_pointers(a);
    if (!station_run(&a->station, &in))
        return false;
    a->books.force = a->station.out.peak_N / m->force_N;
    read(a, recent_force(a, a->station.out.peak_N), x);
    return true;
}

/* ---- the method ---- */

static size_t n_scratch(const struct model *m)
{
    (void)m;
    return (sizeof(struct afm) + sizeof(double) - 1) / sizeof(double);
}

static const char *refuse(const struct model *m, const double *p, double h, double tol)
{
    if (m->rhs)
        return "this method is a microscope's own; take auto";
    if (p[P_TONE] * h > 0.25 * (1.0 + 1e-12)) /* a station takes a little more: it rounds otherwise */
        return "the tone has fewer than 4 samples in a period: give more substeps";
    if (p[P_SWINGS] > 0.0 && h * PEAK_FORCE_PERIOD_MIN > 2.0 * ELEMENTARY_PI * (1.0 + 1e-9))
        return "a period of the lever has fewer than 32 samples, too few for peak_force: give more substeps";
    return modal.refuse(&afm_lever, p, h / p[P_TICKS], tol);
}

static void keep_step(const struct model *m, const double *p, double h, double tol, double *scratch)
{
    (void)m, (void)p, (void)tol;
    ((struct afm *)(void *)scratch)->h = h;
}

/* A segment that ends with its tick is a sample, a shorter one only waits for that. */
static enum step_status step(const struct model *m, const double *p, double *scratch, const struct segment *e,
                             unsigned regime, double *x, struct crossing *c)
{
    struct afm *a = (struct afm *)(void *)scratch;
    (void)m, (void)p;
    double end = (double)(e->instant % TICK_FRACTIONS) / TICK_FRACTIONS + e->length / a->h;
    if (e->length == 0.0 || end < 1.0 - 0.5 / TICK_FRACTIONS)
        return STEP_END;
    if (!a->begun || !run_sample(a, e, x))
        return STEP_NOT_FINITE;
    bool closed = x[AFM_PLANT_CONTACT_FORCE] > 0.0;
    if (regime & REGIME_ANY || closed == (regime & 1u))
        return STEP_END;
    *c = (struct crossing){.done = e->length};
    return STEP_SWITCH;
}

static step_function *bind(const struct model *m)
{
    (void)m;
    return step;
}

static const struct method_books *books(const double *scratch)
{
    return &((const struct afm *)(const void *)scratch)->books;
}

const struct method afm_plant_method = {
    .name = "modal",
    .title = "a microscope's own",
    .n_scratch = n_scratch,
    .refuse = refuse,
    .prepare = keep_step,
    .bind = bind,
    .books = books,
};

/* ---- the calls: what the app changes ---- */

static struct afm *of(struct stages *s)
{
    return (struct afm *)(void *)s;
}

static bool acts(const double *own)
{
    return (int)own[STAGE_AT] == 1 + AFM_PLANT_Z;
}

/* The stages that are on. */
static void build_stages(struct afm *a, double tick_s)
{
    double seed = a->stage[STAGE_SLOTS * STAGE_SETTINGS];
    a->piezo.n = a->sensor.n = 0;
    for (int i = 0; i < STAGE_SLOTS; i++) {
        const double *own = &a->stage[STAGE_SETTINGS * i];
        if (own[STAGE_AT] == 0.0)
            continue;
        const char *why = stages_build(acts(own) ? &a->piezo : &a->sensor, tick_s, seed, i, own);
        ASSERT(!why); /* `refuse_stages` has asked */
    }
}

/* An image or an approach begins or ends. */
static void follow_recipe(struct afm *a, const double *was)
{
    const double *now = a->si;
    struct ramp *r = &a->station.ramp;
    if (now[AFM_PLANT_SCAN] > was[AFM_PLANT_SCAN])
        station_begin_scan(&a->station);
    else if (now[AFM_PLANT_SCAN] < was[AFM_PLANT_SCAN])
        a->station.scans = false;
    if (now[AFM_PLANT_RAMP_SPEED] > 0.0 && was[AFM_PLANT_RAMP_SPEED] == 0.0)
        station_begin_ramp(&a->station, now[AFM_PLANT_RAMP_SPEED], now[AFM_PLANT_RAMP_DWELL]);
    else if (now[AFM_PLANT_RAMP_SPEED] > 0.0)
        r->speed_m_per_s = now[AFM_PLANT_RAMP_SPEED];
    else if (r->phase != RAMP_OFF)
        r->phase = RAMP_OUT;
    r->dwell_s = now[AFM_PLANT_RAMP_DWELL];
}

/* The fewest samples that are longer than a period of the lever, or of a swing. */
static uint32_t samples_of(const struct station *s)
{
    double samples = station_swings(s->number) ? s->swing.samples : 1.0 / (s->f0_Hz * s->sample_s);
    return samples < 4e9 ? (uint32_t)samples + 1 : 4000000000u;
}

/* The instrument at rest at these places, with the plant's parameters. */
static void begin(struct afm *a, struct plant *pl, struct microscope_in at)
{
    static const double none[AFM_PLANT_PARAMETERS] = {0.0};
    memcpy(a->si, pl->si, sizeof a->si);
    struct station_config c = config_of(a->si);
    c.tick_s = pl->tick_s / pl->dilation / c.number[STATION_TICKS];
    build_stages(a, c.tick_s);
    stage_settle(&a->piezo, at.z_m, 0);
    c.at = at;
    c.z_m = a->piezo.result;
    a->begun = !station_init(&a->station, &c); /* model and method have accepted it */
    if (!a->begun)
        return;
    a->period = samples_of(&a->station);
    a->in_period = 0;
    a->peak_N = a->peak_before_N = 0.0;
    follow_recipe(a, none);
    read(a, 0.0, pl->x);
}

static bool equal(const double *a, const double *b, int n)
{
    for (int i = 0; i < n; i++)
        if (a[i] != b[i])
            return false;
    return true;
}

/* Numbers of the station that may change while it runs. */
static void change_numbers(struct afm *a, const struct plant *pl)
{
    double was[AFM_PLANT_PARAMETERS];
    int which;
    memcpy(was, a->si, sizeof was);
    memcpy(a->si, pl->si, sizeof a->si);
    struct station_config c = config_of(a->si);
    c.tick_s = a->station.microscope.tick_s;
    const char *why = station_change(&a->station, &c, &which);
    ASSERT(!why); /* model and method have accepted it */
    a->period = samples_of(&a->station);
    follow_recipe(a, was);
}

/* Settings of stages that are off, and a seed that none has, make no difference. */
static bool equal_stages(const double *a, const double *b)
{
    enum { SEED = STAGE_SLOTS * STAGE_SETTINGS };
    bool on = false;
    for (int i = 0; i < SEED; i += STAGE_SETTINGS) {
        bool here = a[i + STAGE_AT] != 0.0 || b[i + STAGE_AT] != 0.0;
        if (here && !equal(&a[i], &b[i], STAGE_SETTINGS))
            return false;
        on |= here;
    }
    return !on || a[SEED] == b[SEED];
}

static void change(struct stages *s, struct plant *pl, const double *setting)
{
    struct afm *a = of(s);
    double stage[STAGE_SLOTS * STAGE_SETTINGS + 1];
    memcpy(stage, &setting[SET_STAGE], sizeof stage - sizeof *stage);
    stage[STAGE_SLOTS * STAGE_SETTINGS] = setting[SET_SENSOR_SEED];
    bool another = !pl->staged || !equal_stages(stage, a->stage) || !equal(pl->si, a->si, LEVER_PARAMETERS) ||
                   station_fixed(&a->station, pl->si + AFM_PLANT_NUMBERS) >= 0;
    pl->staged = true;
    memcpy(a->stage, stage, sizeof stage);
    if (another)
        begin(a, pl, a->station.in);
    else if (!equal(pl->si, a->si, AFM_PLANT_PARAMETERS))
        change_numbers(a, pl);
    plant_find_regime(pl);
}

static const char *refuse_stages(const struct model *m, double tick_s, const double *setting)
{
    for (int i = 0; i < STAGE_SLOTS; i++) {
        const double *own = &setting[SET_STAGE + STAGE_SETTINGS * i];
        if (own[STAGE_AT] > 0.0 && !acts(own) &&
            (int)own[STAGE_AT] != 1 + MODEL_INPUTS + AFM_PLANT_DISPLACEMENT)
            return "stage: a microscope has one at z, its piezo, and one at displacement, its sensor";
    }
    /* a stage runs with the lever's ticks */
    return stages_for_plants.refuse(m, tick_s / MICROSCOPE_TICKS_MAX, setting);
}

static void clear(struct stages *s)
{
    memset(of(s), 0, sizeof(struct afm));
}

static void settle(struct stages *s, struct plant *pl)
{
    begin(of(s), pl, (struct microscope_in){.z_m = 0.0});
}

static bool act(struct stages *s, struct plant *pl, uint32_t length)
{
    (void)s, (void)pl, (void)length;
    return true;
}

static void sense(struct stages *s, struct plant *pl)
{
    (void)s, (void)pl;
}

static const double *results(const struct stages *s)
{
    return ((const struct afm *)(const void *)s)->cycle;
}

static void replace(const struct stages *s, double *value)
{
    (void)s, (void)value;
}

static uint64_t hash(const struct stages *s, uint64_t from)
{
    return station_hash(&((const struct afm *)(const void *)s)->station, from);
}

static void dac(struct plant *pl, const int16_t *code)
{
    uint32_t clipped = 0; /* 16 bits always fit */
    double dither_V = codes_to_volt(code[0], &clipped), z_V = codes_to_volt(code[1], &clipped);
    plant_sample(pl, AFM_PLANT_FORCE, dither_N_per_V(pl->si) * dither_V, 0);
    plant_sample(pl, AFM_PLANT_Z, pl->si[AFM_PLANT_Z_GAIN] * z_V, 1);
}

/* A reading beyond the range of the converter stays at its end. */
static void adc(const struct plant *pl, int16_t *code)
{
    uint32_t clipped = 0;
    double value[MODEL_OUTPUTS];
    plant_output(pl, value);
    code[0] =
        (int16_t)codes_of_volt(value[AFM_PLANT_DISPLACEMENT] / pl->si[AFM_PLANT_DEFLECTION_GAIN], &clipped);
    code[1] = (int16_t)codes_of_volt(value[AFM_PLANT_HEIGHT] / pl->si[AFM_PLANT_Z_GAIN], &clipped);
}

const struct plant_stage_calls afm_plant_calls = {clear, settle,        act,    sense, results, replace,
                                                  hash,  refuse_stages, change, dac,   adc};

void afm_plant_settings(double *setting)
{
    static const int sent[LOCKIN_SLOTS] = {AFM_PLANT_AMPLITUDE, AFM_PLANT_PHASE, AFM_PLANT_HEIGHT,
                                           AFM_PLANT_SHIFT};
    for (int i = AFM_PLANT_Z; i <= AFM_PLANT_Y; i++)
        setting[SET_STREAM_LINEAR + i] = 1.0;
    setting[SET_LOCKIN_FRAMES] = 1.0;
    for (int i = 0; i < LOCKIN_SLOTS; i++) {
        setting[SET_LOCKIN_CHANNEL + i] = 0.0;
        setting[SET_LOCKIN_HARMONIC + i] = 0.0;
        setting[SET_LOCKIN_OUTPUT + i] = sent[i];
    }
}
