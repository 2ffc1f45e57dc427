/* test_models.c - the contract of every model in models/model.h: tables, rest, energy balance, views,
 * paper states. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/models.h"
#include "models/reduced/polynomial.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/exact.h"
#include "tests/fixture/paper.h"

enum { MODEL_TRIALS = 400 };

/* One model with random parameters, state and inputs. */
struct trial {
    const struct model *m;
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], x[MODEL_STATES];
    struct scale scale;
    struct input u[MODEL_INPUTS];
    double u_accel[MODEL_INPUTS];
};

/* Default parameters times 0.7..1.4 as far as the model
 * accepts them; a whole-numbered one keeps its value. */
static void random_parameters(struct trial *t, uint64_t *seed)
{
    int which;
    do {
        for (int i = 0; i < t->m->n_parameters; i++) {
            const struct parameter *q = &t->m->parameter[i];
            bool whole = !strcmp(q->name, "sign") || !strcmp(q->name, "mode") || !strcmp(q->name, "modes");
            double value = q->initial * (whole ? 1.0 : exact_between(seed, 0.7, 1.4));
            t->si[i] = value;
            if (!strcmp(q->name, "fast_stiffness"))
                t->si[i] = exact_between(seed, -0.3, 0.3);
            if (!strcmp(q->name, "sign") && exact_uniform(seed) < 0.5)
                t->si[i] = -1.0;
            if (!strcmp(q->name, "mode"))
                t->si[i] = 1.0 + floor(exact_between(seed, 0.0, 2.999));
        }
    } while (plant_check(t->m, t->si, &which));
    t->m->prepare(t->si, t->p, &t->scale);
}

static void random_trial(struct trial *t, const struct model *m, uint64_t *seed)
{
    memset(t, 0, sizeof *t);
    t->m = m;
    random_parameters(t, seed);
    for (int i = 0; i < m->n_states; i++)
        t->x[i] = exact_between(seed, -2.5, 2.5);
    for (int i = 0; i < m->n_inputs; i++) {
        t->u[i] = (struct input){exact_between(seed, -1.5, 1.5), exact_between(seed, -2.0, 2.0)};
        t->u_accel[i] = exact_between(seed, -2.0, 2.0);
    }
}

static double size_of(const double *x, int n)
{
    double size = 1.0;
    for (int i = 0; i < n; i++)
        size += fabs(x[i]);
    return size;
}

static void report(const char *name, const struct model *m, double worst, double limit)
{
    check_below(check_name("%s: %s", m->name, name), worst, limit);
}

/* Defaults are accepted, by the plant too; drives of the
 * paper's defaults are finite; the bus's four outputs. */
TEST(models_tables)
{
    static const enum quantity first[4] = {QUANTITY_LENGTH, QUANTITY_VELOCITY, QUANTITY_LENGTH,
                                           QUANTITY_FORCE};
    check_below("numbers of a polynomial model", POLYNOMIAL_NUMBERS, MODEL_DERIVED);
    check_below("numbers of the shaft", SHAFT_NUMBERS, MODEL_DERIVED);
    for (int k = 0; k < MODELS; k++) {
        const struct model *m = model_table[k];
        double si[MODEL_PARAMETERS], paper[MODEL_PARAMETERS];
        struct harmonic drive[MODEL_INPUTS];
        int which, faults = 0;
        for (int i = 0; i < m->n_parameters; i++)
            si[i] = m->parameter[i].initial;
        const char *why = plant_check(m, si, &which);
        check_string(m->name, why ? why : "its defaults are good", "its defaults are good");
        if (m->n_paper > 0) {
            paper_defaults(m, paper);
            m->from_paper(paper, si, drive);
            why = plant_check(m, si, &which);
            check_string(m->name, why ? why : "its paper's defaults are good",
                         "its paper's defaults are good");
        }
        for (int i = 0; i < 4; i++)
            faults += m->output_signal[i].quantity != first[i];
        faults += m->n_states > MODEL_STATES || m->n_states % 2 || m->n_inputs > MODEL_INPUTS ||
                  m->n_outputs > MODEL_OUTPUTS || m->n_contacts > MODEL_CONTACTS ||
                  m->n_parameters > MODEL_PARAMETERS || m->n_paper > MODEL_PARAMETERS;
        for (int i = 0; i < m->n_contacts; i++)
            faults += m->contact_side[i] != 1 && m->contact_side[i] != -1;
        check_int("faults of the tables", faults, 0);
    }
}

/* At rest nothing moves; a model of one degree of freedom swings about it with its eigenfrequency. */
TEST(models_rest)
{
    uint64_t seed = 11;
    for (int k = 0; k < MODELS; k++) {
        struct trial t;
        double worst = 0.0, worst_omega = 0.0;
        for (int n = 0; n < 20; n++) {
            double x[MODEL_STATES], a[MODEL_STATES], b[MODEL_STATES], step = 1e-5;
            random_trial(&t, model_table[k], &seed);
            memset(t.u, 0, sizeof t.u);
            t.m->rest(t.p, x);
            t.m->rhs(t.p, t.u, x, a);
            for (int i = 0; i < t.m->n_states; i++)
                exact_worst(&worst, (long double)(fabs(a[i])));
            if (t.m->n_states > 2 || t.m->n_contacts > 1)
                continue; /* the shaft's eigenfrequency is that of closed gaps: test_models_shaft.c */
            x[0] += step;
            t.m->rhs(t.p, t.u, x, a);
            x[0] -= 2.0 * step;
            t.m->rhs(t.p, t.u, x, b);
            double omega = t.m->eigenfrequency(t.p);
            exact_worst(&worst_omega, (long double)(fabs((b[1] - a[1]) / (2.0 * step) - omega * omega)));
        }
        report("acceleration at rest", t.m, worst, 1e-14);
        report("stiffness at rest off the eigenfrequency's square", t.m, worst_omega, 1e-8);
    }
}

TEST(models_paper_state)
{
    uint64_t seed = 12;
    for (int k = 0; k < MODELS; k++) {
        double worst = 0.0;
        for (int n = 0; model_table[k]->n_paper > 0 && n < MODEL_TRIALS; n++) {
            struct trial t;
            double q[MODEL_STATES], back[MODEL_STATES];
            random_trial(&t, model_table[k], &seed);
            t.m->paper_state(t.p, t.u, t.x, q);
            t.m->state_from_paper(t.p, t.u, q, back);
            for (int i = 0; i < t.m->n_states; i++)
                exact_worst(&worst, (long double)(fabs(back[i] - t.x[i]) / size_of(t.x, t.m->n_states)));
        }
        report("state after paper_state and back", model_table[k], worst, 1e-15);
    }
}

/* d(energy)/dt along the motion, by a central difference, is the inputs' power less the dampers'. */
TEST(models_energy)
{
    uint64_t seed = 13;
    for (int k = 0; k < MODELS; k++) {
        double worst = 0.0, worst_rhs = 0.0, least = 0.0;
        for (int n = 0; n < MODEL_TRIALS; n++) {
            struct trial t;
            struct flow f;
            double x_dot[MODEL_STATES], stored[2], power, dt;
            random_trial(&t, model_table[k], &seed);
            t.m->rhs(t.p, t.u, t.x, x_dot);
            t.m->flow(t.p, t.u, t.x, &f);
            dt = 1e-5 / size_of(x_dot, t.m->n_states);
            for (int side = 0; side < 2; side++) {
                double x[MODEL_STATES], s = side ? dt : -dt;
                struct input u[MODEL_INPUTS];
                for (int i = 0; i < t.m->n_states; i++)
                    x[i] = t.x[i] + s * x_dot[i];
                for (int i = 0; i < t.m->n_inputs; i++)
                    u[i] = (struct input){t.u[i].value + s * t.u[i].rate, t.u[i].rate};
                stored[side] = t.m->energy(t.p, u, x);
            }
            power = -f.damping;
            for (int i = 0; i < t.m->n_inputs; i++)
                power += f.work[i];
            least = fmin(least, f.damping);
            double flows = fabs(power) + size_of(x_dot, t.m->n_states) * size_of(t.x, t.m->n_states);
            exact_worst(&worst, (long double)(fabs((stored[1] - stored[0]) / (2.0 * dt) - power) / flows));
            for (int i = 0; i < t.m->n_states; i++)
                exact_worst(&worst_rhs,
                            (long double)(fabs(f.x_dot[i] - x_dot[i]) / size_of(x_dot, t.m->n_states)));
        }
        report("rate of energy off the powers, over what flows", model_table[k], worst, 1e-6);
        report("x_dot of flow off rhs", model_table[k], worst_rhs, 1e-14);
        check_is("dampers take", least, >=, 0.0);
    }
}

/* a x + b u + b_rate u' + c in the regime that the gaps tell. */
static double linear_error(const struct trial *t, const struct linear *l)
{
    double x_dot[MODEL_STATES], worst = 0.0;
    t->m->rhs(t->p, t->u, t->x, x_dot);
    for (int i = 0; i < t->m->n_states; i++) {
        double sum = l->c[i];
        for (int j = 0; j < t->m->n_states; j++)
            sum += l->a[i][j] * t->x[j];
        for (int j = 0; j < t->m->n_inputs; j++)
            sum += l->b[i][j] * t->u[j].value + l->b_rate[i][j] * t->u[j].rate;
        exact_worst(&worst, (long double)(fabs(sum - x_dot[i]) / size_of(x_dot, t->m->n_states)));
    }
    return worst;
}

static unsigned regime_of(const struct trial *t)
{
    struct input gap[MODEL_CONTACTS];
    unsigned regime = 0;
    t->m->gap(t->p, t->u, t->x, gap);
    for (int i = 0; i < t->m->n_contacts; i++)
        regime |= (gap[i].value < 0.0 ? 1u : 0u) << i;
    return regime;
}

TEST(models_linear_view)
{
    uint64_t seed = 14;
    int views = 0;
    for (int k = 0; k < MODELS; k++) {
        double worst = 0.0;
        unsigned seen[16] = {0};
        int regimes = 0, refused = 0;
        if (!model_table[k]->linear)
            continue;
        views++;
        for (int n = 0; n < 4 * MODEL_TRIALS; n++) {
            struct trial t;
            struct linear l;
            random_trial(&t, model_table[k], &seed);
            unsigned regime = regime_of(&t);
            refused += !t.m->linear(t.p, regime, &l);
            exact_worst(&worst, (long double)(linear_error(&t, &l)));
            regimes += !seen[regime]++;
        }
        report("rhs off the linear view", model_table[k], worst, 1e-13);
        check_int("regimes refused that occurred", refused, 0);
        if (model_table[k] == &shaft_bearing)
            check_int("regimes of the shaft", regimes, 9);
    }
    check_int("linear views: four linear models, the shaft and its mode", views, 6);
}

TEST(models_hertz_form)
{
    uint64_t seed = 15;
    int views = 0;
    for (int k = 0; k < MODELS; k++) {
        double worst = 0.0, worst_gap = 0.0;
        if (!model_table[k]->hertz_form)
            continue;
        views++;
        for (int n = 0; n < MODEL_TRIALS; n++) {
            struct trial t;
            struct hertz_form f;
            struct input gap;
            double x_dot[MODEL_STATES];
            random_trial(&t, model_table[k], &seed);
            t.m->hertz_form(t.p, &f);
            t.m->rhs(t.p, t.u, t.x, x_dot);
            t.m->gap(t.p, t.u, t.x, &gap);
            double eta = f.side * t.x[0] + f.origin, rate = f.side * t.x[1], accel = f.constant,
                   modulation = 1.0;
            double carried = 0.0;
            for (int i = 0; i < t.m->n_inputs; i++) {
                eta += f.shift[i] * t.u[i].value;
                rate += f.shift[i] * t.u[i].rate;
                carried += f.shift[i] * t.u_accel[i];
                accel += f.force[i] * t.u[i].value + f.drag[i] * t.u[i].rate;
                modulation += f.modulation[i] * t.u[i].value;
            }
            accel += carried - f.damping * rate - f.stiffness * eta;
            accel -= f.hertz * modulation * pow(fmax(eta, 0.0), 1.5);
            exact_worst(&worst, (long double)(fabs(accel - carried - f.side * x_dot[1]) / size_of(x_dot, 2)));
            exact_worst(&worst_gap, (long double)(fabs(gap.value + eta) + fabs(gap.rate + rate)));
        }
        report("rhs off the Hertz form", model_table[k], worst, 1e-14);
        report("gap off minus eta", model_table[k], worst_gap, 1e-14);
    }
    check_int("Hertz forms: rig, rolling contact, tip", views, 3);
}

TEST(models_polynomial_form)
{
    uint64_t seed = 16;
    int views = 0;
    for (int k = 0; k < MODELS; k++) {
        double worst = 0.0;
        if (!model_table[k]->polynomial_form)
            continue;
        views++;
        for (int n = 0; n < MODEL_TRIALS; n++) {
            struct trial t;
            struct polynomial_form f;
            double x_dot[MODEL_STATES];
            random_trial(&t, model_table[k], &seed);
            t.m->polynomial_form(t.p, &f);
            t.m->rhs(t.p, t.u, t.x, x_dot);
            double accel = -f.damping * t.x[1], power = 1.0;
            for (int e = 0; e < 4; e++, power *= t.x[0]) {
                double c = f.constant[e];
                for (int i = 0; i < t.m->n_inputs; i++)
                    c += f.modulation[e][i] * t.u[i].value + f.rate[e][i] * t.u[i].rate;
                accel += c * power;
                for (int i = t.m->n_inputs; i < MODEL_INPUTS; i++) /* inputs that are not there */
                    exact_worst(&worst, (long double)(fabs(f.modulation[e][i]) + fabs(f.rate[e][i])));
            }
            exact_worst(&worst, (long double)(fabs(accel - x_dot[1]) / size_of(x_dot, 2)));
        }
        report("rhs off the polynomial form", model_table[k], worst, 1e-14);
    }
    check_is("polynomial forms: linear, cubic, averaged models of one degree of freedom", views, >=, 7);
}

/* Bit i of `sounding`: input i. */
static void compare_instance(int k, unsigned sounding, uint64_t *seed)
{
    struct model copy = *model_table[k]; /* another address, and no view: no instantiation */
    copy.polynomial_form = NULL;
    struct plant a, b;
    double si[MODEL_PARAMETERS], x[MODEL_STATES];
    for (int i = 0; i < copy.n_parameters; i++)
        si[i] = !strcmp(copy.parameter[i].name, "sign") ? -1.0 : copy.parameter[i].initial;
    double p[MODEL_DERIVED];
    struct scale s;
    copy.prepare(si, p, &s);
    double tick_s = 0.1 * s.time_s / copy.eigenfrequency(p);
    struct plant_config ca = {.model = model_table[k],
                              .si = si,
                              .method = &rk4,
                              .tick_s = tick_s,
                              .dilation = 1.0},
                        cb = ca;
    cb.model = &copy;
    const char *why = plant_init(&a, &ca), *why_b = plant_init(&b, &cb);
    if (why || why_b)
        check_string(copy.name, why ? why : why_b, "no refusal");
    for (int i = 0; i < copy.n_states; i++)
        x[i] = i < copy.n_states / 2 ? 2.5 + 0.1 * i : exact_between(seed, -1.0, 1.0);
    plant_set_state(&a, x);
    plant_set_state(&b, x);
    for (int i = 0; i < copy.n_inputs; i++) {
        double unit = scale_of(&s, copy.input_signal[i].quantity);
        if (!((sounding >> i) & 1u))
            continue;
        plant_drive(&a, i, 0.3 * unit, 0.01 / tick_s, 0.5, 0.0);
        plant_drive(&b, i, 0.3 * unit, 0.01 / tick_s, 0.5, 0.0);
    }
    bool fine = plant_run(&a, 2000), fine_b = plant_run(&b, 2000);
    check_int(copy.name, fine, fine_b);
    check_hex("state hash of the instantiation and of the general path", plant_hash(&a), plant_hash(&b));
    check_near("energy residual of both", plant_residual(&a), plant_residual(&b), 0.0);
    check_near("peak force of both", a.peak_force, b.peak_force, 0.0);
    check_int("contact switches of both", a.counts.switches, b.counts.switches);
    if (copy.n_contacts > 0)
        check_above("contact was lost and found", a.counts.switches, 3);
}

/* The instantiations of rk4 and of the ledger do what the general path does with the same model, bit by bit:
 * whatever inputs sound. */
TEST(models_rk4_instances)
{
    uint64_t seed = 17;
    for (int k = 0; k < MODELS; k++)
        for (unsigned sounding = 0; !model_table[k]->modal_form && sounding < 1u << model_table[k]->n_inputs;
             sounding++) /* a lever has no row in instances.h */
            compare_instance(k, sounding, &seed);
}

/* A linear model of one input, which no model here is: the same
 * numbers as that of four, of which the first alone sounds. */
TEST(models_one_input)
{
    struct model one = hertz_rig_linear;
    struct plant pl[2];
    double si[MODEL_PARAMETERS];
    one.n_inputs = 1;
    one.rhs = polynomial_rhs_linear_force;
    one.flow = polynomial_flow_linear_force;
    for (int i = 0; i < one.n_parameters; i++)
        si[i] = one.parameter[i].initial;
    for (int i = 0; i < 2; i++) {
        const struct plant_config c = {
            .model = i ? &one : &hertz_rig_linear, .si = si, .method = &rk4, .tick_s = 5e-5, .dilation = 1.0};
        const char *why = plant_init(&pl[i], &c);
        check_string("a plant", why ? why : "", "");
        plant_drive(&pl[i], RIG_FORCE, 5.0, 150.0, 0.3, 0.01);
        check_true("runs", plant_run(&pl[i], 5000));
    }
    check_above("it moves, static compressions", fabs(pl[0].x[0] - 1.0), 1e-3);
    check_near("position", pl[1].x[0], pl[0].x[0], 0.0);
    check_near("velocity", pl[1].x[1], pl[0].x[1], 0.0);
    check_near("energy residual", plant_residual(&pl[1]), plant_residual(&pl[0]), 0.0);
}
