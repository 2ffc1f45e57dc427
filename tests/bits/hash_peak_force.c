/* hash_peak_force.c - see hash_peak_force.h. */
#include "tests/bits/hash_peak_force.h"

#include "firmware/afm/station.h"
#include "firmware/plant/hash.h"
#include "firmware/stage/stage.h"

static struct station station;
static struct stage sensor;

static void run_sensor(void *who, double *value, uint32_t n)
{
    stage_run_many(who, value, n);
}

/* Two branches of adhesion, in a rough and viscous sample; 5 nN at 2 kHz. */
static const char *begin(void)
{
    static const struct stage_part part[] = {{STAGE_NOISE, 1e-17, 0.0},
                                             {STAGE_FLICKER, 1e4, 1e-17},
                                             {STAGE_DRIFT, 1e-9, 0.0},
                                             {STAGE_LAG, 1e6, 0.0}};
    double si[LEVER_PARAMETERS], number[STATION_NUMBERS];
    for (int i = 0; i < LEVER_PARAMETERS; i++)
        si[i] = afm_lever.parameter[i].initial;
    si[LEVER_Q] = 20.0;
    si[LEVER_TEMPERATURE] = 295.0;
    si[LEVER_HAMAKER_OUT] = 1e-19;
    si[LEVER_HEIGHT] = -2e-9;
    si[LEVER_VISCOSITY] = 10.0;
    station_defaults(number);
    number[STATION_TICKS] = 4.0;
    number[STATION_KI] = 800.0;
    number[STATION_PEAK_FORCE] = 5e-9;
    number[STATION_SURFACE] = SURFACE_ROUGH;
    number[STATION_SURFACE_HEIGHT] = 0.1e-9;
    const double tick_s = 1.0 / (128.0 * si[LEVER_F0]);
    const char *why = stage_init(&sensor, tick_s, 5, part, sizeof part / sizeof part[0]);
    return why ? why
               : station_init(&station, &(struct station_config){.si = si,
                                                                 .tick_s = tick_s,
                                                                 .number = number,
                                                                 .sensor = {run_sensor, &sensor}});
}

static uint64_t add(uint64_t hash, const struct force_cycle *c)
{
    const double number[] = {c->peak_N, c->snap_in_N,     c->adhesion_N, c->baseline_N,
                             c->work_J, c->deformation_m, c->modulus_Pa, c->low_m};
    for (unsigned i = 0; i < sizeof number / sizeof number[0]; i++)
        hash = hash_double(hash, number[i]);
    return station_hash(&station, stage_hash(&sensor, hash));
}

const char *hash_peak_force(int cycles, void (*block)(uint32_t hash))
{
    struct microscope_in in = {.z_m = 0.0};
    uint64_t hash = HASH_BEGIN;
    int touched = 0;
    const char *why = begin();
    for (int i = 0; i < cycles && !why; i++) {
        in.x_m += 1e-9;
        do
            why = station_run(&station, &in) ? NULL : "the motion left the finite numbers";
        while (!why && !station.cycle_ready);
        hash = add(hash, &station.swing.cycle);
        touched += station.swing.cycle.fitted;
        block((uint32_t)(hash ^ hash >> 32));
    }
    return why ? why : touched ? NULL : "no cycle has found a modulus";
}
