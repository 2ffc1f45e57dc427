/* choose_judge.c - see choose_judge.h. */
#include "tests/choose/choose_judge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/app/plant_scene.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "host_sim/choose/choose_print.h"
#include "host_sim/choose/choose_run.h"
#include "host_sim/scene/scene_file.h"

static const double fine_angle = 0.005, coarse_tolerance = 1e-4;

struct pair {
    struct plant plant, ahead;
    double scratch[METHOD_SCRATCH], scratch_ahead[METHOD_SCRATCH];
};

/* The middle. A lever's frame may be a period, whose middle is always the same phase. So a lever is looked at
 * elsewhere in each frame, by the golden section: the values then span its motion. */
double choose_judge_part(const struct scene *s, int frame)
{
    return s->model->modal_form ? fmod(0.5 + 0.61803398874989485 * frame, 1.0) : 0.5;
}

/* Runs a frame and takes the observable once in it. The plant runs up to that tick. A copy goes on by the
 * part of a tick that is left, where the plant itself never stops. */
static bool run_frame(struct pair *o, const struct scene *s, double substeps, struct choose_values *v)
{
    double output[MODEL_OUTPUTS];
    uint64_t fractions = (uint64_t)(substeps * TICK_FRACTIONS * choose_judge_part(s, v->n));
    uint64_t ticks = fractions / TICK_FRACTIONS;
    if (!plant_run(&o->plant, ticks))
        return false;
    struct instant to = {o->plant.now.tick, (uint32_t)(fractions % TICK_FRACTIONS)};
    o->ahead = o->plant;
    o->ahead.scratch = o->scratch_ahead;
    memcpy(o->scratch_ahead, o->scratch, sizeof o->scratch);
    bool good = plant_advance(&o->ahead, to);
    plant_output(&o->ahead, output);
    v->value[v->n++] = output[(int)s->observable];
    return good && plant_run(&o->plant, (uint64_t)substeps - ticks);
}

static struct choose_values follow(const struct scene *s, const char *method, double substeps, double tol,
                                   double nudge)
{
    struct choose_values v = {.value = calloc((size_t)choose_frames(s), sizeof(double)), .good = true};
    struct pair *o = calloc(1, sizeof *o);
    double si[MODEL_PARAMETERS], x[MODEL_STATES];
    struct harmonic drive[MODEL_INPUTS];
    scenes_resolve(s, si, drive);
    const struct plant_config c = {.model = s->model,
                                   .si = si,
                                   .method = method_find(method),
                                   .tick_s = s->frame_s / substeps,
                                   .dilation = s->dilation,
                                   .tol = tol,
                                   .scratch = o->scratch};
    v.good = !plant_init(&o->plant, &c);
    if (v.good) {
        plant_scene_begin(&o->plant, s, si, drive);
        memcpy(x, o->plant.x, sizeof x);
        x[0] += nudge;
        plant_set_state(&o->plant, x);
    }
    for (int i = 0; i < (int)choose_frames(s) && v.good; i++)
        v.good = run_frame(o, s, substeps, &v);
    v.loss = o->plant.total_time > 0.0 ? o->plant.loss_time / o->plant.total_time : 0.0;
    free(o);
    return v;
}

static double span_of(const struct choose_values *v, double unit)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int i = 0; i < v->n; i++) {
        low = fmin(low, v->value[i]);
        high = fmax(high, v->value[i]);
    }
    return high - low + 1e-6 * unit;
}

static double statistics_apart(const struct choose_values *a, const struct choose_values *b, double span)
{
    struct choose_record ra = {.n = a->n, .n_values = a->n, .value = a->value, .loss = a->loss};
    struct choose_record rb = {.n = b->n, .n_values = b->n, .value = b->value, .loss = b->loss};
    double sa[STATISTICS], sb[STATISTICS], most = 0.0;
    choose_statistics(&ra, span, sa);
    choose_statistics(&rb, span, sb);
    for (int k = 0; k < STATISTICS; k++)
        most = fmax(most, fabs(sa[k] - sb[k]));
    return most;
}

static double apart(const struct choose_values *a, const struct choose_values *truth, double unit,
                    bool statistics)
{
    double most = 0.0, span = span_of(truth, unit);
    if (!a->good || !truth->good)
        return HUGE_VAL;
    if (statistics)
        return statistics_apart(a, truth, span);
    for (int i = 0; i < a->n; i++)
        most = fmax(most, fabs(a->value[i] - truth->value[i]));
    return most / span;
}

/* Substeps by which a frame is cut into steps of `angle`
 * rad of the fastest motion, a multiple of the scene's own. */
static double cut(const struct scene *s, double angle)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], rate;
    struct harmonic drive[MODEL_INPUTS];
    struct scale scale;
    scenes_resolve(s, si, drive);
    s->model->prepare(si, p, &scale);
    rate = s->model->eigenfrequency(p) / scale.time_s;
    for (int i = 0; i < s->model->n_inputs; i++)
        rate = fabs(drive[i].amplitude) > 0.0 ? fmax(rate, drive[i].omega) : rate;
    return ceil(rate * s->frame_s / s->dilation / angle / s->substeps) * s->substeps;
}

static bool noisy(const struct scene *s)
{
    double noise = 0.0;
    for (int i = 0; i < s->model->n_inputs; i++)
        noise += s->drive[i].noise;
    return noise > 0.0;
}

/* By rk4 if that knows it well enough, by what it says with steps twice as long. */
static bool judge_by_rk4(const struct scene *s, struct choose_values *v)
{
    if (s->tolerance < coarse_tolerance || noisy(s))
        return false;
    *v = follow(s, "rk4", cut(s, fine_angle), 0.0, 0.0);
    struct choose_values coarse = follow(s, "rk4", cut(s, 2.0 * fine_angle), 0.0, 0.0);
    bool good = apart(&coarse, v, 1.0, false) < 0.1 * s->tolerance;
    free(coarse.value);
    if (!good)
        free(v->value);
    return good;
}

/* As choose's truth, but otherwise: see the top. Noise starts over one step of the scene's own. */
struct choose_values choose_judge(const struct scene *s, bool statistics)
{
    struct choose_values v;
    if (statistics)
        return follow(s, "rk4", cut(s, 0.05), 0.0, 7e-9);
    if (judge_by_rk4(s, &v))
        return v;
    if (s->model->modal_form)
        return follow(s, "modal", 37.0 * s->substeps, 0.0, 0.0);
    return follow(s, s->model->linear ? "exact" : "taylor", (noisy(s) ? 1.0 : 5.0) * s->substeps, 1e-13, 0.0);
}

struct choose_values choose_judge_run(const struct scene *s)
{
    return follow(s, s->method, s->substeps, s->tolerance, 0.0);
}

double choose_judge_error(const struct choose_certificate *c, const struct scene *s,
                          const struct choose_values *truth)
{
    struct choose_values v = choose_judge_run(s);
    double error = apart(&v, truth, c->unit, c->statistics);
    free(v.value);
    return error;
}

/* The scene that choose --out writes, read back. */
static bool written(const struct choose_certificate *c, struct scene *s)
{
    static char text[SCENE_FILE_BYTES];
    char why[SCENE_FILE_REASON];
    FILE *f = tmpfile();
    if (!f)
        return false;
    choose_write(f, c);
    rewind(f);
    size_t n = fread(text, 1, sizeof text, f);
    fclose(f);
    return scene_file_parse("written", text, n, s, why);
}

bool choose_judge_quiet(const struct choose_certificate *c)
{
    struct scene s;
    struct watch w;
    struct watch_limits l;
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    struct pair *o = calloc(1, sizeof *o);
    bool quiet =
        o && written(c, &s) && plant_scene_watch(&s, s.dilation, &l) && !watch_start(&w, &l, s.model);
    if (quiet) {
        scenes_resolve(&s, si, drive);
        const struct plant_config p = {.model = s.model,
                                       .si = si,
                                       .method = method_find(s.method),
                                       .tick_s = s.frame_s / s.substeps,
                                       .dilation = s.dilation,
                                       .tol = s.tolerance,
                                       .scratch = o->scratch};
        quiet = !plant_init(&o->plant, &p);
        plant_scene_begin(&o->plant, &s, si, drive);
    }
    for (double left = choose_frames(&c->scene) * s.substeps; left > 0.0 && quiet; left--)
        quiet = plant_run(&o->plant, 1) && !watch_tick(&w, &o->plant);
    free(o);
    return quiet;
}
