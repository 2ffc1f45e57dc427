/* test_observer.c - who observes sees each tick once,
 * at its end and with its switches, and changes no bit. */
#include <string.h>
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { SEEN_FRAMES = 60 };

static struct bus bus;

struct seen {
    uint64_t ticks, last, wrong, switches;
};

static void look(void *observer, const struct plant *pl)
{
    struct seen *s = observer;
    s->wrong += pl->now.tick != s->last + 1 || pl->now.fraction != 0;
    s->last = pl->now.tick;
    s->ticks++;
    s->switches = pl->counts.switches;
}

static uint64_t run(struct seen *s)
{
    struct app_config c = bus_config();
    c.observe = s ? look : NULL;
    c.observer = s;
    bus_start_running(&bus, &c);
    bus_drive(&bus, RIG_FORCE, 20.0, 225.0, 0.0, 0.0);
    bus_fire(&bus, 1u << RIG_FORCE, false, bus.app.plant.now.tick + 3, 128);
    bus_run(&bus, SEEN_FRAMES);
    return plant_hash(&bus.app.plant);
}

TEST(observer)
{
    struct seen s = {0, 0, 0, 0};
    uint64_t observed = run(&s);
    check_int("ticks seen", (long)s.ticks, (long)bus.app.plant.now.tick);
    check_int("out of order", (long)s.wrong, 0);
    check_above("contact was lost", (double)s.switches, 1.0);
    check_int("switches seen", (long)s.switches, (long)bus.app.plant.counts.switches);
    check_true("equal bits, observed or not", observed == run(NULL));
}

/* Where no drive sounds no slot of the lock-in measures: the observer sees each tick even so. */
TEST(observer_silent)
{
    struct seen s = {0, 0, 0, 0};
    struct app_config c = bus_config();
    c.observe = look;
    c.observer = &s;
    bus_start_running(&bus, &c);
    bus_run(&bus, SEEN_FRAMES);
    check_int("ticks seen", (long)s.ticks, (long)bus.app.plant.now.tick);
    check_is("of all frames but the first", s.ticks, >=, (SEEN_FRAMES - 1) * BUS_TICKS);
    check_int("out of order", (long)s.wrong, 0);
}
