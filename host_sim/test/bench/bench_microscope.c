/* bench_microscope.c - see bench_microscope.h. */
#include "host_sim/test/bench/bench_microscope.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/hash.h"
#include "host_sim/scene/scene_keys.h"
#include "host_sim/test/bench/bench.h"

static const unsigned ticks_index = AFM_PLANT_NUMBERS + STATION_TICKS;

static double ticks_in_sets(const struct test_plant *p, double ticks)
{
    for (int i = 0; i < p->n; i++)
        ticks = p->set[i].index == ticks_index ? p->set[i].value : ticks;
    return ticks;
}

/* Ticks of a microscope's sample as [plant] says; without a bus also as the case says. */
static double ticks_of(const struct test_file *t, const struct test_case *c, const double *varied)
{
    double ticks = ticks_in_sets(&t->plant, station_number[STATION_TICKS].initial);
    if (!t->loops)
        return ticks;
    return varied && c->varied == (int)ticks_index ? *varied : ticks_in_sets(&c->plant, ticks);
}

/* Samples of a frame so long: the lever keeps its pace. Without a bus a frame is a sample, or as many of them
 * as an app's shortest frame has. */
static bool set_frame(struct scene_app *s, const struct test_file *t, const struct test_case *c, double ticks,
                      char *why)
{
    double sample_s = s->config.frame_s / s->config.substeps;
    if (t->loops)
        s->config.frame_s = sample_s = t->lever.frame_s / t->lever.substeps / t->lever.dilation * ticks;
    while (t->loops && s->config.frame_s < 1e-6)
        s->config.frame_s *= 2.0;
    double frame_s = c->plant.rate_Hz > 0.0 ? 1.0 / c->plant.rate_Hz : s->config.frame_s;
    double samples = round(frame_s / sample_s);
    if (samples >= 1.0 && samples <= SCENE_SUBSTEPS_MAX) {
        s->config.substeps = (uint32_t)samples;
        return true;
    }
    snprintf(why, TEST_REASON,
             "a frame would have %.0f samples of %.3g us; 1 to %d are allowed: another rate, or other ticks",
             samples, sample_s * 1e6, SCENE_SUBSTEPS_MAX);
    return false;
}

bool bench_microscope_make(struct scene_app *s, const struct test_file *t, const struct test_case *c,
                           const double *varied, char *why)
{
    double ticks = ticks_of(t, c, varied);
    memset(s, 0, sizeof *s);
    s->origin = SCENE_OF_FILE;
    scene_around_lever(&t->lever, ticks, &s->scene);
    scene_app_configure(s);
    return set_frame(s, t, c, ticks, why);
}

const struct station *bench_microscope_station(const struct plant *pl)
{
    return afm_plant_station(pl->scratch);
}

void bench_microscope_read(const struct plant *pl, double *value)
{
    double in[AFM_PLANT_INPUTS];
    for (int i = 0; i < AFM_PLANT_INPUTS; i++)
        in[i] = pl->drive[i].sample * scale_of(&pl->scale, pl->model->input_signal[i].quantity);
    const struct microscope_in commands = {in[0], in[1], in[2], in[3]};
    test_afm_read(bench_microscope_station(pl), &commands, value);
}

const char *bench_microscope_check_set(const struct plant *pl, const struct staged *set, char *subject)
{
    double number[STATION_NUMBERS];
    for (unsigned i = 0; i < STATION_NUMBERS; i++)
        number[i] = (staged_has(set, AFM_PLANT_NUMBERS + i) ? set->value : pl->si)[AFM_PLANT_NUMBERS + i];
    int fixed = station_fixed(bench_microscope_station(pl), number);
    if (fixed < 0)
        return NULL;
    snprintf(subject, SCENE_SUBJECT, "%s ", station_number[fixed].name);
    return "cannot change while the microscope runs: give it at the beginning";
}

uint64_t bench_microscope_hash(const struct plant *pl)
{
    return station_hash(bench_microscope_station(pl), HASH_BEGIN);
}
