/* test_method_scratch.c - scratch memory: a method keeps to its share of it, and a copy of plant and scratch
 * elsewhere runs on to the same bits. Every model with every method that takes it. */
#include "tests/unit/test.h"

#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/afm_tip.h"
#include "models/models.h"

enum { SCRATCH_TICKS = 700, BEYOND = 8 };

static double guarded_scratch[METHOD_SCRATCH + BEYOND], moved_scratch[METHOD_SCRATCH + BEYOND];

/* A plant with a harmonic drive, a tenth of a radian of
 * its fastest mode a tick. False where the method refuses. */
static bool start_loud(struct plant *pl, const struct model *m, const struct method *method)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct scale scale;
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = m->parameter[i].initial;
    m->prepare(si, p, &scale);
    double omega = m->eigenfrequency(p), tol = method->refuse(m, p, 0.1 / omega, 1e-6) ? 1e-4 : 1e-6;
    if (method->refuse(m, p, 0.1 / omega, tol))
        return false;
    struct plant_config c = {.model = m,
                             .si = si,
                             .method = method,
                             .tick_s = 0.1 / omega * scale.time_s,
                             .dilation = 1.0,
                             .tol = tol,
                             .scratch = guarded_scratch};
    memset(guarded_scratch, 0xA5, sizeof guarded_scratch);
    if (plant_init(pl, &c))
        return false;
    /* Loud enough to lose contact, where the motion does not escape then. */
    bool escapes = m->n_contacts == 0 || m == &afm_tip;
    double unit = scale_of(&scale, m->input_signal[0].quantity);
    plant_drive_start(pl, 0, (escapes ? 0.003 : 1.2) * unit, 0.11 * omega / scale.time_s, 0.3);
    return true;
}

/* The run whole, and the same from a copy of its middle in other memory. */
static void check_pair(const char *name, struct plant *pl, size_t used)
{
    bool good = plant_run(pl, SCRATCH_TICKS / 2 + 1);
    struct plant copy = *pl;
    memset(moved_scratch, 0x5A, sizeof moved_scratch);
    memcpy(moved_scratch, guarded_scratch, used * sizeof *moved_scratch);
    copy.scratch = moved_scratch;
    good = plant_run(pl, SCRATCH_TICKS / 2) && good;
    good = plant_run(&copy, SCRATCH_TICKS / 2) && good;
    check_true(name, good);
    check_hex("  a copy of plant and scratch runs on to the same state", plant_hash(&copy), plant_hash(pl));
    int beyond = 0;
    for (size_t i = used * sizeof *guarded_scratch; i < sizeof guarded_scratch; i++)
        beyond += ((const unsigned char *)guarded_scratch)[i] != 0xA5;
    check_int("  bytes written beyond its share", beyond, 0);
}

TEST(method_scratch)
{
    struct plant pl;
    int pairs = 0;
    for (int i = 0; i < MODELS; i++)
        for (int k = 0; k < METHODS; k++) {
            const struct model *m = model_table[i];
            if (!start_loud(&pl, m, method_table[k]))
                continue;
            check_pair(check_name("%s by %s", m->name, method_table[k]->name), &pl,
                       method_table[k]->n_scratch(m));
            pairs++;
        }
    check_is("pairs of model and method", pairs, >=, 64);
}
