/* test_identities.c - identities of a steady motion of every full model, to 1e-11.
 *
 * The mean contact force balances the steady forces. The drives put in the energy that the dampers take
 * out. The paper's equations are written out here.
 *
 * A motion is settled by the plant, then carried over one period by its method from node to node. Means
 * are integrals between contact switches, cut into pieces, by the double-exponential rule: the force
 * starts like t^{3/2} at a touchdown, which that does not mind. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/paper.h"
#include "tests/fixture/trajectory.h"

#define TWO_PI 6.283185307179586477

enum { NODES = 36, PIECES = 64, PARTS = 40, WALK_TICKS = 512, MEANS = 5 };

/* The quantities to average, from the paper's parameters, time and state. They are forces that balance in
 * the mean (in units of the largest of them), and last the powers of dampers and drives. */
typedef void balance_function(const double *paper, double t, const double *state, double *mean);

struct steady {
    const char *name;
    double period;      /* period of the motion, paper's time */
    int settle;         /* periods */
    int switches;       /* at least, in a period */
    const char *set[5]; /* paper parameters other than the defaults */
    double value[5];
};

/* A motion at work: the plant for settling, then its method alone. */
struct walk {
    balance_function *balance;
    double paper[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    struct plant plant;
    double t; /* from the start of the period, paper's time */
    double switched[PIECES];
    int n_switched;
};

static double scratch[METHOD_SCRATCH];

/* The inputs from now on over `length` of the paper's time. */
static void excite(const struct walk *w, double length, struct segment *e)
{
    const struct plant *pl = &w->plant;
    memset(e, 0, sizeof *e);
    e->length = length / pl->scale.time_s;
    for (int i = 0; i < pl->model->n_inputs; i++) {
        const struct harmonic *d = &w->drive[i];
        double angle = d->omega * w->t + d->phase;
        if (d->amplitude == 0.0)
            continue;
        e->active |= 1u << i;
        e->wave[i] = (struct wave){.amplitude = d->amplitude /
                                                scale_of(&pl->scale, pl->model->input_signal[i].quantity),
                                   .cosine = cos(angle),
                                   .sine = sin(angle),
                                   .omega = d->omega * pl->scale.time_s};
    }
    segment_tail(e, pl->model->n_inputs, 0.0);
    segment_head(e, pl->model->n_inputs, e->length, e);
}

/* To t_end, noting switches. */
static void walk_to(struct walk *w, double t_end)
{
    struct plant *pl = &w->plant;
    struct segment e;
    struct crossing c;
    double begin = w->t;
    excite(w, t_end - w->t, &e);
    double length = e.length, done = 0.0;
    for (int i = 0; i < PIECES; i++) {
        enum step_status status = pl->step(pl->model, pl->p, pl->scratch, &e, pl->regime, pl->x, &c);
        if (status == STEP_END)
            break;
        done += c.done;
        if (status == STEP_SWITCH) {
            pl->regime ^= 1u << c.contact;
            if (w->n_switched < PIECES)
                w->switched[w->n_switched++] = begin + (t_end - begin) * (done / length);
        }
        segment_tail(&e, pl->model->n_inputs, c.done);
    }
    w->t = t_end;
}

/* The balance at the walk's instant. */
static void look(const struct walk *w, double *mean)
{
    struct segment e;
    double state[MODEL_STATES];
    excite(w, 0.0, &e);
    w->plant.model->paper_state(w->plant.p, e.at[0], w->plant.x, state);
    w->balance(w->paper, w->t, state, mean);
}

/* Adds the integral from now to t_end: t = middle + half tanh((pi/2) sinh s), the trapezoidal rule in s. */
static void integrate(struct walk *w, double t_end, double *sum)
{
    const double step = 3.1 / NODES;
    double middle = 0.5 * (w->t + t_end), half = 0.5 * (t_end - w->t), mean[MEANS] = {0};
    for (int k = -NODES; k <= NODES; k++) {
        double inner = 0.25 * TWO_PI * sinh(k * step), c = cosh(inner);
        walk_to(w, middle + half * tanh(inner));
        look(w, mean);
        for (int i = 0; i < MEANS; i++)
            sum[i] += mean[i] * half * step * 0.25 * TWO_PI * cosh(k * step) / (c * c);
    }
    walk_to(w, t_end);
}

/* Integrates between two switches, in parts no longer than `part`. */
static void integrate_parts(struct walk *w, double t_end, double part, double *sum)
{
    double begin = w->t;
    int n = 1 + (int)((t_end - begin) / part);
    for (int i = 1; i <= n; i++)
        integrate(w, begin + (t_end - begin) * i / n, sum);
}

/* At rest, then settled. */
static void walk_start(struct walk *w, const struct model *m, const struct method *method,
                       const struct steady *s)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], x[MODEL_STATES], state[MODEL_STATES];
    struct input none[MODEL_INPUTS] = {{0.0, 0.0}};
    struct scale scale;
    paper_defaults(m, w->paper);
    for (int i = 0; i < 5 && s->set[i]; i++)
        w->paper[paper_index(m, s->set[i])] = s->value[i];
    memset(w->drive, 0, sizeof w->drive);
    m->from_paper(w->paper, si, w->drive);
    m->prepare(si, p, &scale);
    m->rest(p, x);
    m->paper_state(p, none, x, state);
    paper_start_by(&w->plant, m, method, 1e-13, scratch, w->paper, s->period / WALK_TICKS, state);
    check_true("a finite motion", plant_run(&w->plant, (uint64_t)s->settle * WALK_TICKS));
}

/* By how much a period changes the state. */
static double unsteady(struct walk *w, double period)
{
    double x[MODEL_STATES], worst = 0.0;
    memcpy(x, w->plant.x, sizeof x);
    for (int i = 1; i <= WALK_TICKS; i++)
        walk_to(w, period * i / WALK_TICKS);
    for (int i = 0; i < w->plant.model->n_states; i++)
        worst = fmax(worst, fabs(w->plant.x[i] - x[i]));
    return worst;
}

static void check_steady(struct walk *w, const struct steady *s)
{
    struct walk again;
    double sum[MEANS] = {0};
    w->t = 0.0;
    w->n_switched = 0;
    again = *w;
    check_below(check_name("%s: change of the state in a period", s->name), unsteady(w, s->period), 1e-11);
    check_above("contact switches in it", w->n_switched, s->switches);
    for (int i = 0; i <= w->n_switched; i++)
        integrate_parts(&again, i < w->n_switched ? w->switched[i] : s->period, s->period / PARTS, sum);
    for (int i = 0; i < again.plant.model->n_states / 2; i++)
        check_near("mean of the forces", sum[i] / s->period, 0.0, 1e-11);
    check_near("power of the drives over that of the dampers", sum[MEANS - 1] / sum[MEANS - 2], 1.0, 1e-11);
}

static void check_all(const struct model *m, const struct method *method, balance_function *balance,
                      const struct steady *motion, int n)
{
    static struct walk w;
    w.balance = balance;
    for (int i = 0; i < n; i++) {
        walk_start(&w, m, method, &motion[i]);
        check_steady(&w, &motion[i]);
    }
}

static double rig_contact(double eta)
{
    return eta > 0.0 ? eta * sqrt(eta) : 0.0;
}

/* ---- hertz_rig: with p = q - qe, qe = a_b cos W t,
 *   p'' + 2 xi p' + (1 + a_k cos W t)(1 + 2 p/3)_+^{3/2} = 1 + sigma cos(w t + phi) + a_f cos W t - qe''
 */

static void balance_rig(const double *a, double t, const double *state, double *mean)
{
    double w = a[RIG_PAPER_FAST_OMEGA], fast = cos(w * t), sine = sin(w * t), ab = a[RIG_PAPER_BASE];
    double p = state[0] - ab * fast, p_dot = state[1] + ab * w * sine, f = rig_contact(1.0 + (2.0 / 3.0) * p);
    double slow = a[RIG_PAPER_SIGMA] * cos(a[RIG_PAPER_OMEGA] * t + a[RIG_PAPER_PHI]);
    mean[0] = (1.0 + a[RIG_PAPER_STIFFNESS] * fast) * f - 1.0;
    mean[3] = 2.0 * a[RIG_PAPER_XI] * p_dot * p_dot;
    mean[4] =
        p_dot * (slow + a[RIG_PAPER_FORCE] * fast + ab * w * w * fast - a[RIG_PAPER_STIFFNESS] * fast * f);
}

TEST(identities_rig)
{
    const double slow = TWO_PI / 0.8;
    const struct steady motion[] = {
        {"slow force, contact kept", slow, 100, 0, {"xi", "sigma", "omega"}, {0.05, 0.01, 0.8}},
        {"slow force, contact lost", slow, 100, 2, {"xi", "sigma", "omega"}, {0.05, 0.9, 0.8}},
        {"fast force 60", slow, 100, 0, {"xi", "a_force", "omega", "sigma"}, {0.05, 60, 0.8, 0.04}},
        {"fast base 5", slow, 100, 2, {"xi", "a_base", "omega", "sigma"}, {0.05, 5, 0.8, 0.04}},
        {"fast stiffness 4", slow, 100, 0, {"xi", "a_stiff", "omega", "sigma"}, {0.05, 4, 0.8, 0.04}},
    };
    check_all(&hertz_rig, &taylor, balance_rig, motion, (int)(sizeof motion / sizeof motion[0]));
}

/* ---- rolling_contact: with w = xi0 cos(W t + phi),
 *   eta'' + 2 zeta eta' + (2/3)(eta_+^{3/2} - 1) = w'' + 2 zeta w'
 */

static void balance_rolling(const double *a, double t, const double *state, double *mean)
{
    double zeta = a[0], w = a[2], angle = w * t + a[3];
    double f = -a[1] * w * (w * cos(angle) + 2.0 * zeta * sin(angle));
    mean[0] = rig_contact(state[0]) - 1.0;
    mean[3] = 2.0 * zeta * state[1] * state[1];
    mean[4] = state[1] * f;
}

TEST(identities_rolling)
{
    const struct steady motion[] = {
        {"waviness, contact kept", TWO_PI / 0.7, 120, 0, {"zeta", "xi0", "Omega"}, {0.05, 0.1, 0.7}},
        {"waviness, contact lost", TWO_PI / 0.9, 150, 2, {"zeta", "xi0", "Omega"}, {0.05, 0.5, 0.9}},
        {"waviness above the resonance", TWO_PI / 1.7, 400, 0, {"zeta", "xi0", "Omega"}, {0.05, 0.3, 1.7}},
    };
    check_all(&rolling_contact, &taylor, balance_rolling, motion, (int)(sizeof motion / sizeof motion[0]));
}

/* ---- afm_tip: u'' + c u' + u + s (2/3) beta [(1 + r cos W t)(1 - u)_+^{3/2} - 1] = f cos(w t + phi) ---- */

static void balance_tip(const double *a, double t, const double *state, double *mean)
{
    double pull = a[TIP_PAPER_SIGN] * (2.0 / 3.0) * a[TIP_PAPER_BETA], force = rig_contact(1.0 - state[0]);
    double modulation = a[TIP_PAPER_R] * cos(a[TIP_PAPER_FAST_OMEGA] * t);
    double drive = a[TIP_PAPER_F] * cos(a[TIP_PAPER_OMEGA] * t + a[TIP_PAPER_PHI]);
    mean[0] = state[0] + pull * ((1.0 + modulation) * force - 1.0);
    mean[3] = a[TIP_PAPER_C] * state[1] * state[1];
    mean[4] = state[1] * (drive - pull * modulation * force);
}

TEST(identities_tip)
{
    const struct steady motion[] = {
        {"published sign", TWO_PI / 0.5, 60, 0, {"sign", "c", "omega", "f"}, {1, 0.1, 0.5, 0.05}},
        {"published sign, modulated", TWO_PI, 120, 0, {"sign", "c", "r", "Omega"}, {1, 0.1, 0.3, 3.0}},
        {"repulsive, contact lost", TWO_PI / 1.3, 150, 2, {"sign", "c", "omega", "f"}, {-1, 0.1, 1.3, 0.6}},
        {"repulsive, modulated", TWO_PI, 150, 0, {"sign", "c", "r", "Omega"}, {-1, 0.1, 0.5, 3.0}},
    };
    check_all(&afm_tip, &taylor, balance_tip, motion, (int)(sizeof motion / sizeof motion[0]));
}

/* ---- shaft_bearing: M x'' + C x' + K x + f_gap = p cos(2 pi f t), SI ---- */

static void balance_shaft(const double *a, double t, const double *x, double *mean)
{
    double k = a[SHAFT_KAPPA] / (a[SHAFT_LENGTH] * a[SHAFT_LENGTH]), bend = k * (x[0] - 2.0 * x[1] + x[2]);
    double over1 = shaft_bearing_over(x[0], a[SHAFT_G1]), over3 = shaft_bearing_over(x[2], a[SHAFT_G3]);
    double unit = 25.0; /* N */
    mean[0] = (2.0 * a[SHAFT_KS1] * x[0] + bend + a[SHAFT_KG1] * over1) / unit;
    mean[1] = -2.0 * bend / unit;
    mean[2] = (2.0 * a[SHAFT_KS3] * x[2] + bend + a[SHAFT_KG3] * over3) / unit;
    mean[3] = a[SHAFT_C1] * x[3] * x[3] + a[SHAFT_C2] * x[4] * x[4] + a[SHAFT_C3] * x[5] * x[5];
    mean[4] = 25.0 * cos(TWO_PI * a[paper_index(&shaft_bearing, "freq_hz")] * t) * x[4];
}

TEST(identities_shaft)
{
    const struct steady motion[] = {
        {"shaft, no contact", 1.0 / 80.0, 2000, 0, {"p2", "freq_hz"}, {25, 80}},
        {"shaft, soft stops",
         1.0 / 20.0,
         600,
         8,
         {"p2", "freq_hz", "kg1", "kg3"},
         {25, 20, 2.626e4, 2.626e4}},
        {"shaft, hard stops",
         1.0 / 20.0,
         100,
         16,
         {"p2", "freq_hz", "c1", "c2", "c3"},
         {25, 20, 139, 278, 139}},
    };
    check_all(&shaft_bearing, &exact, balance_shaft, motion, (int)(sizeof motion / sizeof motion[0]));
}
