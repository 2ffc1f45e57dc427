/* sweep_chain.c - from point to point, and the bisection where two of them differ; see sweep.h. */
#include "host_sim/sweep.h"
#include "host_sim/unit.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How long a point may take until the change over its measuring time is small. Beside a jump, where motion is slow beyond the end
 * of a branch as well as before it, the limit tells one from the other. */
struct patience {
    int rounds; /* of settling and measuring */
    double change;
};
static const struct patience usual = {4, 1e-3}, beside_jump = {16, 1e-5};

enum { BISECTIONS = 100 };

struct chain {
    struct sweep *s;
    struct scene scene; /* with the family's value */
    double family;
    int i; /* of the point under way: up, then down */
    FILE *rows;
    const char *why; /* a refusal */
};

static bool run(struct chain *c, double value, const struct sweep_state *begin, struct sweep_result *r)
{
    struct scene scene = c->scene;
    scene_range_set(&scene, &c->s->range, value);
    c->why = sweep_point(c->s, &scene, value, begin, r);
    return !c->why;
}

/* The same point on and on, until it is settled. */
static bool settle(struct chain *c, const struct patience *p, struct sweep_result *r)
{
    bool good = true;
    for (int i = 1; i < p->rounds && good && !r->escaped && r->settled > p->change; i++) {
        const struct sweep_state on = r->end;
        good = run(c, r->value, &on, r);
    }
    return good;
}

static bool run_settled(struct chain *c, double value, const struct sweep_state *begin,
                        struct sweep_result *r)
{
    return run(c, value, begin, r) && settle(c, &beside_jump, r);
}

/* The largest difference of two points' amplitudes, over the largest of them. */
static double distance(const struct sweep *s, const struct sweep_result *a, const struct sweep_result *b)
{
    double largest = fmax(sweep_largest(s, &a->measured), sweep_largest(s, &b->measured)), difference = 0.0;
    if (a->escaped || b->escaped)
        return a->escaped == b->escaped ? 0.0 : 1.0;
    for (int i = 0; i < s->n_harmonics; i++)
        difference = fmax(difference, fabs(a->measured.amplitude[i] - b->measured.amplitude[i]));
    return largest > 0.0 ? difference / largest : 0.0;
}

static void write_numbers(const struct sweep *s, const struct sweep_result *r, FILE *f)
{
    const struct model *m = s->scene.model;
    const struct sweep_measured *y = &r->measured;
    for (int i = 0; i < s->n_harmonics; i++)
        fprintf(f, ",%.12g,%.12g", y->amplitude[i], y->phase[i]);
    fprintf(f, ",%.12g,%.12g,%.12g,%.12g,%.12g,%.3g,%u", y->mean, y->lowest, y->highest, y->out_of_contact,
            y->peak_force, r->settled, r->unlocated);
    for (int i = 0; i < m->n_states; i++)
        fprintf(f, ",%.17g", r->end.x[i]);
    for (int i = 0; i < m->n_inputs; i++)
        fprintf(f, "%c%016" PRIx64, i ? ':' : ',', r->end.phase[i]);
    fputc('\n', f);
}

static void write_row(const struct chain *c, const char *kind, const struct sweep_result *r)
{
    const struct sweep *s = c->s;
    char text[UNIT_TEXT];
    fprintf(c->rows, "%s,%s", kind, c->i < s->range.n ? "up" : "down");
    if (s->family.n)
        fprintf(c->rows, ",%.12g", c->family);
    unit_write(r->value, "", text);
    fprintf(c->rows, ",%s", text);
    if (!r->escaped) {
        write_numbers(s, r, c->rows);
        return;
    }
    for (int i = 0; i < 2 * s->n_harmonics + 8 + s->scene.model->n_states; i++)
        fputs(",nan", c->rows);
    fputc('\n', c->rows);
}

/* The next number of a row; *at moves on. */
static double take(const char **at)
{
    char *end;
    double x = strtod(*at, &end);
    *at = *end == ',' ? end + 1 : end;
    return x;
}

/* What write_row wrote: a chain goes on from what its file says, so that a resumed one has the same bits. */
static void read_row(const struct sweep *s, const char *at, struct sweep_result *r)
{
    const struct model *m = s->scene.model;
    *r = (struct sweep_result){.escaped = !strncmp(at, "escaped", 7)};
    for (int i = 0; i < 2 + (s->family.n > 0); i++)
        at = strchr(at, ',') + 1;
    r->value = take(&at);
    if (r->escaped)
        return;
    struct sweep_measured *y = &r->measured;
    for (int i = 0; i < s->n_harmonics; i++) {
        y->amplitude[i] = take(&at);
        y->phase[i] = take(&at);
    }
    double *number[] = {&y->mean, &y->lowest, &y->highest, &y->out_of_contact, &y->peak_force, &r->settled};
    for (size_t i = 0; i < sizeof number / sizeof number[0]; i++)
        *number[i] = take(&at);
    double unlocated = take(&at);
    r->unlocated = unlocated >= 0.0 && unlocated <= UINT32_MAX ? (uint32_t)unlocated : UINT32_MAX;
    for (int i = 0; i < m->n_states; i++)
        r->end.x[i] = take(&at);
    for (int i = 0; i < m->n_inputs; i++, at += 17)
        r->end.phase[i] = strtoull(at, NULL, 16);
}

static bool narrow(const struct sweep *s, const struct sweep_result *a, const struct sweep_result *b)
{
    return fabs(a->value - b->value) <= s->bracket * fmax(fabs(a->value), fabs(b->value));
}

/* Between two points that differ. Above `low` the points of the other side, the furthest first: where a smaller step does not
 * leave the branch of `low`, the last of them was a kick by a step too long, and the one before it counts. */
struct search {
    struct sweep_result low, high[BISECTIONS];
    int n; /* of high */
    struct sweep_result from, to;
    int confirmed;
};

static const struct sweep_result *high_of(const struct search *f)
{
    return &f->high[f->n - 1];
}

/* Bisects once; false when the plant refuses. */
static bool halve(struct chain *c, struct search *f)
{
    struct sweep_result middle;
    if (!run_settled(c, 0.5 * (f->low.value + high_of(f)->value), &f->low.end, &middle))
        return false;
    if (!middle.escaped && distance(c->s, &middle, &f->low) <= distance(c->s, &middle, high_of(f)))
        f->low = middle;
    else
        f->high[f->n++] = middle;
    return true;
}

/* From the branch of `low` by the shortest step: does it lead to the other side? Else it is a kick. */
static bool verify(struct chain *c, struct search *f, bool *kick)
{
    struct sweep_result again;
    if (!run_settled(c, high_of(f)->value, &f->low.end, &again))
        return false;
    *kick = distance(c->s, &f->low, &again) <= SWEEP_JUMP;
    if (*kick) {
        f->low = again;
        f->n--;
        f->confirmed = 0;
    }
    return true;
}

/* What lies between `last` and `now`, which differ. `now` becomes the branch's own point where there is no jump. */
static bool find_jump(struct chain *c, const struct sweep_result *last, struct sweep_result *now)
{
    struct search f = {.low = *last, .high = {*now}, .n = 1};
    for (int i = 0; i < BISECTIONS - 1; i++) {
        bool kick = false;
        if (f.confirmed > 0 || narrow(c->s, &f.low, high_of(&f)))
            f.confirmed++;
        if (f.confirmed == 1)
            f.from = f.low, f.to = *high_of(&f);
        if (f.confirmed > SWEEP_CONFIRM ? !verify(c, &f, &kick) : !halve(c, &f))
            return false;
        if (f.n == 0)
            *now = f.low;
        if (f.n == 0 || distance(c->s, &f.low, high_of(&f)) <= SWEEP_JUMP)
            return true;
        if (f.confirmed > SWEEP_CONFIRM)
            break;
    }
    if (f.confirmed > SWEEP_CONFIRM) {
        write_row(c, "jump_from", &f.from);
        write_row(c, "jump_to", &f.to);
    }
    return true;
}

/* True when two neighbours ask for a bisection; `now` is settled first. */
static bool differ(struct chain *c, const struct sweep_result *last, struct sweep_result *now)
{
    if (last->escaped || distance(c->s, last, now) <= SWEEP_JUMP || !settle(c, &usual, now))
        return false;
    bool steady = last->settled <= SWEEP_JUMP && (now->escaped || now->settled <= SWEEP_JUMP);
    return steady && distance(c->s, last, now) > SWEEP_JUMP;
}

/* One point, and the jump before it, as text. *last becomes what its row says. */
static bool add_point(struct chain *c, struct sweep_result *last)
{
    const struct scene_range *range = &c->s->range;
    struct sweep_result now;
    double value = scene_range_value(range, c->i < range->n ? c->i : 2 * range->n - 1 - c->i);
    if (!run(c, value, last->escaped ? NULL : &last->end, &now))
        return false;
    if (differ(c, last, &now) && !find_jump(c, last, &now))
        return false;
    if (c->why)
        return false;
    write_row(c, now.escaped ? "escaped" : "point", &now);
    *last = now;
    return true;
}

/* One point into `rows` as a piece. */
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
        read_row(c->s, line ? line + 1 : text, last);
    }
    free(text);
    return good;
}

/* As many columns as there are names for. */
static bool is_row(const struct sweep *s, const char *line)
{
    size_t n = 0, names = 0;
    for (const char *c = s->columns; *c; c++)
        names += *c == ',';
    for (; *line != '\n'; line++)
        n += *line == ',';
    return n == names;
}

size_t sweep_resume(void *context, int job, const char *rows)
{
    struct sweep *s = context;
    const char *stay = rows;
    s->resumed = job;
    for (const char *line = rows; *line && is_row(s, line); line = strchr(line, '\n') + 1) {
        if (!strncmp(line, "jump", 4))
            continue;
        read_row(s, line, &s->last);
        s->done++;
        stay = strchr(line, '\n') + 1;
    }
    return (size_t)(stay - rows);
}

/* The way down ends where the way up began. */
bool sweep_chain_ends(void *context, int job, const char *row)
{
    const struct sweep *s = context;
    struct sweep_result r;
    const char *down = strncmp(row, "jump", 4) ? strstr(row, ",down,") : NULL;
    (void)job;
    if (!down)
        return false;
    read_row(s, row, &r);
    return fabs(r.value - s->range.from) <= 1e-12 * fabs(s->range.from);
}

bool sweep_chain(void *context, int job, FILE *rows)
{
    struct sweep *s = context;
    struct chain c = {.s = s, .scene = s->scene};
    struct sweep_result last = {.escaped = true}; /* nothing to go on from */
    if (s->family.n) {
        c.family = scene_range_value(&s->family, job);
        scene_range_set(&c.scene, &s->family, c.family);
    }
    if (s->done > 0 && job == s->resumed) {
        c.i = s->done;
        last = s->last;
    }
    for (; c.i < 2 * s->range.n; c.i++) {
        if (add_piece(&c, &last, rows))
            continue;
        fputs(c.why ? c.why : "no memory", rows);
        return false;
    }
    return true;
}
