/* choose_refuse.c - refusals before a run, from linear theory and from what the truth has shown; see choose.h. */
#include <math.h>
#include <stdarg.h>

#include "host_sim/choose/choose_steps.h"
#include "models/math/elementary.h"
#include "models/shaft_bearing.h"

static const double sure = 30.0; /* predicted errors this far above the tolerance refuse without a run */

enum { VELOCITY = 1, PENETRATION = 2, FORCE = 3 }; /* outputs of every model */

/* Is the compression asked for, or what contains it? */
static bool asks_position(const struct scene *s)
{
    return (int)s->observable != VELOCITY;
}

/* Of a contact that is never made there is nothing to see. */
static bool asks_nothing(const struct choose_certificate *c)
{
    return c->high < 0.0 && ((int)c->scene.observable == PENETRATION || (int)c->scene.observable == FORCE);
}

static void test_averaged(const struct choose_certificate *c, struct choose_verdict *v)
{
    const struct choose_facts *f = &c->facts;
    if (f->fast < 3.0 * f->slow)
        choose_say(v->refused, "its fast drive is only %.3g times the fastest slow frequency, 3 are needed",
                   f->fast / f->slow);
    v->predicted = f->fast_amplitude / (c->high - c->low);
    if (!*v->refused && asks_position(&c->scene) && v->predicted > 3.0 * c->scene.tolerance)
        choose_say(v->refused, "it leaves out the fast motion, %.2g of the observable", v->predicted);
}

static void test_mode(const struct choose_certificate *c, struct choose_verdict *v, int kept)
{
    double dropped = 0.0, all = c->modes[kept];
    for (int k = 0; k < 3; k++)
        dropped = k == kept ? dropped : fmax(dropped, c->modes[k]);
    v->predicted = 0.5 * dropped / fmax(all, dropped);
    if (v->predicted > sure * c->scene.tolerance && !asks_nothing(c))
        choose_say(v->refused,
                   "the modes that it drops move %.2g of the one it keeps, in the full model with a seeded "
                   "asymmetry",
                   dropped / fmax(all, 1e-300));
}

static void test_linear(const struct choose_certificate *c, struct choose_verdict *v)
{
    const struct choose_facts *f = &c->facts;
    if (v->rung.scene.model->n_states != 2) {
        v->predicted = f->beyond_gap;
        if (f->settle > 3.0 && v->predicted > sure * c->scene.tolerance)
            choose_say(
                v->refused,
                "the predicted amplitude is %.3g of the gap: beyond it, it is off by %.2g of its motion",
                f->amplitude, v->predicted);
        return;
    }
    v->predicted = choose_mismatch(&c->scene, &v->rung.scene, f->amplitude);
    if (f->settle > 3.0 && asks_position(&c->scene) && v->predicted > sure * c->scene.tolerance)
        choose_say(
            v->refused,
            "at the predicted amplitude of %.2g of the static compression its force is off by %.2g of its "
            "range",
            f->amplitude, v->predicted);
}

/* Cheap tests; fills predicted and refused. */
void choose_refuse(const struct search *o, struct choose_verdict *v, bool full)
{
    const struct choose_certificate *c = o->c;
    const struct scene *s = &v->rung.scene;
    const struct choose_facts *f = &c->facts;
    double periods = f->fast * c->scene.over / (2.0 * ELEMENTARY_PI);
    char why[SCENE_CHECK_REASON];
    struct scene any = *s;
    if (v->rung.refused)
        choose_say(v->refused, "%s", v->rung.refused);
    else if (c->sweep.steps > 0 && c->sweep.input >= s->model->n_inputs)
        choose_say(v->refused, "it does not have the input that is swept");
    else if (!choose_tighten(&any, CHOOSE_LOOSE, 1.0, why))
        choose_say(v->refused, "%.200s", why);
    if (*v->refused || full)
        return;
    if (choose_ladder_averaged(s->model))
        test_averaged(c, v);
    else if (v->rung.mode > 0)
        test_mode(c, v, (int)s->value[s->paper ? s->model->n_paper - 1 : (int)SHAFT_MODE] - 1);
    else if (v->rung.order > 0)
        test_linear(c, v);
    if (!*v->refused && f->multiplier > 1.0 + 1e-9 && periods * log(f->multiplier) > 7.0 &&
        (choose_ladder_averaged(s->model) || v->rung.order == 1))
        choose_say(v->refused, "the linear part is unstable under its modulation: Floquet multiplier %.4g",
                   f->multiplier);
}
