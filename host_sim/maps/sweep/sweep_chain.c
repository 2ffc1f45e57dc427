/* sweep_chain.c - see sweep_chain.h. */
#include "host_sim/maps/sweep/sweep_chain.h"
#include "host_sim/maps/sweep/sweep_point.h"
#include "host_sim/maps/sweep/sweep_step.h"
#include "host_sim/out/plural.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A motion that does not settle, and the end of a branch, can lead to one of several motions. A state that
 * differs a little, as another grid has it, leads elsewhere. So the way there is repeated from REPEATS such
 * states. Where motion did not settle, it is repeated in SLOW_PARTS shorter steps, too: a long one may miss
 * the branch that begins there. Each other motion is followed until it meets the chain's own motion. A jump
 * in between is a matter of chance, and told as that; jumps of the other motions are not looked for. */
enum { REPEATS = 6, OTHERS = 4, SLOW_PARTS = 8 };
static const double shaken = 1e-3; /* share of each position and velocity, times 1, -1, 2, -2, .. */

struct chain {
    struct sweep *s;
    struct scene scene; /* with the family's value */
    struct step step;
    struct sweep_result other[OTHERS]; /* motions that chance could have led to */
    int n_others;
    double family;
    int job;
    int i; /* index of the point under way, first up, then down */
    FILE *rows;
};

/* ---- points that do not settle ---- */

/* One call, one line: another thread tells the progress. */
static void tell_points(const struct sweep *s, int job, int n, const char *kind, const char *not_looked_for,
                        double from, double to)
{
    char family[SCENE_RANGE_NAME + 32] = "";
    if (s->family.values.n)
        snprintf(family, sizeof family, ", %s = %.9g", s->family.column, range_value(&s->family.values, job));
    fprintf(stderr, "contactplant sweep: %s: %d point%s; %s between %s = %.9g and %.9g%s\n", kind, n,
            plural(n), not_looked_for, s->range.column, from, to, family);
}

static void tell_gap(const struct sweep *s, int job, int n, double from, double to)
{
    tell_points(s, job, n, "not settled", "no jump looked for", from, to);
}

static void tell_others(const struct sweep *s, int job, int n, double from, double to)
{
    tell_points(s, job, n, "by chance", "no jump of another motion looked for", from, to);
}

/* Takes the next point into the gap, which `inside` points go on. True when one ends here; *ended is it. */
static bool see_gap(struct sweep_gap *g, const struct sweep_result *r, bool inside, struct sweep_gap *ended)
{
    if (r) {
        g->low = g->begun ? fmin(g->low, r->value) : r->value;
        g->high = g->begun ? fmax(g->high, r->value) : r->value;
        g->begun = true;
        g->n += inside;
    }
    if (inside)
        return false;
    *ended = *g;
    *g = r ? (struct sweep_gap){0, true, r->value, r->value} : (struct sweep_gap){0};
    return ended->n > 0;
}

/* Takes the next point of a chain, and reports gaps when they end; NULL: there are no more points. */
static void see_point(struct sweep *s, int job, const struct sweep_result *r)
{
    struct sweep_gap ended;
    if (r && !r->escaped)
        s->seen = fmax(s->seen, sweep_largest(s, &r->measured));
    if (see_gap(&s->gap, r, r && !sweep_steady(r), &ended))
        tell_gap(s, job, ended.n, ended.low, ended.high);
    if (see_gap(&s->others, r, r && r->motions > 1.5, &ended))
        tell_others(s, job, ended.n, ended.low, ended.high);
}

/* ---- rows ---- */

static void write_row(const struct chain *c, enum sweep_kind kind, const struct sweep_result *r)
{
    struct sweep_result row = *r;
    row.kind = kind;
    row.down = c->i >= c->s->range.values.n;
    row.motions = 1 + c->n_others;
    row.family = c->family;
    rows_write(&c->s->m.rows, &row, !r->escaped, c->rows);
}

/* A chain continues from the numbers in its file, so that a resumed one has the same bits. */
static bool read_row(const struct sweep *s, const char *line, struct sweep_result *r)
{
    struct scene scene = s->m.scene;
    if (!rows_read(&s->m.rows, line, r))
        return false;
    if (s->family.values.n)
        scene_range_set(&scene, &s->family, r->family);
    scene_range_set(&scene, &s->range, r->value);
    r->escaped = r->kind == SWEEP_ESCAPED;
    if (!r->escaped)
        sweep_take_state(s, &scene, &r->end);
    return true;
}

/* ---- chance ---- */

static bool met(const struct chain *c, const struct sweep_result *main, const struct sweep_result *r)
{
    bool alike = sweep_alike(c->s, main, r);
    for (int i = 0; i < c->n_others && !alike; i++)
        alike = c->other[i].value == r->value && sweep_alike(c->s, &c->other[i], r);
    return alike;
}

/* Repeats the way from *from to *to, and keeps what it leads to besides. */
static bool repeat(struct chain *c, const struct sweep_result *from, const struct sweep_result *to)
{
    for (int k = 0; k < REPEATS && c->n_others < OTHERS; k++) {
        struct sweep_state begin = from->end;
        struct sweep_result r;
        for (int i = 0; i < MODEL_STATES; i++)
            begin.x[i] *= 1.0 + shaken * (k % 2 ? -1 - k / 2 : 1 + k / 2);
        if (!sweep_settle(&c->step, LITTLE, to->value, &begin, &r))
            return false;
        if (!met(c, to, &r))
            c->other[c->n_others++] = r;
    }
    return true;
}

/* Repeats the way in shorter steps. */
static bool repeat_slowly(struct chain *c, const struct sweep_result *from, const struct sweep_result *to)
{
    struct sweep_result r = *from;
    for (int k = SLOW_PARTS - 1; k >= 0 && !r.escaped; k--) {
        const struct sweep_state begin = r.end;
        if (!sweep_settle(&c->step, LITTLE, to->value - (to->value - from->value) * k / SLOW_PARTS, &begin,
                          &r))
            return false;
    }
    if (r.value == to->value && c->n_others < OTHERS && !met(c, to, &r))
        c->other[c->n_others++] = r;
    return true;
}

/* The other motions at the chain's next point. */
static bool follow_others(struct chain *c, const struct sweep_result *now)
{
    int n = c->n_others;
    c->n_others = 0;
    for (int i = 0; i < n; i++) {
        struct sweep_result r = c->other[i];
        if (r.value != now->value && !sweep_step(&c->step, &c->other[i], now->value, &r))
            return false;
        if (!met(c, now, &r))
            c->other[c->n_others++] = r;
    }
    return true;
}

static void tell_chance(const struct chain *c, const struct step_jump *j)
{
    fprintf(stderr,
            "contactplant sweep: by chance: the jump between %s = %.9g and %.9g; %d other motion%s can be "
            "met there\n",
            c->s->range.column, j->from.value, j->to.value, c->n_others, plural(c->n_others));
}

/* The jumps of the step just taken, as rows, and what else they lead to. */
static bool add_jumps(struct chain *c)
{
    bool good = true;
    for (int i = 0; i < c->step.n && good; i++) {
        const struct step_jump *j = &c->step.jump[i];
        bool chance = c->n_others > 0 && !j->lost;
        write_row(c, j->lost ? SWEEP_LOST : chance ? SWEEP_CHANCE : SWEEP_FROM, &j->from);
        write_row(c, j->lost ? SWEEP_LOST : chance ? SWEEP_CHANCE : SWEEP_TO, &j->to);
        if (j->lost)
            tell_gap(c->s, c->job, 1, j->from.value, j->to.value);
        if (chance)
            tell_chance(c, j);
        good = repeat(c, &j->brink, &j->to);
    }
    return good;
}

/* One point, and the jumps before it, as rows. */
static bool add_point(struct chain *c, struct sweep_result *last)
{
    const struct scene_range *range = &c->s->range;
    struct sweep_result now;
    double value =
        range_value(&range->values, c->i < range->values.n ? c->i : 2 * range->values.n - 1 - c->i);
    bool wandered = !last->escaped && !sweep_steady(last);
    if (!sweep_step(&c->step, last, value, &now) || !add_jumps(c) ||
        (wandered && sweep_steady(&now) && !(repeat(c, last, &now) && repeat_slowly(c, last, &now))) ||
        !follow_others(c, &now))
        return false;
    write_row(c, now.escaped ? SWEEP_ESCAPED : sweep_steady(&now) ? SWEEP_POINT : SWEEP_UNSETTLED, &now);
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

/* A chain resumes behind the last point at which no other motion was followed. */
size_t sweep_resume(void *context, int job, const char *rows)
{
    struct sweep *s = context;
    struct sweep_result r;
    const char *stay = rows;
    s->resumed = job;
    for (const char *line = rows; *line && read_row(s, line, &r); line = strchr(line, '\n') + 1)
        if (r.kind <= SWEEP_ESCAPED && r.motions < 1.5)
            stay = strchr(line, '\n') + 1;
    for (const char *line = rows; line < stay && read_row(s, line, &r); line = strchr(line, '\n') + 1) {
        if (r.kind > SWEEP_ESCAPED)
            continue;
        s->last = r;
        see_point(s, job, &r);
        s->done++;
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
           fabs(r.value - s->range.values.from) <= 1e-12 * fabs(s->range.values.from);
}

bool sweep_chain(void *context, int job, FILE *rows)
{
    struct sweep *s = context;
    struct chain c = {.s = s, .scene = s->m.scene, .job = job};
    struct sweep_result last = {.escaped = true}; /* no point yet */
    if (s->family.values.n) {
        c.family = range_value(&s->family.values, job);
        scene_range_set(&c.scene, &s->family, c.family);
    }
    c.step = (struct step){.s = s, .scene = &c.scene};
    if (s->done > 0 && job == s->resumed) {
        c.i = s->done;
        last = s->last;
    } else {
        s->gap = s->others = (struct sweep_gap){0};
        s->seen = 0.0;
    }
    for (; c.i < 2 * s->range.values.n; c.i++) {
        if (!add_piece(&c, &last, rows)) {
            fputs(c.step.why ? c.step.why : "out of memory", rows);
            return false;
        }
        see_point(s, job, &last);
    }
    see_point(s, job, NULL);
    return true;
}

int sweep_chain_of(const struct rows_table *t, const struct sweep_result *row, int i)
{
    return 2 * t->job[i] + row[i].down;
}
