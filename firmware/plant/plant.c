/* plant.c - state, drives and time of a plant; see plant.h. Parameters and model: plant_change.c. */
#include "firmware/plant/plant.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/quiet.h"
#include "models/math/elementary.h"

int instant_compare(struct instant a, struct instant b)
{
    if (a.tick != b.tick)
        return a.tick < b.tick ? -1 : 1;
    return (a.fraction > b.fraction) - (a.fraction < b.fraction);
}

/* ---- state ---- */

void plant_find_regime(struct plant *pl)
{
    struct input gap[MODEL_CONTACTS];
    pl->regime = 0;
    pl->model->gap(pl->p, pl->segment.at[2], pl->x, gap);
    for (int i = 0; i < pl->model->n_contacts; i++)
        pl->regime |= (gap[i].value < 0.0 ? 1u : 0u) << i;
}

bool plant_find_books(struct plant *pl)
{
    bool by_method = pl->method->books && pl->method->books(pl->scratch);
    pl->ledger.open.goes_on &= by_method;
    if (pl->books != BOOKS_NONE)
        pl->books = by_method ? BOOKS_OF_METHOD : BOOKS_OF_LEDGER;
    return by_method;
}

/* State or inputs were put in place, not evolved: regime and ledger follow them. */
static void start_from_here(struct plant *pl)
{
    if (pl->staged)
        pl->stage_calls->settle(pl->stages, pl);
    plant_find_regime(pl);
    ledger_start(&pl->ledger, pl->model, pl->p, pl->segment.at[2], pl->x);
    pl->peak_force = 0.0;
}

void plant_set_state(struct plant *pl, const double *x)
{
    memcpy(pl->x, x, (size_t)pl->model->n_states * sizeof *x);
    start_from_here(pl);
}

static void silence(struct plant *pl, int i)
{
    bool length = i < pl->model->n_inputs && pl->model->input_signal[i].quantity == QUANTITY_LENGTH;
    drive_init(plant_touch_drive(pl, i));
    noise_init(&pl->drive[i].noise, i, length);
}

void plant_reset(struct plant *pl)
{
    for (int i = 0; i < MODEL_INPUTS; i++)
        silence(pl, i);
    memset(&pl->segment, 0, sizeof pl->segment);
    pl->model->rest(pl->p, pl->x);
    start_from_here(pl);
}

/* ---- drives ---- */

static double unit_of(const struct plant *pl, int i)
{
    return scale_of(&pl->scale, pl->model->input_signal[i].quantity);
}

static uint64_t ramp_ticks(const struct plant *pl, double ramp_s)
{
    double ticks = ramp_s / pl->tick_s;
    ASSERT(ticks >= 0.0 && ticks < 9e18 / TICK_FRACTIONS);
    return (uint64_t)(int64_t)(ticks + 0.5);
}

/* The harmonic fields that are given, from SI; the others stay. */
static void convert(const struct plant *pl, int i, unsigned given, const double *value,
                    struct drive_setting *s)
{
    if (given & 1u << DRIVE_AMPLITUDE)
        s->amplitude = value[DRIVE_AMPLITUDE] / unit_of(pl, i);
    if (given & 1u << DRIVE_FREQUENCY)
        s->turns_per_tick = value[DRIVE_FREQUENCY] * pl->tick_s;
    if (given & 1u << DRIVE_PHASE)
        s->phase_turns = value[DRIVE_PHASE] / (2.0 * ELEMENTARY_PI);
    if (given & 1u << DRIVE_RAMP)
        s->ramp_ticks = ramp_ticks(pl, value[DRIVE_RAMP]);
    ASSERT(s->turns_per_tick >= 0.0 && s->turns_per_tick < 0.5);
}

void plant_set_drive(struct plant *pl, int i, unsigned given, const double *value)
{
    struct drive *d = plant_touch_drive(pl, i);
    struct drive_setting s = drive_target(d);
    struct noise_setting n = noise_target(&d->noise);
    s.ramp_ticks = (d->ramp_left + TICK_FRACTIONS - 1) / TICK_FRACTIONS;
    convert(pl, i, given, value, &s);
    if (given & 1u << DRIVE_NOISE) {
        ASSERT(value[DRIVE_NOISE] >= 0.0);
        n.deviation = value[DRIVE_NOISE] / unit_of(pl, i);
    }
    if (given & 1u << DRIVE_NOISE_HOLD) {
        ASSERT(value[DRIVE_NOISE_HOLD] >= 0.0 && value[DRIVE_NOISE_HOLD] < NOISE_HOLD_MAX + 1.0);
        n.hold = (uint32_t)value[DRIVE_NOISE_HOLD];
    }
    if (given & 1u << DRIVE_NOISE_SEED)
        n.seed = (uint32_t)value[DRIVE_NOISE_SEED];
    drive_change(d, &s);
    noise_aim(&d->noise, &n);
}

enum { HARMONIC = 1 << DRIVE_AMPLITUDE | 1 << DRIVE_FREQUENCY | 1 << DRIVE_PHASE | 1 << DRIVE_RAMP };

void plant_drive(struct plant *pl, int i, double amplitude, double frequency_Hz, double phase_rad,
                 double ramp_s)
{
    const double value[DRIVE_FIELDS] = {amplitude, frequency_Hz, phase_rad, ramp_s};
    plant_set_drive(pl, i, HARMONIC, value);
}

void plant_drive_start(struct plant *pl, int i, double amplitude, double frequency_Hz, double phase_rad)
{
    const double value[DRIVE_FIELDS] = {amplitude, frequency_Hz, phase_rad};
    struct drive_setting s = {0};
    convert(pl, i, HARMONIC, value, &s);
    double c, d, omega = s.turns_per_tick * 2.0 * ELEMENTARY_PI * pl->ticks_per_time;
    drive_start(plant_touch_drive(pl, i), &s);
    cos_sin_turns(pl->drive[i].offset, &c, &d);
    pl->segment.at[2][i] = (struct input){s.amplitude * c, -s.amplitude * omega * d};
    start_from_here(pl);
}

void plant_noise(struct plant *pl, int i, double deviation, uint32_t hold, uint32_t seed, double ramp_s)
{
    const double value[DRIVE_FIELDS] = {[DRIVE_RAMP] = ramp_s,
                                        [DRIVE_NOISE] = deviation,
                                        [DRIVE_NOISE_HOLD] = hold,
                                        [DRIVE_NOISE_SEED] = seed};
    plant_set_drive(
        pl, i, 1u << DRIVE_RAMP | 1u << DRIVE_NOISE | 1u << DRIVE_NOISE_HOLD | 1u << DRIVE_NOISE_SEED, value);
}

void plant_drives_to_zero(struct plant *pl, double ramp_s)
{
    uint64_t ticks = ramp_ticks(pl, ramp_s);
    bool sounded = false;
    for (int i = 0; i < pl->model->n_inputs; i++) {
        struct drive_setting s = drive_target(&pl->drive[i]);
        s.amplitude = 0.0;
        s.ramp_ticks = ticks;
        if (drive_active(&pl->drive[i])) {
            drive_change(plant_touch_drive(pl, i), &s);
            pl->drive[i].noise.level = 0.0;
            drive_sample(&pl->drive[i], 0.0, ticks > 0 ? ticks : 1);
            sounded = true;
        }
    }
    pl->counts.changes += sounded;
}

void plant_sample(struct plant *pl, int i, double value, uint64_t ticks)
{
    enum quantity q = pl->model->input_signal[i].quantity;
    /* A jump of the base would be an impulse in velocity that no ledger can book. */
    if (q == QUANTITY_LENGTH && ticks == 0)
        ticks = 1;
    drive_sample(plant_touch_drive(pl, i), value / unit_of(pl, i), ticks);
}

/* ---- time ---- */

static void log_event(struct plant *pl, const struct crossing *c, double fraction)
{
    struct input gap[MODEL_CONTACTS];
    uint32_t slot = (pl->event_head + pl->n_event) % PLANT_EVENTS;
    struct event *e = &pl->event[slot];
    bool touch = !((pl->regime >> c->contact) & 1u);
    pl->model->gap(pl->p, pl->segment.at[0], pl->x, gap);
    *e = (struct event){
        .tick = pl->now.tick, .fraction = fraction, .contact = (uint8_t)c->contact, .touch = touch};
    e->speed = fabs(gap[c->contact].rate) * scale_of(&pl->scale, QUANTITY_VELOCITY);
    e->peak_force = touch ? 0.0 : pl->peak_force * pl->scale.force_N;
    if (pl->event_x)
        e->x = memcpy(pl->event_x[slot], pl->x, sizeof pl->x);
    if (pl->n_event == PLANT_EVENTS) {
        pl->event_head = (pl->event_head + 1) % PLANT_EVENTS;
        pl->counts.events_lost++;
    } else {
        pl->n_event++;
    }
}

bool plant_take_event(struct plant *pl, struct event *e)
{
    if (pl->n_event == 0)
        return false;
    *e = pl->event[pl->event_head];
    pl->event_head = (pl->event_head + 1) % PLANT_EVENTS;
    pl->n_event--;
    return true;
}

void plant_begin_record(struct plant *pl)
{
    pl->event_head = (pl->event_head + pl->n_event) % PLANT_EVENTS;
    pl->n_event = 0;
    pl->loss_time = 0.0;
    pl->total_time = 0.0;
}

NEVER_INLINE double book_otherwise(struct plant *pl)
{
    if (pl->books == BOOKS_NONE)
        return 0.0;
    const struct method_books *b = pl->method->books(pl->scratch);
    const struct method_ends *ends = pl->method->ends ? pl->method->ends(pl->scratch) : NULL;
    if (!ends)
        return ledger_take(&pl->ledger, b);
    ledger_take_ends(&pl->ledger, pl->segment.active, b, ends, 1);
    return b->force;
}

ALWAYS_INLINE void pass_time(struct plant *pl, double length)
{
    pl->total_time += length;
    if (pl->regime == 0 && pl->model->n_contacts > 0)
        pl->loss_time += length;
}

/* Books what happened between x0 and the state now: energy, peak force, time without contact. */
ALWAYS_INLINE void book_piece(struct plant *pl, const struct segment *e, const double *x0)
{
    rise_to(&pl->peak_force, pl->books ? book_otherwise(pl) : ledger_piece(&pl->ledger, pl->p, e, x0, pl->x));
    pass_time(pl, e->length);
}

/* The piece up to `done`, booked; what is left of the segment stays in pl->segment. */
static void cut(struct plant *pl, double done, const double *x0, double *done_ticks)
{
    struct segment *e = &pl->segment;
    struct segment head;
    segment_cut(e, pl->model->n_inputs, done, &head);
    book_piece(pl, &head, x0);
    *done_ticks += done * pl->ticks_per_time;
}

static void take_switch(struct plant *pl, const struct crossing *c, double done_ticks)
{
    log_event(pl, c, done_ticks - c->early * pl->ticks_per_time);
    if (!((pl->regime >> c->contact) & 1u))
        pl->peak_force = 0.0;
    pl->regime ^= 1u << c->contact;
    pl->counts.switches++;
    pl->counts.residual += (uint32_t)c->residual;
}

/* The state is where the model means something: far beyond the contact's own length nothing does. A NaN is
 * outside. */
static bool inside(const double *x, int n)
{
    double size = fabs(x[0]) + fabs(x[1]);
    for (int i = 2; i < n; i++)
        size += fabs(x[i]);
    return size <= PLANT_STATE_LIMIT;
}

/* The state and regime in which a segment began. */
struct origin {
    double x[MODEL_STATES];
    unsigned regime;
};

static bool give_up(struct plant *pl, const struct origin *begin)
{
    memcpy(pl->x, begin->x, (size_t)pl->model->n_states * sizeof *pl->x);
    pl->regime = begin->regime;
    return false;
}

/* The segment in pl->segment, of which the method has just done a part: cut at each switch; what is left
 * after PLANT_PIECES pieces is run through without looking for more. Rare, so it stays out of every tick's
 * registers. */
NEVER_INLINE bool integrate_rest(struct plant *pl, const struct origin *begin, enum step_status status,
                                 struct crossing *c)
{
    struct segment *e = &pl->segment;
    double done_ticks = (double)pl->now.fraction / TICK_FRACTIONS;
    double x0[MODEL_STATES]; /* state at the begin of the piece */
    bool changed = e->changed;
    memcpy(x0, begin->x, (size_t)pl->model->n_states * sizeof *x0);
    for (uint32_t piece = 2;; piece++) {
        bool last = piece == PLANT_PIECES;
        cut(pl, c->done, x0, &done_ticks);
        if (status == STEP_SWITCH)
            take_switch(pl, c, done_ticks);
        else
            pl->counts.work++;
        copy_state(x0, pl->x, pl->model->n_states);
        status =
            pl->step(pl->model, pl->p, pl->scratch, e, last ? (unsigned)REGIME_ANY : pl->regime, pl->x, c);
        if (status == STEP_NOT_FINITE || (last && status != STEP_END) || !inside(pl->x, pl->model->n_states))
            return give_up(pl, begin);
        if (piece > pl->counts.pieces_max)
            pl->counts.pieces_max = piece;
        if (status != STEP_END)
            continue;
        if (e->length > 0.0 || pl->books != BOOKS_OF_LEDGER) /* where powers move nothing */
            book_piece(pl, e, x0);
        e->changed = changed; /* its pieces say so because they begin inside it */
        pl->counts.budget += last;
        if (last)
            plant_find_regime(pl);
        return true;
    }
}

/* The state over the segment in pl->segment. False when it left the finite numbers. */
static bool integrate(struct plant *pl)
{
    struct segment *e = &pl->segment;
    struct crossing c = {0.0, 0, 0, 0.0};
    struct origin begin;
    copy_state(begin.x, pl->x, pl->model->n_states);
    begin.regime = pl->regime;
    enum step_status status = pl->step(pl->model, pl->p, pl->scratch, e, pl->regime, pl->x, &c);
    if (status == STEP_NOT_FINITE || !inside(pl->x, pl->model->n_states))
        return give_up(pl, &begin);
    if (pl->counts.pieces_max == 0)
        pl->counts.pieces_max = 1;
    if (e->changed)
        (void)plant_find_books(pl);
    if (status != STEP_END)
        return integrate_rest(pl, &begin, status, &c);
    book_piece(pl, e, begin.x);
    return true;
}

/* The noise of input i over the segment that its drive has just filled in. */
static bool add_noise(struct plant *pl, int i, uint32_t length)
{
    const struct noise_span s = {pl->now.tick, (double)pl->now.fraction / TICK_FRACTIONS,
                                 (double)length / TICK_FRACTIONS, drive_ramp_position(&pl->drive[i]),
                                 pl->ticks_per_time};
    return noise_add(&pl->drive[i].noise, &s, &pl->segment, i);
}

/* Input i over the next segment; true when it is more than the previous one run on. */
static bool excite_one(struct plant *pl, int i, uint32_t length)
{
    struct segment *e = &pl->segment;
    struct drive *d = &pl->drive[i];
    bool changed =
        drive_segment(d, length, pl->ticks_per_time, &e->wave[i], &e->at[0][i], &e->at[1][i], &e->at[2][i]);
    return (d->noise.active && add_noise(pl, i, length)) || changed;
}

static void put_to_sleep(struct plant *pl, int i)
{
    struct segment *e = &pl->segment;
    pl->awake &= ~(1u << i);
    if ((e->active >> i) & 1u) {
        e->wave[i] = (struct wave){.cosine = 1.0};
        e->at[0][i] = e->at[1][i] = e->at[2][i] = (struct input){0.0, 0.0};
    }
}

/* The inputs over the next segment, without a corner inside; drives move to its end. */
static void excite(struct plant *pl, uint32_t length)
{
    struct segment *e = &pl->segment;
    unsigned drives = pl->awake, active = 0;
    bool changed = false;
    for (int i = 0; drives != 0; i++, drives >>= 1) {
        if (!(drives & 1u))
            continue;
        if (drive_active(&pl->drive[i])) {
            active |= 1u << i;
            changed |= excite_one(pl, i, length);
        } else {
            put_to_sleep(pl, i);
        }
    }
    e->length = length == TICK_FRACTIONS ? pl->h : pl->h * ((double)length / TICK_FRACTIONS);
    e->instant = pl->now.tick * TICK_FRACTIONS + pl->now.fraction;
    e->changed = changed || active != e->active;
    e->active = active;
}

/* The segment in pl->segment, and what is counted when it cannot be taken. */
static bool segment(struct plant *pl)
{
    pl->ledger.flow_valid &= !pl->segment.changed;
    if (integrate(pl))
        return true;
    pl->counts.not_finite++;
    return false;
}

/* The actuators between the drives and the segment in pl->segment. */
NEVER_INLINE bool act(struct plant *pl, uint32_t length)
{
    bool good = pl->stage_calls->act(pl->stages, pl, length);
    pl->counts.not_finite += !good;
    return good;
}

/* 1/65536 ticks from now to the nearest of: end of this
 * tick, `to`, a drive's corner. 0: `to` is not ahead. */
static uint32_t segment_length(const struct plant *pl, struct instant to)
{
    uint32_t length = TICK_FRACTIONS - pl->now.fraction;
    unsigned drives = pl->awake;
    if (pl->now.tick >= to.tick) {
        if (pl->now.tick > to.tick || to.fraction <= pl->now.fraction)
            return 0;
        length = to.fraction - pl->now.fraction;
    }
    for (int i = 0; drives != 0; i++, drives >>= 1) {
        if (!(drives & 1u) || pl->drive[i].phasor_valid)
            continue;
        uint64_t corner = drive_corner(&pl->drive[i]);
        if (corner < length)
            length = (uint32_t)corner;
    }
    return length;
}

/* ---- quiet ticks ---- */

/* In the tick that begins every drive that sounds only runs on, as in the last one. */
NEVER_INLINE bool is_quiet(const struct plant *pl)
{
    const struct segment *last = &pl->segment;
    unsigned drives = pl->awake;
    if (last->changed || drives != last->active)
        return false;
    for (int i = 0; drives != 0; i++, drives >>= 1) {
        const struct drive *d = &pl->drive[i];
        if ((drives & 1u) && !(d->phasor_valid && !d->noise.active && drive_active(d)))
            return false;
    }
    return true;
}

uint32_t quiet_begin(struct plant *pl, uint32_t n, const struct samples *held, struct quiet *q)
{
    struct segment *e = &pl->segment;
    struct method_block *b = &q->b;
    q->turning = q->sloping = q->done = q->booked = q->filled = q->seen = 0;
    q->held = held;
    q->origin = q->passed = pl->now.tick;
    q->switches.n = q->told = 0;
    q->b.switches = &q->switches;
    q->run = pl->bind_run ? pl->bind_run(pl->model, pl->scratch) : NULL;
#if TICK_LANES > 1
    q->book = ledger_bind_ticks(pl->model);
#endif
    e->instant = (pl->now.tick - 1) * TICK_FRACTIONS;
    e->changed = false;
    q->c = (struct crossing){0.0, 0, 0, 0.0};
    b->length = e->length = pl->h;
    b->active = e->active;
    b->regime = pl->regime;
    b->wave = e->wave;
    b->jumps = 0;
    b->instant = pl->now.tick * TICK_FRACTIONS;
    copy_state(b->x[0], pl->x, pl->model->n_states);
    for (int i = 0; i < pl->model->n_inputs; i++) {
        struct drive *d = &pl->drive[i];
        if ((e->active >> i) & 1u) {
            e->at[2][i] = drive_steady(d, pl->ticks_per_time, &e->wave[i]);
            e->at[0][i] = e->at[1][i] = e->at[2][i]; /* the last one may have held samples told ahead */
            if (d->resync_left < n)
                n = d->resync_left;
            if (drive_slope_ticks(d) < n)
                n = (uint32_t)drive_slope_ticks(d);
            q->sloping |= (d->sample_left > 0 ? 1u : 0u) << i;
            q->turning |= (d->sample_left > 0 || drive_stands(d) ? 0u : 1u) << i;
        }
    }
    q->moving = q->turning | q->sloping | (held ? 1u << held->input : 0u);
    if (pl->books == BOOKS_OF_LEDGER)
        ledger_begin(&pl->ledger, pl->p, e, e->at[2], pl->x);
    uint32_t filled = n < BLOCK_TICKS ? n : BLOCK_TICKS;
    memset(b->at, 0, (2 * filled + 1) * sizeof b->at[0]);
    for (int i = 0; i < pl->model->n_inputs; i++) {
        bool stands = ((e->active & ~q->turning) >> i) & 1u;
        b->at[0][i] = e->at[2][i];
        b->phasor[0][i] = (struct phasor){pl->drive[i].cosine, pl->drive[i].sine};
        for (uint32_t k = 1; k <= 2 * filled && stands; k++)
            b->at[k][i] = e->at[2][i];
        for (uint32_t k = 1; k <= filled && stands; k++)
            b->phasor[k][i] = b->phasor[0][i];
    }
    return n;
}

/* The block's ticks before `to` get their samples. */
static void fill_samples(struct quiet *q, uint32_t to)
{
    const struct samples *h = q->held;
    struct method_block *b = &q->b;
    uint32_t k = q->filled;
    uint64_t since = q->origin + k - h->begin, next = (since + h->ticks - 1) / h->ticks;
    uint64_t until = next * h->ticks - since; /* the next one begins */
    struct input u = b->at[2 * k][h->input];
    for (; k < to; k++, until--) {
        if (until == 0) {
            u.value = h->value[next++] / h->unit;
            b->jumps |= 1u << k;
            until = h->ticks;
        }
        b->at[2 * k + 1][h->input] = b->at[2 * k + 2][h->input] = u;
    }
    q->filled = to;
}

/* Input i in a tick's segment and in the block; turn: it is to be filled in first. */
ALWAYS_INLINE void fill_tick(struct plant *pl, int i, struct ticks t, bool turn)
{
    struct segment *e = &pl->segment;
    struct wave *w = &e->wave[i];
    w->cosine = t.phasor[0][i].cosine;
    w->sine = t.phasor[0][i].sine;
#if TICK_LANES == 1
    if (turn) { /* nobody reads the middle in the block */
        e->at[0][i] = t.at[0][i];
        drive_turn(&pl->drive[i], w, &e->at[0][i], &t.phasor[0][i], 1);
        t.at[2][i] = e->at[2][i];
        return;
    }
#endif
    if (turn)
        drive_turn(&pl->drive[i], w, &t.at[0][i], &t.phasor[0][i], 1);
    e->at[0][i] = t.at[0][i];
    e->at[1][i] = t.at[1][i];
    e->at[2][i] = t.at[2][i];
}

void quiet_climb(struct plant *pl, const struct quiet *q, struct ticks t, uint32_t n)
{
    uint64_t since = q->origin + (uint64_t)(t.x - q->b.x) - q->passed;
    unsigned drives = q->sloping;
    for (int i = 0; drives != 0; i++, drives >>= 1) {
        const struct drive *d = &pl->drive[i];
        struct wave *w = &pl->segment.wave[i];
        uint64_t left = d->sample_left - since * TICK_FRACTIONS;
        if (!(drives & 1u))
            continue;
        w->offset = since == 0 ? d->sample : drive_sample_before(d, left);
        drive_climb(d, w, left, w->offset, &t.at[0][i], &t.phasor[0][i], n);
    }
}

/* Such drives in a tick's segment, too. */
NEVER_INLINE void climb_once(struct plant *pl, const struct quiet *q, struct ticks t)
{
    quiet_climb(pl, q, t, 1);
    for (int i = 0; q->sloping >> i != 0; i++)
        if ((q->sloping >> i) & 1u)
            fill_tick(pl, i, t, false);
}

/* The sample of a tick in its segment. */
static void hold(struct plant *pl, const struct quiet *q, struct ticks t)
{
    struct segment *e = &pl->segment;
    int i = q->held->input;
    e->wave[i].offset = t.at[1][i].value;
    e->at[0][i] = e->at[1][i] = e->at[2][i] = t.at[1][i];
    e->changed = ((q->b.jumps >> (t.x - q->b.x)) & 1u) != 0;
}

/* One tick by a single step, in pl->x, where the plant stands; turn: its inputs are to be filled in first.
 * False if it is not a good one to its end. */
ALWAYS_INLINE bool step_tick(struct plant *pl, struct quiet *q, struct ticks t, bool turn)
{
    struct segment *e = &pl->segment;
    unsigned drives = q->turning;
    int n = pl->model->n_states;
    for (int i = 0; drives != 0; i++, drives >>= 1) {
        if (drives & 1u)
            fill_tick(pl, i, t, turn);
    }
    if (q->held)
        hold(pl, q, t);
    if (q->sloping)
        climb_once(pl, q, t);
    e->instant += TICK_FRACTIONS;
    q->status = pl->step(pl->model, pl->p, pl->scratch, e, q->b.regime, pl->x, &q->c);
    if (q->status != STEP_END || !inside(pl->x, n))
        return false;
    copy_state(t.x[1], pl->x, n);
    if (pl->books == BOOKS_OF_METHOD)
        rise_to(&pl->peak_force, book_otherwise(pl));
#if TICK_LANES == 1
    if (pl->books == BOOKS_OF_LEDGER) {
        pl->ledger.flow_valid &= !e->changed;
        rise_to(&pl->peak_force, ledger_piece(&pl->ledger, pl->p, e, t.x[0], pl->x));
    }
#endif
    return true;
}

/* A tick before which `run` stopped. */
NEVER_INLINE bool step_suspect(struct plant *pl, struct quiet *q, struct ticks t)
{
    copy_state(pl->x, t.x[0], pl->model->n_states);
    return step_tick(pl, q, t, TICK_LANES == 1); /* without lanes the block has no middles */
}

ALWAYS_INLINE struct ticks ticks_after(struct ticks t, uint32_t n)
{
    return (struct ticks){t.x + n, t.at + 2 * n, t.phasor + n};
}

/* `asked` ticks, at most BLOCK_TOGETHER; returns those that are good to their ends. */
ALWAYS_INLINE uint32_t move_ticks(struct plant *pl, struct quiet *q, struct ticks t, uint32_t asked)
{
    uint32_t done = 0;
    unsigned drives = q->turning;
    if (!q->run) {
        while (done < asked && step_tick(pl, q, ticks_after(t, done), true))
            done++;
        return done;
    }
    for (int i = 0; drives != 0; i++, drives >>= 1) {
        if (drives & 1u)
            drive_turn(&pl->drive[i], &pl->segment.wave[i], &t.at[0][i], &t.phasor[0][i], BLOCK_TOGETHER);
    }
    if (q->sloping)
        quiet_climb(pl, q, t, asked);
    done = q->run(pl->model, pl->p, pl->scratch, &q->b, t.at, t.x, asked);
    pl->segment.instant += done * TICK_FRACTIONS;
    while (done < asked && q->switches.n == 0 && step_suspect(pl, q, ticks_after(t, done)))
        done++;
    return done;
}

/* The ledger's books of n ticks, at most BLOCK_TOGETHER. */
ALWAYS_INLINE void book_ticks(struct plant *pl, const struct quiet *q, struct ticks t, uint32_t n)
{
#if TICK_LANES > 1
    if (pl->books == BOOKS_OF_LEDGER && n > 0)
        rise_to(&pl->peak_force, q->book(&pl->ledger, pl->p, t.at, t.x, n, q->b.jumps != 0));
#else
    (void)pl, (void)q, (void)t, (void)n;
#endif
}

bool quiet_step(struct plant *pl, struct quiet *q)
{
    bool good = step_suspect(pl, q, ticks_from(&q->b, q->done));
    q->done += good;
    book_ticks(pl, q, ticks_from(&q->b, q->booked), q->done - q->booked);
    q->booked = q->done;
    return good;
}

/* Time, inputs and phasors stand at the end of the block's tick k. */
ALWAYS_INLINE void show_tick(struct plant *pl, const struct quiet *q, uint32_t k)
{
    unsigned drives = q->moving;
    const struct input *at = q->b.at[2 * k];
    const struct phasor *phasor = q->b.phasor[k];
    for (int i = 0; drives != 0; i++, drives >>= 1) {
        if (!(drives & 1u))
            continue;
        pl->drive[i].cosine = phasor[i].cosine;
        pl->drive[i].sine = phasor[i].sine;
        pl->segment.at[2][i] = at[i];
    }
    if (q->held) {
        struct drive *d = &pl->drive[q->held->input];
        d->sample = d->sample_to = pl->segment.wave[q->held->input].offset = at[q->held->input].value;
    }
    pl->now.tick = q->origin + k;
}

/* Drives go on by so many ticks. */
static void pass_drives(struct plant *pl, const struct quiet *q, uint32_t ticks)
{
    unsigned drives = q->b.active;
    for (int i = 0; drives != 0; i++, drives >>= 1) {
        if (drives & 1u)
            drive_pass(&pl->drive[i], ticks);
    }
}

/* n ticks without a switch. */
ALWAYS_INLINE void pass_times(struct plant *pl, uint32_t n)
{
    bool lost = pl->regime == 0 && pl->model->n_contacts > 0;
    double total = pl->total_time, loss = pl->loss_time;
    for (uint32_t k = 0; k < n; k++) { /* the sums of so many single additions */
        total += pl->h;
        loss += lost ? pl->h : 0.0;
    }
    pl->total_time = total;
    pl->loss_time = loss;
}

/* Time goes on to the ticks that are done, none of which has a switch. */
static void pass_ticks(struct plant *pl, struct quiet *q)
{
    uint32_t ticks = (uint32_t)(q->origin + q->done - q->passed);
    q->passed += ticks;
    pass_drives(pl, q, ticks);
    pass_times(pl, ticks);
}

void quiet_look(struct plant *pl, const struct quiet *q, uint32_t from, plant_look *look, void *who)
{
    int n = pl->model->n_states;
    double x[MODEL_STATES];
    copy_state(x, pl->x, n);
    for (uint32_t k = from + 1; k <= q->done; k++) {
        show_tick(pl, q, k);
        copy_state(pl->x, q->b.x[k], n);
        look(who, pl);
    }
    copy_state(pl->x, x, n); /* a step that was no good may have gone on */
}

/* The inputs in the tick behind those that are done, `done` after its begin. */
static void show_inputs(struct plant *pl, const struct quiet *q, double done)
{
    for (int i = 0; q->b.active >> i != 0; i++) {
        struct wave *w = &pl->segment.wave[i];
        if (!((q->b.active >> i) & 1u))
            continue;
        if (done == pl->h) {
            pl->segment.at[0][i] = q->b.at[2 * q->done + 2][i];
            continue;
        }
        w->cosine = q->b.phasor[q->done][i].cosine;
        w->sine = q->b.phasor[q->done][i].sine;
        wave_at(w, done, &pl->segment.at[0][i]);
    }
}

static const struct method_ends *ends_of(const struct plant *pl)
{
    return pl->method->ends ? pl->method->ends(pl->scratch) : NULL;
}

/* n ticks that the method has booked. Where books leave shares of their ends, the ledger has them already. */
static void take_books(struct plant *pl, const struct quiet *q, const struct method_books *b, uint32_t n)
{
    bool taken = ends_of(pl) != NULL;
    for (uint32_t k = 0; k < n && taken && pl->books != BOOKS_NONE; k++)
        rise_to(&pl->peak_force, b[k].force);
    if (!taken && pl->books != BOOKS_NONE)
        rise_to(&pl->peak_force, ledger_take_ticks(&pl->ledger, q->b.active, b, n));
}

/* The tick behind those that are done, in which a contact switches: as integrate_rest does it. */
NEVER_INLINE void pass_switch(struct plant *pl, struct quiet *q)
{
    const struct method_switches *s = &q->switches;
    const uint32_t tick = s->at[q->told].tick;
    uint32_t pieces = 1;
    double begin = 0.0;
    pass_ticks(pl, q);
    pass_drives(pl, q, 1);
    pl->now.tick = q->passed++;
    for (; q->told < s->n && s->at[q->told].tick == tick; q->told++, pieces++) {
        const struct method_switch *w = &s->at[q->told];
        const struct crossing c = {w->done, w->contact, 0, 0.0};
        copy_state(pl->x, w->x, pl->model->n_states);
        if (w->moved)
            show_inputs(pl, q, w->done);
        rise_to(&pl->peak_force, w->force);
        if (w->before && pl->books == BOOKS_OF_METHOD)
            rise_to(&pl->peak_force, ledger_take(&pl->ledger, w->before));
        if (pieces > 1 && pl->books == BOOKS_OF_LEDGER) /* the force at the instant of both */
            rise_to(&pl->peak_force, pl->ledger.flow.force);
        pass_time(pl, w->done - begin);
        take_switch(pl, &c, w->done * pl->ticks_per_time);
        begin = w->done;
    }
    pass_time(pl, pl->h - begin);
    if (pl->books == BOOKS_OF_METHOD)
        take_books(pl, q, q->books, 1);
    if (pl->counts.pieces_max < pieces)
        pl->counts.pieces_max = pieces;
    q->b.regime = pl->regime;
    q->done++;
}

/* The ticks that are done, as far as they are unseen. */
static void look_at_done(struct plant *pl, struct quiet *q)
{
    if (q->look)
        quiet_look(pl, q, q->seen, q->look, q->who);
    q->seen = q->done;
}

/* Ticks of the last run up to the last one with a switch; the run began with tick `from` of the block. books:
 * NULL, or those of the method, one each. A tick with a switch ends the books before it, for a peak force is
 * that of one contact. */
NEVER_INLINE void pass_switches(struct plant *pl, struct quiet *q, uint32_t from,
                                const struct method_books *books)
{
    while (q->told < q->switches.n) {
        uint32_t last = from + q->switches.at[q->told].tick;
        if (books) {
            take_books(pl, q, &books[q->done - from], last - q->done);
            q->books = &books[last - from];
        } else {
            book_ticks(pl, q, ticks_from(&q->b, q->booked), last + 1 - q->booked);
        }
        q->done = last;
        look_at_done(pl, q);
        pass_switch(pl, q);
        q->booked = q->done;
        look_at_done(pl, q);
    }
    q->switches.n = q->told = 0;
}

/* The first `moved` ticks of a pair of `asked` ones, with switches at their ends; and the next one. Returns
 * those that are good to their ends. */
NEVER_INLINE uint32_t end_pair(struct plant *pl, struct quiet *q, struct ticks t, uint32_t moved,
                               uint32_t asked)
{
    uint32_t from = q->done;
    pass_switches(pl, q, from, NULL);
    while (moved < asked && step_suspect(pl, q, ticks_after(t, moved)))
        moved++;
    q->done = from + moved;
    book_ticks(pl, q, ticks_from(&q->b, q->booked), q->done - q->booked);
    q->booked = q->done;
    return moved;
}

/* Up to n ticks from q->done on, and the books of those before. False if one of them, behind q->done, is not
 * a good one to its end. */
static bool run_block(struct plant *pl, struct quiet *q, uint32_t n)
{
    struct ticks t = ticks_from(&q->b, q->done);
    uint32_t to = q->done + n, asked, moved;
    do {
        asked = to - q->done < BLOCK_TOGETHER ? to - q->done : BLOCK_TOGETHER;
        moved = move_ticks(pl, q, t, asked);
        if (q->booked < q->done)
            book_ticks(pl, q, (struct ticks){t.x - BLOCK_TOGETHER, t.at - 2 * BLOCK_TOGETHER, NULL},
                       BLOCK_TOGETHER);
        q->booked = q->done;
        if (TICK_LANES > 1 && q->switches.n > 0) /* without lanes, methods with books alone have any */
            moved = end_pair(pl, q, t, moved, asked);
        else
            q->done += moved;
        t = ticks_after(t, BLOCK_TOGETHER);
    } while (moved == BLOCK_TOGETHER && q->done < to);
    return moved == asked;
}

/* As run_block, by a method that keeps books of its own: nothing has to follow behind. */
NEVER_INLINE bool run_booked(struct plant *pl, struct quiet *q, uint32_t n)
{
    struct ticks t = ticks_from(&q->b, q->done);
    unsigned drives = q->turning;
    uint32_t from = q->done;
    for (int i = 0; drives != 0; i++, drives >>= 1) {
        const struct drive d = pl->drive[i]; /* a copy: registers hold it */
        const struct wave w = pl->segment.wave[i];
        if (drives & 1u)
            drive_turn_ends(&d, &w, &t.at[0][i], &t.phasor[0][i], n);
    }
    if (q->sloping)
        quiet_climb(pl, q, t, n);
    uint32_t done = q->run(pl->model, pl->p, pl->scratch, &q->b, t.at, t.x, n);
    pl->segment.instant += done * TICK_FRACTIONS;
    const struct method_books *b = pl->method->books(pl->scratch);
    const struct method_ends *ends = ends_of(pl);
    if (ends && done > 0 && pl->books != BOOKS_NONE)
        ledger_take_ends(&pl->ledger, q->b.active, b, ends, done);
    bool good = done == n || q->switches.n == RUN_SWITCHES;
    if (q->switches.n > 0)
        pass_switches(pl, q, from, b);
    take_books(pl, q, &b[q->done - from], from + done - q->done);
    q->done = from + done;
    if (!good) {
        good = step_suspect(pl, q, ticks_after(t, done));
        q->done += good;
    }
    q->booked = q->done;
    return good;
}

/* The block is full: its end moves to its begin, and with lanes the ticks that may not be booked. */
static void move_block(struct quiet *q, int n_states, bool booked)
{
    enum { KEPT = TICK_LANES > 1 ? BLOCK_TOGETHER : 0, FROM = BLOCK_TICKS - KEPT };
    struct method_block *b = &q->b;
    unsigned drives = q->moving;
    for (int k = booked ? KEPT : 0; k <= KEPT; k++)
        copy_state(b->x[k], b->x[FROM + k], n_states);
    for (int i = 0; drives != 0; i++, drives >>= 1) {
        if (!(drives & 1u))
            continue;
        UNROLL
        for (int k = KEPT > 0 ? 1 : 0; k <= 2 * KEPT; k++)
            b->at[k][i] = b->at[2 * FROM + k][i];
        b->phasor[KEPT][i] = b->phasor[BLOCK_TICKS][i];
    }
    b->jumps >>= FROM;
    b->instant += FROM * TICK_FRACTIONS;
    q->origin += FROM;
    q->booked = q->booked > FROM ? q->booked - FROM : 0;
    q->done = q->filled = q->seen = KEPT;
}

/* The tick behind those that are done, in which a contact switches or that cannot be taken. */
NEVER_INLINE bool end_quiet(struct plant *pl, struct quiet *q)
{
    struct origin begin = {.regime = pl->regime};
    copy_state(begin.x, q->b.x[q->done], pl->model->n_states);
    show_tick(pl, q, q->done + 1);
    pl->now.tick--;
    pass_drives(pl, q, 1);
    pl->ledger.flow_valid &= !pl->segment.changed;
    bool finite = q->status != STEP_NOT_FINITE && inside(pl->x, pl->model->n_states);
    if (finite ? integrate_rest(pl, &begin, q->status, &q->c) : give_up(pl, &begin)) {
        pl->now.tick++;
        return true;
    }
    pl->counts.not_finite++;
    return false;
}

ALWAYS_INLINE bool stop(struct plant *pl, struct quiet *q, bool good, plant_look *look, void *who)
{
    book_ticks(pl, q, ticks_from(&q->b, q->booked), q->done - q->booked);
    show_tick(pl, q, q->done);
    pass_ticks(pl, q);
    if (good) {
        copy_state(pl->x, q->b.x[q->done], pl->model->n_states);
        return true;
    }
    good = end_quiet(pl, q);
    if (good && look)
        look(who, pl);
    return good;
}

bool quiet_stop(struct plant *pl, struct quiet *q, bool good, uint32_t timed, plant_look *look, void *who)
{
    uint32_t ticks = (uint32_t)(q->origin + q->done - q->passed);
    q->passed += ticks;
    pass_drives(pl, q, ticks);
    pass_times(pl, ticks - timed);
    return stop(pl, q, good, look, who);
}

/* Quiet ticks up to n, a phasor that is due, or the end of a tick with a switch in it. Does what excite and
 * segment do, without asking in each tick what does not change. */
ALWAYS_INLINE bool run_on(struct plant *pl, uint32_t n, const struct samples *held, plant_look *look,
                          plant_look_ticks *several, void *who)
{
    struct quiet q;
    bool good = true;
    n = quiet_begin(pl, n, held, &q);
    q.look = several ? NULL : look;
    q.who = who;
    bool booked = q.run && plant_find_books(pl);
    for (uint32_t moved = 0; good && n > 0; n -= moved) {
        if (q.done == BLOCK_TICKS)
            move_block(&q, pl->model->n_states, pl->books != BOOKS_OF_LEDGER);
        uint32_t from = q.done, room = BLOCK_TICKS - from;
        uint32_t asked = n < room ? n : room;
        if (held)
            fill_samples(&q, from + asked);
        good = booked ? run_booked(pl, &q, asked) : run_block(pl, &q, asked);
        moved = q.done - from;
        if (several && moved > 0)
            several(who, pl, &q.b, from, moved);
        look_at_done(pl, &q);
    }
    return stop(pl, &q, good, look, who);
}

/* Ticks up to `to` as long as they are quiet, as the next one is; look: NULL, or called after each, if not
 * `several` is. held: NULL, or samples as far as `to`, which are all that sounds. A function of its own: a
 * tick that is asked for alone does not pay. */
NEVER_INLINE bool run_quiet(struct plant *pl, uint64_t to, const struct samples *held, plant_look *look,
                            plant_look_ticks *several, void *who)
{
    bool good;
    do {
        uint64_t left = to - pl->now.tick;
        good = run_on(pl, left < PHASOR_RESYNC_TICKS ? (uint32_t)left : PHASOR_RESYNC_TICKS, held, look,
                      several, who);
    } while (good && pl->now.tick < to && (held || is_quiet(pl)));
    return good;
}

NEVER_INLINE bool advance(struct plant *pl, struct instant to)
{
    uint32_t length;
    while ((length = segment_length(pl, to)) > 0) {
        excite(pl, length);
        if (pl->staged && !act(pl, length))
            return false;
        if (!segment(pl))
            return false;
        pl->now.fraction += length;
        if (pl->now.fraction == TICK_FRACTIONS) {
            pl->now.fraction = 0;
            pl->now.tick++;
            if (pl->staged)
                pl->stage_calls->sense(pl->stages, pl);
            if (pl->now.tick + 1 < to.tick && is_quiet(pl) && !run_quiet(pl, to.tick, NULL, NULL, NULL, NULL))
                return false;
        }
    }
    return true;
}

bool quiet_is_next(const struct plant *pl)
{
    return pl->now.fraction == 0 && !pl->staged && is_quiet(pl);
}

NEVER_INLINE bool advance_far(struct plant *pl, struct instant to)
{
    if (quiet_is_next(pl) && !run_quiet(pl, to.tick, NULL, NULL, NULL, NULL))
        return false;
    return advance(pl, to);
}

bool plant_advance(struct plant *pl, struct instant to)
{
    return pl->now.tick + QUIET_FEW < to.tick ? advance_far(pl, to) : advance(pl, to);
}

bool plant_run(struct plant *pl, uint64_t ticks)
{
    return plant_advance(pl, (struct instant){pl->now.tick + ticks, pl->now.fraction});
}

bool plant_run_seen(struct plant *pl, uint64_t ticks, plant_look *look, plant_look_ticks *several, void *who)
{
    uint64_t to = pl->now.tick + ticks;
    while (pl->now.tick < to) {
        if (pl->now.tick + QUIET_FEW < to && quiet_is_next(pl)) {
            if (!run_quiet(pl, to, NULL, look, several, who))
                return false;
            continue;
        }
        if (!plant_advance(pl, (struct instant){pl->now.tick + 1, 0}))
            return false;
        look(who, pl);
    }
    return true;
}

/* ---- samples told ahead ---- */

/* Input i is all that sounds, it may jump, and its sample is all of it, as it was in the last tick. */
static bool is_held(const struct plant *pl, int i)
{
    const struct drive *d = &pl->drive[i];
    unsigned alone = 1u << i;
    return pl->awake == alone && pl->segment.active == alone && pl->now.fraction == 0 && !pl->staged &&
           pl->model->input_signal[i].quantity != QUANTITY_LENGTH && d->phasor_valid && drive_stands(d) &&
           d->amplitude == 0.0 && !d->noise.active && d->sample_left == 0;
}

/* The first n samples that are not 0. */
static uint32_t count_samples(const double *value, uint32_t n, double unit)
{
    uint32_t k = 0;
    while (k < n && value[k] / unit != 0.0)
        k++;
    return k;
}

bool plant_run_samples(struct plant *pl, int i, const double *value, uint32_t n, uint64_t ticks)
{
    double unit = unit_of(pl, i);
    bool good = true;
    uint32_t alike = 0; /* samples told by themselves that the next ones may follow */
    for (uint32_t k = 0; k < n && good;) {
        uint32_t several = alike < 2 ? 0 : count_samples(&value[k], n - k, unit);
        if (several > 0) {
            const struct samples held = {i, &value[k], unit, pl->now.tick, ticks};
            pl->drive[i].phasor_kept = true;
            good = run_quiet(pl, pl->now.tick + several * ticks, &held, NULL, NULL, NULL);
            k += several;
        } else {
            plant_sample(pl, i, value[k++], 0);
            good = plant_run(pl, ticks);
            alike = is_held(pl, i) ? alike + 1 : 0;
        }
    }
    return good;
}
