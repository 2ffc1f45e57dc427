/* test_mailbox.c - the mailbox against a plain list in order of arrival. */
#include "tests/unit/test.h"

#include <string.h>
#include "firmware/bus/mailbox.h"
#include "tests/fixture/assertion.h"

static struct fire make_fire(uint64_t tick, uint32_t fraction, uint64_t mark)
{
    struct fire f;
    memset(&f, 0, sizeof f);
    f.at = (struct instant){tick, fraction};
    f.received_tick = mark;
    return f;
}

static struct sample make_sample(uint64_t frame, int channel, double value)
{
    return (struct sample){.frame = frame, .channel = (uint8_t)channel, .value = value};
}

/* The list of all entries in order of arrival, searched from its begin. */
struct list {
    struct fire fire[8];
    int n_fires;
    struct sample sample[64];
    int n_samples;
};

static int is_before(struct instant a, struct instant b)
{
    return a.tick < b.tick || (a.tick == b.tick && a.fraction < b.fraction);
}

static int list_take_fire(struct list *l, struct instant end, struct fire *f)
{
    int first = -1;
    for (int i = 0; i < l->n_fires; i++)
        if (!is_before(end, l->fire[i].at) && (first < 0 || is_before(l->fire[i].at, l->fire[first].at)))
            first = i;
    if (first < 0)
        return 0;
    *f = l->fire[first];
    memmove(&l->fire[first], &l->fire[first + 1], (size_t)(--l->n_fires - first) * sizeof *f);
    return 1;
}

static int list_find_sample(const struct list *l, uint64_t frame, int channel)
{
    for (int i = 0; i < l->n_samples; i++)
        if (l->sample[i].frame == frame && l->sample[i].channel == channel)
            return i;
    return -1;
}

/* Every order in which four fires of up to four instants, whole and fractional, can arrive. */
TEST(mailbox_fires)
{
    static const struct instant AT[4] = {{5, 0}, {5, 1}, {5, 65535}, {6, 0}};
    struct instant far = {UINT64_MAX, 0}, next;
    struct mailbox b;
    struct fire got, expected;
    int wrong = 0;
    for (unsigned order = 0; order < 256; order++) {
        struct list l = {.n_fires = 0};
        mailbox_empty(&b);
        for (unsigned i = 0; i < 4; i++) {
            struct instant at = AT[order >> 2 * i & 3];
            l.fire[l.n_fires++] = make_fire(at.tick, at.fraction, i);
            wrong += !mailbox_put_fire(&b, &l.fire[i]);
        }
        for (int i = 0; i < 4; i++) {
            wrong += !mailbox_next_fire(&b, &next);
            wrong += !list_take_fire(&l, far, &expected) || !mailbox_take_fire(&b, far, &got);
            wrong += memcmp(&got, &expected, sizeof got) != 0 || memcmp(&next, &got.at, sizeof next) != 0;
        }
        wrong += mailbox_take_fire(&b, far, &got) || mailbox_next_fire(&b, &next);
    }
    check_int("256 orders of arrival, deviations", wrong, 0);

    struct fire f = make_fire(5, 100, 0);
    for (int i = 0; i < MAILBOX_FIRES; i++)
        check_true("room for a fire", mailbox_put_fire(&b, &f));
    f = make_fire(1, 0, 9);
    check_true("full: refused", !mailbox_put_fire(&b, &f));
    check_true("... and not taken in place of another", mailbox_next_fire(&b, &next));
    check_int("... and not taken in place of another", next.tick, 5);
    check_true("nothing before 5 + 100/65536", !mailbox_take_fire(&b, (struct instant){5, 99}, &got));
    check_true("one at it", mailbox_take_fire(&b, (struct instant){5, 100}, &got));
    mailbox_empty(&b);
    check_true("empty: nothing left", !mailbox_take_fire(&b, far, &got) && !mailbox_next_fire(&b, &next));
}

TEST(mailbox_samples)
{
    struct mailbox b;
    struct sample s, got;
    mailbox_empty(&b);
    for (int i = 0; i < MAILBOX_SAMPLES; i++) {
        s = make_sample((uint64_t)(i / 4), i % 4, i);
        if (!mailbox_put_sample(&b, &s))
            check_true("room for a sample", 0);
    }
    s = make_sample(100, 0, -1.0);
    check_true("full: refused", !mailbox_put_sample(&b, &s));
    s = make_sample(3, 2, 77.0);
    check_true("full: a newer sample of the same frame and channel is taken", mailbox_put_sample(&b, &s));
    check_true("... once", mailbox_take_sample(&b, 3, 2, &got) && !mailbox_take_sample(&b, 3, 2, &s));
    check_near("... and wins", (double)got.value, 77.0, 0.0);
    check_true("another frame's is not taken", !mailbox_take_sample(&b, 8, 0, &got));
    s = make_sample(100, 0, -1.0);
    check_true("room again", mailbox_put_sample(&b, &s));
    b.commit_with_fire = true;
    staged_put(&b.committed, 3, 1.0);
    b.armed[2].given = 1;
    mailbox_empty(&b);
    check_true("empty: no sample", !mailbox_take_sample(&b, 100, 0, &got));
    check_true("empty: no set, no arms", !b.commit_with_fire);
    check_int("empty: no set, no arms", staged_count(&b.committed), 0);
    check_int("empty: no set, no arms", b.armed[2].given, 0);
}

static int random_fire(struct mailbox *b, struct list *l, unsigned r)
{
    struct fire f = make_fire(r % 4, r / 4 % 3, r), got, expected;
    struct instant end = {r % 5, r / 5 % 3};
    if (r / 64 % 2) {
        int room = l->n_fires < MAILBOX_FIRES;
        if (room)
            l->fire[l->n_fires++] = f;
        return mailbox_put_fire(b, &f) != room;
    }
    int there = list_take_fire(l, end, &expected);
    return mailbox_take_fire(b, end, &got) != there || (there && memcmp(&got, &expected, sizeof got) != 0);
}

static int random_sample(struct mailbox *b, struct list *l, unsigned r)
{
    struct sample s = make_sample(r % 16, (int)(r / 16 % 4), r), got;
    int i = list_find_sample(l, s.frame, s.channel);
    if (r / 64 % 3) {
        int room = i >= 0 || l->n_samples < MAILBOX_SAMPLES;
        if (room)
            l->sample[i >= 0 ? i : l->n_samples++] = s;
        return mailbox_put_sample(b, &s) != room;
    }
    bool there = mailbox_take_sample(b, s.frame, s.channel, &got);
    if (there != (i >= 0) || (there && got.value != l->sample[i].value))
        return 1;
    if (there)
        l->sample[i] = l->sample[--l->n_samples];
    return 0;
}

TEST(mailbox_random)
{
    struct mailbox b;
    struct list l = {.n_fires = 0};
    uint32_t state = 12345;
    int wrong = 0, full_fires = 0, full_samples = 0;
    mailbox_empty(&b);
    for (int i = 0; i < 200000; i++) {
        state = state * 1664525u + 1013904223u;
        unsigned r = state >> 8;
        wrong += r / 4096 % 2 ? random_fire(&b, &l, r % 4096) : random_sample(&b, &l, r % 4096);
        full_fires += l.n_fires == MAILBOX_FIRES;
        full_samples += l.n_samples == MAILBOX_SAMPLES;
    }
    check_int("200000 random requests, deviations from the list", wrong, 0);
    check_above("... with all fires waiting, times", full_fires, 1000);
    check_above("... with all samples waiting, times", full_samples, 1000);
}

static void put_beyond(const void *staged)
{
    struct staged s = *(const struct staged *)staged;
    staged_put(&s, STAGED_VALUES, 1.0);
}

TEST(mailbox_staged)
{
    struct staged s;
    memset(&s, 0, sizeof s);
    check_int("nothing staged", staged_count(&s), 0);
    check_hex("CRC of nothing", staged_crc(&s), 0);
    staged_put(&s, 0, 1.0);
    check_hex("CRC of 1.0f at 0 (zlib, bytes 00 0000803f)", staged_crc(&s), 0x4bc7426b);
    staged_put(&s, 127, -2.5);
    staged_put(&s, 31, 1e-3);
    staged_put(&s, 32, 4.0);
    staged_put(&s, 32, 400.0);
    check_int("staged", staged_count(&s), 4);
    check_hex("CRC of four in order of index (zlib)", staged_crc(&s), 0x45ce935a);
    check_true("an index beyond the last is refused", assertion_fails(put_beyond, &s));
    int wrong = 0;
    for (unsigned i = 0; i < STAGED_VALUES + 40u; i++)
        wrong += staged_has(&s, i) != (i == 0 || i == 31 || i == 32 || i == 127);
    check_int("indices that are there and should not, or the reverse", wrong, 0);
}
