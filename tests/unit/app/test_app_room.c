/* test_app_room.c - a bus with too little room: what must not
 * be lost waits, where the rest is replaced by the newest. */
#include <math.h>
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { ROOM = 2, SAMPLES = 20, SIGNALS = 5, WINDOW = 40, WINDOWS = 30 };
static struct bus bus;

/* Running, and from here on ROOM frames a turn go out; the plant says four and more. */
static void room_start(void)
{
    bus_start_rig(&bus);
    bus_run(&bus, 5);
    bus.wires.port[0].tx_limit = ROOM;
}

TEST(app_room_capture)
{
    room_start();
    bus_set(&bus, SETTING_FIRST + SET_CAPTURE_SAMPLES, SAMPLES);
    bus_set(&bus, SETTING_FIRST + SET_CAPTURE_PRETRIGGER, 0);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_ARM});
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_TRIGGER});
    bus_run(&bus, 5);
    check_int("the burst is full", bus.app.capture.state, CAPTURE_FULL);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_READ, 0, SAMPLES});
    bus_forget(&bus);
    bus_run(&bus, 20 * SAMPLES * SIGNALS);
    int n = 0, wrong = 0;
    for (int i = 0; i < bus.n_seen; i++) {
        const struct message *m = &bus.seen[i];
        if (m->kind != WIRE_CAPTURE_DATA)
            continue;
        wrong += m->value[CAPTURE_DATA_SAMPLE] != n / SIGNALS || m->value[CAPTURE_DATA_SIGNAL] != n % SIGNALS;
        n++;
    }
    check_int("values of the burst that came", n, SAMPLES * SIGNALS);
    check_int("out of their order", wrong, 0);
    check_above("frames of other kinds that gave way", bus.app.telemetry.replaced, 1000);
}

/* All windows end in the same frame: none of the slots pushes another out. */
TEST(app_room_lockin)
{
    int told[LOCKIN_SLOTS] = {0};
    room_start();
    for (unsigned i = 0; i < LOCKIN_SLOTS; i++) {
        bus_set(&bus, SETTING_FIRST + SET_LOCKIN_HARMONIC + i, 0.0); /* the mean: needs no drive */
        bus_set(&bus, SETTING_FIRST + SET_LOCKIN_OUTPUT + i, i);
    }
    bus_set_now(&bus, SETTING_FIRST + SET_LOCKIN_FRAMES, WINDOW);
    bus_forget(&bus);
    bus_run(&bus, WINDOW * WINDOWS + WINDOW / 2);
    for (int i = 0; i < bus.n_seen; i++)
        if (bus.seen[i].kind == WIRE_LOCKIN)
            told[(int)bus.seen[i].value[LOCKIN_SLOT]]++;
    for (int i = 0; i < LOCKIN_SLOTS; i++)
        check_int("windows told by a slot", told[i], WINDOWS);
}

TEST(app_room_echo)
{
    enum { READS = 12 };
    room_start();
    bus_forget(&bus);
    for (unsigned i = 0; i < READS; i++)
        bus_command(&bus, WIRE_PARAM_READ, (double[WIRE_FIELDS]){0, SETTING_FIRST + i});
    bus_run(&bus, 400);
    int missing = 0;
    for (unsigned i = 0; i < READS; i++)
        missing += isnan(bus_item(&bus, WIRE_PARAM_ECHO, SETTING_FIRST + i));
    check_int("echoes that were asked for and never came", missing, 0);
    check_int("echoes", bus_count(&bus, WIRE_PARAM_ECHO), READS);
}

/* Bus-off and an interface that goes down cancel what
 * waits: nothing from before the outage goes out after it. */
TEST(app_room_outage)
{
    static const int fault[] = {HAL_BUS_OFF, HAL_DOWN, HAL_ERROR_PASSIVE};
    for (int i = 0; i < 3; i++) {
        bool cancels = fault[i] != HAL_ERROR_PASSIVE;
        room_start();
        bus.wires.port[0].tx_limit = 0;
        bus_run(&bus, 5);
        uint32_t waits = bus.app.telemetry.n_tx, replaced = bus.app.telemetry.replaced;
        uint64_t before = bus.app.frame;
        check_above("kinds that wait", waits, 5);
        bus.app.setting[SET_SYNC_EVERY] = bus.app.setting[SET_STATUS_EVERY] = 10000;
        bus.app.state = STATE_PAUSED; /* plant time stands: nothing new but STATUS */
        bus.wires.port[0].fault = fault[i];
        bus.wires.port[0].tx_limit = UINT32_MAX;
        bus_forget(&bus);
        bus_run(&bus, 1);
        int old = 0;
        for (int k = 0; k < bus.n_seen; k++)
            old += bus.seen[k].kind == WIRE_SYNC && bus.seen[k].value[SYNC_FRAME] < (double)before;
        check_int("an old SYNC goes out", old, !cancels);
        check_int("counted as replaced", bus.app.telemetry.replaced - replaced, cancels ? waits : 0);
    }
}
