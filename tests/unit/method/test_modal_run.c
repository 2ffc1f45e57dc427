/* test_modal_run.c - many ticks of `modal` in one call have the bits of its single steps. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/method/modal_run.h"
#include "tests/fixture/afm/lever.h"

enum { MODAL_TICKS = 4000, RUN = 7 };

/* A way that touches the sample: down by 12 nm and up again in a sine. */
static double place(const struct lever *l, int k)
{
    return -6e-9 * (1.0 - cos(0.004 * k)) / l->plant.scale.length_m;
}

static double force(int k)
{
    return 0.02 * sin(0.05 * k);
}

static struct modal_tick tick_at(const struct lever *l, int k, double h)
{
    double from = place(l, k), to = place(l, k + 1);
    return (struct modal_tick){{force(k), force(k + 1)}, {from, to}, 1.01 * (to - from) / h, 0.0};
}

static bool step_once(struct lever *l, const struct modal_tick *in, uint64_t tick, double *x)
{
    struct segment e = {
        .length = l->plant.h, .active = 1u << LEVER_FORCE | 1u << LEVER_Z, .instant = tick << 16};
    struct crossing unused;
    for (int k = 0; k < 3; k++)
        e.at[k][LEVER_Z] = (struct input){in->base[k / 2], in->base_rate};
    e.at[1][LEVER_Z].value = 0.5 * (in->base[0] + in->base[1]);
    e.at[0][LEVER_FORCE].value = in->force[0];
    e.at[2][LEVER_FORCE].value = in->force[1];
    return modal.bind(&afm_lever)(&afm_lever, l->plant.p, l->scratch, &e, REGIME_ANY, x, &unused) == STEP_END;
}

/* The motion by steps and by runs; true when state and forces are the same to the bit. */
static bool equal_bits(struct lever *l, double *peak)
{
    static double other[METHOD_SCRATCH];
    double x[MODEL_STATES], y[MODEL_STATES], h = l->plant.h;
    bool same = true;
    modal.prepare(&afm_lever, l->plant.p, h, 0.0, l->scratch);
    modal.prepare(&afm_lever, l->plant.p, h, 0.0, other);
    memcpy(x, l->plant.x, sizeof x);
    memcpy(y, l->plant.x, sizeof y);
    *peak = 0.0;
    for (int k = 0; k < MODAL_TICKS && same; k += RUN) {
        struct modal_tick in[RUN];
        for (int i = 0; i < RUN; i++)
            in[i] = tick_at(l, k + i, h);
        same = modal_run(&afm_lever, l->plant.p, other, in, RUN, (uint64_t)k, y);
        for (int i = 0; i < RUN; i++) {
            same &= step_once(l, &in[i], (uint64_t)(k + i), x);
            same &= in[i].peak == modal.books(l->scratch)->force;
            *peak = fmax(*peak, in[i].peak);
        }
        same &= memcmp(x, y, sizeof x) == 0;
    }
    return same;
}

static void check_lever(const char *what, int modes, int which, double value)
{
    static struct lever l;
    double peak;
    char name[64];
    lever_defaults(&l);
    l.si[LEVER_HEIGHT] = 8e-9;
    l.si[LEVER_TEMPERATURE] = 295.0;
    l.si[LEVER_MODES] = modes;
    l.si[which] = value;
    snprintf(name, sizeof name, "%s, %d modes", what, modes);
    check_no_error(name, lever_start(&l, &modal, 128.0));
    check_true(name, equal_bits(&l, &peak));
    check_above("the sample pushes, nN", peak * l.plant.scale.force_N * 1e9, 0.1);
}

TEST(modal_run_has_the_bits_of_steps)
{
    for (int modes = 1; modes <= MODEL_MODES; modes++) {
        check_lever("elastic", modes, LEVER_VISCOSITY, 0.0);
        check_lever("viscous", modes, LEVER_VISCOSITY, 100.0);
        check_lever("two branches", modes, LEVER_HAMAKER_OUT, 1e-19);
        check_lever("cold", modes, LEVER_TEMPERATURE, 0.0);
        check_lever("Gaussian heat", modes, LEVER_Q, 3.0);
        check_lever("permanent contact", modes, LEVER_PERMANENT, 1.0);
    }
}

TEST(modal_run_says_when_it_left_the_numbers)
{
    static struct lever l;
    lever_defaults(&l);
    check_no_error("lever", lever_start(&l, &modal, 128.0));
    struct modal_tick in = {{(double)INFINITY, 0.0}, {0.0, 0.0}, 0.0, 0.0};
    check_true("not finite", !modal_run(&afm_lever, l.plant.p, l.scratch, &in, 1, 0, l.plant.x));
}
