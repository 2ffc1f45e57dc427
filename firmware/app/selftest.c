/* selftest.c - see selftest.h. Model units throughout: the unit rig's scale is 1. */
#include "firmware/app/selftest.h"

#include <math.h>
#include "firmware/method/taylor/taylor_series.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/text.h"
#include "models/math/elementary.h"
#include "models/hertz_rig.h"

/* SI parameters of the rig whose scale is 1, with damping ratio 0 and 0.05. */
static const double unit_rig[RIG_PARAMETERS] = {1.5, 1.0, 1.0, 0.0};
static const double unit_rig_damped[RIG_PARAMETERS] = {1.5, 1.0, 1.0, 0.15};

/* ---- what is measured ---- */

enum { PHASE_TICKS = 1000000000, PHASE_LAST = 1000 };

/* Modulo a turn, adding a step n times equals multiplying it by n. So only the last ticks are run; they
 * pass through resynchronisations. */
static double drive_phase(struct plant *pl)
{
    struct drive d;
    struct wave w;
    struct input u[3];
    (void)pl;
    drive_init(&d);
    drive_start(&d, &(struct drive_setting){.amplitude = 1.0, .turns_per_tick = 0.0123456789});
    d.carrier = d.step * (uint64_t)(PHASE_TICKS - PHASE_LAST);
    for (int i = 0; i < PHASE_LAST; i++)
        (void)drive_segment(&d, TICK_FRACTIONS, 1.0, &w, &u[0], &u[1], &u[2]);
    return u[2].value;
}

enum { PERIOD_TICKS = 256 };
#define PERIOD_TICK                                                                                          \
    0.0248472 /* the ticks end 3e-6 before the top: velocity over acceleration is the rest to 1e-17 */

static double free_period(struct plant *pl)
{
    const double top = 1.5, acceleration = (2.0 / 3.0) * (1.0 - top * sqrt(top));
    plant_set_state(pl, (const double[MODEL_STATES]){top, 0.0});
    if (!plant_run(pl, PERIOD_TICKS))
        return (double)NAN;
    return PERIOD_TICKS * pl->h - pl->x[1] / acceleration;
}

enum { CONTACT_TICKS = 320 };
#define CONTACT_TICK 0.015

static double contact_time(struct plant *pl)
{
    const double above = 1e-3; /* dropped from here, it arrives with speed 1 */
    struct event touch, lift;
    plant_set_state(pl, (const double[MODEL_STATES]){-above, sqrt(1.0 - (4.0 / 3.0) * above)});
    if (!plant_run(pl, CONTACT_TICKS) || !plant_take_event(pl, &touch) || !plant_take_event(pl, &lift))
        return (double)NAN;
    return ((double)(lift.tick - touch.tick) + (lift.fraction - touch.fraction)) * pl->h;
}

enum { OSCILLATOR_TICKS = 512 };
#define OSCILLATOR_TICK 0.025

static double oscillator(struct plant *pl)
{
    plant_drive_start(pl, RIG_FORCE, 0.3, 0.9 / (2.0 * ELEMENTARY_PI), 0.0);
    plant_set_state(pl, (const double[MODEL_STATES]){1.2, 0.0});
    return plant_run(pl, OSCILLATOR_TICKS) ? pl->x[0] - 1.0 : (double)NAN;
}

enum { HASH_TICKS = 500 };
#define HASH_TICK (1e-3 / 64)

/* Every input sounds; the low 48 bits, as on the wire: a double holds them. */
static double hash(struct plant *pl)
{
    if (!plant_advance(pl, (struct instant){13, 7919}))
        return (double)NAN;
    for (int i = 0; i < pl->model->n_inputs; i++) {
        enum quantity q = pl->model->input_signal[i].quantity;
        double amplitude = q == QUANTITY_FORCE ? 150.0 : q == QUANTITY_LENGTH ? 1e-6 : 0.1;
        plant_drive(pl, i, amplitude, 210.0 + 97.0 * i, 0.3, 0.0005);
    }
    if (!plant_advance(pl, (struct instant){HASH_TICKS, 0}))
        return (double)NAN;
    return (double)(plant_hash(pl) & 0xFFFFFFFFFFFFu);
}

/* ---- the table ---- */

#define COSINE       0.80901699595375582778
#define PERIOD       6.3608862098152785284
#define CONTACT      4.4792663493740612281
#define DISPLACEMENT (-0.30723526721111194793)
#define HASH_RK4     19319762807948.0
#define HASH_EXACT   103041600935417.0
#define HASH_FLOAT32 41661513258282.0
#define HASH_TAYLOR  171572627912033.0

#define FREE_PERIOD(method, tolerance)                                                                       \
    {                                                                                                        \
        "free_period_" method, "period of free vibration", "hertz_rig", method, unit_rig, PERIOD_TICK,       \
            free_period, PERIOD, tolerance                                                                   \
    }
#define CONTACT_TIME(method, tolerance)                                                                      \
    {                                                                                                        \
        "contact_time_" method, "from touchdown to lift-off", "hertz_rig", method, unit_rig, CONTACT_TICK,   \
            contact_time, CONTACT, tolerance                                                                 \
    }
#define OSCILLATOR(method, tolerance)                                                                        \
    {                                                                                                        \
        "oscillator_" method, "driven linear oscillator", "hertz_rig_linear", method, unit_rig_damped,       \
            OSCILLATOR_TICK, oscillator, DISPLACEMENT, tolerance                                             \
    }
#define HASH(model, method, expected)                                                                        \
    {                                                                                                        \
        "hash_" method, "every bit of a short run", model, method, NULL, HASH_TICK, hash, expected, 0.0      \
    }

const struct selftest_check selftest_table[SELFTEST_CHECKS] = {
    {"drive_phase", "drive after 1e9 ticks", NULL, NULL, NULL, 0.0, drive_phase, COSINE, 1e-13},
    FREE_PERIOD("rk4", 1e-8),
    CONTACT_TIME("rk4", 1e-7),
    OSCILLATOR("rk4", 1e-7),
    HASH("hertz_rig", "rk4", HASH_RK4),
    FREE_PERIOD("taylor", 1e-9),
    CONTACT_TIME("taylor", 1e-9),
    OSCILLATOR("taylor", 1e-9),
    HASH("hertz_rig", "taylor", HASH_TAYLOR),
    OSCILLATOR("exact", 1e-12),
    HASH("shaft_bearing", "exact", HASH_EXACT),
    FREE_PERIOD("rk4_float32", 1e-6),
    CONTACT_TIME("rk4_float32", 1e-6),
    OSCILLATOR("rk4_float32", 1e-6),
    HASH("hertz_rig", "rk4_float32", HASH_FLOAT32),
};

/* ---- running it ---- */

static const struct model *find_model(const struct selftest_parts *parts, const char *name)
{
    for (int i = 0; i < parts->n_models; i++) {
        if (text_equal(name, parts->model[i]->name))
            return parts->model[i];
    }
    return NULL;
}

static const struct method *find_method(const struct selftest_parts *parts, const char *name)
{
    for (int i = 0; i < parts->n_methods; i++) {
        if (text_equal(name, parts->method[i]->name))
            return parts->method[i];
    }
    return NULL;
}

bool selftest_measure(const struct selftest_check *c, const struct selftest_parts *parts, double *value)
{
    struct plant_config pc = {.si = c->si, .tick_s = c->tick_s, .dilation = 1.0, .scratch = parts->scratch};
    if (c->model) {
        pc.model = find_model(parts, c->model);
        pc.method = find_method(parts, c->method);
        if (!pc.model || !pc.method || pc.method->n_scratch(pc.model) > parts->n_scratch)
            return false;
        if (plant_init(parts->plant, &pc)) {
            *value = (double)NAN;
            return true;
        }
    }
    *value = c->measure(parts->plant);
    return true;
}

double selftest_error(const struct selftest_check *c, double value)
{
    return fabs(value - c->expected) / fabs(c->expected);
}

void selftest_run(const struct selftest_parts *parts, struct selftest_result *r)
{
    *r = (struct selftest_result){0, 0, {0.0f}};
    for (int i = 0; i < SELFTEST_CHECKS; i++) {
        const struct selftest_check *c = &selftest_table[i];
        double value;
        if (!selftest_measure(c, parts, &value))
            continue;
        double error = selftest_error(c, value);
        r->error[i] = (float)error;
        r->present |= (uint16_t)(1u << i);
        r->failed |= (uint16_t)((error <= c->tolerance ? 0u : 1u) << i);
    }
}
