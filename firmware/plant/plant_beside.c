/* plant_beside.c - see plant_beside.h. */
#include "firmware/plant/plant_beside.h"

#include <string.h>
#include "firmware/plant/quiet.h"

enum { BESIDE_FEW = SIDES / 2 }; /* fewer plants take less one by one: all SIDES are computed */

/* Quiet ticks under way of several plants, whose blocks begin and end together. Behind the last plant stands
 * that one once more. */
struct company {
    uint32_t n;
    struct plant_run *r[SIDES];
    struct quiet q[SIDES];
    bool in[SIDES];        /* its quiet ticks go on */
    uint32_t timed[SIDES]; /* its ticks by `run` since they began */
    struct plant_side side[SIDES];
    plant_bind_sides *bind;
    plant_sides_function *run;
    unsigned active;
    uint32_t left; /* ticks that all of them have */
};

static uint32_t begin_one(struct company *c, uint32_t i)
{
    struct plant *pl = c->r[i]->pl;
    uint64_t left = c->r[i]->to - pl->now.tick;
    uint32_t n =
        quiet_begin(pl, left < PHASOR_RESYNC_TICKS ? (uint32_t)left : PHASOR_RESYNC_TICKS, NULL, &c->q[i]);
    if (n < c->left)
        c->left = n;
    c->timed[i] = 0;
    c->in[i] = true;
    return n;
}

static void begin_company(struct company *c)
{
    c->left = PHASOR_RESYNC_TICKS;
    for (uint32_t i = 0; i < SIDES; i++) {
        uint32_t k = i < c->n ? i : c->n - 1;
        if (i < c->n)
            (void)begin_one(c, i);
        c->side[i] = (struct plant_side){.pl = c->r[k]->pl, .b = &c->q[k].b};
    }
}

/* The block is full, and booked: its end moves to its begin. */
static void turn_over(struct quiet *q, int n_states)
{
    struct method_block *b = &q->b;
    copy_state(b->x[0], b->x[BLOCK_TICKS], n_states);
    memcpy(b->at[0], b->at[2 * BLOCK_TICKS], sizeof b->at[0]);
    memcpy(b->phasor[0], b->phasor[BLOCK_TICKS], sizeof b->phasor[0]);
    b->instant += BLOCK_TICKS * TICK_FRACTIONS;
    q->origin += BLOCK_TICKS;
    q->done = q->booked = q->filled = 0;
}

/* n ticks of the block are moved to, those of one plant. */
static void turn_drives(struct plant *pl, struct quiet *q, uint32_t n)
{
    struct ticks t = ticks_from(&q->b, q->done);
    unsigned drives = q->turning;
    for (int i = 0; drives != 0; i++, drives >>= 1) {
        if (drives & 1u)
            drive_turn(&pl->drive[i], &pl->segment.wave[i], &t.at[0][i], &t.phasor[0][i], (int)n);
    }
    if (q->sloping)
        quiet_climb(pl, q, t, n);
}

/* Plant i may be one of the company. */
static bool is_alike(const struct company *c, const struct plant *pl)
{
    return pl->books == BOOKS_OF_LEDGER && c->bind(pl, c->active) == c->run;
}

/* The block behind tick k, which begins there. */
static void begin_within(struct quiet *q, uint32_t k, int n_states)
{
    struct method_block *b = &q->b;
    copy_state(b->x[k], b->x[0], n_states);
    memcpy(b->at[2 * k], b->at[0], sizeof b->at[0]);
    memcpy(b->phasor[k], b->phasor[0], sizeof b->phasor[0]);
    b->instant -= k * TICK_FRACTIONS;
    q->origin -= k;
    q->done = q->booked = k;
}

/* Plant i takes a tick with a switch in it, and begins anew where the blocks of the others stand: behind tick
 * k. */
static void pass_switch(struct company *c, uint32_t i, uint32_t k)
{
    struct plant_run *r = c->r[i];
    struct plant *pl = r->pl;
    r->good = quiet_stop(pl, &c->q[i], false, c->timed[i], r->look, r->who);
    c->in[i] = r->good && pl->now.tick + QUIET_FEW < r->to && quiet_is_next(pl) && is_alike(c, pl);
    if (!c->in[i])
        c->left = 0;
    else if (begin_one(c, i) < BLOCK_TICKS) /* its block is filled up to there */
        c->left = 0;
    else
        begin_within(&c->q[i], k, pl->model->n_states);
}

/* Plant i has moved; where it stopped it takes that tick alone. Then looks. */
static void end_block(struct company *c, uint32_t i, uint32_t moved, bool stopped)
{
    const struct plant_run *r = c->r[i];
    struct quiet *q = &c->q[i];
    uint32_t from = q->done, own = moved - stopped;
    bool good = true;
    r->pl->segment.instant += own * TICK_FRACTIONS;
    q->done = q->booked = from + own;
    c->timed[i] += own;
    if (stopped)
        good = quiet_step(r->pl, q);
    if (r->several && q->done > from)
        r->several(r->who, r->pl, &q->b, from, q->done - from);
    else if (r->look)
        quiet_look(r->pl, q, from, r->look, r->who);
    if (!good)
        pass_switch(c, i, (from + moved) % BLOCK_TICKS);
}

/* Ticks in the blocks. */
static void run_company(struct company *c)
{
    uint32_t from = c->q[0].done % BLOCK_TICKS, room = BLOCK_TICKS - from;
    uint32_t asked = c->left < room ? c->left : room;
    unsigned stopped;
    for (uint32_t i = 0; i < SIDES; i++) {
        struct quiet *q = &c->q[i < c->n ? i : c->n - 1];
        if (q->done == BLOCK_TICKS)
            turn_over(q, c->side[i].pl->model->n_states);
        if (i < c->n)
            turn_drives(c->r[i]->pl, q, asked);
        c->side[i].at = &q->b.at[2 * from];
        c->side[i].x = &q->b.x[from];
    }
    uint32_t moved = c->run(c->side, asked, &stopped);
    c->left -= moved;
    for (uint32_t i = 0; i < c->n; i++)
        end_block(c, i, moved, (stopped >> i) & 1u);
}

/* Single ticks up to one that may begin a block; false: there is none, or none of a block beside others. */
static bool come_to_quiet(struct plant_run *r)
{
    struct plant *pl = r->pl;
    while (r->good && pl->now.tick < r->to) {
        if (pl->now.tick + QUIET_FEW < r->to && quiet_is_next(pl))
            return true;
        r->good = plant_advance(pl, (struct instant){pl->now.tick + 1, 0});
        if (r->good && r->look)
            r->look(r->who, pl);
    }
    return false;
}

static void run_alone(struct plant_run *r)
{
    uint64_t ticks = r->to - r->pl->now.tick;
    r->good = r->good &&
              (r->look ? plant_run_seen(r->pl, ticks, r->look, r->several, r->who) : plant_run(r->pl, ticks));
}

/* Those of the n plants that are of the first one's kind and have quiet ticks next; false: they are too few.
 */
static bool gather(struct company *c, struct plant_run *r, uint32_t n, plant_bind_sides *bind)
{
    const struct plant *first = r[0].pl;
    c->n = 0;
    c->active = 0;
    c->bind = bind;
    for (uint32_t i = 0; i < n && n > 1; i++) {
        const struct plant *pl = r[i].pl;
        if (pl->model != first->model || !pl->bind_run || !bind(pl, 0) || !come_to_quiet(&r[i]) ||
            pl->books != BOOKS_OF_LEDGER || !bind(pl, 0))
            continue;
        c->active |= pl->segment.active;
        c->r[c->n++] = &r[i];
    }
    if (c->n < BESIDE_FEW)
        return false;
    c->run = bind(c->r[0]->pl, c->active);
    return true;
}

void plant_run_beside(struct plant_run *r, uint32_t n, plant_bind_sides *bind)
{
    struct company c;
    for (uint32_t i = 0; i < n; i++)
        r[i].good = true;
    while (gather(&c, r, n, bind)) {
        begin_company(&c);
        while (c.left > 0)
            run_company(&c);
        for (uint32_t i = 0; i < c.n; i++) {
            struct plant_run *one = c.r[i];
            if (c.in[i])
                one->good = quiet_stop(one->pl, &c.q[i], true, c.timed[i], one->look, one->who);
        }
    }
    for (uint32_t i = 0; i < n; i++)
        run_alone(&r[i]);
}
