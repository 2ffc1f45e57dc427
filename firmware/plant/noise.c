/* noise.c - see noise.h. */
#include "firmware/plant/noise.h"

#include <math.h>
#include "models/math/elementary.h"

void noise_init(struct noise *n, int i_input, bool straight)
{
    *n = (struct noise){.sequence = (uint64_t)i_input << 32, .hold = 1, .x = 1.0, .straight = straight};
}

static double level_at(const struct noise *n, double x)
{
    return x >= 1.0 ? n->level : n->level_from + (n->level - n->level_from) * x;
}

void noise_leave(struct noise *n)
{
    n->level_from = level_at(n, n->x);
    n->rest *= 1.0 - n->x;
    n->x = 0.0;
}

void noise_aim(struct noise *n, const struct noise_setting *s)
{
    uint64_t sequence = (n->sequence & ~(uint64_t)UINT32_MAX) | s->seed;
    uint32_t hold = s->hold > 0 ? s->hold : 1;
    n->level = s->deviation;
    n->active = n->active || n->level != 0.0;
    if (sequence == n->sequence && hold == n->hold)
        return;
    n->sequence = sequence;
    n->hold = hold;
    n->known = false;
    n->anew = true;
}

void noise_start(struct noise *n, const struct noise_setting *s)
{
    noise_aim(n, s);
    n->x = 1.0;
    n->rest = 0.0;
    n->anew = false;
    n->active = n->level != 0.0;
}

struct noise_setting noise_target(const struct noise *n)
{
    return (struct noise_setting){n->level, n->hold, (uint32_t)n->sequence};
}

/* The cell of a tick: the one at hand, the next, or any. True when it is another one. */
static bool find_cell(struct noise *n, uint64_t tick)
{
    uint64_t inside = tick - n->begin_tick;
    if (n->known && inside < n->hold)
        return false;
    bool follows = n->known && inside == n->hold;
    n->cell = follows ? n->cell + 1 : tick / n->hold;
    n->begin_tick = n->cell * n->hold;
    for (unsigned i = follows; i < 2; i++) {
        n->here = n->next;
        n->next = noise_deviate(noise_word(n->sequence, n->cell + i));
    }
    n->known = true;
    return true;
}

bool noise_add(struct noise *n, const struct noise_span *s, struct segment *e, int i)
{
    bool changed = find_cell(n, s->tick);
    double rise = n->straight ? (n->next - n->here) / n->hold : 0.0;
    double at = (double)(s->tick - n->begin_tick) + s->begin;
    double first = n->here + rise * at, last = first + rise * s->length;
    if (n->anew)
        n->rest = n->value - n->level_from * first;
    n->anew = false;
    first = level_at(n, n->x) * first + n->rest * (1.0 - n->x);
    n->x = s->ramp_end;
    n->value = level_at(n, n->x) * last + n->rest * (1.0 - n->x);
    double slope = (n->value - first) / s->length * s->ticks_per_time;
    e->wave[i].offset += first;
    e->wave[i].slope += slope;
    for (int k = 0; k < 3; k++) {
        e->at[k][i].value += first + (n->value - first) * (0.5 * k);
        e->at[k][i].rate += slope;
    }
    n->active = n->x < 1.0 || n->level != 0.0;
    return changed || slope != 0.0;
}

void noise_rescale(struct noise *n, double factor)
{
    n->level_from *= factor;
    n->level *= factor;
    n->rest *= factor;
    n->value *= factor;
}
