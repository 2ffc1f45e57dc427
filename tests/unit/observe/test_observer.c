/* test_observer.c - who observes sees each tick once,
 * at its end and with its switches, and changes no bit. */
#include "firmware/plant/plant_report.h"
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

/* The lock-in under an observer takes each tick by itself, else those of a block together. */
static void measure(struct seen *s, struct lockin_slots *result)
{
    struct app_config c = bus_config();
    c.observe = s ? look : NULL;
    c.observer = s;
    bus_start_running(&bus, &c);
    bus_set(&bus, SETTING_FIRST + SET_LOCKIN_FRAMES, 20.0);
    bus_set(&bus, SETTING_FIRST + SET_LOCKIN_HARMONIC + 1, 3.0);
    bus_set(&bus, SETTING_FIRST + SET_LOCKIN_CHANNEL + 1, RIG_FORCE);
    bus_drive(&bus, RIG_FORCE, 20.0, 225.0, 0.0, 0.0);
    bus_drive(&bus, RIG_FAST_FORCE, 5.0, 1800.0, 0.0, 0.0);
    bus_fire(&bus, 1u << RIG_FORCE | 1u << RIG_FAST_FORCE, false, bus.app.plant.now.tick + 3, 128);
    bus_run(&bus, 3 * SEEN_FRAMES);
    *result = bus.app.lockin;
}

TEST(observer_lockin)
{
    struct seen s = {0, 0, 0, 0};
    static struct lockin_slots observed, alone;
    measure(&s, &observed);
    measure(NULL, &alone);
    check_is("windows", alone.slot[1].result.number, >=, 2);
    for (int i = 0; i < 2; i++) {
        check_is("amplitude", alone.slot[i].result.amplitude, >, 0.0);
        check_is("amplitude, observed or not", observed.slot[i].result.amplitude, ==,
                 alone.slot[i].result.amplitude);
        check_is("phase, observed or not", observed.slot[i].result.phase, ==, alone.slot[i].result.phase);
    }
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
