/* auto.c - the method that picks exact, rk4, taylor, adams or modal by model, step, tolerance and drives.
 *
 *   linear view             exact
 *   Hertzian contact, 1e-3  adams at short steps while forces alone sound, and steadily; else as below
 *   Hertzian contact        rk4 where its guard takes the step, (h omega)^(5/2) <= tol and it follows the
 *                           drives; else taylor
 *   polynomial force        taylor: rk4, through pointers there, costs more
 *   modes of a lever        modal
 *   nothing but rhs         rk4, whatever the tolerance
 *
 * (h omega)^(5/2) is the error of rk4 where contact is lost. A drive a cos(Omega t) adds the error of
 * Simpson's rule over a tick: (h Omega)^4/2880 of the velocity a/Omega that it drives. All drives together
 * may add the tolerance times the motion. The motion is at least the response of the contact at rest to the
 * strongest drive. A tick of rk4 costs 0.6 to 0.9 of one of taylor. Without a tolerance (0) the contact is
 * taylor's, with its default tolerance. Above TAYLOR_TOL_MOST it is rk4's under any drives where rk4 takes
 * the step.
 *
 * adams keeps 1e-3 at up to ADAMS_STEADY_ANGLE, across switches, too. Forces have a part in its error by the
 * damper alone: with three ticks a period its force, too fast to be extrapolated, adds 0.15 h damping. A base
 * or a stiffness has one, and a force that ramps or changes again within ADAMS_STEADY costs it more than rk4:
 * these are for the other two.
 *
 * `prepare` chooses by model, step and tolerance, so a change of parameters may change the method: state and
 * regime belong to the plant, and the tables are made anew. Between rk4, taylor and adams the choice is made
 * again when a drive changes, by a few operations for each drive. Cost beyond that of the method: 40
 * instructions a step. */
#include "firmware/method/auto.h"

#include <math.h>
#include "models/check.h"
#include "firmware/method/method.h"

enum candidate { EXACT, RK4, TAYLOR, MODAL, ADAMS, CANDIDATES };
static const struct method *const candidate[CANDIDATES] = {&exact, &rk4, &taylor, &modal, &adams};

#define ADAMS_TOL_LEAST    1e-3
#define ADAMS_STEADY_ANGLE 0.025          /* h omega */
#define ADAMS_DAMPING      5.0            /* h damping, over the tolerance */
#define ADAMS_STEADY       (32u * 65536u) /* ticks, in the unit of a segment's `instant` */

/* The part of scratch memory that auto keeps for itself, ahead of that of the method that it takes. */
struct own {
    enum candidate choice;
    bool watches;         /* rk4, taylor or adams, by the drives */
    bool takes_adams;     /* where `moving` rest */
    unsigned char moving; /* bit i: input i is more than a force */
    double tol, h, omega;
    double value[MODEL_INPUTS], rate[MODEL_INPUTS]; /* accelerations by an input and by its rate, at rest */
    uint64_t last;                                  /* instant of the last change that is no ramp */
};
STATIC_ASSERT(sizeof(struct own) <= METHOD_AUTO_SCRATCH * sizeof(double), auto_own_fits);

/* The effect of the drives: the error of rk4 in velocity, and how far and how fast the strongest moves the
 * contact. */
struct response {
    double error, position, velocity;
};

static double larger(double a, double b)
{
    return a > b ? a : b;
}

static void add_drive(const struct own *o, int i, double amplitude, double omega, struct response *r)
{
    double turn = fabs(omega), angle = o->h * turn;
    double push = fabs(amplitude) * (o->value[i] + o->rate[i] * turn);
    double position = push / (o->omega * o->omega + turn * turn);
    r->error += push * o->h * (angle * angle * angle) * (1.0 / 2880.0);
    r->position = larger(r->position, position);
    r->velocity = larger(r->velocity, position * turn);
}

static bool rk4_follows(const struct own *o, const struct response *r)
{
    double position = o->omega * r->position;
    return r->error <= o->tol * (position < r->velocity ? position : r->velocity);
}

/* With the waves of a segment that sound. */
static bool rk4_follows_waves(const struct own *o, const struct segment *e)
{
    struct response r = {0.0, 0.0, 0.0};
    unsigned active = e->active;
    for (int i = 0; active != 0; i++, active >>= 1) {
        const struct wave *w = &e->wave[i];
        if ((active & 1u) && (w->amplitude != 0.0 || w->growth != 0.0))
            add_drive(o, i, larger(fabs(w->amplitude), fabs(w->amplitude + w->growth * e->length)), w->omega,
                      &r);
    }
    return rk4_follows(o, &r);
}

/* The drives change in this segment: adams may serve, and will be left alone for a while. */
static bool adams_serves(struct own *o, const struct segment *e)
{
    uint64_t since = e->instant - o->last;
    unsigned active = e->active;
    if (!o->takes_adams || (active & o->moving) != 0)
        return false;
    if (e->length < o->h) /* the rest of a tick behind a switch, or a corner in it */
        return o->choice == ADAMS;
    for (int i = 0; active != 0; i++, active >>= 1) {
        if ((active & 1u) && (e->wave[i].slope != 0.0 || e->wave[i].growth != 0.0))
            return false;
    }
    o->last = e->instant;
    return since >= ADAMS_STEADY;
}

/* Without drives the error of rk4 is within the tolerance. */
static bool rk4_will_do(const struct model *m, const double *p, double h, double tol)
{
    double angle = h * m->eigenfrequency(p);
    return m->hertz_form && angle * angle * sqrt(angle) <= tol;
}

static bool has_series(const struct model *m)
{
    return m->hertz_form || m->polynomial_form;
}

/* The methods that may serve, the best first; returns how many, at least one. */
static int rank(const struct model *m, const double *p, double h, double tol, enum candidate *order)
{
    int n = 0;
    if (m->modal_form) {
        order[0] = MODAL;
        return 1;
    }
    if (m->linear)
        order[n++] = EXACT;
    if (!has_series(m) || rk4_will_do(m, p, h, tol))
        order[n++] = RK4;
    if (has_series(m))
        order[n++] = TAYLOR;
    return n;
}

/* The best method that takes the step, and *why NULL. When none does: the best of all, and *why is its
 * reason. */
static enum candidate choose(const struct model *m, const double *p, double h, double tol, const char **why)
{
    enum candidate order[CANDIDATES];
    int n = rank(m, p, h, tol, order);
    for (int i = 0; i < n; i++) {
        const char *reason = candidate[order[i]]->refuse(m, p, h, tol);
        if (i == 0 || !reason)
            *why = reason;
        if (!reason)
            return order[i];
    }
    return order[0];
}

/* The choice without drives. */
static void begin(const struct model *m, const double *p, double h, double tol, struct own *o)
{
    const char *why;
    struct hertz_form f;
    *o = (struct own){.tol = tol, .h = h, .omega = m->eigenfrequency(p)};
    o->choice = choose(m, p, h, tol, &why);
    if (o->choice != RK4 || !m->hertz_form || tol > TAYLOR_TOL_MOST || taylor.refuse(m, p, h, tol))
        return;
    m->hertz_form(p, &f);
    o->watches = true;
    o->takes_adams =
        tol >= ADAMS_TOL_LEAST && h * o->omega <= ADAMS_STEADY_ANGLE && h * f.damping <= ADAMS_DAMPING * tol;
    o->choice = o->takes_adams ? ADAMS : RK4;
    o->last = 0u - (uint64_t)ADAMS_STEADY;
    for (int i = 0; i < MODEL_INPUTS; i++) {
        bool moves = f.modulation[i] != 0.0 || f.shift[i] != 0.0 || f.drag[i] != 0.0;
        o->moving = (unsigned char)(o->moving | (moves ? 1u << i : 0u));
        o->value[i] =
            fabs(f.force[i]) + fabs(f.hertz * f.modulation[i]) + fabs(f.shift[i]) * (o->omega * o->omega);
        o->rate[i] = fabs(f.drag[i]);
    }
}

const struct method *auto_choice(const struct model *m, const double *p, double h, double tol,
                                 const struct harmonic *drive, const struct scale *scale)
{
    struct own o;
    struct response r = {0.0, 0.0, 0.0};
    unsigned active = 0;
    begin(m, p, h, tol, &o);
    for (int i = 0; drive && o.watches && i < m->n_inputs; i++)
        if (drive[i].amplitude != 0.0) {
            add_drive(&o, i, drive[i].amplitude / scale_of(scale, m->input_signal[i].quantity),
                      drive[i].omega * scale->time_s, &r);
            active |= 1u << i;
        }
    if (!o.watches || (o.takes_adams && (active & o.moving) == 0))
        return candidate[o.choice];
    return candidate[rk4_follows(&o, &r) ? RK4 : TAYLOR];
}

const struct method *auto_now(const double *scratch)
{
    return candidate[((const struct own *)(const void *)scratch)->choice];
}

static const char *refuse(const struct model *m, const double *p, double h, double tol)
{
    const char *why;
    (void)choose(m, p, h, tol, &why);
    return why;
}

static size_t n_scratch(const struct model *m)
{
    size_t most = modal.n_scratch(m) + adams.n_scratch(m); /* levers; contacts */
    size_t of_exact = m->linear ? exact.n_scratch(m) : 0, of_taylor = has_series(m) ? taylor.n_scratch(m) : 0;
    most = of_exact > most ? of_exact : most;
    return METHOD_AUTO_SCRATCH + (most > of_taylor ? most : of_taylor);
}

static void prepare(const struct model *m, const double *p, double h, double tol, double *scratch)
{
    struct own *o = (struct own *)(void *)scratch;
    begin(m, p, h, tol, o);
    candidate[o->choice]->prepare(m, p, h, tol, &scratch[METHOD_AUTO_SCRATCH]);
}

/* Chooses again: drives have changed, or the step begins or ends at a switch. */
NEVER_INLINE void choose_again(const struct model *m, const double *p, double *scratch,
                               const struct segment *e)
{
    struct own *o = (struct own *)(void *)scratch;
    enum candidate choice = adams_serves(o, e) ? ADAMS : rk4_follows_waves(o, e) ? RK4 : TAYLOR;
    if (choice == o->choice)
        return;
    o->choice = choice;
    candidate[choice]->prepare(m, p, o->h, o->tol, &scratch[METHOD_AUTO_SCRATCH]);
}

static enum step_status step(const struct model *m, const double *p, double *scratch, const struct segment *e,
                             unsigned regime, double *x, struct crossing *c)
{
    const struct own *o = (const struct own *)(const void *)scratch;
    if (e->changed && o->watches)
        choose_again(m, p, scratch, e);
    return candidate[o->choice]->bind(m)(m, p, &scratch[METHOD_AUTO_SCRATCH], e, regime, x, c);
}

static step_function *bind(const struct model *m)
{
    (void)m;
    return step;
}

/* Drives that jumped before some of n ticks of a block; where drives jump all the time in the same way, the
 * choice stays. */
static void note_jumps(struct own *o, const struct method_block *b, const struct input (*at)[MODEL_INPUTS],
                       uint32_t n)
{
    uint32_t from = (uint32_t)(at - b->at) / 2;
    if (!o->takes_adams || (b->active & o->moving) != 0)
        return;
    for (uint32_t k = from; k < from + n; k++)
        if ((b->jumps >> k) & 1u)
            o->last = b->instant + k * UINT64_C(65536);
}

#if TICK_LANES > 1
static uint32_t run_rk4(const struct model *m, const double *p, double *scratch, const struct method_block *b,
                        const struct input (*at)[MODEL_INPUTS], double (*x)[MODEL_STATES], uint32_t n)
{
    uint32_t done = rk4.bind_run(m, NULL)(m, p, NULL, b, at, x, n);
    if (b->jumps)
        note_jumps((struct own *)(void *)scratch, b, at, done);
    return done;
}
#endif

static uint32_t run_adams(const struct model *m, const double *p, double *scratch,
                          const struct method_block *b, const struct input (*at)[MODEL_INPUTS],
                          double (*x)[MODEL_STATES], uint32_t n)
{
    uint32_t done = adams.bind_run(m, NULL)(m, p, &scratch[METHOD_AUTO_SCRATCH], b, at, x, n);
    if (b->jumps)
        note_jumps((struct own *)(void *)scratch, b, at, done);
    return done;
}

#if TICK_LANES > 1
static uint32_t run_exact(const struct model *m, const double *p, double *scratch,
                          const struct method_block *b, const struct input (*at)[MODEL_INPUTS],
                          double (*x)[MODEL_STATES], uint32_t n)
{
    double *inner = &scratch[METHOD_AUTO_SCRATCH];
    return exact.bind_run(m, inner)(m, p, inner, b, at, x, n);
}
#endif

/* rk4 reads no scratch memory; taylor and modal have none. */
static run_function *bind_run(const struct model *m, const double *scratch)
{
    const struct own *o = (const struct own *)(const void *)scratch;
    if (o->choice == ADAMS)
        return run_adams;
#if TICK_LANES > 1
    if (o->choice == EXACT)
        return exact.bind_run(m, &scratch[METHOD_AUTO_SCRATCH]) ? run_exact : NULL;
    if (o->choice == RK4 && o->takes_adams)
        return run_rk4;
#endif
    return o->choice == RK4 ? rk4.bind_run(m, NULL) : NULL;
}

static const struct method_books *books(const double *scratch)
{
    const struct method *now = auto_now(scratch);
    return now->books ? now->books(&scratch[METHOD_AUTO_SCRATCH]) : NULL;
}

static const struct method_ends *ends(const double *scratch)
{
    const struct method *now = auto_now(scratch);
    return now->ends ? now->ends(&scratch[METHOD_AUTO_SCRATCH]) : NULL;
}

const struct method auto_method = {
    .name = "auto",
    .title = "exact, rk4, taylor or adams, the cheapest that keeps the tolerance, by model, step and drives; "
             "levers: modal, without one",
    .order = 0,
    .n_scratch = n_scratch,
    .refuse = refuse,
    .prepare = prepare,
    .bind = bind,
    .bind_run = bind_run,
    .books = books,
    .ends = ends,
};
