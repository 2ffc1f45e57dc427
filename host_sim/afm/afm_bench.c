/* afm_bench.c - see afm_bench.h. */
#include "host_sim/afm/afm_bench.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/afm/gsf.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/files.h"
#include "host_sim/commands.h"
#include "host_sim/scene/scene_app.h"
#include "host_sim/scene/scene_range.h"

enum { PATH = 4096 };

/* ---- numbers ---- */

/* The number of the station that NAME=.. names, with or without its unit; -1: none. */
static int find_number(const char *text)
{
    size_t n = strcspn(text, "=");
    for (int i = 0; i < STATION_NUMBERS; i++) {
        struct scene_key k;
        scene_keys_parameter(&station_number[i], 0, &k);
        if ((strlen(k.name) == n && !strncmp(k.name, text, n)) ||
            (strlen(k.full) == n && !strncmp(k.full, text, n)))
            return i;
    }
    return -1;
}

static int read_settings(struct afm_bench *b)
{
    int status = 0;
    struct scene_range_names own = {.n = STATION_NUMBERS, .where = "contactplant list microscope shows them"};
    struct scene_key key[STATION_NUMBERS];
    for (int i = 0; i < STATION_NUMBERS; i++) {
        scene_keys_parameter(&station_number[i], 0, &key[i]);
        own.name[i] = key[i].name;
    }
    for (int i = 0; i < options_count(&b->o, "set") && !status; i++) {
        const char *text = options_text(&b->o, "set", i), *equal = strchr(text, '=');
        int which = equal ? find_number(text) : -1;
        status = which >= 0
                     ? scene_range_parameter(b->usage, &station_number[which], equal, &b->number[which])
                     : scene_range_setting(b->usage, &b->scene, text, &own);
    }
    return status;
}

int afm_bench_read(struct afm_bench *b)
{
    char why[SCENE_REASON];
    struct harmonic unused[MODEL_INPUTS];
    const char *name = b->o.n_words ? b->o.word[0] : "tapping";
    b->usage = b->o.usage;
    b->origin = scene_load(name, &b->scene, why);
    if (b->origin == SCENE_OF_NOTHING)
        return options_misuse(b->usage, "%s", why);
    if (!b->scene.model->modal_form) /* afm_lever is the one model with this view */
        return options_misuse(b->usage,
                              "%s is no AFM lever; give soft, tapping, stiff or a scene of afm_lever", name);
    station_defaults(b->number);
    int status = read_settings(b);
    scenes_resolve(&b->scene, b->si, unused);
    b->tick_s = b->scene.frame_s / b->scene.substeps / b->scene.dilation;
    return status;
}

/* ---- the surface from a file ---- */

static void set_grid(struct afm_bench *b, const struct gsf *g)
{
    float largest = 0.0f;
    for (size_t i = 0; i < g->nx * g->ny; i++)
        largest = fabsf(g->value[i]) > largest ? fabsf(g->value[i]) : largest;
    double unit = largest > 0.0f ? (double)largest / 32767.0 : 1.0;
    for (size_t i = 0; i < g->nx * g->ny; i++)
        b->count[i] = (int16_t)lrint((double)g->value[i] / unit);
    b->grid = (struct surface_grid){b->count, (uint32_t)g->nx, (uint32_t)g->ny, g->width, g->length, unit};
    b->number[STATION_SURFACE] = SURFACE_GRID;
}

/* Bytes in the wrong order give heights that no surface has. */
static bool are_heights(const struct gsf *g, char *why)
{
    static const float lowest = 1e-20f, highest = 1.0f; /* m */
    float largest = 0.0f;
    for (size_t i = 0; i < g->nx * g->ny; i++)
        largest = fmaxf(largest, fabsf(g->value[i]));
    if (largest <= highest && !(largest > 0.0f && largest < lowest))
        return true;
    snprintf(why, GSF_REASON,
             "has heights to %.3g m, which no surface has: give metres, as float32 with the low byte first",
             (double)largest);
    return false;
}

int afm_bench_read_surface(struct afm_bench *b)
{
    char why[GSF_REASON] = "";
    const char *path = options_text(&b->o, "surface", 0);
    struct gsf g = {.value = NULL};
    FILE *f = path ? fopen(path, "rb") : NULL;
    if (!path)
        return 0;
    if (!f)
        return options_misuse(b->usage, "cannot read --surface %s: %s", path, strerror(errno));
    int good = gsf_read(f, &g, why) && are_heights(&g, why);
    fclose(f);
    b->count = good ? malloc(g.nx * g.ny * sizeof *b->count) : NULL;
    if (b->count)
        set_grid(b, &g);
    free(g.value);
    return b->count
               ? 0
               : options_misuse(b->usage, "--surface %s %s", path, good ? "does not fit into memory" : why);
}

/* ---- the station ---- */

static void run_stage(void *stage, double *value, uint32_t n)
{
    stage_run_many(stage, value, n);
}

/* The scene's stages stand where the microscope has a place for them: piezo and sensor, with memory of the
 * caller. NULL, or the reason of a refusal. */
static const char *read_stages(const struct scene *scene, const double *si, struct station_config *c,
                               struct stage *piezo, struct stage *sensor)
{
    for (int i = 0; i < SCENE_STAGES; i++) {
        const double *own = scene->stage[i];
        int at = (int)own[STAGE_AT];
        bool acts = at == 1 + LEVER_Z;
        if (at == 0)
            continue;
        if (!acts && at != 1 + MODEL_INPUTS + LEVER_DEFLECTION)
            return "a microscope has [stage z], its piezo, and [stage deflection], its sensor; leave out the "
                   "others";
        struct stage *s = acts ? piezo : sensor;
        const char *why = stages_build(s, c->tick_s, fmod(si[LEVER_SEED], 65536.0), i, own);
        if (why)
            return why;
        *(acts ? &c->piezo : &c->sensor) = (struct microscope_stage){run_stage, s};
    }
    return NULL;
}

int afm_bench_start(struct afm_bench *b)
{
    struct station_config c = {
        .si = b->si, .tick_s = b->tick_s, .number = b->number, .grid = b->count ? &b->grid : NULL};
    int which;
    const char *why = read_stages(&b->scene, b->si, &c, &b->piezo, &b->sensor);
    if (why)
        return options_misuse(b->usage, "%s", why);
    why = station_check(&c, &which);
    if (why)
        return options_misuse(b->usage, "%s %s", station_number[which].name, why);
    why = station_init(&b->station, &c);
    if (why)
        return options_misuse(b->usage, "%s", why);
    char noise[SCENE_REASON];
    return !b->station.microscope.sensor.run || scene_sensor_is_quiet(&b->station, &b->sensor, noise)
               ? 0
               : options_misuse(b->usage, "%s", noise);
}

void afm_bench_warn(const struct afm_bench *b)
{
    double ring = station_ring_time(b->si), pixel = b->number[STATION_PIXEL];
    double cycle = b->station.swing.samples * b->station.sample_s;
    if (station_swings(b->number) && 4.0 * ring > cycle)
        fprintf(
            stderr,
            "contactplant %s: warning: the lever's ring time 2 Q/w0 = %.3g ms is longer than a quarter of a "
            "cycle of %.3g ms: it still rings from one pull-off when the next touch comes, and the peaks "
            "scatter; take a lower frequency or quality\n",
            b->usage->name, ring * 1e3, cycle * 1e3);
    if (b->number[STATION_Z_LOOP] == Z_AMPLITUDE && !station_swings(b->number) && pixel < ring)
        fprintf(stderr,
                "contactplant %s: warning: a pixel of %.3g ms is shorter than the lever's ring time 2 Q/w0 = "
                "%.3g ms: "
                "the amplitude cannot follow\n",
                b->usage->name, pixel * 1e3, ring * 1e3);
}

int afm_bench_run(struct afm_bench *b, uint64_t samples)
{
    static const struct microscope_in still;
    for (uint64_t i = 0; i < samples; i++)
        if (!station_run(&b->station, &still))
            return options_failure(b->usage,
                                   "the motion left the finite numbers; take more substeps or less ki");
    return 0;
}

int afm_bench_run_on(struct afm_bench *b, uint64_t samples)
{
    return clock_interrupted() ? options_failure(b->usage, "interrupted") : afm_bench_run(b, samples);
}

/* The z loop holds this, a deflection or an amplitude. */
static double set_deflection(const struct afm_bench *b)
{
    const double *n = b->number;
    return station_swings(n) ? n[STATION_PEAK_FORCE] / b->si[LEVER_K] : fabs(n[STATION_SETPOINT]);
}

/* The longest way down: by ki times the largest error, three times over; then 20 ring times to settle. */
static double longest_engage(const struct afm_bench *b)
{
    const double *n = b->number;
    bool amplitude = n[STATION_Z_LOOP] == Z_AMPLITUDE && !station_swings(n);
    double error = amplitude ? n[STATION_DRIVE] - n[STATION_SETPOINT] : set_deflection(b);
    double way = 3.0 * b->si[LEVER_HEIGHT] / (n[STATION_KI] * error + 1e-300);
    return way + 20.0 * station_ring_time(b->si) + 10.0 / n[STATION_KI];
}

/* Found: the error is small, or it has changed its sign: then the loop swings about the surface. */
int afm_bench_engage(struct afm_bench *b)
{
    struct station *s = &b->station;
    double ring = station_ring_time(b->si), limit = set_deflection(b) * 0.1;
    double most = longest_engage(b), low = (double)INFINITY, high = -(double)INFINITY;
    clock_catch_signals();
    int status = afm_bench_run(b, (uint64_t)(5.0 * ring / s->sample_s) + 1); /* the lever rings up */
    uint64_t piece = (uint64_t)(ring / s->sample_s) + 1;
    piece = station_swings(b->number) && piece < s->swing.samples ? s->swing.samples : piece;
    for (double t = 0.0; t < most && !status; t += (double)piece * s->sample_s) {
        status = afm_bench_run_on(b, piece);
        low = fmin(low, s->error_m);
        high = fmax(high, s->error_m);
        if (fabs(s->error_m) < limit || low * high < 0.0)
            return afm_bench_run(b, 5 * piece);
    }
    return status ? status
                  : options_failure(
                        b->usage,
                        "the z loop has not found the surface in %.3g s: its error is %.3g nm at z = %.4g "
                        "nm; check ki, setpoint and height",
                        most, s->error_m * 1e9, s->in.z_m * 1e9);
}

FILE *afm_bench_open(struct afm_bench *b, const char *directory, const char *name)
{
    char path[PATH];
    int n = snprintf(path, sizeof path, "%s/%s", directory, name);
    FILE *f = n < PATH ? files_create(path) : NULL;
    if (!f)
        (void)options_failure(b->usage, "cannot write %s: %s", path,
                              n < PATH ? strerror(errno) : "too long a name");
    return f;
}

void afm_bench_free(struct afm_bench *b)
{
    free(b->count);
}
