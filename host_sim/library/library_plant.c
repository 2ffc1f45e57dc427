/* library_plant.c - a plant alone: what is done to its inputs and its time, and what it says. */
#include "host_sim/library/library_plant.h"

#include <math.h>
#include "firmware/plant/plant_report.h"

static const double ramp_max_s = 1e4, phase_max_rad = 1e6; /* as on the bus */

static double nan_of(struct contactplant *p, int code, const char *text, int index)
{
    (void)library_fail(&p->error, code, "%s %d of this plant", text, index);
    return (double)NAN;
}

bool library_is_input(struct contactplant *p, int input)
{
    const struct model *m = p->scene.config.model;
    if (input >= 0 && input < m->n_inputs)
        return true;
    (void)library_fail(&p->error, CONTACTPLANT_BAD_INDEX, "no input %d; %s has 0 to %d", input, m->name,
                       m->n_inputs - 1);
    return false;
}

/* A plant alone that may be changed; else a code is noted. */
static bool may_change(struct contactplant *p)
{
    if (!p->on_bus)
        return true;
    (void)library_fail(&p->error, CONTACTPLANT_BAD_ORDER,
                       "this plant is on a bus, where frames move it; contactplant_open gives a plant alone");
    return false;
}

static double input_unit(const struct contactplant *p, int input)
{
    return scale_of(&p->scene.app.plant.scale, p->scene.config.model->input_signal[input].quantity);
}

/* The handle is a plant alone that has this input; else the code. */
static int begin_alone(struct contactplant *p, int input)
{
    if (!library_is_plant(p))
        return CONTACTPLANT_BAD_HANDLE;
    if (!may_change(p) || !library_is_input(p, input))
        return p->error.code;
    return CONTACTPLANT_OK;
}

/* A value of a drive inside its range; NaN is none where it may be left out. */
static int check(struct contactplant *p, const char *name, double value, double min, double max)
{
    if (value >= min && value <= max)
        return CONTACTPLANT_OK;
    return library_fail(&p->error, CONTACTPLANT_BAD_VALUE, "%s %g is out of range; give %g to %g", name,
                        value, min, max);
}

/* ---- inputs ---- */

int contactplant_set_drive(struct contactplant *p, int input, double amplitude, double frequency_Hz,
                           double phase_rad, double ramp_s)
{
    int code = begin_alone(p, input);
    if (code != CONTACTPLANT_OK)
        return code;
    struct plant *pl = &p->scene.app.plant;
    const struct {
        const char *name;
        double value, min, max;
    } field[] = {
        [DRIVE_AMPLITUDE] = {"amplitude", amplitude, -DRIVE_LIMIT * input_unit(p, input),
                             DRIVE_LIMIT * input_unit(p, input)},
        [DRIVE_FREQUENCY] = {"frequency", frequency_Hz, 0.0, 1.0 / (DRIVE_TICKS_MIN * pl->tick_s)},
        [DRIVE_PHASE] = {"phase", phase_rad, -phase_max_rad, phase_max_rad},
        [DRIVE_RAMP] = {"ramp", ramp_s, 0.0, ramp_max_s},
    };
    double value[DRIVE_FIELDS] = {0};
    unsigned given = 0;
    for (int i = DRIVE_AMPLITUDE; i <= DRIVE_RAMP; i++) {
        if (isnan(field[i].value))
            continue;
        code = check(p, field[i].name, field[i].value, field[i].min, field[i].max);
        if (code != CONTACTPLANT_OK)
            return code;
        given |= 1u << i;
        value[i] = field[i].value;
    }
    plant_set_drive(pl, input, given, value);
    pl->counts.changes++;
    return CONTACTPLANT_OK;
}

int contactplant_set_noise(struct contactplant *p, int input, double deviation, uint32_t ticks, uint32_t seed,
                           double ramp_s)
{
    int code = begin_alone(p, input);
    if (code == CONTACTPLANT_OK)
        code = check(p, "deviation", deviation, 0.0, NOISE_LIMIT * input_unit(p, input));
    if (code == CONTACTPLANT_OK)
        code = check(p, "hold of the noise in ticks", ticks, 1.0, NOISE_HOLD_MAX);
    if (code == CONTACTPLANT_OK)
        code = check(p, "ramp", ramp_s, 0.0, ramp_max_s);
    if (code != CONTACTPLANT_OK)
        return code;
    plant_noise(&p->scene.app.plant, input, deviation, ticks, seed, ramp_s);
    p->scene.app.plant.counts.changes++;
    return CONTACTPLANT_OK;
}

int contactplant_set_sample(struct contactplant *p, int input, double value, uint64_t ticks)
{
    int code = begin_alone(p, input);
    if (code != CONTACTPLANT_OK)
        return code;
    double limit = DRIVE_LIMIT * input_unit(p, input);
    code = check(p, "sample", value, -limit, limit);
    if (code == CONTACTPLANT_OK)
        code = check(p, "ticks of the sample", (double)ticks, 0.0, ramp_max_s / p->scene.app.plant.tick_s);
    if (code != CONTACTPLANT_OK)
        return code;
    plant_sample(&p->scene.app.plant, input, value, ticks);
    p->scene.app.plant.counts.changes++;
    return CONTACTPLANT_OK;
}

int contactplant_silence(struct contactplant *p, double ramp_s)
{
    int code = begin_alone(p, 0);
    if (code == CONTACTPLANT_OK)
        code = check(p, "ramp", ramp_s, 0.0, ramp_max_s);
    if (code == CONTACTPLANT_OK)
        plant_drives_to_zero(&p->scene.app.plant, ramp_s);
    return code;
}

int contactplant_set_state(struct contactplant *p, const double *state, int n)
{
    double x[MODEL_STATES], size = 0.0;
    int code = begin_alone(p, 0);
    if (code != CONTACTPLANT_OK)
        return code;
    struct plant *pl = &p->scene.app.plant;
    if (!state || n != pl->model->n_states)
        return library_fail(&p->error, CONTACTPLANT_BAD_VALUE, "give all %d states of %s",
                            pl->model->n_states, pl->model->name);
    for (int i = 0; i < n; i++) {
        x[i] = state[i] / scale_of(&pl->scale, pl->model->state_signal[i].quantity);
        size += fabs(x[i]);
    }
    if (!(size <= PLANT_STATE_LIMIT))
        return library_fail(&p->error, CONTACTPLANT_BAD_VALUE,
                            "the state is not finite, or beyond 1e12 times the contact's own length");
    plant_set_state(pl, x);
    pl->counts.changes++;
    return CONTACTPLANT_OK;
}

/* ---- time ---- */

static int moved(struct contactplant *p, bool good)
{
    if (good)
        return CONTACTPLANT_OK;
    return library_fail(&p->error, CONTACTPLANT_DIVERGED,
                        "the motion left the finite numbers at %.9g s; the plant stands there",
                        plant_time(&p->scene.app.plant));
}

/* So many times so many ticks. */
static int check_ticks(struct contactplant *p, uint64_t times, uint64_t ticks)
{
    if (times == 0 || ticks <= (UINT64_MAX - 1 - p->scene.app.plant.now.tick) / times)
        return CONTACTPLANT_OK;
    return library_fail(&p->error, CONTACTPLANT_BAD_VALUE, "more ticks than a plant can count");
}

int contactplant_advance(struct contactplant *p, uint64_t ticks)
{
    if (!library_is_plant(p))
        return CONTACTPLANT_BAD_HANDLE;
    if (!may_change(p))
        return p->error.code;
    int code = check_ticks(p, 1, ticks);
    return code == CONTACTPLANT_OK ? moved(p, plant_run(&p->scene.app.plant, ticks)) : code;
}

int contactplant_advance_samples(struct contactplant *p, int input, const double *value, uint32_t n,
                                 uint64_t ticks)
{
    int code = begin_alone(p, input);
    if (code == CONTACTPLANT_OK && !value && n > 0)
        code = library_fail(&p->error, CONTACTPLANT_BAD_VALUE, "give %u samples, not NULL", (unsigned)n);
    if (code == CONTACTPLANT_OK)
        code = check_ticks(p, n, ticks);
    for (uint32_t i = 0; i < n && code == CONTACTPLANT_OK; i++) {
        double limit = DRIVE_LIMIT * input_unit(p, input);
        code = check(p, "sample", value[i], -limit, limit);
    }
    if (code != CONTACTPLANT_OK)
        return code;
    p->scene.app.plant.counts.changes += n;
    return moved(p, plant_run_samples(&p->scene.app.plant, input, value, n, ticks));
}

int contactplant_advance_to(struct contactplant *p, double time_s)
{
    static const double ticks_max = 9007199254740992.0; /* whole numbers below are exact */
    if (!library_is_plant(p))
        return CONTACTPLANT_BAD_HANDLE;
    if (!may_change(p))
        return p->error.code;
    struct plant *pl = &p->scene.app.plant;
    double ticks = time_s / pl->tick_s, whole = floor(ticks);
    if (!(ticks >= 0.0 && ticks < ticks_max))
        return library_fail(&p->error, CONTACTPLANT_BAD_VALUE, "time %g s is out of range; give 0 to %g",
                            time_s, ticks_max * pl->tick_s);
    struct instant to = {(uint64_t)whole, (uint32_t)((ticks - whole) * TICK_FRACTIONS + 0.5)};
    to.tick += to.fraction / TICK_FRACTIONS;
    to.fraction %= TICK_FRACTIONS;
    if (instant_compare(to, pl->now) < 0)
        return library_fail(&p->error, CONTACTPLANT_BAD_VALUE,
                            "time %.9g s has passed; the plant is at %.9g s", time_s, plant_time(pl));
    return moved(p, plant_advance(pl, to));
}

/* ---- what it says ---- */

double contactplant_time(struct contactplant *p)
{
    return library_is_plant(p) ? plant_time(&p->scene.app.plant) : (double)NAN;
}

uint64_t contactplant_tick(struct contactplant *p)
{
    return library_is_plant(p) ? p->scene.app.plant.now.tick : 0;
}

double contactplant_tick_time(struct contactplant *p)
{
    return library_is_plant(p) ? p->scene.app.plant.tick_s : (double)NAN;
}

uint32_t contactplant_substeps(struct contactplant *p)
{
    return library_is_plant(p) ? p->scene.config.substeps : 0;
}

double contactplant_input(struct contactplant *p, int index)
{
    if (!library_is_plant(p) || !library_is_input(p, index))
        return (double)NAN;
    return p->scene.app.plant.segment.at[2][index].value * input_unit(p, index);
}

double contactplant_output(struct contactplant *p, int index)
{
    double output[MODEL_OUTPUTS];
    if (!library_is_plant(p))
        return (double)NAN;
    if (index < 0 || index >= p->scene.config.model->n_outputs)
        return nan_of(p, CONTACTPLANT_BAD_INDEX, "no output", index);
    plant_output(&p->scene.app.plant, output);
    return output[index];
}

int contactplant_outputs(struct contactplant *p, double *output, int n)
{
    double all[MODEL_OUTPUTS];
    if (!library_is_plant(p))
        return CONTACTPLANT_BAD_HANDLE;
    if (!output || n != p->scene.config.model->n_outputs)
        return library_fail(&p->error, CONTACTPLANT_BAD_VALUE, "give room for all %d outputs of %s",
                            p->scene.config.model->n_outputs, p->scene.config.model->name);
    plant_output(&p->scene.app.plant, all);
    for (int i = 0; i < n; i++)
        output[i] = all[i];
    return CONTACTPLANT_OK;
}

double contactplant_state(struct contactplant *p, int index)
{
    if (!library_is_plant(p))
        return (double)NAN;
    const struct plant *pl = &p->scene.app.plant;
    if (index < 0 || index >= pl->model->n_states)
        return nan_of(p, CONTACTPLANT_BAD_INDEX, "no state", index);
    return pl->x[index] * scale_of(&pl->scale, pl->model->state_signal[index].quantity);
}

double contactplant_energy(struct contactplant *p)
{
    return library_is_plant(p) ? plant_energy(&p->scene.app.plant) : (double)NAN;
}

double contactplant_residual(struct contactplant *p)
{
    return library_is_plant(p) ? plant_residual(&p->scene.app.plant) : (double)NAN;
}

int contactplant_next_event(struct contactplant *p, struct contactplant_event *event)
{
    struct event e;
    if (!library_is_plant(p) || !may_change(p))
        return 0;
    if (!event) {
        (void)library_fail(&p->error, CONTACTPLANT_BAD_VALUE, "contactplant_next_event: event is NULL");
        return 0;
    }
    if (!plant_take_event(&p->scene.app.plant, &e))
        return 0;
    *event = (struct contactplant_event){.time_s = ((double)e.tick + e.fraction) * p->scene.app.plant.tick_s,
                                         .tick = e.tick,
                                         .fraction = e.fraction,
                                         .speed = e.speed,
                                         .peak_force_N = e.peak_force,
                                         .contact = e.contact,
                                         .touch = e.touch};
    return 1;
}

uint64_t contactplant_counter(struct contactplant *p, enum contactplant_counter which)
{
    if (!library_is_plant(p))
        return 0;
    const struct plant_counts *c = &p->scene.app.plant.counts;
    switch (which) {
    case CONTACTPLANT_SWITCHES:
        return c->switches;
    case CONTACTPLANT_EVENTS_LOST:
        return c->events_lost;
    case CONTACTPLANT_SWITCHES_MISSED:
        return c->budget;
    case CONTACTPLANT_UNSURE:
        return c->residual;
    case CONTACTPLANT_NOT_FINITE:
        return c->not_finite;
    default:
        (void)library_fail(&p->error, CONTACTPLANT_BAD_VALUE, "no such counter: %d", (int)which);
        return 0;
    }
}

uint64_t contactplant_hash(struct contactplant *p)
{
    return library_is_plant(p) ? plant_hash(&p->scene.app.plant) : 0;
}
