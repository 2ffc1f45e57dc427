/* faults.c - see faults.h. */
#include "hal/link/faults.h"

#include <string.h>

const char *const faults_name[FAULTS_KINDS] = {
    [FAULTS_BUS_OFF] = "bus-off",   [FAULTS_DROP] = "drop",     [FAULTS_REPEAT] = "repeat",
    [FAULTS_TRUNCATE] = "truncate", [FAULTS_FLIP] = "flip",     [FAULTS_DUPLICATE] = "duplicate",
    [FAULTS_REORDER] = "reorder",   [FAULTS_DELAY] = "delay",   [FAULTS_BURST] = "burst",
    [FAULTS_FREEZE] = "freeze",     [FAULTS_REFUSE] = "refuse",
};

/* SplitMix64 (Steele, Lea & Flood 2014). */
static uint64_t next_word(struct faults *f)
{
    uint64_t z = f->seed + ++f->words * 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

static uint32_t below(struct faults *f, uint32_t n)
{
    return (uint32_t)((next_word(f) >> 32) * n >> 32);
}

static bool acts(const struct faults *f, const struct faults_rule *r, enum faults_kind kind, bool in)
{
    return r->kind == kind && (in ? r->in : r->out) && r->begin <= f->frame && f->frame < r->until;
}

/* The first rule of this kind that this frame suffers from, or NULL. */
static const struct faults_rule *strikes(struct faults *f, enum faults_kind kind, bool in)
{
    for (uint32_t i = 0; i < f->n_rules; i++) {
        const struct faults_rule *r = &f->rule[i];
        if (!acts(f, r, kind, in) || (double)(next_word(f) >> 11) * 0x1p-53 >= r->probability)
            continue;
        f->count[kind]++;
        return r;
    }
    return NULL;
}

/* ---- the queue ---- */

static struct faults_held *held_at(struct faults_line *l, uint32_t i)
{
    return &l->held[(l->first + i) % FAULTS_QUEUE];
}

/* In order of due, those of one due in order of arrival. */
static void hold(struct faults *f, bool in, uint64_t due, const struct frame *frame)
{
    struct faults_line *l = in ? &f->in : &f->out;
    if (l->n == FAULTS_QUEUE) {
        f->lost++;
        f->report |= in ? HAL_DROPPED : 0;
        return;
    }
    uint32_t i = l->n++;
    for (; i > 0 && held_at(l, i - 1)->due > due; i--)
        *held_at(l, i) = *held_at(l, i - 1);
    *held_at(l, i) = (struct faults_held){due, *frame};
}

/* The next frame that is due, or NULL; with `all` those too that come after the others. */
static struct faults_held *next_due(const struct faults *f, struct faults_line *l, bool all)
{
    struct faults_held *h = held_at(l, 0);
    return l->n && h->due <= 2 * f->frame + all ? h : NULL;
}

static void let_go(struct faults_line *l)
{
    l->first = (l->first + 1) % FAULTS_QUEUE;
    l->n--;
}

/* ---- what happens to a frame ---- */

static void flip_bits(struct faults *f, struct frame *frame)
{
    uint32_t n = frame->length ? 1 + below(f, 3) : 0;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t bit = below(f, 8u * frame->length);
        frame->data[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
}

/* Until when bursts and freezes hold a frame back that would leave at `due`. */
static uint64_t held_until(struct faults *f, bool in, uint64_t due)
{
    for (uint32_t i = 0; i < f->n_rules; i++) {
        const struct faults_rule *r = &f->rule[i];
        uint64_t free = f->frame;
        if (acts(f, r, FAULTS_BURST, in) && f->frame % r->frames)
            free += r->frames - f->frame % r->frames;
        if (acts(f, r, FAULTS_FREEZE, in))
            free = r->until;
        f->count[r->kind] += free > f->frame;
        due = due > 2 * free ? due : 2 * free;
    }
    return due;
}

/* When a frame of now leaves. */
static uint64_t due_of(struct faults *f, bool in)
{
    uint64_t due = 2 * f->frame;
    const struct faults_rule *r;
    if (strikes(f, FAULTS_REORDER, in))
        due = 2 * (f->frame + 1) + 1;
    if ((r = strikes(f, FAULTS_DELAY, in)) != NULL)
        due += 2 * (uint64_t)r->frames;
    return held_until(f, in, due);
}

static void repeat_old(struct faults *f, bool in)
{
    struct faults_line *l = in ? &f->in : &f->out;
    uint32_t n = l->n_past < FAULTS_HISTORY ? l->n_past : FAULTS_HISTORY;
    if (n && strikes(f, FAULTS_REPEAT, in))
        hold(f, in, due_of(f, in), &l->past[below(f, n)]);
}

static void remember(struct faults_line *l, const struct frame *frame)
{
    l->past[l->n_past % FAULTS_HISTORY] = *frame;
    l->n_past++;
}

static void pass(struct faults *f, bool in, struct frame frame)
{
    if (f->off) {
        f->count[FAULTS_BUS_OFF]++;
        return;
    }
    if (strikes(f, FAULTS_DROP, in))
        return;
    repeat_old(f, in);
    remember(in ? &f->in : &f->out, &frame);
    if (frame.length && strikes(f, FAULTS_TRUNCATE, in))
        frame.length = (uint8_t)below(f, frame.length);
    if (strikes(f, FAULTS_FLIP, in))
        flip_bits(f, &frame);
    hold(f, in, due_of(f, in), &frame);
    if (strikes(f, FAULTS_DUPLICATE, in))
        hold(f, in, due_of(f, in), &frame);
}

/* ---- the hal ---- */

static int receive(void *context, struct frame *frame)
{
    struct faults *f = context;
    int got = 1, report;
    for (int i = 0; i < FAULTS_READ && got && !f->report && !next_due(f, &f->in, false); i++) {
        got = f->inner.recv(f->inner.context, frame);
        f->report |= got < 0 ? -got : 0;
        if (got > 0)
            pass(f, true, *frame);
    }
    if ((report = f->report) != 0) {
        f->report = 0;
        return -report;
    }
    struct faults_held *h = next_due(f, &f->in, true);
    if (!h)
        return 0;
    *frame = h->frame;
    let_go(&f->in);
    return 1;
}

/* Sends the frames that are due until the inner hal has no room. */
static void send_due(struct faults *f, bool all)
{
    struct faults_held *h;
    while ((h = next_due(f, &f->out, all)) != NULL && f->inner.send(f->inner.context, &h->frame) == 1)
        let_go(&f->out);
}

static int transmit(void *context, const struct frame *frame)
{
    struct faults *f = context;
    send_due(f, false);
    bool full = next_due(f, &f->out, false) != NULL; /* the inner hal has no room */
    if (f->off || full || strikes(f, FAULTS_REFUSE, false))
        return 0;
    pass(f, false, *frame);
    send_due(f, false);
    return 1;
}

/* The bus goes off or comes back, when a rule begins or ends. */
static void watch_bus(struct faults *f)
{
    bool off = false;
    for (uint32_t i = 0; i < f->n_rules; i++)
        off = off || acts(f, &f->rule[i], FAULTS_BUS_OFF, true);
    f->report |= off && !f->off ? HAL_BUS_OFF : 0;
    f->off = off;
}

static void flush(void *context)
{
    struct faults *f = context;
    send_due(f, true);
    f->inner.flush(f->inner.context);
    f->frame++;
    watch_bus(f);
}

static uint32_t now_us(void *context)
{
    struct faults *f = context;
    return f->inner.now_us(f->inner.context);
}

static void healthy(void *context)
{
    struct faults *f = context;
    f->inner.healthy(f->inner.context);
}

void faults_init(struct faults *f, const struct hal *inner, uint64_t seed)
{
    memset(f, 0, sizeof *f);
    f->inner = *inner;
    f->seed = seed;
    f->hal = (struct hal){f, receive, transmit, flush, now_us, healthy};
}

const char *faults_add(struct faults *f, const struct faults_rule *r)
{
    bool timed = r->kind == FAULTS_DELAY || r->kind == FAULTS_BURST;
    if (f->n_rules == FAULTS_RULES)
        return "at most 16 faults";
    if (!(r->probability >= 0.0 && r->probability <= 1.0))
        return "a probability is 0 to 1";
    if (timed && r->frames < 1)
        return "delay and burst last 1 frame or more";
    if (!(r->begin < r->until))
        return "a fault ends after it begins";
    if (r->kind == FAULTS_FREEZE && r->until == UINT64_MAX)
        return "a freeze needs an end; give freeze@FROM:UNTIL";
    if (r->kind == FAULTS_BUS_OFF && !(r->in && r->out))
        return "a bus is off in both directions; take away in. or out.";
    if (r->kind == FAULTS_REFUSE && !r->out)
        return "only frames that go out can find no room; take away in.";
    f->rule[f->n_rules++] = *r;
    watch_bus(f);
    return NULL;
}
