/* batch.c - see batch.h. */
#include "tests/batch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/rolling_contact.h"
#include "tests/exact.h"
#include "tests/test.h"

#define TWO_PI 6.283185307179586477

void batch_inputs(const struct batch_trajectory *t, double time, struct input *u)
{
    memset(u, 0, MODEL_INPUTS * sizeof *u);
    for (int i = 0; i < t->model->n_inputs; i++) {
        const struct harmonic *h = &t->drive[i];
        u[i].value = h->amplitude * cos(h->omega * time + h->phase);
        u[i].rate = -h->amplitude * h->omega * sin(h->omega * time + h->phase);
    }
}

void batch_of_paper(struct batch_one *o, const struct model *m, const double *paper, const double *state,
                    double interval)
{
    struct scale scale;
    struct input u[MODEL_INPUTS];
    double si[MODEL_PARAMETERS];
    memset(o, 0, sizeof *o);
    m->from_paper(paper, si, o->t.drive);
    m->prepare(si, o->p, &scale);
    o->t.model = m;
    o->t.p = o->p;
    o->t.interval = interval;
    batch_inputs(&o->t, 0.0, u);
    m->state_from_paper(o->p, u, state, o->t.x);
}

void *batch_make(struct batch_taylor *b, int n)
{
    void *memory = malloc(batch_taylor_bytes(n));
    if (!memory)
        abort();
    batch_taylor_init(b, n, memory);
    return memory;
}

void batch_put(struct batch_taylor *b, int i, struct batch_one *o)
{
    o->t.p = o->p;
    const char *why = batch_taylor_set(b, i, &o->t);
    if (why)
        check_string("batch_taylor_set", why, "no refusal");
}

void batch_ran(const char *why)
{
    if (why)
        check_string("the batch runs", why, "no refusal");
}

double batch_between(uint64_t *seed, double a, double b)
{
    return a + (b - a) * exact_uniform(seed);
}

void batch_random(uint64_t *seed, struct batch_one *o)
{
    double rig[RIG_PAPER] = {batch_between(seed, 0.005, 0.05), batch_between(seed, 0.0, 0.5),
                             batch_between(seed, 0.7, 1.3),    batch_between(seed, -3.0, 3.0),
                             batch_between(seed, 4.0, 9.0),    batch_between(seed, 0.0, 5.0),
                             batch_between(seed, 0.0, 1.0),    batch_between(seed, 0.0, 0.4)};
    double rolling[] = {batch_between(seed, 0.01, 0.1), batch_between(seed, 0.0, 0.5), rig[RIG_PAPER_OMEGA],
                        rig[RIG_PAPER_PHI]};
    double tip[TIP_PAPER] = {
        0.8, 0.02, batch_between(seed, 0.0, 0.5), 5.0, batch_between(seed, 0.0, 0.3), 1.3, 0.3, -1.0};
    double state[2] = {batch_between(seed, -2.5, 1.0), batch_between(seed, -0.5, 0.5)};
    double kind = batch_between(seed, 0.0, 3.0), interval = TWO_PI / rig[RIG_PAPER_OMEGA];
    if (kind < 1.0)
        batch_of_paper(o, &rolling_contact, rolling, state, interval);
    else if (kind < 2.0)
        batch_of_paper(o, &afm_tip, tip, state, interval);
    else
        batch_of_paper(o, &hertz_rig, rig, state, interval);
}
