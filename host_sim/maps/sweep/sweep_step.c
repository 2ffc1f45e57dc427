/* sweep_step.c - settles a point, and searches for jumps by bisection where neighbours differ. */
#include "host_sim/maps/sweep/sweep_step.h"
#include "host_sim/maps/sweep/sweep_point.h"

#include <math.h>
#include "models/math/elementary.h"

/* A point is settled when `settled` is below SETTLED. Else it is written as it is after a number of rounds.
 * ROUNDS is for slow points, as on both sides of the end of a branch; ROUNDS_ALOOF for points that wander,
 * as in chaos. */
#define SETTLED 1e-5
enum { ROUNDS = 16, ROUNDS_ALOOF = 3 };

/* Bisection begins at this difference of neighbours, so that no slope hides a jump. */
#define STEEP (0.5 * SWEEP_JUMP)

/* Harmonics below this share of the largest that was seen have differences of this size: those of a contact
 * that begins to touch grow from zero without a jump. */
#define FAINT 1e-3

enum {
    BISECTIONS = 100,
    SEARCH_STEPS = 1000,
    APPROACH_PARTS = 32,
    STAY = 8,
    MEASURE_DOUBLED = 4 /* how often, while a point does not settle */
};

static bool run(struct step *c, double value, const struct sweep_state *begin, int times,
                struct sweep_result *r)
{
    struct scene scene = *c->scene;
    scene_range_set(&scene, &c->s->range, value);
    c->why = sweep_point(c->s, &scene, value, begin, times, r);
    return !c->why;
}

/* Settled enough to compare with others; and to wait for. */
bool sweep_steady(const struct sweep_result *r)
{
    return r->escaped || r->settled <= SWEEP_JUMP;
}

static bool known(const struct sweep_result *r)
{
    return r->escaped || r->settled <= 0.2 * SWEEP_JUMP;
}

/* Settled enough to be a side of a jump. Weak chaos stays near 5e-3. The slow approach beside a fold, which
 * must not count as arrival, comes below 1e-3. */
static bool sure(const struct sweep_result *r)
{
    return r->escaped || r->settled <= 0.02 * SWEEP_JUMP;
}

/* It may settle yet: it came from a settled motion, or
 * changes little. Beats never do, so that less is asked. */
static bool promising(enum patience p, const struct sweep_result *r)
{
    if (p == ALL)
        return !r->beats || !sure(r);
    return p == SOME ? !r->beats || !known(r) : !r->beats && known(r);
}

bool sweep_settle(struct step *c, enum patience p, double value, const struct sweep_state *begin,
                  struct sweep_result *r)
{
    bool good = run(c, value, begin, 1, r);
    for (int i = 1; i < ROUNDS && good && !r->escaped && r->settled > SETTLED; i++) {
        const struct sweep_result before = *r;
        if (i >= ROUNDS_ALOOF + r->beats && !promising(p, r))
            break;
        good = run(c, value, &before.end, 1 << (i < MEASURE_DOUBLED ? i : MEASURE_DOUBLED), r);
        r->settled = fmax(r->change, sweep_change(c->s, &before.measured, &r->measured));
    }
    return good;
}

/* The largest difference of two points' harmonics, over the largest amplitude. Phases count, because
 * amplitudes alone can agree on both sides of a jump. */
static double distance(const struct sweep *s, const struct sweep_result *a, const struct sweep_result *b)
{
    if (a->escaped || b->escaped)
        return a->escaped == b->escaped ? 0.0 : 1.0;
    const struct sweep_measured *x = &a->measured, *y = &b->measured;
    double largest = fmax(sweep_largest(s, x), sweep_largest(s, y));
    double change = largest > sweep_largest(s, y) ? sweep_change(s, y, x) : sweep_change(s, x, y);
    return change * fmin(1.0, largest / (FAINT * s->seen));
}

bool sweep_alike(const struct sweep *s, const struct sweep_result *a, const struct sweep_result *b)
{
    if (!sweep_steady(a) || !sweep_steady(b))
        return sweep_steady(a) == sweep_steady(b);
    struct sweep_result mirrored = *b;
    for (int i = 0; i < s->n_harmonics; i++)
        if (s->harmonic[i].n % 2 == 0)
            mirrored.measured.phase[i] += ELEMENTARY_PI;
    return distance(s, a, b) <= STEEP || distance(s, a, &mirrored) <= STEEP;
}

static bool narrow(const struct sweep *s, const struct sweep_result *a, const struct sweep_result *b)
{
    return fabs(a->value - b->value) <= s->bracket * fmax(fabs(a->value), fabs(b->value));
}

/* A bisection between two points that differ. `high` has points of the other side, the furthest first.
 * Where a smaller step does not leave the branch of `low`, the last of them was a kick by too long a step,
 * and the one before it counts. */
struct search {
    struct sweep_result low, high[BISECTIONS];
    int n; /* elements of high */
    struct sweep_result start, from, to;
    struct sweep_result left; /* the near side that did not last */
    int confirmed;
    int stay;  /* rounds more for each point, once a side of a bracket did not last */
    bool lost; /* a motion in between does not settle */
};

static const struct sweep_result *high_of(const struct search *f)
{
    return &f->high[f->n - 1];
}

/* So many rounds more at the same place. Just beyond the end of a branch the nudges of a few rounds grow
 * too little to be seen. */
static bool wait(struct step *c, int rounds, struct sweep_result *r)
{
    for (int i = 0; i < rounds && !r->escaped; i++) {
        const struct sweep_state begin = r->end;
        if (!sweep_settle(c, ALL, r->value, &begin, r))
            return false;
    }
    return true;
}

/* Bisects once. Where motion in the middle does not settle, as beyond a branch's end, it tries beside it.
 * False: the plant refuses. */
static bool halve(struct step *c, struct search *f)
{
    static const double part[] = {0.5, 0.3, 0.7, 0.1};
    const struct sweep_result *high = high_of(f);
    struct sweep_result middle;
    f->lost = true;
    for (int i = 0; i < 4 && f->lost; i++) {
        double value = f->low.value + part[i] * (high->value - f->low.value);
        if (!sweep_settle(c, ALL, value, &f->low.end, &middle) || !wait(c, f->stay, &middle))
            return false;
        f->lost = f->confirmed == 0 && !sure(&middle);
    }
    if (f->lost)
        return true;
    double most = f->confirmed > 0 ? distance(c->s, &middle, high) : STEEP;
    if (!middle.escaped && distance(c->s, &middle, &f->low) <= most)
        f->low = middle;
    else
        f->high[f->n++] = middle;
    return true;
}

/* Does the shortest step from the branch of `low` lead to the other side? Else it was a kick. It has the time
 * that the search gave: a motion on its way to the other side is not on the branch. */
static bool verify(struct step *c, struct search *f, bool *kick)
{
    struct sweep_result again;
    if (!sweep_settle(c, ALL, high_of(f)->value, &f->low.end, &again) || !wait(c, f->stay, &again))
        return false;
    *kick = distance(c->s, &f->low, &again) <= STEEP;
    if (*kick) {
        f->low = again;
        f->n--;
        f->confirmed = 0;
    }
    return true;
}

/* Ranges that meet are one. */
static void add_jump(struct step *c, bool lost, const struct sweep_result *brink,
                     const struct sweep_result *from, const struct sweep_result *to)
{
    struct step_jump *last = c->n > 0 ? &c->jump[c->n - 1] : NULL;
    if (lost && last && last->lost && narrow(c->s, &last->to, from)) {
        last->to = *to;
        return;
    }
    if (c->n < STEP_JUMPS)
        c->jump[c->n++] = (struct step_jump){lost, *brink, *from, *to};
}

/* The branch continues at the next point of the other side. */
static void go_on(struct search *f)
{
    f->low = *high_of(f);
    f->n--;
    f->confirmed = 0;
}

/* Does this motion before a jump or a range last? One that does not is beyond the end of its branch: the
 * search begins again, with more time for each point. The end of a branch stays where it was found before; a
 * place that moves with the time given is no jump's. Its range begins where the search began. */
static bool outlast(struct step *c, struct search *f, const struct sweep_result *near, bool *lasts)
{
    struct sweep_result r = *near;
    if (!wait(c, STAY, &r))
        return false;
    *lasts = distance(c->s, near, &r) <= STEEP;
    if (*lasts)
        return true;
    f->lost = f->stay;
    f->stay = STAY;
    f->left = *near;
    f->low = f->start;
    if (!f->lost && sure(&r))
        f->high[f->n++] = r;
    f->confirmed = 0;
    return true;
}

/* A bracket as narrow as asked is a jump, unless it is a kick, or its shortest step is smaller than a jump. A
 * motion that grows as a root may differ more across the bracket. The search continues from its far side. */
static bool conclude(struct step *c, struct search *f)
{
    bool kick, lasts = f->stay && narrow(c->s, &f->from, &f->left);
    if (!verify(c, f, &kick))
        return false;
    if (kick)
        return true;
    f->lost = !lasts && !sure(&f->from);
    if (f->lost)
        return true;
    if (!lasts && !outlast(c, f, &f->from, &lasts))
        return false;
    if (!lasts)
        return true;
    if (distance(c->s, &f->low, high_of(f)) > SWEEP_JUMP)
        add_jump(c, false, &f->low, &f->from, &f->to);
    double far = fabs(f->to.value - f->from.value);
    while (f->n > 0 && fabs(high_of(f)->value - f->from.value) <= far)
        f->n--;
    f->low = f->start = f->to;
    f->confirmed = f->stay = 0;
    return true;
}

/* A range in which motion does not settle is told, from the last motion that is sure, and the search
 * continues beyond it. */
static bool pass_over(struct step *c, struct search *f)
{
    bool lasts = f->stay;
    if (!lasts && !outlast(c, f, &f->low, &lasts))
        return false;
    if (!lasts)
        return true;
    const struct sweep_result *begin = sure(&f->low) ? &f->low : &f->start;
    add_jump(c, true, begin, begin, high_of(f));
    f->lost = false;
    f->stay = 0;
    go_on(f);
    f->start = f->low;
    return true;
}

/* Searches between `last` and `now`, which differ. `now` becomes the branch's own point where there is no
 * jump. */
static bool find_jump(struct step *c, const struct sweep_result *last, struct sweep_result *now)
{
    struct search f = {.low = *last, .high = {*now}, .n = 1};
    f.start = f.low;
    for (int i = 0; i < SEARCH_STEPS && f.n > 0; i++) {
        if (distance(c->s, &f.low, high_of(&f)) <= STEEP) {
            go_on(&f);
            continue;
        }
        if (f.confirmed > 0 || narrow(c->s, &f.low, high_of(&f)))
            f.confirmed++;
        if (f.confirmed == 1)
            f.from = f.low, f.to = *high_of(&f);
        if (f.confirmed > SWEEP_CONFIRM ? !conclude(c, &f) : !halve(c, &f))
            return false;
        if (f.lost && !pass_over(c, &f))
            return false;
        if (f.n == BISECTIONS || c->n == STEP_JUMPS - 1)
            break;
    }
    if (f.n > 0)
        add_jump(c, true, &f.low, &f.low, high_of(&f));
    else
        *now = f.low;
    return true;
}

/* True when two neighbours must be bisected. */
static bool differ(const struct sweep *s, const struct sweep_result *last, const struct sweep_result *now)
{
    return !last->escaped && sweep_steady(last) && sweep_steady(now) && distance(s, last, now) > STEEP;
}

/* A step too long may kick a motion with a period into one that does not settle. Shorter steps keep it, as
 * far as it goes. */
static bool approach(struct step *c, const struct sweep_result *last, struct sweep_result *now)
{
    struct sweep_result low = *last, r = *last;
    int at = 0, steps = APPROACH_PARTS / 2; /* parts of the way: behind, and the next step */
    while (at < APPROACH_PARTS && steps > 0) {
        int next = at + steps < APPROACH_PARTS ? at + steps : APPROACH_PARTS;
        double left = (double)(APPROACH_PARTS - next) / APPROACH_PARTS;
        if (!sweep_settle(c, SOME, now->value - left * (now->value - last->value), &low.end, &r))
            return false;
        if (!sweep_steady(&r) || r.escaped) {
            steps /= 2;
            continue;
        }
        low = r;
        at = next;
    }
    if (at == APPROACH_PARTS)
        *now = low;
    return true;
}

bool sweep_step(struct step *c, const struct sweep_result *last, double value, struct sweep_result *now)
{
    bool settled = !last->escaped && sweep_steady(last);
    c->n = 0;
    if (!sweep_settle(c, settled ? SOME : LITTLE, value, last->escaped ? NULL : &last->end, now))
        return false;
    if (settled && !sweep_steady(now) && !approach(c, last, now))
        return false;
    return !differ(c->s, last, now) || find_jump(c, last, now);
}
