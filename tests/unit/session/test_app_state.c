/* test_app_state.c - every command in every state, and the rules of sessions, through the wire. */
#include <stdio.h>
#include <string.h>
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

static struct bus bus;

enum { STATES = STATE_FAULT + 1 };
static const char *const state_name[STATES] = {"off",     "ready",  "running", "paused",
                                               "stopped", "frozen", "fault"};

/* Brings a fresh app into a state, by commands alone. */
static void enter(enum plant_state state)
{
    const struct app_config c = bus_config();
    bus_start(&bus, &c);
    if (state == STATE_OFF) {
        bus_silent(&bus, 1);
        return;
    }
    bus_run(&bus, 1);
    if (state == STATE_FROZEN || state == STATE_FAULT)
        bus_set(&bus, SETTING_FIRST + SET_REACTION, REACTION_FREEZE);
    bus_set(&bus, SETTING_FIRST + SET_OVERRUN_POLICY, OVERRUN_STOP);
    if (state != STATE_READY)
        bus_order(&bus, CONTROL_START);
    bus_run(&bus, 2);
    if (state == STATE_PAUSED)
        bus_order(&bus, CONTROL_PAUSE);
    if (state == STATE_STOPPED) {
        bus_order(&bus, CONTROL_STOP);
        bus_silent(&bus, 1);
        bus_next_session(&bus);
    }
    if (state == STATE_FAULT)
        (void)!app_overrun(&bus.app, 1);
    if (state == STATE_FROZEN) {
        bus_silent(&bus, 102);
        bus.session = 2;
    }
    bus_run(&bus, 1);
}

enum command {
    START,
    PAUSE,
    STEP,
    UNTIL,
    RESET,
    STOP,
    NONSENSE,
    HEARTBEAT,
    RELEASE,
    ARM,
    FIRE,
    STREAM,
    WRITE,
    COMMIT,
    READ,
    CAPTURE,
    COMMANDS
};

/* S stays in the state; other letters are states: O R U(n) P T(stopped) Z(frozen) F. `ok` per state: K
 * accepted, N session, T state. */
struct row {
    const char *name;
    unsigned kind;
    const char *cause; /* per state: K ok, N session, T state, I incomplete, U unknown */
    const char *next;  /* per state: o r u p t z f */
};

/*                                               OFF READY RUNNING PAUSED STOPPED FROZEN FAULT */
static const struct row table[COMMANDS] = {
    [START] = {"start", WIRE_CONTROL, "NKKKKKT", "ouuuuuf"},
    [PAUSE] = {"pause", WIRE_CONTROL, "NKKKKKT", "opppppf"},
    [STEP] = {"step", WIRE_CONTROL, "NTTKTTT", "oruptzf"},
    [UNTIL] = {"run until", WIRE_CONTROL, "NTTKTTT", "oruptzf"},
    [RESET] = {"reset", WIRE_CONTROL, "NKTKKKK", "orurrrr"},
    [STOP] = {"stop", WIRE_CONTROL, "KKKKKKK", "otttttf"},
    [NONSENSE] = {"operation 9", WIRE_CONTROL, "NUUUUUU", "oruptzf"},
    [HEARTBEAT] = {"enable", WIRE_ENABLE, "KKKKKKK", "rruptzf"},
    [RELEASE] = {"disable", WIRE_ENABLE, "NKKKKKK", "oooooof"},
    [ARM] = {"arm", WIRE_ARM, "NKKKKKK", "oruptzf"},
    [FIRE] = {"fire", WIRE_FIRE, "NTKKTTT", "oruptzf"},
    [STREAM] = {"stream", WIRE_STREAM, "NTKKTTT", "oruptzf"},
    [WRITE] = {"write", WIRE_PARAM_WRITE, "NKKKKKK", "oruptzf"},
    [COMMIT] = {"commit", WIRE_PARAM_COMMIT, "NKKKKKK", "oruptzf"},
    [READ] = {"read", WIRE_PARAM_READ, "NKKKKKK", "oruptzf"},
    [CAPTURE] = {"capture arm", WIRE_CAPTURE, "NKKKKKK", "oruptzf"},
};

static void command(enum command which)
{
    uint64_t tick = bus.app.plant.now.tick;
    switch (which) {
    case START:
        bus_order(&bus, CONTROL_START);
        break;
    case PAUSE:
        bus_order(&bus, CONTROL_PAUSE);
        break;
    case STEP:
        bus_control(&bus, CONTROL_STEP, 5);
        break;
    case UNTIL:
        bus_control(&bus, CONTROL_RUN_UNTIL, (double)(tick + 160));
        break;
    case RESET:
        bus_order(&bus, CONTROL_RESET);
        break;
    case STOP:
        bus_order(&bus, CONTROL_STOP);
        break;
    case NONSENSE:
        bus_order(&bus, (enum control_operation)9);
        break;
    case HEARTBEAT:
    case RELEASE:
        bus_enable(&bus, which == HEARTBEAT);
        break;
    case ARM:
        bus_arm(&bus, RIG_FORCE, ARM_AMPLITUDE, 3.0);
        break;
    case FIRE:
        bus_arm(&bus, RIG_FORCE, ARM_AMPLITUDE, 3.0);
        bus_fire(&bus, 1, false, tick + 64, 0);
        break;
    case STREAM:
        bus_stream(&bus, RIG_FORCE, tick / 16 + 3, 1.0);
        break;
    case WRITE:
        bus_write(&bus, RIG_MASS, 7.0);
        break;
    case COMMIT:
        bus_set(&bus, RIG_MASS, 7.0);
        break;
    case READ:
        bus_command(&bus, WIRE_PARAM_READ, (double[WIRE_FIELDS]){0, RIG_MASS});
        break;
    case CAPTURE:
        bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_ARM, 0, 0});
        break;
    case COMMANDS:
        break;
    }
}

static int cause_of(char letter)
{
    switch (letter) {
    case 'N':
        return CAUSE_SESSION;
    case 'T':
        return CAUSE_STATE;
    case 'U':
        return CAUSE_UNKNOWN;
    default:
        return CAUSE_OK;
    }
}

/* Commands that are answered only when they are refused say nothing when they are taken. */
static int answer_of(enum command which, enum plant_state state)
{
    unsigned kind = table[which].kind;
    int cause = cause_of(table[which].cause[state]);
    bool quiet = kind == WIRE_ARM || kind == WIRE_STREAM || kind == WIRE_PARAM_WRITE ||
                 kind == WIRE_PARAM_READ || (which == HEARTBEAT && state != STATE_OFF);
    return quiet && cause == CAUSE_OK ? -1 : cause;
}

static void check_cell(enum command which, enum plant_state state)
{
    static const char letters[] = "oruptzf";
    char name[96];
    enter(state);
    snprintf(name, sizeof name, "%s: reached", state_name[state]);
    if (bus.app.state != state)
        check_int(name, bus.app.state, state);
    bus_forget(&bus);
    command(which);
    bus_silent(&bus, 1);
    check_int(check_name("%s in %s: answer", table[which].name, state_name[state]),
              bus_cause(&bus, table[which].kind), answer_of(which, state));
    check_int(check_name("%s in %s: next state", table[which].name, state_name[state]), bus.app.state,
              strchr(letters, table[which].next[state]) - letters);
}

TEST(app_state_table)
{
    for (int which = 0; which < COMMANDS; which++) {
        for (int state = 0; state < STATES; state++)
            check_cell((enum command)which, (enum plant_state)state);
    }
    const int forgets[] = {STOP, RELEASE, RESET};
    for (int i = 0; i < 3; i++) {
        enter(i == 2 ? STATE_PAUSED : STATE_RUNNING);
        bus_arm(&bus, 1, ARM_AMPLITUDE, 1.0);
        bus_write(&bus, RIG_MASS, 8.0);
        command(FIRE);
        command(STREAM);
        command((enum command)forgets[i]);
        bus_silent(&bus, 1);
        const struct mailbox *m = &bus.app.mailbox;
        printf("      after %s\n", table[forgets[i]].name);
        check_int("nothing waits: fires + samples + armed + staged",
                  m->n_fires + m->n_samples + m->armed[1].given + staged_count(&m->staged), 0);
        check_int("state", bus.app.state, i == 0 ? STATE_STOPPED : i == 1 ? STATE_OFF : STATE_READY);
    }
}

TEST(app_session)
{
    const struct app_config c = bus_config();
    bus_start(&bus, &c);
    bus.session = 0;
    bus_run(&bus, 1);
    check_int("session 0 opens nothing", bus_cause(&bus, WIRE_ENABLE), CAUSE_SESSION);
    check_true("and the plant is not in session", !bus.app.enabled);
    for (int session = 1; session <= 15; session++) {
        bus.session = (uint8_t)session;
        bus_forget(&bus);
        bus_run(&bus, 1);
        if (bus_cause(&bus, WIRE_ENABLE) != CAUSE_OK || bus.app.session != session)
            check_int("session opens", bus.app.session, session);
        bus_enable(&bus, false);
        bus_silent(&bus, 1);
        bus_forget(&bus);
        bus_run(&bus, 1);
        if (bus_cause(&bus, WIRE_ENABLE) != CAUSE_SESSION || bus.app.enabled)
            check_int("the session just ended does not open again", bus_cause(&bus, WIRE_ENABLE),
                      CAUSE_SESSION);
    }
    check_int("sessions 1 to 15, the last one", bus.app.session, 15);
    check_int("each refused once when reopened, session 0 too", bus.app.count[DIAG_SESSION], 16);

    for (int session = 2; session <= 15; session++) {
        bus.session = (uint8_t)session;
        bus_run(&bus, 1);
    }
    check_true("after 15 only 1 opens", !bus.app.enabled);
    bus.session = 1;
    bus_run(&bus, 1);
    bus.session = 2;
    bus_forget(&bus);
    bus_run(&bus, 1);
    check_int("another session cannot take over", bus_cause(&bus, WIRE_ENABLE), CAUSE_SESSION);
    check_int("session of the STATUS", bus.app.session, 1);
    bus_enable(&bus, false);
    bus_silent(&bus, 1);
    check_true("nor end it", bus.app.enabled);
    bus.session = 1;
    bus_enable(&bus, false);
    bus_silent(&bus, 1);
    bus.session = 0;
    bus_run(&bus, 1);
    check_true("session 0 opens nothing after another one either", !bus.app.enabled);
    /* The first frame of an identifier in a session may have any counter, the last one's too. */
    bus.session = 2;
    bus_run(&bus, 1);
    bus_arm(&bus, 0, ARM_AMPLITUDE, 1.0);
    bus_enable(&bus, false);
    bus_silent(&bus, 1);
    bus.session = 3;
    bus_run(&bus, 1);
    bus.counter[WIRE_ARM] =
        (uint8_t)((bus.counter[WIRE_ARM] + WIRE_COUNTER_STATES - 1) % WIRE_COUNTER_STATES);
    bus_arm(&bus, 0, ARM_AMPLITUDE, 2.0);
    bus_run(&bus, 1);
    check_near("armed with the last counter of the session before", bus.app.mailbox.armed[0].value[0], 2.0,
               0.0);
}

/* A second controller that knows nothing of our counters speaks all the time: it changes nothing for us. */
TEST(app_stranger)
{
    bus_start_rig(&bus);
    bus_run(&bus, 1);
    uint8_t ours[WIRE_COMMANDS];
    for (int i = 0; i < 40; i++) {
        memcpy(ours, bus.counter, sizeof ours);
        bus.session = 9; /* the stranger happens to use our next counters */
        bus_stream(&bus, RIG_FORCE, bus.app.frame, 50.0);
        bus_arm(&bus, RIG_FORCE, ARM_AMPLITUDE, 50.0);
        bus_order(&bus, CONTROL_PAUSE);
        bus_enable(&bus, true);
        bus.session = 1;
        memcpy(bus.counter, ours, sizeof ours);
        bus_stream(&bus, RIG_FORCE, bus.app.plant.now.tick / 16, 0.5);
        bus_run(&bus, 1);
    }
    check_int("our samples applied", bus.app.count[DIAG_STREAM_APPLIED], 40);
    check_int("the stranger's commands refused", bus.app.count[DIAG_SESSION], 160);
    check_int("our counters are not mistaken for repetitions", bus.app.count[DIAG_REPEATED], 0);
    check_int("nor for gaps", bus.app.count[DIAG_LOST], 0);
    check_int("armed by the stranger", bus.app.mailbox.armed[0].given, 0);
    check_int("state", bus.app.state, STATE_RUNNING);
}

TEST(app_enable_age)
{
    const double age[] = {0, 50, 51, 1000, -1};
    const int cause[] = {CAUSE_OK, CAUSE_OK, CAUSE_STALE, CAUSE_STALE, CAUSE_STALE};
    for (int i = 0; i < 5; i++) {
        const struct app_config c = bus_config();
        bus_start(&bus, &c);
        bus_silent(&bus, 2000);
        bus_forget(&bus);
        bus_command(&bus, WIRE_ENABLE, (double[WIRE_FIELDS]){0, 1, (double)bus.app.frame - age[i]});
        bus_silent(&bus, 1);
        printf("      ENABLE that echoes a frame %g old\n", age[i]);
        check_int("cause", bus_cause(&bus, WIRE_ENABLE), cause[i]);
        check_int("in session", bus.app.enabled, cause[i] == CAUSE_OK);
    }
    /* Across the wrap of the 32-bit frame number. */
    const struct app_config c = bus_config();
    bus_start(&bus, &c);
    bus.app.frame = (UINT64_C(1) << 32) + 20;
    bus_command(&bus, WIRE_ENABLE, (double[WIRE_FIELDS]){0, 1, 4294967286.0});
    bus_silent(&bus, 1);
    check_int("30 frames old across 2^32", bus_cause(&bus, WIRE_ENABLE), CAUSE_OK);
    /* START, PAUSE and RESET name a frame as well. */
    bus_forget(&bus);
    bus_control(&bus, CONTROL_START, (double)(uint32_t)(bus.app.frame - 51));
    bus_silent(&bus, 1);
    check_int("START that names a frame 51 old", bus_cause(&bus, WIRE_CONTROL), CAUSE_STALE);
    check_int("state", bus.app.state, STATE_READY);
}

TEST(app_complement)
{
    const struct app_config c = bus_config();
    bus_start(&bus, &c);
    bus_run(&bus, 1);
    int taken = 0;
    for (int wrong = 0; wrong < 256; wrong++) {
        if (wrong == 255 - CONTROL_START)
            continue;
        bus_command(&bus, WIRE_CONTROL,
                    (double[WIRE_FIELDS]){0, CONTROL_START, wrong, (double)bus.app.frame});
        bus_run(&bus, 1);
        taken += bus.app.state != STATE_READY || bus_cause(&bus, WIRE_CONTROL) != CAUSE_RANGE;
    }
    check_int("START with one of 255 wrong complements: taken", taken, 0);
    check_int("refused: range", bus.app.count[DIAG_RANGE], 255);
    bus_command(&bus, WIRE_CONTROL, (double[WIRE_FIELDS]){0, CONTROL_STOP, 0, 0});
    bus_run(&bus, 1);
    check_int("STOP with a wrong complement", bus_cause(&bus, WIRE_CONTROL), CAUSE_RANGE);
}

/* STOP is the safe direction: any session, any age, any counter. */
TEST(app_stop_always)
{
    const struct app_config c = bus_config();
    for (int how = 0; how < 4; how++) {
        bus_start_running(&bus, &c);
        bus_run(&bus, 3);
        if (how == 0)
            bus.session = 11;
        if (how == 1)
            bus.session = 0;
        if (how == 2) /* a bare station that always sends the same frame, as our START had it */
            bus.counter[WIRE_CONTROL] = 0;
        if (how == 3)
            bus_silent(&bus, 200);
        bus_control(&bus, CONTROL_STOP, 12345678.0);
        bus_silent(&bus, 1);
        printf("      STOP: %s\n", (const char *[]){"foreign session", "no session", "repeated counter",
                                                    "after the time-out"}[how]);
        check_int("state", bus.app.state, STATE_STOPPED);
    }
    /* Where there is no session it draws the line all the same. */
    bus_start(&bus, &c);
    bus_silent(&bus, 5);
    double seen = (double)bus.app.frame;
    bus_control(&bus, CONTROL_STOP, 0);
    bus_silent(&bus, 1);
    check_int("STOP in OFF: state", bus.app.state, STATE_OFF);
    bus_command(&bus, WIRE_ENABLE, (double[WIRE_FIELDS]){0, 1, seen});
    bus_silent(&bus, 1);
    check_int("an ENABLE from before it", bus_cause(&bus, WIRE_ENABLE), CAUSE_STALE);
    bus_enable(&bus, true);
    bus_silent(&bus, 1);
    check_int("and one from after it", bus.app.state, STATE_READY);
}
