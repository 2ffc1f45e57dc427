#include "tests/hash_run.h"

#include "firmware/text.h"
#include "models/hertz_rig.h"
#include "models/shaft_bearing.h"
#include "tests/arithmetic.h"

enum { BLOCKS = 150, NOISE_FROM = 120, BLOCK_TICKS = 1000 };

/* What is commanded in block i, at a fraction of a tick. */
static const char *command(struct plant *pl, int i)
{
    double si[MODEL_PARAMETERS];
    int n = pl->model->n_parameters;
    switch (i % 12) {
    case 0:
        plant_drive(pl, RIG_FORCE, 20.0 + 7.0 * (i % 5), 150.0 + 9.0 * (i % 13), 0.3 * (i % 7), 0.004);
        break;
    case 1:
        plant_drive(pl, RIG_BASE, 2e-6, 1700.0 + i, 1.0, 0.0);
        break;
    case 2:
        plant_drive(pl, RIG_STIFFNESS, 0.25, 900.0, -2.0, 0.0113);
        break;
    case 3:
        plant_drive(pl, RIG_FAST_FORCE, 90.0, 1900.0, 0.0, 0.002);
        break;
    case 4:
        plant_sample(pl, RIG_FORCE, 5.0 - i % 4, 0);
        break;
    case 5:
        plant_sample(pl, RIG_BASE, 1e-6 * (i % 3), 16);
        break;
    case 6:
        plant_drive(pl, RIG_FORCE, 95.0, 210.0 + i % 9, 0.3 * (i % 7),
                    0.006); /* inside the ramp below, too */
        break;
    case 7:
        plant_drive(pl, RIG_FORCE, 60.0, 235.0, -0.1 * (i % 7), 0.01);
        break;
    case 8:
        for (int k = 0; k < n; k++)
            si[k] = pl->model->parameter[k].initial * (1.0 + 0.01 * ((i + 3 * k) % 11));
        return plant_change(pl, si);
    case 9:
        plant_sample(pl, RIG_STIFFNESS, 0.05 * (i % 5), 3);
        break;
    case 10:
        plant_drive(pl, RIG_BASE, 0.0, 1700.0, 0.0, 0.001);
        break;
    default:
        plant_drive(pl, RIG_STIFFNESS, 0.1, 300.0, 0.5, 0.0001);
    }
    return NULL;
}

/* The shaft: drives on all three masses, samples, and parameters in block 8 of 12. */
static const char *shake(struct plant *pl, int i)
{
    double si[MODEL_PARAMETERS];
    if (i % 12 == 8) {
        for (int k = 0; k < pl->model->n_parameters; k++)
            si[k] = pl->si[k];
        si[i % 3] = pl->model->parameter[i % 3].initial * (1.0 + 0.01 * (i % 7));
        return plant_change(pl, si);
    }
    if (i % 4 == 3)
        plant_sample(pl, i % pl->model->n_inputs, 5.0 - i % 4, (uint64_t)(i % 3) * 8);
    else
        plant_drive(pl, i % pl->model->n_inputs, 20.0 + 7.0 * (i % 5), 18.0 + 9.0 * (i % 13), 0.3 * (i % 7),
                    0.001 * (i % 6));
    return NULL;
}

/* From block NOISE_FROM on: noise that comes, changes and goes between the other commands. */
static const char *rustle(struct plant *pl, int i)
{
    int k = i % pl->model->n_inputs;
    double unit = scale_of(&pl->scale, pl->model->input_signal[k].quantity);
    plant_noise(pl, k, 0.03 * unit * (i % 3), (uint32_t)(1 + i % 5), (uint32_t)i, 0.001 * (i % 4));
    return NULL;
}

const char *const hash_runs[HASH_RUNS] = {"arithmetic", "rk4",         "taylor",
                                          "exact",      "rk4_float32", "rk4_float32:shaft"};

/* The method whose name the text begins with, up to its end or a colon. */
static const struct method *method_of(const char *name)
{
    for (int i = 0; i < METHODS; i++) {
        const char *a = method_table[i]->name, *b = name;
        while (*a && *a == *b)
            a++, b++;
        if (!*a && (!*b || *b == ':'))
            return method_table[i];
    }
    return NULL;
}

static bool on_shaft(const char *name)
{
    while (*name && *name != ':')
        name++;
    return *name == ':';
}

static const char *calculate(void (*line)(uint64_t tick, uint64_t hash))
{
    uint64_t random = 1, hash = 0;
    for (int i = 1; i <= BLOCKS; i++) {
        hash = arithmetic_hash(&random, BLOCK_TICKS, hash);
        line((uint64_t)i * BLOCK_TICKS, hash);
    }
    return NULL;
}

const char *hash_run(struct plant *pl, double *work, const char *name,
                     void (*line)(uint64_t tick, uint64_t hash))
{
    struct plant_config c = {.method = method_of(name), .tick_s = 1e-3 / 64.0, .dilation = 1.0, .work = work};
    if (text_equal(name, "arithmetic"))
        return calculate(line);
    bool shaft = c.method == &exact || on_shaft(name);
    const char *(*disturb)(struct plant *, int) = shaft ? shake : command;
    c.model = shaft ? &shaft_bearing : &hertz_rig;
    if (!c.method)
        return "no such method";
    const char *why = plant_init(pl, &c);
    for (int i = 0; !why && i < BLOCKS; i++) {
        struct instant at = {pl->now.tick + 137, (uint32_t)(7919 * i % TICK_FRACTIONS)};
        struct instant again = {at.tick + 200, (uint32_t)(104729 * i % TICK_FRACTIONS)};
        if (!plant_advance(pl, at))
            why = "not finite";
        if (!why)
            why = i < NOISE_FROM ? disturb(pl, i) : rustle(pl, i);
        if (!why && !plant_advance(pl, again))
            why = "not finite";
        if (!why && i % 2)
            why = disturb(pl, i + 5);
        if (!why && !plant_advance(pl, (struct instant){(uint64_t)(i + 1) * BLOCK_TICKS, 0}))
            why = "not finite";
        line(pl->now.tick, plant_hash(pl));
    }
    return why;
}
