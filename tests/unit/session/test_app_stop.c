/* test_app_stop.c - STOP is a line: over a network that delays, copies and reorders, nothing that was sent
 * before the plant took it acts afterwards. The test does not use the plant's own rules to see it. It
 * gives each frame to the app alone, and compares the app's data before and after it. */
#include <stdio.h>
#include <string.h>
#include "firmware/app/session.h"
#include "tests/fixture/bus.h"
#include "tests/fixture/silent_bus.h"
#include "tests/unit/test.h"

enum {
    SEEDS = 3000,
    FRAMES = 240,
    DELAY = 120,   /* frames, the longest */
    STOP_GAP = 12, /* frames between two STOPs of the controller, at least: 15 sessions outlast the delay */
    FLYING = 4096,
    SEND_MAX = 6 /* commands that the controller sends in a frame, at most */
};

/* ---- the network: every copy of a command with the frame that sent it and the one that brings it ---- */

struct copy {
    struct frame frame;
    uint64_t sent, arrives;
    unsigned kind;
    bool stop;
};

static struct net {
    struct hal hal;
    struct copy flying[FLYING];
    int n;
    struct copy *last; /* given to the app, not yet judged */
    struct copy given;
    uint64_t seed, draws;
    uint64_t stopped; /* frame of the last STOP that was taken */
    bool any_stop;
} net;

static struct app stopped_app;
static struct wire_scene net_scene;

/* The data that a command may change. Counters of received and refused frames are not among them, nor
 * messages. */
struct held {
    enum plant_state state;
    bool enabled;
    uint8_t session, faults;
    uint64_t step_left, heartbeat_frame, tick;
    unsigned streaming;
    struct mailbox mailbox;
    struct capture capture;
    double setting[SETTINGS], si[MODEL_PARAMETERS], x[MODEL_STATES];
    struct drive drive[MODEL_INPUTS];
};

static struct held held_before, held_after;

static void hold(struct held *h)
{
    memset(h, 0, sizeof *h);
    h->state = stopped_app.state;
    h->enabled = stopped_app.enabled;
    h->session = stopped_app.session;
    h->faults = stopped_app.faults;
    h->step_left = stopped_app.step_left;
    h->heartbeat_frame = stopped_app.heartbeat_frame;
    h->tick = stopped_app.plant.now.tick;
    h->streaming = stopped_app.streaming;
    memcpy(&h->mailbox, &stopped_app.mailbox, sizeof h->mailbox);
    memcpy(&h->capture, &stopped_app.capture, sizeof h->capture);
    memcpy(h->setting, stopped_app.setting, sizeof h->setting);
    memcpy(h->si, stopped_app.plant.si, sizeof h->si);
    memcpy(h->x, stopped_app.plant.x, sizeof h->x);
    memcpy(h->drive, stopped_app.plant.drive, sizeof h->drive);
}

struct verdict {
    int stops, acted, wrong_stop, moved;
    int old[WIRE_COMMANDS + CONTROL_OPERATIONS], young[WIRE_COMMANDS + CONTROL_OPERATIONS];
    int wraps;
};

static struct verdict verdict;

/* A STOP leaves nothing that could still act. */
static bool is_quiet(void)
{
    bool quiet = stopped_app.mailbox.n_fires == 0 && stopped_app.mailbox.n_samples == 0 &&
                 !stopped_app.mailbox.commit_with_fire && staged_count(&stopped_app.mailbox.staged) == 0 &&
                 stopped_app.step_left == 0 && stopped_app.streaming == 0 && !stopped_app.enabled &&
                 stopped_app.state != STATE_RUNNING && stopped_app.state != STATE_PAUSED;
    for (int i = 0; i < hertz_rig.n_inputs; i++)
        quiet = quiet && stopped_app.mailbox.armed[i].given == 0 &&
                drive_target(&stopped_app.plant.drive[i]).amplitude == 0.0;
    return quiet;
}

/* The frame that was given last has done what it does. */
static void judge(void)
{
    const struct copy *c = &net.given;
    if (!net.last)
        return;
    net.last = NULL;
    if (c->stop) {
        net.any_stop = true;
        net.stopped = stopped_app.frame;
        verdict.stops++;
        verdict.wrong_stop += !is_quiet();
        return;
    }
    bool old = net.any_stop && c->sent < net.stopped;
    (old ? verdict.old : verdict.young)[c->kind]++;
    if (!old)
        return;
    hold(&held_after);
    if (memcmp(&held_before, &held_after, sizeof held_before) != 0) {
        verdict.acted++;
        printf("      seed %llu, frame %llu: kind %u of frame %llu acts after the STOP of frame %llu\n",
               (unsigned long long)net.seed, (unsigned long long)stopped_app.frame, c->kind,
               (unsigned long long)c->sent, (unsigned long long)net.stopped);
    }
}

/* The copies that are due, in the order in which they fly: that of their sending, swapped at random. */
static int net_recv(void *context, struct frame *f)
{
    (void)context;
    judge();
    for (int i = 0; i < net.n; i++) {
        if (net.flying[i].arrives > stopped_app.frame)
            continue;
        net.given = net.flying[i];
        net.last = &net.given;
        net.flying[i] = net.flying[--net.n];
        *f = net.given.frame;
        if (net.any_stop)
            hold(&held_before);
        return 1;
    }
    return 0;
}

/* Whole number in [0, n). */
static unsigned draw_below(unsigned n)
{
    return (unsigned)((noise_word(net.seed, net.draws++) >> 32) % n);
}

static double draw_share(void)
{
    return (double)draw_below(1u << 20) * 0x1p-20;
}

/* One or more copies of it, most of them at once, some late. */
static void fly(const struct frame *f, unsigned kind, bool stop)
{
    int copies = draw_below(10) == 0 ? 0 : draw_below(5) == 0 ? 2 : 1;
    for (int i = 0; i < copies && net.n < FLYING; i++) {
        uint64_t late = draw_below(2) ? draw_below(3) : draw_below(8) ? draw_below(20) : draw_below(DELAY);
        net.flying[net.n++] = (struct copy){*f, stopped_app.frame - 1, stopped_app.frame + late, kind, stop};
    }
}

/* ---- a controller that knows what the plant said at the end of some frame, not long ago ---- */

static struct {
    uint8_t session, counter[WIRE_COMMANDS];
    uint64_t frame, tick; /* as told */
    uint8_t told_session;
    bool told_open;
    uint64_t next_stop;
} us;

static void send(unsigned kind, const double value[WIRE_FIELDS], unsigned as, bool stop)
{
    struct message m = {.kind = (uint8_t)kind, .counter = us.counter[kind]};
    struct frame f;
    memcpy(m.value, value, sizeof m.value);
    m.value[SESSION] = us.session;
    us.counter[kind] = (uint8_t)((us.counter[kind] + 1) % WIRE_COUNTER_STATES);
    wire_encode(&net_scene, &m, &f);
    fly(&f, as, stop);
}

static void control(enum control_operation operation, double argument)
{
    send(WIRE_CONTROL, (double[WIRE_FIELDS]){0, operation, 255 - (int)operation, argument},
         WIRE_COMMANDS + operation, operation == CONTROL_STOP);
}

static void enable(bool on)
{
    send(WIRE_ENABLE, (double[WIRE_FIELDS]){0, on, (double)(uint32_t)us.frame}, WIRE_ENABLE, false);
}

static void parameters(void)
{
    struct staged set = {{0}, {0}};
    unsigned index = draw_below(3) ? RIG_MASS : SETTING_FIRST + SET_HORIZON_FRAMES;
    double x = index == RIG_MASS ? 6.0 + draw_below(16) / 16.0 : 1000.0 + draw_below(100);
    staged_put(&set, index, x);
    send(WIRE_PARAM_WRITE, (double[WIRE_FIELDS]){0, index, x}, WIRE_PARAM_WRITE, false);
    send(WIRE_PARAM_COMMIT, (double[WIRE_FIELDS]){0, 1, draw_below(2), staged_crc(&set)}, WIRE_PARAM_COMMIT,
         false);
}

/* Commands that echo a frame go out at any time; all others only in a session that the plant has reported
 * open. */
static void one_command(void)
{
    unsigned i = draw_below(RIG_BASE + 1);
    uint64_t ahead = us.tick + draw_below(DELAY * BUS_TICKS);
    bool open = us.told_open && us.told_session == us.session;
    switch (draw_below(open ? 12 : 3)) {
    case 0:
        control(CONTROL_START, (double)(uint32_t)us.frame);
        break;
    case 1:
        control(CONTROL_PAUSE, (double)(uint32_t)us.frame);
        break;
    case 2:
        if (draw_below(8) == 0)
            control(CONTROL_RESET, (double)(uint32_t)us.frame);
        break;
    case 3:
        control(CONTROL_STEP, 1 + draw_below(40));
        break;
    case 4:
        control(CONTROL_RUN_UNTIL, (double)(uint32_t)(ahead - ahead % BUS_TICKS));
        break;
    case 5:
    case 6:
        send(WIRE_ARM + i,
             (double[WIRE_FIELDS]){0, ARM_AMPLITUDE, (i == RIG_BASE ? 1e-9 : 0.5) * draw_share()},
             WIRE_ARM + i, false);
        break;
    case 7:
    case 8:
        send(WIRE_FIRE, (double[WIRE_FIELDS]){0, 1u << i, draw_below(4) == 0, 0, (double)(uint32_t)ahead},
             WIRE_FIRE, false);
        break;
    case 9:
        send(WIRE_STREAM + i,
             (double[WIRE_FIELDS]){0, (double)(uint16_t)(us.tick / BUS_TICKS + draw_below(60)),
                                   (i == RIG_BASE ? 1e-9 : 0.5) * draw_share()},
             WIRE_STREAM + i, false);
        break;
    case 10:
        parameters();
        break;
    default:
        send(WIRE_CAPTURE, (double[WIRE_FIELDS]){0, draw_below(3), 0, 0}, WIRE_CAPTURE, false);
    }
}

/* After a frame: hears or not, then acts on what it knows. */
static void act(void)
{
    if (draw_below(4)) {
        us.frame = stopped_app.frame - 1;
        us.tick = stopped_app.plant.now.tick;
        us.told_session = stopped_app.session;
        us.told_open = stopped_app.enabled;
    }
    if (!us.told_open && draw_below(3) == 0) {
        us.session = (uint8_t)(us.told_session % WIRE_SESSIONS + 1);
        verdict.wraps += us.session == 1 && us.told_session == WIRE_SESSIONS;
        enable(true);
        control(CONTROL_START, (double)(uint32_t)us.frame);
    }
    if (draw_below(8) == 0)
        enable(draw_below(40) > 0);
    for (unsigned n = draw_below(SEND_MAX); n > 0; n--)
        one_command();
    if (stopped_app.frame >= us.next_stop) {
        control(CONTROL_STOP, 0);
        us.next_stop = stopped_app.frame + STOP_GAP + draw_below(5 * STOP_GAP);
    }
}

/* One schedule; after its last command everything that flies comes down. */
static void schedule(uint64_t seed)
{
    static float capture[BUS_CAPTURE];
    struct app_config c = bus_config();
    c.substeps = BUS_TICKS;
    c.capture = capture;
    c.n_capture = BUS_CAPTURE;
    memset(&net, 0, sizeof net);
    memset(&us, 0, sizeof us);
    net.seed = seed;
    net.hal = (struct hal){NULL, net_recv, silent_send, silent_nothing, silent_clock, silent_nothing};
    if (app_init(&stopped_app, &c, &net.hal))
        check_true("app_init", 0);
    stopped_app.setting[SET_TIMEOUT_FRAMES] = 60;
    stopped_app.session = (uint8_t)(seed % (WIRE_SESSIONS + 1)); /* the plant has had so many before */
    net_scene = stopped_app.scene;
    us.next_stop = 20;
    uint64_t quiet_tick = 0;
    for (int i = 0; i < FRAMES + DELAY; i++) {
        bool stood = net.any_stop && !stopped_app.enabled && stopped_app.reaction == REACTION_STOP;
        quiet_tick = stopped_app.plant.now.tick;
        app_frame(&stopped_app);
        judge();
        verdict.moved += stood && !stopped_app.enabled && stopped_app.plant.now.tick != quiet_tick;
        if (i < FRAMES)
            act();
    }
}

TEST(app_stop_line)
{
    memset(&verdict, 0, sizeof verdict);
    for (uint64_t seed = 1; seed <= SEEDS && verdict.acted < 10; seed++)
        schedule(seed);
    printf("      %d schedules, %d STOPs taken, session 1 after 15 asked for %d times\n", SEEDS,
           verdict.stops, verdict.wraps);
    check_int("commands that act after a STOP that they were sent before", verdict.acted, 0);
    check_int("STOPs that leave a session, a drive or something that waits", verdict.wrong_stop, 0);
    check_int("frames in which plant time moved without a session after a STOP", verdict.moved, 0);
    static const struct {
        const char *name;
        unsigned kind;
    } kind[] = {{"ENABLE", WIRE_ENABLE},
                {"start", WIRE_COMMANDS + CONTROL_START},
                {"pause", WIRE_COMMANDS + CONTROL_PAUSE},
                {"step", WIRE_COMMANDS + CONTROL_STEP},
                {"run_until", WIRE_COMMANDS + CONTROL_RUN_UNTIL},
                {"reset", WIRE_COMMANDS + CONTROL_RESET},
                {"ARM", WIRE_ARM},
                {"FIRE", WIRE_FIRE},
                {"STREAM", WIRE_STREAM},
                {"PARAM_WRITE", WIRE_PARAM_WRITE},
                {"PARAM_COMMIT", WIRE_PARAM_COMMIT},
                {"CAPTURE", WIRE_CAPTURE}};
    for (size_t i = 0; i < sizeof kind / sizeof kind[0]; i++)
        check_above(kind[i].name, verdict.old[kind[i].kind], 2000);
    check_above("sessions that followed the fifteenth", verdict.wraps, 100);
}

static struct bus bus;

/* The effects of a STOP: on the bus, and for a controller that goes on. */
TEST(app_stop_ends)
{
    bus_start_rig(&bus);
    bus_drive(&bus, RIG_FORCE, 10.0, 100.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, 20, 0);
    bus_run(&bus, 5);
    uint64_t told = bus.app.frame; /* the frame that takes the STOP */
    bus_order_now(&bus, CONTROL_STOP);
    check_near("STATUS: stopped", bus_value(&bus, WIRE_STATUS, STATUS_STATE), STATE_STOPPED, 0);
    check_near("STATUS: reaction stop", bus_value(&bus, WIRE_STATUS, STATUS_REACTION), REACTION_STOP, 0);
    check_near("STATUS: the session that is over", bus_value(&bus, WIRE_STATUS, SESSION), 1, 0);
    check_int("the heartbeat behind it", bus_cause(&bus, WIRE_ENABLE), CAUSE_SESSION);
    bus_order(&bus, CONTROL_START);
    bus_silent(&bus, 1);
    check_int("START of its session", bus_cause(&bus, WIRE_CONTROL), CAUSE_SESSION);
    check_int("no time-out, no fault", bus.app.faults, 0);
    bus.session = 2;
    bus_command(&bus, WIRE_ENABLE, (double[WIRE_FIELDS]){0, 1, (double)told});
    bus_silent(&bus, 1);
    check_int("the next session, by who has not seen the STOP", bus_cause(&bus, WIRE_ENABLE), CAUSE_STALE);
    bus.session = 3;
    bus_enable(&bus, true);
    bus_silent(&bus, 1);
    check_int("the session after the next", bus_cause(&bus, WIRE_ENABLE), CAUSE_SESSION);
    bus.session = 2;
    bus_command(&bus, WIRE_ENABLE, (double[WIRE_FIELDS]){0, 1, (double)(told + 1)});
    bus_control(&bus, CONTROL_START, (double)told);
    bus_silent(&bus, 1);
    check_int("the next session, by who has", bus_cause(&bus, WIRE_ENABLE), CAUSE_OK);
    check_near("STATUS: reaction none", bus_value(&bus, WIRE_STATUS, STATUS_REACTION), REACTION_NONE, 0);
    check_int("START of that session that echoes a frame from before", bus_cause(&bus, WIRE_CONTROL),
              CAUSE_STALE);
    bus_order_now(&bus, CONTROL_START);
    check_int("one that does not", bus.app.state, STATE_RUNNING);
    check_true("the drive that sounded before is at zero", !drive_active(&bus.app.plant.drive[RIG_FORCE]));
    session_fault(&bus.app, FAULT_OVERRUN);
    bus_enable(&bus, false);
    bus_silent(&bus, 1);
    check_int("ENABLE off in FAULT: state", bus.app.state, STATE_FAULT);
    check_near("STATUS says that there is no session", bus_value(&bus, WIRE_STATUS, STATUS_REACTION),
               REACTION_STOP, 0);
    bus_run(&bus, 1);
    bus_next_session(&bus);
    bus_run(&bus, 1);
    bus_order(&bus, CONTROL_RESET);
    bus_order_now(&bus, CONTROL_START);
    check_int("the next one resets and runs", bus.app.state, STATE_RUNNING);
    bus.session = 1;
    bus_order(&bus, CONTROL_STOP);
    bus_silent(&bus, 1);
    check_int("a late copy of the first STOP stops again", bus.app.state, STATE_STOPPED);
}
