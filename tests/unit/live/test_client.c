/* test_client.c - a controller's session over a link that loses exactly the frames that open or close it;
 * what it counts, and numbers that come in their low bits. */
#include "hal/link/faults.h"
#include "host_sim/live/client_host.h"
#include "host_sim/cli/clock.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { TIMEOUT = 10000, ENDLESS = 1 << 20 };
static const double patience_s = 20.0;

static struct bus bus;
static struct faults faults;
static struct client client;
static int64_t turned_ns;

/* The client's recv: the plant takes a turn whenever nothing is left to hear, at most one a millisecond. */
static int recv_and_turn(void *context, struct frame *f)
{
    struct faults *link = context;
    int got = link->hal.recv(link, f);
    if (got || clock_now_ns() - turned_ns < 1000000)
        return got;
    turned_ns = clock_now_ns();
    app_frame(&bus.app);
    return link->hal.recv(link, f);
}

/* A client in front of a link whose time is the client's sends: each is flushed. */
static void begin(void)
{
    static struct hal hal;
    const struct app_config c = bus_config();
    bus_start(&bus, &c);
    bus.app.setting[SET_TIMEOUT_FRAMES] = TIMEOUT;
    faults_init(&faults, &bus.wires.port[BUS_CONTROLLER].hal, 1);
    hal = faults.hal;
    hal.recv = recv_and_turn;
    client_init(&client, &hal, &bus.app.scene);
}

/* From now on the next n sends are lost; or, with `in`,
 * what the plant says until the client has sent n frames. */
static void lose(bool in, uint64_t n)
{
    const struct faults_rule r = {.kind = FAULTS_DROP,
                                  .in = in,
                                  .out = !in,
                                  .probability = 1.0,
                                  .frames = 1,
                                  .begin = faults.frame,
                                  .until = faults.frame + n};
    check_no_error("the rule is taken", faults_add(&faults, &r));
}

/* As it should be after a session. */
static void check_closed(const char *name)
{
    check_true(name, client_close(&client, patience_s));
    check_true("no session", !bus.app.enabled);
    check_int("state: off", bus.app.state, STATE_OFF);
    check_int("time-outs", bus.app.count[DIAG_TIMEOUTS], 0);
    check_int("faults", bus.app.faults, 0);
}

TEST(client_close)
{
    for (uint64_t n = 1; n < 4; n++) {
        begin();
        check_true("a session", client_open(&client, false, patience_s));
        lose(false, n);
        check_closed("closed, with as many closing frames lost");
        check_int("frames lost", (int64_t)faults.count[FAULTS_DROP], (int64_t)n);
    }
    begin();
    check_true("a session", client_open(&client, false, patience_s));
    lose(true, 2);
    check_closed("closed, with the plant's answers lost");
    check_above("frames lost", (double)faults.count[FAULTS_DROP], 1);

    begin();
    check_true("a session", client_open(&client, false, patience_s));
    lose(false, ENDLESS);
    check_true("a link that loses every one: not closed", !client_close(&client, 0.2));
    check_true("the session is still there", bus.app.enabled);
    check_above("tries", (double)faults.count[FAULTS_DROP], 2);
}

TEST(client_open)
{
    begin();
    lose(false, 2);
    check_true("a session, with two opening frames lost", client_open(&client, false, patience_s));
    check_int("frames lost", (int64_t)faults.count[FAULTS_DROP], 2);
    check_int("the plant's session", bus.app.session, client.session);
    struct client other = client;
    check_true("nobody else gets one", !client_open(&other, false, 0.2));
    check_true("but may join", client_open(&other, true, patience_s));
    check_closed("closed");
}

TEST(client_counts)
{
    struct frame f;
    const struct app_config c = bus_config();
    bus_start(&bus, &c);
    client_init(&client, &bus.wires.port[BUS_CONTROLLER].hal, &bus.scene);
    bus.wires.port[BUS_CONTROLLER].tx_limit = 0;
    uint8_t counter = client.counter[WIRE_PARAM_READ];
    check_true("no room", !client_read(&client, 0));
    check_int("counted", (int64_t)client.unsent, 1);
    check_int("the number of the frame that did not go is the next one's", client.counter[WIRE_PARAM_READ],
              counter);
    bus_encode(&bus, WIRE_PARAM_READ, (double[WIRE_FIELDS]){0, 0}, &f);
    f.id = 0x200 + WIRE_STATUS;
    bus.wires.port[0].hal.send(&bus.wires.port[0], &f);
    client_poll(&client);
    check_int("a damaged frame of the plant's identifiers", (int64_t)client.bad, 1);
    bus.wires.port[BUS_CONTROLLER].fault = HAL_DOWN;
    client_poll(&client);
    check_int("a report of the bus", (int64_t)client.bus_faults, 1);
}

/* The client hears a message that no plant has sent. */
static void hear(const struct message *m)
{
    struct frame f;
    wire_encode(&bus.scene, m, &f);
    bus.wires.port[0].hal.send(&bus.wires.port[0], &f);
    client_poll(&client);
}

static void hear_sync(double frame, double tick)
{
    const struct message m = {.kind = WIRE_SYNC, .value = {frame, tick}};
    hear(&m);
}

/* The number nearest to the last one with these bits, forwards and back. */
TEST(client_low_bits)
{
    static const uint64_t frame[] = {30000, 60000, 65535, 65538, 65534, 65536};
    const uint64_t substeps = 65536; /* ticks pass 2^32 with the frames' 2^16 */
    const struct app_config c = bus_config();
    bus_start(&bus, &c);
    client_init(&client, &bus.wires.port[BUS_CONTROLLER].hal, &bus.scene);
    client.scene.substeps = (uint32_t)substeps;
    for (size_t i = 0; i < sizeof frame / sizeof frame[0]; i++) {
        hear_sync((double)(frame[i] % 65536), (double)(frame[i] * substeps % (UINT64_C(1) << 32)));
        check_int("bus frame", (int64_t)client.latest.frame, (int64_t)frame[i]);
        check_int("tick", (int64_t)client.latest.tick, (int64_t)(frame[i] * substeps));
    }
}

static void hear_status(double frame, double session, enum plant_state state)
{
    const struct message m = {.kind = WIRE_STATUS, .value = {session, state, REACTION_NONE, 0, 0, frame}};
    hear(&m);
}

/* A STATUS is over that a newer one has overtaken on the way; a plant that restarted is believed. */
TEST(client_status_overtaken)
{
    const struct app_config c = bus_config();
    bus_start(&bus, &c);
    client_init(&client, &bus.wires.port[BUS_CONTROLLER].hal, &bus.scene);
    hear_status(198, 0, STATE_OFF);
    hear_status(201, 1, STATE_RUNNING);
    check_int("in a session", client_in_session(&client), true);
    hear_status(200, 0, STATE_OFF);
    check_int("overtaken: still in it", client_in_session(&client), true);
    hear_status(201, 1, STATE_PAUSED);
    check_int("of one frame: the later one", client.latest.state, STATE_PAUSED);
    hear_status(0, 0, STATE_OFF);
    check_int("restarted: no session", client_in_session(&client), false);
    check_int("its frame", (int64_t)client.latest.frame, 0);
}

static void hear_reply(unsigned session, unsigned message, unsigned counter, enum cause cause)
{
    struct message m = {.kind = WIRE_REPLY, .value = {[SESSION] = session}};
    m.value[REPLY_MESSAGE] = message;
    m.value[REPLY_COUNTER] = counter;
    m.value[REPLY_CAUSE] = cause;
    hear(&m);
}

/* A bus that takes its time, as SocketCAN to a board: the plant answers while the command still goes. */
static int send_answered(void *context, const struct frame *f)
{
    struct message m;
    if (wire_decode(&bus.scene, f, &m) == WIRE_OK)
        hear_reply((unsigned)m.value[SESSION], m.kind, m.counter, CAUSE_OK);
    return bus.wires.port[BUS_CONTROLLER].hal.send(context, f);
}

TEST(client_reply_while_it_sends)
{
    const struct app_config c = bus_config();
    bus_start(&bus, &c);
    struct hal slow = bus.wires.port[BUS_CONTROLLER].hal;
    slow.send = send_answered;
    client_init(&client, &slow, &bus.scene);
    client.session = 3;
    client_expect(&client, WIRE_CAPTURE);
    client_capture(&client, CAPTURE_TRIGGER, 0, 0);
    check_true("the answer counts", client.reply.came);
}

/* The one reply that counts is the first to this client's own command. */
TEST(client_reply)
{
    const struct app_config c = bus_config();
    bus_start(&bus, &c);
    client_init(&client, &bus.wires.port[BUS_CONTROLLER].hal, &bus.scene);
    client.session = 3;
    unsigned before = client.counter[WIRE_CAPTURE];
    client_capture(&client, CAPTURE_ARM, 0, 0);
    client_expect(&client, WIRE_CAPTURE);
    unsigned first = client.counter[WIRE_CAPTURE];
    hear_reply(3, WIRE_CAPTURE, first, CAUSE_OK);
    check_true("nothing was sent yet", !client.reply.came);
    client_capture(&client, CAPTURE_TRIGGER, 0, 0);
    client_capture(&client, CAPTURE_TRIGGER, 0, 0);
    hear_reply(3, WIRE_CAPTURE, before, CAUSE_OK);
    check_true("to a command of before", !client.reply.came);
    hear_reply(3, WIRE_FIRE, first, CAUSE_OK);
    check_true("to another kind", !client.reply.came);
    hear_reply(4, WIRE_CAPTURE, first, CAUSE_OK);
    check_true("of another session", !client.reply.came);
    hear_reply(3, WIRE_CAPTURE, first + 1, CAUSE_RANGE);
    check_true("to the second try", client.reply.came);
    check_int("  its cause", client.reply.cause, CAUSE_RANGE);
    hear_reply(3, WIRE_CAPTURE, first, CAUSE_OK);
    check_int("the first one counts", client.reply.cause, CAUSE_RANGE);
}

/* ---- lockstep ---- */

static struct {
    int words;
    enum client_answer answer;
    int looks;
} lockstep;

/* A word begins a bus frame. */
static void flush_word(void *context)
{
    struct hal *port = context;
    port->flush(port->context);
    lockstep.words++;
    if (lockstep.answer == CLIENT_ANSWERED)
        app_frame(&bus.app);
}

static int recv_port(void *context, struct frame *f)
{
    struct hal *port = context;
    return port->recv(port->context, f);
}

static int send_port(void *context, const struct frame *f)
{
    struct hal *port = context;
    return port->send(port->context, f);
}

static enum client_answer tell_answer(void *context)
{
    (void)context;
    return lockstep.words ? lockstep.answer : CLIENT_ANSWERED;
}

static void look(void *context, double seconds)
{
    (void)context;
    lockstep.looks++;
    clock_sleep_s(seconds);
}

static bool never(const struct client *c, const void *argument)
{
    (void)c, (void)argument;
    return false;
}

static struct client_link link_of_turns = {.wait = look, .answer = tell_answer, .patience_s = 0.3};

static void begin_lockstep(void)
{
    static struct hal hal;
    const struct app_config c = bus_config();
    bus_start(&bus, &c);
    hal = (struct hal){&bus.wires.port[BUS_CONTROLLER].hal, recv_port, send_port, flush_word, NULL, NULL};
    client_init(&client, &hal, &bus.app.scene);
    client.link = &link_of_turns;
    lockstep.words = lockstep.looks = 0;
    lockstep.answer = CLIENT_ANSWERED;
}

/* Commands go out together, one word a bus frame, and all times are bus frames: no look at the clock. */
TEST(client_lockstep)
{
    begin_lockstep();
    check_true("a session", client_open(&client, false, 5.0));
    check_int("a word a bus frame", lockstep.words, (int64_t)bus.app.frame);
    check_int("which the client counts", (int64_t)client.turns, lockstep.words);
    check_below("bus frames until it stands", lockstep.words, 120);
    uint64_t frame = bus.app.frame;
    client_control(&client, CONTROL_START, client.latest.frame);
    client_arm(&client, 0, 1.0, 100.0, 0.0, 0.1);
    client_stream(&client, 1, 0, 0.0);
    check_is("commands wait", bus.app.frame, ==, frame);
    check_true("the plant runs", client_wait_state(&client, STATE_RUNNING, 5.0));
    check_int("all of them came in one bus frame", (int64_t)bus.app.receiver[WIRE_ARM].counter, 3);
    frame = bus.app.frame;
    client_enable(&client, true);
    check_true("what is true already", client_wait_state(&client, STATE_RUNNING, 5.0));
    check_int("takes the bus frame in which the command goes out", (int64_t)(bus.app.frame - frame), 1);
    check_true("and without a command", client_wait_state(&client, STATE_RUNNING, 5.0));
    check_int("none", (int64_t)(bus.app.frame - frame), 1);
    client_enable(&client, true);
    frame = bus.app.frame;
    check_true("50 ms", !client_wait(&client, never, NULL, 0.05));
    check_int("are bus frames", (int64_t)(bus.app.frame - frame), 50);
    check_true("closed", client_close(&client, 5.0));
    check_int("no wait by the clock", lockstep.looks, 0);
}

TEST(client_lockstep_silent)
{
    begin_lockstep();
    lockstep.answer = CLIENT_UNANSWERED;
    check_true("a plant that says nothing: no session", !client_open(&client, false, 5.0));
    check_int("one word", lockstep.words, 1);
    check_above("looks", lockstep.looks, 2);
    check_true("silent", client.silent);
    int looks = lockstep.looks;
    check_true("nor later", !client_wait_alive(&client, 5.0));
    check_int("without the patience once more", lockstep.looks, looks);
    begin_lockstep();
    check_true("a session", client_open(&client, false, 5.0));
    lockstep.answer = CLIENT_REFUSED;
    check_true("a plant that has ended: not closed", !client_close(&client, 5.0));
    check_int("without a wait", lockstep.looks, 0);
    check_true("silent", client.silent);
}
