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
    bool good[SIDES]; /* the tick behind those that are done is one to its end */
    struct plant_side side[SIDES];
    plant_sides_function *run;
    uint32_t run_ticks; /* by `run` */
};

/* Begins; returns the ticks that all of them have. */
static uint32_t begin_company(struct company *c)
{
    uint32_t n = PHASOR_RESYNC_TICKS;
    c->run_ticks = 0;
    for (uint32_t i = 0; i < SIDES; i++) {
        uint32_t k = i < c->n ? i : c->n - 1;
        struct plant *pl = c->r[k]->pl;
        uint64_t left = c->r[k]->to - pl->now.tick;
        if (i < c->n)
            n = quiet_begin(pl, left < n ? (uint32_t)left : n, NULL, &c->q[i]);
        c->good[i] = true;
        c->side[i] = (struct plant_side){.pl = pl, .b = &c->q[k].b};
    }
    return n;
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

/* The plant has moved. The tick in which one of them stopped once more, alone. Then looks. */
static void end_block(struct company *c, uint32_t i, uint32_t moved, bool stopped)
{
    const struct plant_run *r = c->r[i];
    struct quiet *q = &c->q[i];
    uint32_t from = q->done;
    r->pl->segment.instant += moved * TICK_FRACTIONS;
    q->done = q->booked = from + moved;
    if (stopped)
        c->good[i] = quiet_step(r->pl, q);
    if (r->several && q->done > from)
        r->several(r->who, r->pl, &q->b, from, q->done - from);
    else if (r->look)
        quiet_look(r->pl, q, from, r->look, r->who);
}

/* Up to n ticks in the blocks; returns those that are done, 0 when one of the plants has no more. */
static uint32_t run_company(struct company *c, uint32_t n)
{
    uint32_t from = c->q[0].done % BLOCK_TICKS, room = BLOCK_TICKS - from, asked = n < room ? n : room;
    for (uint32_t i = 0; i < SIDES; i++) {
        struct quiet *q = &c->q[i < c->n ? i : c->n - 1];
        if (q->done == BLOCK_TICKS)
            turn_over(q, c->r[i]->pl->model->n_states);
        if (i < c->n)
            turn_drives(c->r[i]->pl, q, asked);
        c->side[i].at = &q->b.at[2 * from];
        c->side[i].x = &q->b.x[from];
    }
    uint32_t moved = c->run(c->side, asked);
    bool stopped = moved < asked, good = true;
    c->run_ticks += moved;
    for (uint32_t i = 0; i < c->n; i++) {
        end_block(c, i, moved, stopped);
        good = good && c->good[i];
    }
    return good ? moved + stopped : 0;
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
    unsigned active = 0;
    c->n = 0;
    for (uint32_t i = 0; i < n && n > 1; i++) {
        const struct plant *pl = r[i].pl;
        if (pl->model != first->model || !pl->bind_run || !bind(pl, 0) || !come_to_quiet(&r[i]) ||
            pl->books != BOOKS_OF_LEDGER || !bind(pl, 0))
            continue;
        active |= pl->segment.active;
        c->r[c->n++] = &r[i];
    }
    if (c->n < BESIDE_FEW)
        return false;
    c->run = bind(c->r[0]->pl, active);
    return true;
}

void plant_run_beside(struct plant_run *r, uint32_t n, plant_bind_sides *bind)
{
    struct company c;
    for (uint32_t i = 0; i < n; i++)
        r[i].good = true;
    while (gather(&c, r, n, bind)) {
        uint32_t left = begin_company(&c), done = 1;
        for (; left > 0 && done > 0; left -= done)
            done = run_company(&c, left);
        for (uint32_t i = 0; i < c.n; i++)
            c.r[i]->good = quiet_stop(c.r[i]->pl, &c.q[i], c.good[i], c.run_ticks, c.r[i]->look, c.r[i]->who);
    }
    for (uint32_t i = 0; i < n; i++)
        run_alone(&r[i]);
}
