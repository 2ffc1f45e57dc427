/* choose_ladder.c - see choose_ladder.h. */
#include <math.h>
#include <stdio.h>

#include "host_sim/choose/choose_ladder.h"
#include "host_sim/out/plural.h"
#include "models/afm_lever.h"
#include "models/reduced/afm_tip_reduced.h"
#include "models/math/elementary.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/reduced/shaft_mode.h"
#include "models/rolling_contact.h"
#include "models/shaft_views.h"

/* Parameters of an averaged model that stand for the fast inputs, those from `first` on. */
struct fast {
    int first, hz, amplitude; /* its parameters: the frequency, and the amplitude of input `first` */
};
static const struct fast rig_fast = {RIG_FAST_FORCE, RIG_FAST_HZ, RIG_FAST_FORCE_N};
static const struct fast tip_fast = {TIP_STIFFNESS, TIP_FAST_HZ, TIP_FAST_STIFFNESS};

/* No cubic model stands below rig and tip: a Hertzian contact is one square root, and a cubic force costs
 * as much. */
static const struct {
    const struct model *full, *candidate;
    enum choose_kind kind;
    int mode;                /* that it keeps, or 0 */
    const struct fast *fast; /* fast drive of an averaged model, else NULL */
} ladder[] = {
    {&hertz_rig, &hertz_rig_linear, KIND_LINEAR, 0, NULL},
    {&hertz_rig, &hertz_rig_averaged, KIND_AVERAGED, 0, &rig_fast},
    {&hertz_rig_cubic, &hertz_rig_linear, KIND_LINEAR, 0, NULL},
    {&hertz_rig_cubic, &hertz_rig_averaged, KIND_AVERAGED, 0, &rig_fast},
    {&rolling_contact, &rolling_contact_linear, KIND_LINEAR, 0, NULL},
    {&afm_tip, &afm_tip_linear, KIND_LINEAR, 0, NULL},
    {&afm_tip, &afm_tip_averaged, KIND_AVERAGED, 0, &tip_fast},
    {&afm_tip_cubic, &afm_tip_linear, KIND_LINEAR, 0, NULL},
    {&afm_tip_cubic, &afm_tip_averaged, KIND_AVERAGED, 0, &tip_fast},
    {&shaft_bearing, &shaft_bearing_linear, KIND_GAPLESS, 0, NULL},
    {&shaft_bearing, &shaft_bearing_mode, KIND_MODE, 1, NULL},
    {&shaft_bearing, &shaft_bearing_mode, KIND_MODE, 2, NULL},
    {&shaft_bearing, &shaft_bearing_mode, KIND_MODE, 3, NULL},
};
enum { LADDER = sizeof ladder / sizeof ladder[0] };

bool choose_ladder_modal(const struct model *m)
{
    for (int i = 0; i < LADDER; i++)
        if (ladder[i].full == m && ladder[i].kind == KIND_MODE)
            return true;
    return false;
}

static bool sounds(const struct harmonic *d)
{
    return d->amplitude < 0.0 || d->amplitude > 0.0;
}

/* The state at the start, in model units of its own model. */
static void begin_state(const struct scene *s, struct scene_point *o, double *x)
{
    point_of_scene(s, o);
    scenes_begin(s, o->si, o->drive, x);
}

/* Makes the reduced model start in state x (model units). */
static void put_start(struct scene *s, const double *x)
{
    struct scene_point o;
    struct input silent[MODEL_INPUTS] = {{0.0, 0.0}};
    point_of_scene(s, &o);
    s->started = true;
    if (s->paper)
        s->model->paper_state(o.p, silent, x, s->start);
    for (int i = 0; i < s->model->n_states && !s->paper; i++)
        s->start[i] = x[i] * scale_of(&o.scale, s->model->state_signal[i].quantity);
}

/* Moves the one fast input that sounds into the parameters of an averaged model. NULL or a reason. */
static const char *take_fast(const struct scene *full, const struct harmonic *drive, const struct fast *own,
                             struct scene *candidate, int *fast)
{
    int n_inputs = full->model->n_inputs;
    *fast = -1;
    for (int i = own->first; i < n_inputs; i++) {
        if (full->drive[i].noise > 0.0)
            return "averaging has no place for noise on a fast input";
        if (sounds(&drive[i]) && *fast >= 0)
            return "averaging takes one fast drive, here are two";
        *fast = sounds(&drive[i]) ? i : *fast;
    }
    if (*fast < 0)
        return "no fast drive to average over";
    for (int i = own->first; i < n_inputs; i++)
        candidate->drive[i] = (struct scene_drive){.amplitude = 0.0};
    if (!candidate->paper) {
        candidate->value[own->hz] = drive[*fast].omega / (2.0 * ELEMENTARY_PI);
        candidate->value[own->amplitude + (*fast - own->first)] = drive[*fast].amplitude;
    }
    return NULL;
}

/* The slow motion starts where the full one does, less the fast motion there: that of a free mass under
 * the fast drive. */
static const char *to_averaged(const struct scene *full, const struct fast *own, struct scene *candidate)
{
    double x[MODEL_STATES], x_dot[2][MODEL_STATES], cosine, sine;
    struct scene_point o;
    struct input u[MODEL_INPUTS] = {{0.0, 0.0}};
    int fast;
    begin_state(full, &o, x);
    const char *why = take_fast(full, o.drive, own, candidate, &fast);
    if (why)
        return why;
    double W = o.drive[fast].omega * o.scale.time_s;
    if (!(W > 0.0))
        return "the fast drive has no frequency";
    full->model->rhs(o.p, u, x, x_dot[0]);
    u[fast].value = o.drive[fast].amplitude / scale_of(&o.scale, full->model->input_signal[fast].quantity);
    full->model->rhs(o.p, u, x, x_dot[1]);
    double a = (x_dot[1][1] - x_dot[0][1]) / (W * W);
    cos_sin(o.drive[fast].phase, &cosine, &sine);
    x[0] += a * cosine;
    x[1] -= a * W * sine;
    put_start(candidate, x);
    return NULL;
}

void choose_ladder_modes(const double *p, double shape[3][3], const double *x, double q[3])
{
    for (int k = 0; k < 3; k++) {
        const double *s = shape[k];
        double size = fmax(fabs(s[0]), fabs(s[2])), sign = s[0] < 0.0 ? -1.0 : 1.0, mass = 0.0, sum = 0.0;
        for (int i = 0; i < 3; i++) {
            mass += p[SHAFT_P_MASS + i] * s[i] * s[i];
            sum += p[SHAFT_P_MASS + i] * s[i] * x[i];
        }
        q[k] = sign * size * sum / mass;
    }
}

/* The full motion seen along one open mode. */
static const char *to_mode(const struct scene *full, struct scene *candidate, int mode)
{
    double x[MODEL_STATES], q[2][3], shape[3][3], one[MODEL_STATES] = {0.0};
    struct scene_point o;
    candidate->value[candidate->paper ? (int)SHAFT_PAPER_MODE : (int)SHAFT_MODE] = mode;
    if (!full->started)
        return NULL;
    begin_state(full, &o, x);
    shaft_open_modes(o.p, shape);
    choose_ladder_modes(o.p, shape, x, q[0]);
    choose_ladder_modes(o.p, shape, x + 3, q[1]);
    one[0] = q[0][mode - 1];
    one[1] = q[1][mode - 1];
    put_start(candidate, one);
    return NULL;
}

static const char *map(const struct scene *full, int i, struct scene *candidate)
{
    *candidate = *full;
    candidate->model = ladder[i].candidate;
    if (full->observable >= candidate->model->n_outputs)
        return "it does not have the observable asked for";
    if (ladder[i].mode > 0)
        return to_mode(full, candidate, ladder[i].mode);
    return ladder[i].fast ? to_averaged(full, ladder[i].fast, candidate) : NULL;
}

static void name(struct choose_candidate *candidate, int mode)
{
    char number[12] = "";
    if (mode > 0)
        snprintf(number, sizeof number, " %d", mode);
    snprintf(candidate->name, sizeof candidate->name, "%s%s", candidate->scene.model->name, number);
}

/* ---- levers ---- */

/* The kept modes start as they did. */
static void keep_modes(struct scene *s, int modes)
{
    double beta = beam_modes[0].beta;
    int all = (int)s->value[LEVER_MODES];
    for (int i = modes; i < all; i++)
        s->start[i] = s->start[LEVER_RATE + i] = 0.0;
    if (modes == 1 && all > 1)
        s->value[LEVER_K] *= beta * beta * beta * beta / 12.0;
    s->value[LEVER_MODES] = modes;
}

static void reduce(const struct scene *full, int modes, bool bare, struct choose_candidate *candidate)
{
    bool fewer = modes < (int)full->value[LEVER_MODES];
    *candidate = (struct choose_candidate){.scene = *full};
    candidate->kind = (enum choose_kind)((fewer ? KIND_FEWER : 0) | (bare ? KIND_BARE : 0));
    snprintf(candidate->name, sizeof candidate->name, "%s, %d mode%s%s", full->model->name, modes,
             plural(modes), bare ? ", no attraction" : "");
    keep_modes(&candidate->scene, modes);
    if (bare)
        candidate->scene.value[LEVER_HAMAKER] = candidate->scene.value[LEVER_HAMAKER_OUT] = 0.0;
}

static int lever_ladder(const struct scene *s, struct choose_candidate *candidate)
{
    int all = (int)s->value[LEVER_MODES], n = 0;
    for (int modes = 1; modes <= all && s->value[LEVER_HAMAKER] > 0.0; modes++)
        reduce(s, modes, true, &candidate[n++]);
    for (int modes = 1; modes < all; modes++)
        reduce(s, modes, false, &candidate[n++]);
    return n;
}

/* ---- all ---- */

int choose_ladder(const struct scene *s, struct choose_candidate candidate[CHOOSE_CANDIDATES])
{
    int n = s->model->modal_form ? lever_ladder(s, candidate) : 0;
    for (int i = 0; i < LADDER; i++) {
        if (ladder[i].full != s->model)
            continue;
        candidate[n].refused = map(s, i, &candidate[n].scene);
        candidate[n].kind = ladder[i].kind;
        name(&candidate[n++], ladder[i].mode);
    }
    candidate[n] = (struct choose_candidate){.scene = *s, .kind = KIND_OWN};
    name(&candidate[n], 0);
    return n + 1;
}
