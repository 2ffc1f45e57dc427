/* test_listen.c - numbers of which a message has the low bits, plants that begin anew, and halves of events.
 */
#include "host_sim/listen/latest.h"
#include "host_sim/listen/listen.h"
#include "tests/unit/test.h"

enum { SUBSTEPS = 64 };

static struct message sync_of(uint64_t frame, uint64_t tick)
{
    return (struct message){.kind = WIRE_SYNC,
                            .value = {(double)(frame % 65536), (double)(tick % (UINT64_C(1) << 32))}};
}

TEST(listen_extend)
{
    const uint64_t wrap = UINT64_C(1) << 32;
    struct message m = sync_of(0, wrap - 1);
    check_int("the first number heard is none below 0", (int64_t)listen_extend(0, &m, SYNC_TICK),
              (int64_t)wrap - 1);
    check_int("just before", (int64_t)listen_extend(wrap + 5, &m, SYNC_TICK), (int64_t)wrap - 1);
    check_int("just behind", (int64_t)listen_extend(3 * wrap - 9, &m, SYNC_TICK), 3 * (int64_t)wrap - 1);
    m = sync_of(7, 0);
    check_int("by the field's bits", (int64_t)listen_extend(65530, &m, SYNC_FRAME), 65536 + 7);
}

/* SYNCs of these frames, one after the other: where the last one is, and how often time began anew. */
static void check_silence(const char *name, uint64_t last, uint64_t next, uint64_t frame, int anew)
{
    const uint64_t at[] = {last, next};
    uint64_t f = last, tick = last * SUBSTEPS;
    int n = 0;
    for (int i = 0; i < 2; i++) {
        struct message m = sync_of(at[i], at[i] * SUBSTEPS);
        n += listen_sync(SUBSTEPS, &m, &f, &tick);
    }
    check_int(name, (int64_t)f, (int64_t)frame);
    check_int("  began anew", n, anew);
    check_int("  tick", (int64_t)tick, (int64_t)(next * SUBSTEPS));
}

TEST(listen_sync)
{
    check_silence("the next frame", 70000, 70001, 70001, 0);
    check_silence("after 40000 silent frames, more than half of FRAME", 70000, 110000, 110000, 0);
    check_silence("after 200000", 70000, 270000, 270000, 0);
    check_silence("overtaken", 70000, 69990, 69990, 0);
    check_silence("started again", 70000, 3, 3, 1);
    check_silence("started again, early", 20, 2, 2, 1);
    uint64_t frame = 0, tick = 0;
    struct message m = sync_of(70000, 70000 * SUBSTEPS);
    (void)listen_sync(SUBSTEPS, &m, &frame, &tick);
    check_int("the first SYNC has its low bits alone", (int64_t)frame, 70000 - 65536);
    m = sync_of(70001, 70000 * SUBSTEPS);
    frame = 70000;
    (void)listen_sync(SUBSTEPS, &m, &frame, &tick);
    check_int("while time stands, frames count", (int64_t)frame, 70001);
}

TEST(latest_plant_that_begins_anew)
{
    static struct latest l;
    latest_begin(&l);
    struct message status = {.kind = WIRE_STATUS,
                             .value = {1.0, STATE_RUNNING, REACTION_NONE, 0.0, 0.0, 70000.0}};
    struct message sync = sync_of(70001, 70001 * SUBSTEPS), again = sync_of(2, 2 * SUBSTEPS);
    latest_take(&l, SUBSTEPS, &status);
    latest_take(&l, SUBSTEPS, &sync);
    check_int("frame of STATUS and SYNC", (int64_t)l.frame, 70001);
    latest_take(&l, SUBSTEPS, &again);
    check_int("a plant that was started again: its frame", (int64_t)l.frame, 2);
    check_int("  and tick", (int64_t)l.tick, 2 * SUBSTEPS);
}

static struct listen_event event;
static int n_events;

static void take(void *context, const struct listen_event *e)
{
    (void)context;
    event = *e;
    n_events++;
}

TEST(listen_events)
{
    struct listen_events l = {.tick_s = 1e-3, .take = take};
    struct message time = {.kind = WIRE_EVENT_TIME, .counter = 3, .value = {1.0, 1.0, 0.25, 1000.0}},
                   data = {.kind = WIRE_EVENT_DATA, .counter = 3, .value = {1.0, 0.0, -0.5, 20.0}};
    n_events = 0;
    listen_events_take(&l, &time, 1005);
    listen_events_take(&l, &data, 1005);
    check_int("data of another contact are another event's", n_events, 0);
    data.value[EVENT_CONTACT] = 1.0;
    listen_events_take(&l, &data, 1005);
    check_int("both halves: an event", n_events, 1);
    check_near("  its time, s", event.t_s, 1.00025, 1e-15);
    check_near("  its speed, m/s", event.speed, -0.5, 0.0);
    listen_events_take(&l, &data, 1005);
    check_int("once", n_events, 1);
    listen_events_take(&l, &time, 1005);
    listen_events_end(&l);
    check_true("a time alone is an event without data", n_events == 2 && !event.has_data);
    check_nan("  its speed", event.speed);
}
