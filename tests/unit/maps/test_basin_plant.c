/* test_basin_plant.c - a motion of a basin map equals, to the last bit, that of a plain plant run from its
 * start one tick at a time. Compared are outcome, periods, the state where it ends, and all that is
 * measured from there. */
#include "firmware/app/plant_scene.h"
#include "firmware/plant/plant_change.h"
#include "host_sim/batch/batch_taylor_set.h"
#include "host_sim/maps/basin/basin_repeat.h"
#include "host_sim/maps/basin/basin_settle.h"
#include "host_sim/batch/batch_taylor.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/reduced/shaft_mode.h"
#include "models/shaft_views.h"
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>

enum { PLANT_STARTS = 11 /* more than lanes of a vector, and no multiple of them */ };
static const double two_pi = 2.0 * 3.14159265358979323846, tol = 1e-10;

/* A scene, and how it is run. */
struct way {
    const struct scene *scene;
    const struct method *method; /* NULL: batch_taylor, measured by taylor */
    int steps;
    struct basin_patience patience;
};

/* ---- a plain plant ---- */

static const struct method *plant_method(const struct way *w)
{
    return w->method ? w->method : &taylor;
}

/* The forcing period. */
static double period_s(const struct scene *s)
{
    double si[MODEL_PARAMETERS], slowest = (double)INFINITY;
    struct harmonic drive[MODEL_INPUTS];
    scenes_resolve(s, si, drive);
    for (int i = 0; i < s->model->n_inputs; i++)
        if (drive[i].amplitude != 0.0 && drive[i].omega > 0.0)
            slowest = fmin(slowest, drive[i].omega);
    return two_pi / slowest;
}

static void begin_plant(struct plant *pl, double *scratch, const struct way *w, int steps, const double *x)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    scenes_resolve(w->scene, si, drive);
    const struct plant_config c = {.model = w->scene->model,
                                   .si = si,
                                   .method = plant_method(w),
                                   .tick_s = period_s(w->scene) / steps,
                                   .dilation = 1.0,
                                   .tol = tol,
                                   .scratch = scratch};
    const char *why = plant_init(pl, &c);
    if (why)
        check_true(why, false);
    plant_scene_begin(pl, w->scene, si, drive);
    plant_set_state(pl, x);
}

/* Sums over ticks. */
struct account {
    double x[MODEL_STATES], square[MODEL_STATES], peak, ticks;
};

static void note(const struct plant *pl, int observable, struct account *a)
{
    double output[MODEL_OUTPUTS];
    pl->model->output(pl->p, pl->segment.at[2], pl->x, output);
    a->peak = a->ticks > 0.0 ? fmax(a->peak, output[observable]) : output[observable];
    a->ticks += 1.0;
    for (int i = 0; i < pl->model->n_states; i++) {
        a->x[i] += pl->x[i];
        a->square[i] += pl->x[i] * pl->x[i];
    }
}

/* A period, tick by tick: false, with the outcome, where it goes wrong. */
static bool run_period(struct plant *pl, int steps, int observable, struct account *a, struct basin_motion *m)
{
    for (int k = 0; k < steps; k++) {
        double size = 0.0;
        bool good = plant_run(pl, 1);
        for (int i = 0; i < pl->model->n_states; i++)
            size += fabs(pl->x[i]);
        bool lost = pl->counts.budget > 0 || pl->counts.residual > 0;
        if (!good || lost || !(size <= 1e6)) {
            m->outcome = lost ? BASIN_TROUBLE : BASIN_GONE;
            m->period = 0;
            return false;
        }
        if (a)
            note(pl, observable, a);
    }
    return true;
}

static double memory[2][METHOD_SCRATCH];

static void settle_plant(const struct way *w, const double *start, struct basin_motion *m)
{
    static struct plant pl;
    struct basin_repeat r;
    int n = w->scene->model->n_states;
    begin_plant(&pl, memory[0], w, w->steps, start);
    basin_repeat_start(&r, start, n);
    memcpy(m->end, start, sizeof m->end);
    while (m->periods < w->patience.bound && m->period == 0) {
        if (!run_period(&pl, w->steps, 0, NULL, m))
            return;
        memcpy(m->end, pl.x, (size_t)n * sizeof *pl.x);
        m->periods++;
        m->period = basin_repeat_see(&r, pl.x, n, w->patience.repeat);
    }
    m->outcome = m->period > 0 ? BASIN_SETTLED : BASIN_UNSETTLED;
}

/* By a batch of one, BASIN_CHUNK periods a call. */
static void settle_one(const struct way *w, const struct basin_plant *b, const double *start,
                       struct basin_motion *m)
{
    static double room[1024], samples[2 * BASIN_CHUNK];
    struct batch_trajectory t = {.model = b->model, .p = b->p, .interval = b->period};
    struct batch_taylor batch;
    struct basin_repeat r;
    memcpy(t.drive, b->drive, sizeof t.drive);
    memcpy(m->end, start, sizeof m->end);
    basin_repeat_start(&r, start, 2);
    if (batch_taylor_bytes(1) > sizeof room)
        check_true("room for a batch of one", false);
    m->outcome = BASIN_SETTLED;
    for (int k = 0; m->periods < w->patience.bound && m->period == 0; k++) {
        if (k % BASIN_CHUNK == 0) {
            batch_taylor_init(&batch, 1, room);
            memcpy(t.x, m->end, sizeof t.x);
            const char *why = batch_taylor_set(&batch, 0, &t);
            why = why ? why : batch_taylor(&batch, tol, BASIN_CHUNK, samples);
            if (why)
                check_true(why, false);
        }
        if (k % BASIN_CHUNK >= batch.intervals[0]) {
            m->outcome = batch.status[0] == BATCH_ESCAPED ? BASIN_GONE : BASIN_TROUBLE;
            return;
        }
        const double *sample = &samples[2 * (k % BASIN_CHUNK)];
        batch_taylor_state(&t, 0.0, sample[0], sample[1], m->end);
        m->periods++;
        m->period = basin_repeat_see(&r, m->end, 2, w->patience.repeat);
    }
    m->outcome = m->period > 0 ? BASIN_SETTLED : BASIN_UNSETTLED;
}

/* A new plant where the motion has settled, with 256 ticks a period or more. */
static void measure_plant(const struct way *w, struct basin_motion *m)
{
    static struct plant pl;
    struct account a = {.ticks = 0.0};
    int steps = w->steps > 256 ? w->steps : 256, periods = m->period > 0 ? m->period : 512;
    begin_plant(&pl, memory[0], w, steps, m->end);
    for (int k = 0; k < periods; k++)
        if (!run_period(&pl, steps, (int)w->scene->observable, &a, m))
            return;
    m->open = pl.loss_time / pl.total_time;
    m->peak = a.peak;
    for (int i = 0; i < w->scene->model->n_states; i++) {
        m->mean[i] = a.x[i] / a.ticks;
        m->rms[i] = sqrt(a.square[i] / a.ticks);
    }
}

static double largest(const double *x, const double *from, int n)
{
    double d = 0.0;
    for (int i = 0; i < n; i++)
        d = fmax(d, fabs(from ? x[i] - from[i] : x[i]));
    return d;
}

/* Two plants, the one moved back to a millionth of the other each
 * period (Benettin et al. 1980): the slope of the sum of logarithms. */
static void grow_plants(const struct way *w, struct basin_motion *m)
{
    static struct plant pl[2];
    double y[MODEL_STATES], sum = 0.0, slope = 0.0;
    int n = w->scene->model->n_states, periods = m->period > 0 ? 512 : 1024;
    for (int i = 0; i < n; i++)
        y[i] = m->end[i] + 1e-6 * (1.0 + largest(m->end, NULL, n)) / (i + 1);
    begin_plant(&pl[0], memory[0], w, w->steps, m->end);
    begin_plant(&pl[1], memory[1], w, w->steps, y);
    for (int k = -64; k < periods; k++) {
        if (!run_period(&pl[0], w->steps, 0, NULL, m) || !run_period(&pl[1], w->steps, 0, NULL, m))
            return;
        double apart = fmax(largest(pl[0].x, pl[1].x, n), 1e-300);
        double wanted = 1e-6 * (1.0 + largest(pl[0].x, NULL, n));
        for (int i = 0; i < n; i++)
            y[i] = pl[0].x[i] + (pl[1].x[i] - pl[0].x[i]) * (wanted / apart);
        plant_set_state(&pl[1], y);
        sum += log(apart / wanted);
        if (k >= 0)
            slope += (k - 0.5 * (periods - 1)) * sum;
    }
    m->growth = slope * 12.0 / (periods * ((double)periods * periods - 1.0));
}

/* ---- the two beside each other ---- */

static bool same(const struct basin_motion *a, const struct basin_motion *b, int n)
{
    size_t size = (size_t)n * sizeof a->end[0];
    return a->outcome == b->outcome && a->period == b->period && a->periods == b->periods &&
           !memcmp(&a->growth, &b->growth, sizeof a->growth) && !memcmp(&a->open, &b->open, sizeof a->open) &&
           !memcmp(&a->peak, &b->peak, sizeof a->peak) && !memcmp(a->mean, b->mean, size) &&
           !memcmp(a->rms, b->rms, size) && !memcmp(a->end, b->end, size);
}

static void read_way(const struct way *w, struct basin_plant *b)
{
    const char *why = basin_map_read(b, w->scene);
    if (why)
        check_true(why, false);
    b->method = plant_method(w);
    b->series = !w->method;
    b->tol = tol;
    b->steps = w->steps;
}

/* Starts around rest within `reach` and `speed`; what: of the
 * message. How many have each outcome, and how many switch for ever. */
static void compare(const char *what, const struct way *w, double reach, double speed, int *outcomes,
                    int *switching)
{
    static double start[PLANT_STARTS][MODEL_STATES], x[PLANT_STARTS][MODEL_STATES];
    static struct basin_motion motion[PLANT_STARTS];
    struct basin_plant b;
    int differ = 0, n = w->scene->model->n_states;
    read_way(w, &b);
    for (int i = 0; i < PLANT_STARTS; i++) {
        b.model->rest(b.p, start[i]);
        for (int k = 0; k < n; k++)
            start[i][k] += (k < n / 2 ? reach : speed) * sin(1.0 + 3.0 * i + 1.7 * k);
    }
    memcpy(x, start, sizeof x);
    check_no_error(what, basin_motion_find(&b, &w->patience, PLANT_STARTS, x, motion));
    for (int i = 0; i < PLANT_STARTS; i++) {
        struct basin_motion m = {.periods = 0};
        if (w->method)
            settle_plant(w, start[i], &m);
        else
            settle_one(w, &b, start[i], &m);
        if (m.outcome == BASIN_SETTLED || m.outcome == BASIN_UNSETTLED)
            measure_plant(w, &m);
        if (m.outcome == BASIN_SETTLED || m.outcome == BASIN_UNSETTLED)
            grow_plants(w, &m);
        differ += !same(&motion[i], &m, n);
        outcomes[m.outcome]++;
        *switching += m.open > 0.0 && m.open < 1.0;
    }
    check_int(check_name("%s: starts whose motion is not the plant's", what), differ, 0);
}

static void rig_scene(struct scene *s, double omega)
{
    scenes_default(s, &hertz_rig);
    s->paper = true;
    memset(s->value, 0, sizeof s->value);
    s->value[RIG_PAPER_XI] = 0.01;
    s->value[RIG_PAPER_SIGMA] = 0.04;
    s->value[RIG_PAPER_OMEGA] = omega;
}

static const struct basin_patience patient = {3000, 1e-8}, short_patience = {100, 1e-8};

/* Between the folds. 300 steps: the drives' phasors come
 * anew (PHASOR_RESYNC_TICKS) elsewhere in each period. */
TEST(basin_plant_rig)
{
    struct scene s;
    int outcomes[BASIN_OUTCOMES] = {0}, switching = 0;
    rig_scene(&s, 0.9580772293);
    compare("rig, rk4", &(struct way){&s, &rk4, 64, patient}, 3.0, 3.0, outcomes, &switching);
    compare("rig, rk4_unlocated", &(struct way){&s, &rk4_unlocated, 300, patient}, 3.0, 3.0, outcomes,
            &switching);
    compare("rig, taylor", &(struct way){&s, &taylor, 8, patient}, 3.0, 3.0, outcomes, &switching);
    compare("rig, batch_taylor", &(struct way){&s, NULL, 8, patient}, 3.0, 3.0, outcomes, &switching);
    check_int("they settle", outcomes[BASIN_SETTLED], 4 * PLANT_STARTS);
    check_above("of which keep losing contact", switching, 4.0);
}

/* A base moves the gap with its phase, and the rig's state
 * is read from it; a fast force and a stiffness besides. */
TEST(basin_plant_base)
{
    struct scene s;
    int outcomes[BASIN_OUTCOMES] = {0}, switching = 0;
    rig_scene(&s, 1.0);
    s.value[RIG_PAPER_FAST_OMEGA] = 4.0;
    s.value[RIG_PAPER_BASE] = 2.0;
    s.value[RIG_PAPER_PHI] = 0.7;
    compare("base, rk4", &(struct way){&s, &rk4, 75, patient}, 3.0, 3.0, outcomes, &switching);
    compare("base, rk4_unlocated", &(struct way){&s, &rk4_unlocated, 75, patient}, 3.0, 3.0, outcomes,
            &switching);
    s.value[RIG_PAPER_STIFFNESS] = 0.5;
    s.value[RIG_PAPER_FORCE] = 1.0;
    compare("all inputs, taylor", &(struct way){&s, &taylor, 20, patient}, 3.0, 3.0, outcomes, &switching);
    check_int("they settle", outcomes[BASIN_SETTLED], 3 * PLANT_STARTS);
    check_above("of which keep losing contact", switching, 10.0);
}

/* The repulsive lever loses contact under ten times its force;
 * with the published sign what starts beyond the saddle escapes. */
TEST(basin_plant_tip)
{
    static const struct {
        const char *name, *other;
        const struct method *method;
        int steps;
    } how[] = {{"lever, rk4", "tip, rk4", &rk4, 80},
               {"lever, rk4_unlocated", "tip, rk4_unlocated", &rk4_unlocated, 80},
               {"lever, taylor", "tip, taylor", &taylor, 8},
               {"lever, batch_taylor", "tip, batch_taylor", NULL, 8}};
    struct scene lever = scenes_find("tip")->scene, published = scenes_find("kb-fig16")->scene;
    int outcomes[BASIN_OUTCOMES] = {0}, gone[BASIN_OUTCOMES] = {0}, switching = 0, none = 0;
    lever.drive[0].amplitude *= 10.0;
    published.value[TIP_PAPER_R] = 0.0; /* the slow force alone */
    for (int i = 0; i < 4; i++) {
        compare(how[i].name, &(struct way){&lever, how[i].method, how[i].steps, patient}, 4.0, 4.0, outcomes,
                &switching);
        compare(how[i].other, &(struct way){&published, how[i].method, how[i].steps, patient}, 1.6, 0.15,
                gone, &none);
    }
    check_int("levers that settle", outcomes[BASIN_SETTLED], 4 * PLANT_STARTS);
    check_above("of which keep losing contact", switching, 10.0);
    check_above("tips that settle", gone[BASIN_SETTLED], 7.0);
    check_above("tips that escape", gone[BASIN_GONE], 7.0);
}

TEST(basin_plant_shaft)
{
    struct scene quiet = scenes_find("shaft-fig16-705")->scene, broken = scenes_find("shaft-fig13-18")->scene,
                 chaos = scenes_find("shaft-fig9")->scene;
    int outcomes[BASIN_OUTCOMES] = {0}, switching = 0;
    compare("705 Hz, exact", &(struct way){&quiet, &exact, 8, {9000, 1e-8}}, 4.0, 1.4, outcomes, &switching);
    compare("18 Hz, exact", &(struct way){&broken, &exact, 256, patient}, 4.0, 0.2, outcomes, &switching);
    check_int("they settle", outcomes[BASIN_SETTLED], 2 * PLANT_STARTS);
    compare("705 Hz, rk4", &(struct way){&quiet, &rk4, 48, short_patience}, 4.0, 1.4, outcomes, &switching);
    compare("25 Hz, exact", &(struct way){&chaos, &exact, 250, short_patience}, 4.0, 0.2, outcomes,
            &switching);
    check_int("they do not", outcomes[BASIN_UNSETTLED], 2 * PLANT_STARTS);
    check_above("motions that keep losing contact", switching, 20.0);
}

/* One mode: gaps that are equal close together, at one instant. */
TEST(basin_plant_mode)
{
    struct scene s = scenes_find("shaft-fig13-18")->scene;
    int outcomes[BASIN_OUTCOMES] = {0}, switching = 0;
    s.model = &shaft_bearing_mode;
    s.value[SHAFT_PAPER_MODE] = 1.0;
    compare("mode, exact", &(struct way){&s, &exact, 100, patient}, 4.0, 0.2, outcomes, &switching);
    compare("mode, rk4", &(struct way){&s, &rk4, 128, patient}, 4.0, 0.2, outcomes, &switching);
    s.value[SHAFT_G3] *= 1.1;
    compare("mode, unequal gaps, rk4", &(struct way){&s, &rk4, 128, patient}, 4.0, 0.2, outcomes, &switching);
    check_int("they settle", outcomes[BASIN_SETTLED], 3 * PLANT_STARTS);
    check_above("of which keep losing contact", switching, 10.0);
}
