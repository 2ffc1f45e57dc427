/* rate_cases.c - see rate_cases.h. */
#include "tests/bench/rate/rate_cases.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "models/text.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/shaft_bearing.h"

#define TWO_PI 6.283185307179586477

/* Driven at the eigenfrequency sqrt(1 -+ beta). */
#define TIP(beta, r, f, omega, sign)                                                                         \
    {                                                                                                        \
        {"beta", beta}, {"r", r}, {"Omega", 3.0}, {"f", f}, {"omega", omega}, {"sign", sign},                \
    }

/* clang-format off: a table */
const struct rate_case rate_case[RATE_CASES] = {
    {"rig_lost", &hertz_rig, {{"xi", 0.01}, {"sigma", 0.3}, {"omega", 0.9}}, 0.75, RIG_FORCE, 20, 1, false},
    {"rig_kept", &hertz_rig, {{"xi", 0.01}, {"sigma", 0.04}, {"omega", 0.9}}, 0.5, RIG_FORCE, 20, 1, false},
    {"shaft",
     &shaft_bearing,
     {{"c1", 139}, {"c2", 139}, {"c3", 139}, {"p2", 25}, {"freq_hz", 25}},
     0.9 * 2.54e-4,
     1,
     4,
     8,
     false},
    {"tip_attracted", &afm_tip, TIP(0.8, 0.5, 0.008, 0.44721, 1.0), 0.0, TIP_FORCE, 100, 1, true},
    {"tip_repelled", &afm_tip, TIP(0.8, 0.5, 0.008, 1.34164, -1.0), 0.0, TIP_FORCE, 100, 1, true},
    {"tip_stiff", &afm_tip, TIP(29.7, 0.0, 0.008, 5.54076, -1.0), 0.0, TIP_FORCE, 100, 1, true},
    {"tip_stiff_lost", &afm_tip, TIP(29.7, 0.0, 0.3, 5.54076, -1.0), 0.0, TIP_FORCE, 100, 1, true},
};
/* clang-format on */

/* Fixed steps: 16 to 1024, four in an octave. */
enum { FIXED = 25, EXACT = 3, TAYLOR = 5 /* tolerances */ };

static int steps_of(int i)
{
    static const int octave[] = {16, 20, 24, 28};
    return octave[i % 4] << (i / 4);
}

struct rate_setting rate_setting(const struct rate_case *c, int i)
{
    static const int tolerance[TAYLOR] = {2, 3, 4, 6, 9}, long_step[] = {16, 24, 48};
    if (i < FIXED)
        return (struct rate_setting){&rk4, c->finer * steps_of(i), 0};
    if ((i -= FIXED) < FIXED)
        return (struct rate_setting){&rk4_float32, c->finer * steps_of(i), 0};
    if ((i -= FIXED) < FIXED)
        return (struct rate_setting){&adams, c->finer * steps_of(i), 0};
    if ((i -= FIXED) < EXACT)
        return (struct rate_setting){&exact, c->finer * 32 << i, 0};
    i -= EXACT;
    return (struct rate_setting){&taylor, long_step[i / TAYLOR], tolerance[i % TAYLOR]};
}

/* The paper's parameters of a case, in the order of its model's table. */
static void paper_of(const struct rate_case *c, double *paper)
{
    const struct model *m = c->model;
    for (int i = 0; i < m->n_paper; i++) {
        paper[i] = m->paper[i].initial;
        for (int k = 0; k < RATE_SET && c->set[k].name; k++)
            if (text_equal(c->set[k].name, m->paper[i].name))
                paper[i] = c->set[k].value;
    }
}

/* The silicon lever of the paper's section 3.3 with the same dimensionless numbers; drives in its units. */
static void make_lever(const double *paper, double *si, struct harmonic *drive)
{
    const struct parameter *lever = afm_tip_parameters;
    double k = lever[TIP_LEVER_STIFFNESS].initial, m = lever[TIP_MASS].initial;
    double root = paper[TIP_PAPER_BETA] * k / (1.5 * lever[TIP_CONTACT_STIFFNESS].initial);
    for (int i = 0; i < TIP_PARAMETERS; i++)
        si[i] = lever[i].initial;
    si[TIP_DAMPING] = paper[TIP_PAPER_C] * sqrt(k * m);
    si[TIP_INDENTATION] = root * root;
    si[TIP_SIGN] = paper[TIP_PAPER_SIGN];
    for (int i = 0; i < TIP_INPUTS; i++)
        drive[i].omega *= sqrt(k / m);
    drive[TIP_FORCE].amplitude *= k * si[TIP_INDENTATION];
}

/* Radians per second of what a case's periods are of. */
static double omega_of(const struct rate_case *c, const double *si, const struct harmonic *drive)
{
    return c->lever ? sqrt(si[TIP_LEVER_STIFFNESS] / si[TIP_MASS]) : drive[c->drive].omega;
}

const char *rate_start(struct rate_run *r, const struct rate_case *c, const struct rate_setting *s,
                       bool force)
{
    double paper[MODEL_PARAMETERS], si[MODEL_PARAMETERS], x[MODEL_STATES], start[MODEL_STATES] = {0.0};
    struct harmonic drive[MODEL_INPUTS];
    struct plant *pl = &r->plant;
    struct plant_config config = {.model = c->model, .si = si, .method = s->method, .dilation = 1.0};
    memset(drive, 0, sizeof drive);
    paper_of(c, paper);
    c->model->from_paper(paper, si, drive);
    if (c->lever)
        make_lever(paper, si, drive);
    config.tick_s = TWO_PI / (omega_of(c, si, drive) * s->steps);
    config.tol = s->tolerance > 0 ? 1.0 : 0.0;
    for (int i = 0; i < s->tolerance; i++)
        config.tol *= 0.1;
    config.force = force;
    config.scratch = r->scratch;
    const char *why = plant_init(pl, &config);
    if (why)
        return why;
    for (int i = 0; i < c->model->n_inputs; i++) {
        if (drive[i].amplitude != 0.0)
            plant_drive_start(pl, i, drive[i].amplitude, drive[i].omega / TWO_PI, drive[i].phase);
    }
    start[0] = c->start;
    c->model->state_from_paper(pl->p, pl->segment.at[2], start, x);
    plant_set_state(pl, x);
    lockin_begin(&r->window, (uint32_t)(c->periods * s->steps));
    r->sum = (struct lockin_sum){0.0, 0.0};
    return NULL;
}

/* The lock-in takes a tick that ends in state x with inputs u and the drives' phasors. */
static void hear(struct rate_run *r, const struct plant *pl, const struct input *u, const double *x,
                 struct phasor phasor)
{
    double output[MODEL_OUTPUTS], phase;
    pl->model->output(pl->p, u, x, output);
    lockin_add(&r->sum, 1, lockin_weight(&r->window) * output[0], phasor.cosine, phasor.sine);
    if (r->window.i_tick < r->window.n_ticks)
        return;
    lockin_polar(&r->sum, 2.0 / r->window.weight, &r->amplitude, &phase);
    lockin_begin(&r->window, r->window.n_ticks);
    r->sum = (struct lockin_sum){0.0, 0.0};
}

/* A plant_look. */
static void listen(void *run, const struct plant *pl)
{
    struct rate_run *r = run;
    const struct drive *d = &pl->drive[r->drive];
    hear(r, pl, pl->segment.at[2], pl->x, (struct phasor){d->cosine, d->sine});
}

/* A plant_look_ticks. */
static void listen_ticks(void *run, const struct plant *pl, const struct method_block *b, uint32_t from,
                         uint32_t n)
{
    struct rate_run *r = run;
    for (uint32_t k = from + 1; k <= from + n; k++)
        hear(r, pl, b->at[2 * k], b->x[k], b->phasor[k][r->drive]);
}

bool rate_advance(struct rate_run *r, const struct rate_case *c, uint32_t ticks)
{
    r->drive = c->drive;
    return c->lever ? plant_run_seen(&r->plant, ticks, listen, listen_ticks, r) : plant_run(&r->plant, ticks);
}
