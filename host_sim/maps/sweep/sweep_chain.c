/* sweep_chain.c - a chain of points: settles each, bisects where neighbours differ, writes and resumes
 * rows. */
#include "host_sim/maps/sweep/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A point is settled when `settled` is below SETTLED. Else it is written as it is after a number of rounds.
 * ROUNDS is for slow points, as on both sides of the end of a branch; ROUNDS_ALOOF for points that wander,
 * as in chaos. */
#define SETTLED 1e-5
enum { ROUNDS = 16, ROUNDS_ALOOF = 3 };

/* Bisection begins at this difference of neighbours, so that no slope hides a jump. */
#define STEEP (0.5 * SWEEP_JUMP)

enum {
    BISECTIONS = 100,
    SEARCH_STEPS = 1000,
    MEASURE_DOUBLED = 3 /* how often, while a point does not settle */
};

struct chain {
    struct sweep *s;
    struct scene scene; /* with the family's value */
    double family;
    int job;
    int i; /* index of the point under way, first up, then down */
    FILE *rows;
    const char *why; /* reason of a refusal */
};

static bool run(struct chain *c, double value, const struct sweep_state *begin, int times,
                struct sweep_result *r)
{
    struct scene scene = c->scene;
    scene_range_set(&scene, &c->s->range, value);
    c->why = sweep_point(c->s, &scene, value, begin, times, r);
    return !c->why;
}

/* Settled enough to compare with others; and to wait for. */
static bool steady(const struct sweep_result *r)
{
    return r->escaped || r->settled <= SWEEP_JUMP;
}

static bool known(const struct sweep_result *r)
{
    return r->escaped || r->settled <= 0.2 * SWEEP_JUMP;
}

/* Settled enough to be a side of a jump. Weak chaos stays near 5e-3. The slow approach beside a fold, which must
 * not count as arrival, comes below 1e-3. */
static bool sure(const struct sweep_result *r)
{
    return r->escaped || r->settled <= (r->beats ? 0.2 : 0.02) * SWEEP_JUMP;
}

/* How long to wait for a point: LITTLE after one that did not settle, SOME after one that did, ALL in a
 * bisection. */
enum patience { LITTLE, SOME, ALL };

/* It may settle yet: it came from a settled motion, or changes little. Beats never do. */
static bool promising(enum patience p, const struct sweep_result *r)
{
    if (p == SOME)
        return !r->beats || !known(r);
    return p == ALL || (!r->beats && known(r));
}

/* Rounds of one point until it changes neither from half to half nor from round to round. */
static bool run_settled(struct chain *c, enum patience p, double value, const struct sweep_state *begin,
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

/* The largest difference of two points' harmonics, over the largest amplitude. Phases count, because amplitudes
 * alone can agree on both sides of a jump; but not those of beats, which are not steady enough. */
static double distance(const struct sweep *s, const struct sweep_result *a, const struct sweep_result *b)
{
    if (a->escaped || b->escaped)
        return a->escaped == b->escaped ? 0.0 : 1.0;
    struct sweep_measured x = a->measured, y = b->measured;
    for (int i = 0; i < s->n_harmonics && (a->beats || b->beats); i++)
        x.phase[i] = y.phase[i];
    return sweep_largest(s, &x) > sweep_largest(s, &y) ? sweep_change(s, &y, &x) : sweep_change(s, &x, &y);
}

/* ---- points that do not settle ---- */

static void tell_gap(const struct sweep *s, int job, int n, double from, double to)
{
    fprintf(stderr,
            "contactplant sweep: not settled: %d point%s; no jump looked for between %s = %.9g and %.9g", n,
            n > 1 ? "s" : "", s->range.column, from, to);
    if (s->family.n)
        fprintf(stderr, ", %s = %.9g", s->family.column, scene_range_value(&s->family, job));
    fputc('\n', stderr);
}

/* Takes the next point of a chain, and reports a gap when it ends; NULL: there are no more points. */
static void see_point(struct sweep *s, int job, const struct sweep_result *r)
{
    struct sweep_gap *g = &s->gap;
    if (r && !g->begun)
        g->low = g->high = r->value;
    if (r) {
        g->low = fmin(g->low, r->value);
        g->high = fmax(g->high, r->value);
        g->begun = true;
        g->n += !steady(r);
    }
    if (r && !steady(r))
        return;
    if (g->n > 0)
        tell_gap(s, job, g->n, g->low, g->high);
    *g = (struct sweep_gap){0};
    if (r)
        *g = (struct sweep_gap){0, true, r->value, r->value};
}

/* ---- rows ---- */

static void write_row(const struct chain *c, enum sweep_kind kind, const struct sweep_result *r)
{
    struct sweep_result row = *r;
    row.kind = kind;
    row.down = c->i >= c->s->range.n;
    row.family = c->family;
    rows_write(&c->s->m.rows, &row, !r->escaped, c->rows);
}

/* A chain continues from the numbers in its file, so that a resumed one has the same bits. */
static bool read_row(const struct sweep *s, const char *line, struct sweep_result *r)
{
    bool good = rows_read(&s->m.rows, line, r);
    r->escaped = r->kind == SWEEP_ESCAPED;
    return good;
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
    struct sweep_result from, to;
    int confirmed;
    bool lost; /* a motion in between does not settle */
};

static const struct sweep_result *high_of(const struct search *f)
{
    return &f->high[f->n - 1];
}

/* Bisects once. Where motion in the middle does not settle, as beyond a branch's end, it tries beside it.
 * False: the plant refuses. */
static bool halve(struct chain *c, struct search *f)
{
    static const double part[] = {0.5, 0.3, 0.7};
    const struct sweep_result *high = high_of(f);
    struct sweep_result middle;
    f->lost = true;
    for (int i = 0; i < 3 && f->lost; i++) {
        double value = f->low.value + part[i] * (high->value - f->low.value);
        if (!run_settled(c, ALL, value, &f->low.end, &middle))
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

/* Does the shortest step from the branch of `low` lead to the other side? Else it was a kick. */
static bool verify(struct chain *c, struct search *f, bool *kick)
{
    struct sweep_result again;
    if (!run_settled(c, ALL, high_of(f)->value, &f->low.end, &again))
        return false;
    *kick = distance(c->s, &f->low, &again) <= STEEP;
    if (*kick) {
        f->low = again;
        f->n--;
        f->confirmed = 0;
    }
    return true;
}

/* There is a jump between these two, but motion in between does not settle, so its place is unknown. */
static bool lose(struct chain *c, const struct sweep_result *from, const struct sweep_result *to)
{
    write_row(c, SWEEP_LOST, from);
    write_row(c, SWEEP_LOST, to);
    tell_gap(c->s, c->job, 1, from->value, to->value);
    return true;
}

/* The branch continues at the next point of the other side. */
static void go_on(struct search *f)
{
    f->low = *high_of(f);
    f->n--;
    f->confirmed = 0;
}

/* A bracket as narrow as asked is a jump, unless it is a kick. The search continues from its far side. */
static bool conclude(struct chain *c, struct search *f)
{
    bool kick;
    if (!verify(c, f, &kick))
        return false;
    if (kick)
        return true;
    f->lost = !sure(&f->from);
    if (f->lost)
        return true;
    if (distance(c->s, &f->from, &f->to) > SWEEP_JUMP) {
        write_row(c, SWEEP_FROM, &f->from);
        write_row(c, SWEEP_TO, &f->to);
    }
    double far = fabs(f->to.value - f->from.value);
    while (f->n > 0 && fabs(high_of(f)->value - f->from.value) <= far)
        f->n--;
    f->low = f->to;
    f->confirmed = 0;
    return true;
}

/* Searches between `last` and `now`, which differ. `now` becomes the branch's own point where there is no
 * jump. */
static bool find_jump(struct chain *c, const struct sweep_result *last, struct sweep_result *now)
{
    struct search f = {.low = *last, .high = {*now}, .n = 1};
    f.low.beats = now->beats; /* a row does not tell it */
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
        if (f.lost || f.n == BISECTIONS)
            break;
    }
    if (f.n > 0)
        return lose(c, &f.low, high_of(&f));
    *now = f.low;
    return true;
}

/* True when two neighbours must be bisected. */
static bool differ(const struct sweep *s, const struct sweep_result *last, const struct sweep_result *now)
{
    return !last->escaped && steady(last) && steady(now) && distance(s, last, now) > STEEP;
}

/* One point, and the jump before it, as rows. */
static bool add_point(struct chain *c, struct sweep_result *last)
{
    const struct scene_range *range = &c->s->range;
    struct sweep_result now;
    double value = scene_range_value(range, c->i < range->n ? c->i : 2 * range->n - 1 - c->i);
    enum patience p = last->escaped || !steady(last) ? LITTLE : SOME;
    if (!run_settled(c, p, value, last->escaped ? NULL : &last->end, &now))
        return false;
    if (differ(c->s, last, &now) && !find_jump(c, last, &now))
        return false;
    write_row(c, now.escaped ? SWEEP_ESCAPED : steady(&now) ? SWEEP_POINT : SWEEP_UNSETTLED, &now);
    *last = now;
    return true;
}

/* Hands over one point as a piece; *last becomes its row, as read back. */
static bool add_piece(struct chain *c, struct sweep_result *last, FILE *rows)
{
    char *text = NULL;
    size_t size = 0;
    c->rows = open_memstream(&text, &size);
    bool good = c->rows && add_point(c, last);
    if (c->rows && fclose(c->rows))
        good = false;
    if (good) {
        fputs(text, rows);
        jobs_piece(rows);
        text[size - 1] = '\0';
        char *line = strrchr(text, '\n');
        text[size - 1] = '\n';
        good = read_row(c->s, line ? line + 1 : text, last);
    }
    free(text);
    return good;
}

size_t sweep_resume(void *context, int job, const char *rows)
{
    struct sweep *s = context;
    struct sweep_result r;
    const char *stay = rows;
    s->resumed = job;
    for (const char *line = rows; *line && read_row(s, line, &r); line = strchr(line, '\n') + 1) {
        if (r.kind > SWEEP_ESCAPED)
            continue;
        s->last = r;
        see_point(s, job, &r);
        s->done++;
        stay = strchr(line, '\n') + 1;
    }
    return (size_t)(stay - rows);
}

/* A chain ends where it began. */
bool sweep_chain_ends(void *context, int job, const char *row)
{
    const struct sweep *s = context;
    struct sweep_result r;
    (void)job;
    return read_row(s, row, &r) && r.kind <= SWEEP_ESCAPED && r.down &&
           fabs(r.value - s->range.from) <= 1e-12 * fabs(s->range.from);
}

bool sweep_chain(void *context, int job, FILE *rows)
{
    struct sweep *s = context;
    struct chain c = {.s = s, .scene = s->m.scene, .job = job};
    struct sweep_result last = {.escaped = true}; /* no point yet */
    if (s->family.n) {
        c.family = scene_range_value(&s->family, job);
        scene_range_set(&c.scene, &s->family, c.family);
    }
    if (s->done > 0 && job == s->resumed) {
        c.i = s->done;
        last = s->last;
    } else {
        s->gap = (struct sweep_gap){0};
    }
    for (; c.i < 2 * s->range.n; c.i++) {
        if (!add_piece(&c, &last, rows)) {
            fputs(c.why ? c.why : "out of memory", rows);
            return false;
        }
        see_point(s, job, &last);
    }
    see_point(s, job, NULL);
    return true;
}
