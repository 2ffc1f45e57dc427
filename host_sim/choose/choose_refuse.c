/* choose_refuse.c - see choose_refuse.h. */
#include <math.h>

#include "host_sim/choose/choose_refuse.h"
#include "host_sim/choose/choose_tell.h"
#include "host_sim/choose/choose_theory.h"
#include "host_sim/choose/choose_truth.h"
#include "models/math/elementary.h"
#include "models/shaft_bearing.h"

static const double sure =
    30.0; /* an error predicted to be this many times the tolerance refuses without a run */

/* Is the compression asked for, or what contains it? */
static bool asks_position(const struct choose_certificate *c)
{
    return (int)c->scene.observable != OUTPUT_VELOCITY;
}

/* The contact never closes: penetration and force are identically zero. */
static bool asks_nothing(const struct choose_certificate *c)
{
    return c->high < 0.0 &&
           ((int)c->scene.observable == OUTPUT_PENETRATION || (int)c->scene.observable == OUTPUT_FORCE);
}

static bool is_slow(const struct choose_certificate *c, struct choose_verdict *v, double blank[2])
{
    v->predicted = c->facts.fast_amplitude / (c->high - c->low);
    blank[0] = c->facts.fast / c->facts.slow;
    return c->facts.fast < 3.0 * c->facts.slow;
}

static bool leaves_out(const struct choose_certificate *c, struct choose_verdict *v, double blank[2])
{
    blank[0] = v->predicted;
    return asks_position(c) && v->predicted > 3.0 * c->scene.tolerance;
}

static bool drops_modes(const struct choose_certificate *c, struct choose_verdict *v, double blank[2])
{
    const struct scene *s = &v->candidate.scene;
    int kept = (int)s->value[s->paper ? s->model->n_paper - 1 : (int)SHAFT_MODE] - 1;
    double dropped = 0.0, all = c->modes[kept];
    for (int k = 0; k < 3; k++)
        dropped = k == kept ? dropped : fmax(dropped, c->modes[k]);
    v->predicted = 0.5 * dropped / fmax(all, dropped);
    blank[0] = dropped / fmax(all, 1e-300);
    return v->predicted > sure * c->scene.tolerance && !asks_nothing(c);
}

static bool passes_gap(const struct choose_certificate *c, struct choose_verdict *v, double blank[2])
{
    v->predicted = c->facts.beyond_gap;
    blank[0] = c->facts.amplitude;
    blank[1] = v->predicted;
    return c->facts.settle > 3.0 && v->predicted > sure * c->scene.tolerance;
}

static bool misses_force(const struct choose_certificate *c, struct choose_verdict *v, double blank[2])
{
    v->predicted = choose_mismatch(&c->scene, &v->candidate.scene, c->facts.amplitude);
    blank[0] = c->facts.amplitude;
    blank[1] = v->predicted;
    return c->facts.settle > 3.0 && asks_position(c) && v->predicted > sure * c->scene.tolerance;
}

static bool is_unstable(const struct choose_certificate *c, struct choose_verdict *v, double blank[2])
{
    double periods = c->facts.fast * c->scene.over / (2.0 * ELEMENTARY_PI);
    (void)v;
    blank[0] = c->facts.multiplier;
    return c->facts.multiplier > 1.0 + 1e-9 && periods * log(c->facts.multiplier) > 7.0;
}

/* The name, the kinds of reduced models that it concerns, the test, and the sentence of refusal with its
 * numbers. The test also fills predicted. */
static const struct {
    const char *name;
    unsigned kinds;
    bool (*refuses)(const struct choose_certificate *c, struct choose_verdict *v, double blank[2]);
    const char *sentence;
} test[] = {
    {"fast drive", KIND_AVERAGED, is_slow,
     "its fast drive is only %.3g times as fast as the fastest slow frequency; averaging needs 3 times"},
    {"fast motion", KIND_AVERAGED, leaves_out,
     "it leaves out the fast motion, which is %.2g of the observable's range"},
    {"dropped modes", KIND_MODE, drops_modes,
     "the modes that it drops move %.2g times as far as the one it keeps, in the full model with a seeded "
     "asymmetry"},
    {"gap", KIND_GAPLESS, passes_gap,
     "linear theory predicts an amplitude of %.3g of the gap; what is beyond the gap makes an error of %.2g"},
    {"force law", KIND_LINEAR, misses_force,
     "at the predicted amplitude of %.2g of the static compression its force is off by %.2g of its range"},
    {"Floquet", KIND_LINEAR | KIND_AVERAGED | KIND_GAPLESS, is_unstable,
     "the linear part is unstable under its modulation, with a Floquet multiplier of %.4g"},
};

void choose_refuse(const struct search *o, struct choose_verdict *v)
{
    const struct choose_certificate *c = o->c;
    char why[SCENE_CHECK_REASON];
    struct scene any = v->candidate.scene;
    if (v->candidate.refused)
        choose_say(v->refused, "%s", v->candidate.refused);
    else if (c->sweep.Hz.n > 0 && c->sweep.input >= any.model->n_inputs)
        choose_say(v->refused, "it does not have the input that is swept");
    else if (!choose_tighten(&any, CHOOSE_LOOSE, 1.0, why))
        choose_say(v->refused, "%.200s", why);
    for (int i = 0; i < (int)(sizeof test / sizeof test[0]) && !*v->refused; i++) {
        double blank[2] = {0.0, 0.0};
        if ((test[i].kinds & v->candidate.kind) && test[i].refuses(c, v, blank))
            choose_say(v->refused, test[i].sentence, blank[0], blank[1]);
    }
}
