/* adams.c - Adams' predictor and corrector with one force a tick, for errors of 1e-3.
 *
 * The motion is eta'' = u(t) + g(eta, eta') of a model's hertz_form. The inputs' part u is integrated in
 * closed form (adams_wave.c), so a jump or a ramp of a force spoils nothing. Only g is extrapolated. A rule
 * through the last five g predicts the end of a tick; one that has g there, too, corrects it (Adams,
 * Bashforth, Moulton; Stormer for the place). Both are exact for a free motion's frequency, or for that of an
 * input that stands in g (adams_weights.c). g is not computed again. The order is 6 in smooth motion, and 5
 * with its start. A step goes straight through a contact switch. Its end gets what the rule
 * lacks there (adams_kink.c): order 4 to 5, from the sixth tick behind the switch on. A tick costs one square
 * root.
 *
 * The first five g come from steps of a Runge-Kutta method of order 4. They are needed after a state that was
 * set, a change of parameters, and a part of a tick. An input that stands in g (a moving base, a modulated
 * stiffness) needs one whenever it changes.
 *
 * A switch is found in the Hermite cubic of a tick, and told at its instant. The rest of the tick is kept:
 * the next call gives it out. Energies are booked by adams_books.h. Peak forces are of the cubic, where the
 * compression turns. */
#include <float.h>
#include <math.h>
#include <string.h>
#include "firmware/method/adams/adams.h"
#include "firmware/method/adams/adams_books.h"
#include "firmware/method/adams/adams_kink.h"
#include "firmware/method/adams/adams_wave.h"
#include "firmware/method/adams/adams_weights.h"
#include "firmware/method/switch.h"
#include "models/check.h"

STATIC_ASSERT(sizeof(struct adams) <= METHOD_SCRATCH * sizeof(double), adams_fits);

/* ---- set-up ---- */

static size_t n_scratch(const struct model *m)
{
    return m->hertz_form ? (sizeof(struct adams) + sizeof(double) - 1) / sizeof(double) : 0;
}

static const char *refuse(const struct model *m, const double *p, double h, double tol)
{
    struct hertz_form form;
    (void)tol;
    if (!m->hertz_form)
        return "adams is for a model with one Hertzian contact (hertz_rig, rolling_contact, afm_tip); take "
               "auto";
    if (!(h * m->eigenfrequency(p) <= ADAMS_ANGLE_MAX))
        return "step too coarse for adams: eigenfrequency * step is above 0.4 rad (more substeps, or a "
               "slower rig)";
    m->hertz_form(p, &form);
    if (!(h * form.damping <= ADAMS_DAMPING_MAX))
        return "step too coarse for adams: damping/mass * step is above 0.04 (more substeps, less damping, "
               "or rk4)";
    return NULL;
}

static void prepare(const struct model *m, const double *p, double h, double tol, double *scratch)
{
    struct adams *s = (struct adams *)(void *)scratch;
    const struct input silent[MODEL_INPUTS] = {{0.0, 0.0}};
    double x[MODEL_STATES] = {0.0};
    struct flow flow;
    (void)tol;
    memset(s, 0, sizeof *s);
    m->hertz_form(p, &s->form);
    s->per_damping = s->form.damping > 0.0 ? 1.0 / s->form.damping : 0.0;
    s->h = h;
    adams_prepare_series(s);
    s->angle = -1.0;
    s->free_angle = h * m->eigenfrequency(p);
    (void)adams_weigh(s, s->free_angle);
    for (int i = 0; i < m->n_inputs; i++) {
        s->modulating |= (s->form.modulation[i] != 0.0 ? 1u : 0u) << i;
        s->shifting |= (s->form.shift[i] != 0.0 ? 1u : 0u) << i;
        s->pushing |= (s->form.force[i] != 0.0 || s->form.drag[i] != 0.0 ? 1u : 0u) << i;
    }
    s->pushing |= s->shifting;
    x[0] = s->form.side * (1.0 - s->form.origin);
    m->flow(p, silent, x, &flow);
    s->force_unit = s->form.hertz != 0.0 ? flow.force / s->form.hertz : 0.0;
}

/* ---- forces ---- */

static double positive(double x)
{
    return x > 0.0 ? x : 0.0;
}

/* 1 and the modulation of the contact. */
ALWAYS_INLINE double stiffness_of(const struct adams *s, const struct input *u, const int *on, int n_on)
{
    double sum = 1.0;
    UNROLL_TWO
    for (int k = 0; k < n_on; k++)
        sum += unfused(s->form.modulation[on[k]] * u[on[k]].value);
    return sum;
}

static double stiffness_at(const struct adams *s, const struct input *u)
{
    return stiffness_of(s, u, s->on, s->n_on);
}

/* g, of which *contact is the contact's part. */
ALWAYS_INLINE double force_at(const struct adams *s, double stiffness, double place, double rate,
                              struct adams_contact *contact)
{
    double depth = positive(place);
    double free = -unfused(s->form.stiffness * place) - unfused(s->form.damping * rate);
    contact->root = sqrt(depth);
    contact->plain = (s->form.hertz * depth) * contact->root;
    contact->force = unfused(stiffness * contact->plain);
    return free - contact->force;
}

/* ---- one tick ---- */

/* From place and rate `to` at the begin of a span to those at its end, but for g, under the push of inputs
 * that begin at the phasors `turn`. Bit i of `pushing`: input i pushes. */
ALWAYS_INLINE void drift(const struct adams_push *push, unsigned pushing, const struct phasor *turn,
                         double length, adams_two *to, const int *on, int n_on)
{
    const adams_two way = {unfused(length * (*to)[ADAMS_RATE]), 0.0};
    BOTH SIDE(*to) = (SIDE(*to) + SIDE(way)) + SIDE(push->steady);
    UNROLL_TWO
    for (int j = 0; j < n_on; j++) {
        const struct adams_response *r = &push->response[j];
        const struct phasor *t = &turn[on[j]];
        if (!((pushing >> on[j]) & 1u))
            continue;
        BOTH SIDE(*to) += unfused(SIDE(r->cosine) * t->cosine) + unfused(SIDE(r->sine) * t->sine);
    }
}

/* From m to the end of a tick, but for the books; `stiffness` is that at its end. */
ALWAYS_INLINE void advance(const struct adams *s, unsigned pushing, const struct phasor *turn,
                           double stiffness, const int *on, int n_on, const struct adams_motion *m,
                           struct adams_motion *end)
{
    adams_two ahead;
    BOTH SIDE(ahead) = SIDE(m->without);
    drift(&s->push, pushing, turn, s->h, &ahead, on, n_on);
    UNROLL
    for (int j = ADAMS_NODES - 1; j >= 0; j--) {
        BOTH SIDE(ahead) += unfused(SIDE(s->predict[j]) * m->g[j]);
    }
    double extrapolated =
        (unfused(s->ahead[0] * (m->g[0] - m->g[3])) - unfused(s->ahead[1] * (m->g[1] - m->g[2]))) + m->g[4];
    double g = force_at(s, stiffness, ahead[ADAMS_PLACE], ahead[ADAMS_RATE], &end->contact);
    BOTH SIDE(end->without) = SIDE(ahead) - unfused(SIDE(s->correct) * extrapolated);
    BOTH SIDE(end->at) = SIDE(end->without) + unfused(SIDE(s->correct) * g);
    end->g[0] = g;
    UNROLL
    for (int j = 1; j < ADAMS_NODES; j++)
        end->g[j] = m->g[j - 1];
}

/* The state that belongs to eta and its rate where the inputs are u. */
ALWAYS_INLINE void state_of(const struct adams *s, const struct input *u, const adams_two *of,
                            enum adams_kind kind, double *x)
{
    const adams_two origin = {s->form.origin, 0.0};
    adams_two at;
    BOTH SIDE(at) = SIDE(*of) - SIDE(origin);
    for (int k = 0; kind == ADAMS_SHIFTED && k < s->n_on; k++) {
        const adams_two input = {u[s->on[k]].value, u[s->on[k]].rate};
        BOTH SIDE(at) -= s->form.shift[s->on[k]] * SIDE(input);
    }
#if TICK_LANES > 1
    at *= s->form.side;
#else
    BOTH at[which] = s->form.side > 0.0 ? at[which] : -at[which]; /* 1 or -1, without a product */
#endif
    x[0] = at[ADAMS_PLACE];
    x[1] = at[ADAMS_RATE];
}

/* The largest force from a to b, `length` later, between which the compression turns. */
NEVER_INLINE double force_at_turn(const struct adams *s, adams_pair a, adams_pair b, double length,
                                  double stiffness)
{
    const struct input g0 = {a[ADAMS_PLACE], a[ADAMS_RATE]}, g1 = {b[ADAMS_PLACE], b[ADAMS_RATE]};
    double depth = positive(switch_highest(&g0, &g1, length));
    return fabs(s->force_unit * (stiffness * s->form.hertz)) * depth * sqrt(depth);
}

/* The largest force behind `a` and up to `b`: at the end, where the contact's is `contact`, or in between. */
ALWAYS_INLINE double peak_force(const struct adams *s, adams_pair a, adams_pair b, double length,
                                double stiffness, double contact)
{
    double end = fabs(s->force_unit * contact);
    if (!(a[ADAMS_RATE] > 0.0 && b[ADAMS_RATE] < 0.0))
        return end;
    double turn = force_at_turn(s, a, b, length, stiffness);
    return turn > end ? turn : end;
}

static struct input gap_of(adams_pair at)
{
    return (struct input){-at[ADAMS_PLACE], -at[ADAMS_RATE]};
}

/* A contact switches from a to b, or may have dipped in between. */
static bool suspected(adams_pair a, adams_pair b, double length, unsigned regime)
{
    const struct input g0 = gap_of(a), g1 = gap_of(b);
    return switch_suspected(&g0, &g1, length, regime & 1u);
}

ALWAYS_INLINE bool inside(adams_pair at, double limit)
{
    return fabs(at[0]) + fabs(at[1]) <= limit;
}

/* The first switch between a and b, behind a; done is -1 if there is none. */
static struct switch_found seek(adams_pair a, adams_pair b, double length, unsigned regime)
{
    const struct input g0 = gap_of(a), g1 = gap_of(b);
    struct switch_found f = {-1.0, 0.0, 0.0};
    if (!(regime & REGIME_ANY) && switch_suspected(&g0, &g1, length, regime & 1u))
        (void)switch_find(&g0, &g1, length, regime & 1u, &f);
    return f;
}

/* The motion at a switch. */
static adams_pair at_switch(const struct switch_found *f)
{
    return (adams_pair){0.0, -f->rate};
}

/* The rule falls short by this at the end `to` of a tick with the switch f. At the time s from there, inside
 * contact, the contact's part of g is to the second order
 *
 *     -stiffness hertz ((|eta'| s)^1.5 + 3/4 eta'' |eta'|^0.5 s^2.5) */
NEVER_INLINE adams_pair lack_of(const struct adams *s, const struct switch_found *f, adams_pair to,
                                double stiffness, unsigned regime)
{
    bool touch = !(regime & 1u);
    double h = s->h, left = 1.0 - f->done / h;
    if (!(f->done >= 0.0 && f->done < h) || (to[ADAMS_PLACE] > 0.0) != touch)
        return (adams_pair){0.0, 0.0};
    const struct adams_remainder r = adams_remainder(touch ? left : 1.0 - left);
    double way = fabs(f->rate) * h, bend = -f->bend * (h * h);
    double push = -(stiffness * s->form.hertz) * sqrt(way) * h;
    double rate = push * (way * r.of_force + 0.75 * (bend * r.of_force_by_s));
    double by_s = push * (way * r.of_force_by_s);
    adams_pair lack = {h * (left * rate + (touch ? -by_s : by_s)), rate};
    if ((to[ADAMS_PLACE] + lack[ADAMS_PLACE] > 0.0) != touch)
        lack[ADAMS_PLACE] = 0.0; /* it would be back */
    return lack;
}

/* ---- the past ---- */

static void find_place(struct adams *s, const struct input *u, const double *x)
{
    adams_pair at = s->form.side * (adams_pair){x[0], x[1]} + (adams_pair){s->form.origin, 0.0};
    for (int k = 0; k < s->n_on; k++)
        at += s->form.shift[s->on[k]] * (adams_pair){u[s->on[k]].value, u[s->on[k]].rate};
    BOTH SIDE(s->m.at) = SIDE(at);
}

/* g of where the motion stands becomes the newest. */
static void note_force(struct adams *s, const struct input *u)
{
    struct adams_motion *m = &s->m;
    for (int j = ADAMS_NODES - 1; j > 0; j--)
        m->g[j] = m->g[j - 1];
    m->g[0] = force_at(s, stiffness_at(s, u), m->at[ADAMS_PLACE], m->at[ADAMS_RATE], &m->contact);
    BOTH SIDE(m->without) = SIDE(m->at) - SIDE(s->correct) * m->g[0];
    s->known += s->known < ADAMS_NODES ? 1 : 0;
}

static bool stands(const struct adams *s, const double *x)
{
    return x[0] == s->x[0] && x[1] == s->x[1];
}

/* The angle by which g turns in a tick: with the fastest input that stands in it and that weights may follow,
 * or with a free motion. */
static double turn_of(const struct adams *s)
{
    unsigned within = s->modulating | s->shifting;
    double most = 0.0;
    for (int k = 0; k < s->n_on; k++) {
        const struct wave *w = &s->wave[s->on[k]];
        double angle = fabs(w->omega * s->h);
        bool sounds = w->amplitude != 0.0 || w->growth != 0.0;
        if (((within >> s->on[k]) & 1u) && sounds && angle <= ADAMS_FIT_MOST && angle > most)
            most = angle;
    }
    return most > 0.0 ? most : s->free_angle;
}

/* The share of the begin of the segment e: books that go on have that of the end before it already. */
static void begin_books(struct adams *s, const struct segment *e, bool goes_on)
{
    struct method_share begin = {.damping = 0.0};
    book_share(s, e->length, 0.0, e->at[0], &s->m, &begin);
    s->ends.anew = !goes_on;
    if (goes_on)
        s->more = share_between(&s->ends.end, &begin);
    else
        s->ends.end = begin;
    s->booked = e->length;
}

/* The segment goes on from the past, or begins without one. */
NEVER_INLINE void follow(struct adams *s, const struct segment *e, const double *x)
{
    unsigned were = s->active;
    bool goes_on = s->booked > 0.0 && were == e->active && stands(s, x);
    adams_take_waves(s, e);
    if (adams_weigh(s, turn_of(s)))
        BOTH SIDE(s->m.without) = SIDE(s->m.at) - SIDE(s->correct) * s->m.g[0];
    memset(s->books, 0, sizeof s->books); /* the work of other inputs stays 0 */
    if (s->known == 0 || !stands(s, x) || ((were | e->active) & (s->modulating | s->shifting)) != 0) {
        find_place(s, e->at[0], x);
        s->known = 0;
        note_force(s, e->at[0]);
    }
    begin_books(s, e, goes_on);
}

static void phasors_of(const struct adams *s, const struct segment *e, struct phasor *turn)
{
    for (int k = 0; k < s->n_on; k++)
        turn[s->on[k]] = (struct phasor){e->wave[s->on[k]].cosine, e->wave[s->on[k]].sine};
}

/* By the classical Runge-Kutta method of order 4 on what the inputs and the g at the begin leave, for the
 * next g. So a motion's part that stays, as a load in balance, has no error. */
NEVER_INLINE void step_alone(struct adams *s, const struct segment *e)
{
    double h = e->length, half = 0.5 * h, g = s->m.g[0], stiffness = stiffness_at(s, e->at[1]);
    struct adams_contact contact;
    struct adams_push push;
    struct phasor turn[MODEL_INPUTS];
    phasors_of(s, e, turn);
    adams_push_for(s, half, &push);
    adams_two middle, end;
    BOTH SIDE(middle) = SIDE(end) = SIDE(s->m.at);
    drift(&push, s->pushing, turn, half, &middle, s->on, s->n_on);
    if (h != s->h)
        adams_push_for(s, h, &push);
    drift(h == s->h ? &s->push : &push, s->pushing, turn, h, &end, s->on, s->n_on);
    const adams_two to_middle = {0.5 * half * half, half}, to_end = {half * h, h};
    BOTH SIDE(middle) += g * SIDE(to_middle);
    BOTH SIDE(end) += g * SIDE(to_end);
    double k2 = force_at(s, stiffness, middle[0], middle[1], &contact) - g;
    double k3 = force_at(s, stiffness, middle[0], middle[1] + half * k2, &contact) - g;
    double k4 = force_at(s, stiffness_at(s, e->at[2]), end[0] + half * h * k2, end[1] + h * k3, &contact) - g;
    double sixth = h * (1.0 / 6.0);
    const adams_two rest = {h * sixth * (k2 + k3), sixth * (k4 + 2.0 * (k2 + k3))};
    BOTH SIDE(s->m.at) = SIDE(end) + SIDE(rest);
    note_force(s, e->at[2]);
}

/* The books of a tick, or of a part of one. */
static void book_alone(struct adams *s, const struct segment *e)
{
    struct method_books *b = &s->books[0];
    struct powers q;
    powers_any(s, e->length, e->length, e->at[2], &s->m, &q);
    for (int k = 0; k < s->n_on; k++)
        b->work[s->on[k]] = q.work[k];
    b->damping = q.damping;
    add_share(&s->more, s->on, s->n_on, b);
    s->ends.begin = s->ends.end;
    book_share(s, e->length, e->length, e->at[2], &s->m, &s->ends.end);
}

/* ---- the step ---- */

/* One tick, or a part of one, which leaves no past: s->m and the books go to its end, and x too. Returns the
 * switch in it, as by seek. */
static struct switch_found take(struct adams *s, const struct segment *e, unsigned regime, double *x)
{
    struct phasor turn[MODEL_INPUTS];
    s->more = (struct method_share){.damping = 0.0};
    s->ends.anew = false;
    if (e->changed || s->sloping || s->known == 0 || e->active != s->active || e->length != s->booked ||
        !stands(s, x))
        follow(s, e, x);
    const struct adams_motion begin = s->m;
    s->from = PAIR(begin.at);
    s->from_contact = begin.contact.force;
    double stiffness = stiffness_at(s, e->at[2]);
    struct switch_found f;
    if (s->known == ADAMS_NODES && e->length == s->h) {
        phasors_of(s, e, turn);
        advance(s, s->pushing, turn, stiffness, s->on, s->n_on, &begin, &s->m);
        f = seek(PAIR(begin.at), PAIR(s->m.at), e->length, regime);
        adams_pair lack = lack_of(s, &f, PAIR(s->m.at), stiffness, regime);
        BOTH SIDE(s->m.at) += SIDE(lack);
        BOTH SIDE(s->m.without) += SIDE(lack);
    } else {
        step_alone(s, e);
        f = seek(PAIR(begin.at), PAIR(s->m.at), e->length, regime);
    }
    if (e->length != s->h)
        s->known = 0;
    book_alone(s, e);
    state_of(s, e->at[2], &s->m.at, s->kind, x);
    return f;
}

/* s->m is beyond a switch: x becomes the state there, and the rest of the tick waits for the next call. */
static void stop_at(struct adams *s, const struct segment *e, double done, const adams_two *at, double *x)
{
    struct input u[MODEL_INPUTS];
    for (int k = 0; s->kind == ADAMS_SHIFTED && k < s->n_on; k++)
        wave_at(&e->wave[s->on[k]], done, &u[s->on[k]]);
    s->end[0] = x[0];
    s->end[1] = x[1];
    state_of(s, u, at, s->kind, x);
    s->left = e->length - done;
    s->kept = s->books[0];
    s->kept_ends = s->ends;
    s->kept_ends.anew = false;
    s->books[0] = (struct method_books){.force = 0.0};
    s->ends.end = s->ends.begin;
}

/* The motion from s->from to the end of e: to the switch f in it, or to its end. The energies of a tick are
 * booked at its end. */
static enum step_status tell(struct adams *s, const struct segment *e, const struct switch_found *f,
                             double *x, struct crossing *c)
{
    adams_pair a = s->from, to = PAIR(s->m.at);
    double length = e->length, done = f->done, contact = s->m.contact.force;
    s->left = 0.0;
    if (done >= 0.0) {
        *c = (struct crossing){done, 0, 0, 0.0};
        if (done < length) {
            to = at_switch(f);
            const adams_two at = {to[ADAMS_PLACE], to[ADAMS_RATE]};
            stop_at(s, e, done, &at, x);
        }
        length = done;
        contact = 0.0;
    }
    double begin = fabs(s->force_unit * s->from_contact);
    double most = peak_force(s, a, to, length, stiffness_at(s, e->at[2]), contact);
    s->books[0].force = begin > most ? begin : most;
    s->from_contact = contact;
    s->from = to;
    memcpy(s->x, x, sizeof s->x);
    return done >= 0.0 ? STEP_SWITCH : STEP_END;
}

static enum step_status step(const struct model *m, const double *p, double *scratch, const struct segment *e,
                             unsigned regime, double *x, struct crossing *c)
{
    struct adams *s = (struct adams *)(void *)scratch;
    (void)m, (void)p;
    if (e->length == 0.0) { /* behind a switch at the end */
        s->books[0] = (struct method_books){.force = 0.0};
        s->ends.begin = s->ends.end;
        s->ends.anew = false;
        return STEP_END;
    }
    if (s->left > 0.0 && e->length == s->left && stands(s, x)) {
        memcpy(x, s->end, sizeof s->end);
        s->books[0] = s->kept;
        s->ends = s->kept_ends;
        const struct switch_found next = seek(s->from, PAIR(s->m.at), e->length, regime);
        return tell(s, e, &next, x, c);
    }
    const struct switch_found f = take(s, e, regime, x);
    return inside(PAIR(s->m.at), DBL_MAX) ? tell(s, e, &f, x, c) : STEP_NOT_FINITE;
}

static step_function *bind(const struct model *m)
{
    (void)m;
    return step;
}

/* ---- quiet ticks ---- */

/* The next tick goes on as the last one did, or with a jump that leaves g alone. */
static bool goes_on(const struct adams *s, const struct method_block *b, const double *x)
{
    return s->known == ADAMS_NODES && s->left == 0.0 && stands(s, x) && b->length == s->h &&
           b->active == s->active && !s->sloping && !(b->jumps && s->kind != ADAMS_FORCED);
}

/* Nothing but a plain tick has happened: the contact stays on its side, and the rate of eta keeps its sign.
 */
ALWAYS_INLINE bool is_plain(const adams_two *a, const adams_two *b, double side)
{
    return side * (*b)[ADAMS_PLACE] > 0.0 && (*a)[ADAMS_RATE] * (*b)[ADAMS_RATE] > 0.0 &&
           inside(PAIR(*b), METHOD_STATE_LIMIT);
}

/* A tick that is not plain: the compression turns, or a contact switches. */
struct turn {
    adams_pair from, to, without;
    double begin, end, stiffness; /* the contact's force at its ends; 1 and the modulation at its end */
    unsigned regime;
    uint32_t tick;
    const struct phasor *phasor; /* at its begin */
    struct method_switches *switches;
};

/* The state at the switch, `done` behind the begin. */
static void state_at_switch(const struct adams *s, const struct phasor *phasor, double done, adams_pair to,
                            double *x)
{
    const adams_two at = {to[ADAMS_PLACE], to[ADAMS_RATE]};
    struct input u[MODEL_INPUTS];
    for (int k = 0; s->kind == ADAMS_SHIFTED && k < s->n_on; k++) {
        struct wave w = s->wave[s->on[k]];
        w.cosine = phasor[s->on[k]].cosine;
        w.sine = phasor[s->on[k]].sine;
        wave_at(&w, done, &u[s->on[k]]);
    }
    state_of(s, u, &at, s->kind, x);
}

/* Its forces and its switch. False where it is for a single step. */
NEVER_INLINE bool take_turn(struct adams *s, struct turn *t, struct method_books *b)
{
    struct method_switches *known = t->switches;
    adams_pair from = t->from;
    double h = s->h;
    if (!inside(t->to, METHOD_STATE_LIMIT))
        return false;
    const struct switch_found f = seek(from, t->to, h, t->regime);
    if (f.done >= 0.0) {
        adams_pair at = at_switch(&f), lack = lack_of(s, &f, t->to, t->stiffness, t->regime);
        double done = f.done;
        t->to += lack;
        t->without += lack;
        if (done >= h || suspected(at, t->to, h - done, t->regime ^ 1u))
            return false;
        double begin = fabs(s->force_unit * t->begin);
        double most = peak_force(s, from, at, done, t->stiffness, 0.0);
        double *x = s->at_switch[known->n];
        state_at_switch(s, t->phasor, done, at, x);
        known->at[known->n++] = (struct method_switch){
            t->tick, 0, done, begin > most ? begin : most, s->kind == ADAMS_SHIFTED, x, NULL};
        t->regime ^= 1u;
        from = at;
        h -= done;
    }
    b->force = peak_force(s, from, t->to, h, t->stiffness, t->end);
    return true;
}

/* The tick that begins at m begins with a jump of forces, which hold, from u0 to u. */
NEVER_INLINE void jump(struct adams *s, const struct input *u0, const struct input *u,
                       const struct adams_motion *m)
{
    struct method_share before = {.damping = 0.0}, behind = {.damping = 0.0};
    double value = s->form.constant;
    for (int k = 0; k < s->n_on; k++) {
        s->wave[s->on[k]].offset = u[s->on[k]].value;
        value += s->force[k] * u[s->on[k]].value;
    }
    s->push.steady = adams_push_steady(s->h, value, 0.0);
    book_share(s, s->h, s->h, u0, m, &before);
    book_share(s, s->h, 0.0, u, m, &behind);
    s->more = share_between(&before, &behind);
}

/* `now` becomes `next`, field by field: registers hold both. */
ALWAYS_INLINE void go_on(const struct adams_motion *next, struct adams_motion *now)
{
    BOTH SIDE(now->at) = SIDE(next->at);
    BOTH SIDE(now->without) = SIDE(next->without);
    UNROLL
    for (int j = 0; j < ADAMS_NODES; j++)
        now->g[j] = next->g[j];
    now->contact = next->contact;
}

/* The first of n ticks has the force at its begin, too, as a single step has. */
static void count_begin(struct adams *s, const struct method_block *b, uint32_t n, double force)
{
    bool before_switch = b->switches->n > 0 && b->switches->at[0].tick == 0;
    if (n > 0 && !before_switch && force > s->books[0].force)
        s->books[0].force = force;
}

/* Motion and state behind a run. Its books begin with the share of the last end. */
ALWAYS_INLINE void keep_run(struct adams *s, const struct adams_motion *now, const double *x)
{
    s->m = *now;
    s->ends.begin = s->ends.end;
    s->ends.anew = false;
    s->x[0] = x[0];
    s->x[1] = x[1];
}

/* on[k] is the place of active input k behind `first`. */
ALWAYS_INLINE uint32_t run(struct adams *s, const struct method_block *b,
                           const struct input (*at)[MODEL_INPUTS], double (*x)[MODEL_STATES], uint32_t n,
                           enum adams_kind kind, int first, const int *on, int n_on)
{
    const unsigned n_before = (unsigned)(at - b->at) / 2, jumps = b->jumps >> n_before;
    const struct phasor *turn = &b->phasor[n_before][first];
    const struct input *end = &at[2][first];
    unsigned regime = b->regime;
    double side = regime & 1u ? 1.0 : -1.0;
    const unsigned pushing = kind == ADAMS_FORCED ? ~0u : s->pushing >> first;
    const struct gauge gauge = gauge_of(s, s->h, on, n_on);
    struct adams_motion now = s->m;
    const double begin = fabs(s->force_unit * now.contact.force);
    uint32_t k = 0;
    while (k < n) {
        struct adams_motion next;
        struct method_books *books = &s->books[k];
        double stiffness = kind == ADAMS_FORCED ? 1.0 : stiffness_of(s, end, on, n_on);
        bool jumped = (kind == ADAMS_FORCED || TICK_LANES == 1) && ((jumps >> k) & 1u);
        if (jumped) {
            const struct adams_motion here = now; /* a copy: registers hold `now` */
            jump(s, end - 2 * MODEL_INPUTS - first, end - first, &here);
        }
        advance(s, pushing, turn, stiffness, on, n_on, &now, &next);
        books->force = fabs(s->force_unit * next.contact.force);
        if (!is_plain(&now.at, &next.at, side)) {
            struct turn t = {PAIR(now.at),
                             PAIR(next.at),
                             PAIR(next.without),
                             now.contact.force,
                             next.contact.force,
                             stiffness,
                             regime,
                             k,
                             turn - first,
                             b->switches};
            if (!take_turn(s, &t, books))
                break;
            BOTH SIDE(next.at) = SIDE(t.to);
            BOTH SIDE(next.without) = SIDE(t.without);
            regime = t.regime;
            side = regime & 1u ? 1.0 : -1.0;
            if (b->switches->n == RUN_SWITCHES)
                n = k + 1;
        }
        book_tick(s, &gauge, end, &next, kind, on, n_on, &books->work[first], &books->damping);
        if (jumped)
            add_share(&s->more, s->on, n_on, books);
        state_of(s, end, &next.at, kind, x[k + 1]);
        go_on(&next, &now);
        k++;
        turn += MODEL_INPUTS;
        end += 2 * MODEL_INPUTS;
    }
    keep_run(s, &now, x[k]);
    if (k > 0)
        book_end(s, s->h, s->h, end - 2 * MODEL_INPUTS, &now, kind, on, n_on, &s->ends.end.work[first],
                 &s->ends.end.damping);
    count_begin(s, b, k, begin);
    return k;
}

/* By the kind of the inputs; two have a copy of their own, and a force alone. A board has room for two of
 * them: two inputs that do not move the contact, and any. */
static uint32_t run_any(const struct model *m, const double *p, double *scratch, const struct method_block *b,
                        const struct input (*at)[MODEL_INPUTS], double (*x)[MODEL_STATES], uint32_t n)
{
    struct adams *s = (struct adams *)(void *)scratch;
    (void)m, (void)p;
    if (!goes_on(s, b, x[0]))
        return 0;
#if TICK_LANES > 1
    static const int alone[] = {0};
    bool two = s->n_on == 2;
    if (s->kind == ADAMS_SHIFTED)
        return two ? run(s, b, at, x, n, ADAMS_SHIFTED, 0, s->on, 2)
                   : run(s, b, at, x, n, ADAMS_SHIFTED, 0, s->on, s->n_on);
    if (s->kind == ADAMS_MODULATED)
        return two ? run(s, b, at, x, n, ADAMS_MODULATED, 0, s->on, 2)
                   : run(s, b, at, x, n, ADAMS_MODULATED, 0, s->on, s->n_on);
    if (s->n_on == 1)
        return run(s, b, at, x, n, ADAMS_FORCED, s->on[0], alone, 1);
    return two ? run(s, b, at, x, n, ADAMS_FORCED, 0, s->on, 2)
               : run(s, b, at, x, n, ADAMS_FORCED, 0, s->on, s->n_on);
#else
    if (s->kind != ADAMS_SHIFTED && s->n_on == 2) {
        const int two[] = {s->on[0], s->on[1]};
        return run(s, b, at, x, n, ADAMS_MODULATED, 0, two, 2);
    }
    return run(s, b, at, x, n, s->kind, 0, s->on, s->n_on);
#endif
}

static run_function *bind_run(const struct model *m, const double *scratch)
{
    (void)m, (void)scratch;
    return run_any;
}

static const struct method_books *books(const double *scratch)
{
    return ((const struct adams *)(const void *)scratch)->books;
}

static const struct method_ends *ends(const double *scratch)
{
    return &((const struct adams *)(const void *)scratch)->ends;
}

const struct method adams = {
    .name = "adams",
    .title = "Adams' predictor and corrector, one force a tick, drives integrated exactly; order 5, 4 to 5 "
             "behind switches",
    .order = 5,
    .n_scratch = n_scratch,
    .refuse = refuse,
    .prepare = prepare,
    .bind = bind,
    .bind_run = bind_run,
    .books = books,
    .ends = ends,
};
