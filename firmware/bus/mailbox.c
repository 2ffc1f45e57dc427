/* mailbox.c - commands waiting for their plant tick; see mailbox.h. */
#include "firmware/bus/mailbox.h"

#include <string.h>

void mailbox_empty(struct mailbox *b)
{
    memset(b, 0, sizeof *b);
}

/* Sorted so that the fire to be taken next stands last: the latest instant first, and fires of one instant
 * in reverse order of arrival. */
bool mailbox_put_fire(struct mailbox *b, const struct fire *f)
{
    if (b->n_fires == MAILBOX_FIRES)
        return false;
    uint32_t i = b->n_fires++;
    for (; i > 0 && instant_compare(b->fire[i - 1].at, f->at) <= 0; i--)
        b->fire[i] = b->fire[i - 1];
    b->fire[i] = *f;
    return true;
}

bool mailbox_next_fire(const struct mailbox *b, struct instant *at)
{
    if (b->n_fires == 0)
        return false;
    *at = b->fire[b->n_fires - 1].at;
    return true;
}

bool mailbox_take_fire(struct mailbox *b, struct instant end, struct fire *f)
{
    struct instant at;
    if (!mailbox_next_fire(b, &at) || instant_compare(at, end) > 0)
        return false;
    *f = b->fire[--b->n_fires];
    return true;
}

/* Where this frame's sample of this channel stands, or n_samples. */
static uint32_t find_sample(const struct mailbox *b, uint64_t frame, int channel)
{
    uint32_t i = 0;
    while (i < b->n_samples && !(b->sample[i].frame == frame && b->sample[i].channel == channel))
        i++;
    return i;
}

bool mailbox_put_sample(struct mailbox *b, const struct sample *s)
{
    uint32_t i = find_sample(b, s->frame, s->channel);
    if (i == MAILBOX_SAMPLES)
        return false;
    if (i == b->n_samples)
        b->n_samples++;
    b->sample[i] = *s;
    return true;
}

/* Samples are unordered: removal swaps in the last element. */
bool mailbox_take_sample(struct mailbox *b, uint64_t frame, int channel, struct sample *s)
{
    uint32_t i = find_sample(b, frame, channel);
    if (i == b->n_samples)
        return false;
    *s = b->sample[i];
    b->sample[i] = b->sample[--b->n_samples];
    return true;
}

void staged_put(struct staged *s, unsigned index, double value)
{
    ASSERT(index < STAGED_VALUES);
    s->given[index / 32] |= UINT32_C(1) << index % 32;
    s->value[index] = value;
}

bool staged_has(const struct staged *s, unsigned index)
{
    return index < STAGED_VALUES && (s->given[index / 32] >> index % 32 & 1);
}

unsigned staged_count(const struct staged *s)
{
    unsigned n = 0;
    for (unsigned i = 0; i < STAGED_VALUES; i++)
        n += staged_has(s, i);
    return n;
}

uint32_t staged_crc(const struct staged *s)
{
    uint32_t crc = 0;
    for (unsigned i = 0; i < STAGED_VALUES; i++) {
        if (staged_has(s, i))
            crc = wire_crc32_entry(crc, i, s->value[i]);
    }
    return crc;
}
