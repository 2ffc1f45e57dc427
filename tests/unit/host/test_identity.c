/* test_identity.c - the identity on the bus: its numbers by another CRC-32, when it is sent, and what
 * changes it. Also how a client treats a plant with another identity. */
#include <string.h>
#include "firmware/bus/identity.h"
#include "hal/link/faults.h"
#include "host_sim/cli/clock.h"
#include "host_sim/live/client_host.h"
#include "host_sim/live/explain.h"
#include "models/afm_tip.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { EVERY = 100 };

static struct bus bus;
static double scratch[METHOD_SCRATCH];
static struct client client;

static double item(unsigned i)
{
    return bus_item(&bus, WIRE_INFO, i);
}

/* A fresh plant and what it tells of itself, all of it. */
static void listen_to(const struct app_config *c)
{
    bus_start(&bus, c);
    bus_silent(&bus, INFO_ITEMS);
}

/* CRC-32 with the bits in their other order: the polynomial
 * as the standard writes it, bytes from bit 0 on. */
static uint32_t crc32_of(uint32_t crc, const uint8_t *data, int n)
{
    for (int i = 0; i < 8 * n; i++) {
        uint32_t bit = (data[i / 8] >> i % 8 & 1u) ^ crc >> 31;
        crc = (crc << 1) ^ (bit ? 0x04C11DB7u : 0u);
    }
    return crc;
}

/* The result as the standard sends it: inverted, and its bits in the other order. Low 24 bits. */
static uint32_t crc32_end(uint32_t crc)
{
    uint32_t turned = 0;
    for (int i = 0; i < 32; i++)
        turned |= (~crc >> i & 1u) << (31 - i);
    return turned & 0xFFFFFFu;
}

static uint32_t crc32_entry(uint32_t crc, unsigned index, float value)
{
    uint8_t entry[5] = {(uint8_t)index};
    memcpy(entry + 1, &value, sizeof value); /* this machine is little endian */
    return crc32_of(crc, entry, 5);
}

/* From what the bus said alone. */
static uint32_t check_of_items(void)
{
    static const unsigned part[] = {0, 1, 2, 4, 8, 9, 10, 11, 12, 13}; /* docs/reference/messages.md */
    uint32_t crc = 0xFFFFFFFFu;
    for (size_t i = 0; i < sizeof part / sizeof part[0]; i++)
        crc = crc32_entry(crc, part[i], (float)item(part[i]));
    return crc32_end(crc);
}

TEST(identity_check)
{
    struct app_config c = bus_config();
    c.dilation = 3.0;
    listen_to(&c);
    check_int("the other CRC-32 of 123456789, low 24 bits",
              crc32_end(crc32_of(0xFFFFFFFFu, (const uint8_t *)"123456789", 9)), 0xF43926);
    check_near("MODEL is zlib's crc32 of hertz_rig", item(INFO_MODEL), 0x6D68A9, 0);
    check_near("IDENTITY is the check of the items told", item(INFO_IDENTITY), check_of_items(), 0);
    check_near("LSB of DISPLACEMENT, m", item(INFO_LSB), 5e-11, 5e-18);
    check_near("LSB of VELOCITY, three times slower, m/s", item(INFO_LSB + 1), 2e-8, 2e-15);
    check_near("LSB of PENETRATION, m", item(INFO_LSB + 2), 5e-11, 5e-18);
    check_near("LSB of FORCE, N", item(INFO_LSB_LAST), 5e-4, 5e-11);
    uint32_t crc = 0xFFFFFFFFu;
    for (unsigned i = 81; i <= 98; i++)
        crc = crc32_entry(crc, i, (float)bus.app.setting[i - SETTING_FIRST]);
    check_near("SETTINGS is the check of 81 to 98", item(INFO_SETTINGS), crc32_end(crc), 0);
}

/* Which INFO item the i-th INFO since bus_forget was; -1 for none. */
static int told(int i)
{
    for (int k = 0; k < bus.n_seen; k++)
        if (bus.seen[k].kind == WIRE_INFO && i-- == 0)
            return (int)bus.seen[k].value[INFO_ITEM];
    return -1;
}

/* Items told since bus_forget, each once: a bit mask. */
static uint32_t told_items(void)
{
    uint32_t mask = 0;
    for (int i = 0; told(i) >= 0; i++)
        mask |= 1u << told(i);
    return mask;
}

TEST(identity_opening)
{
    const struct app_config c = bus_config();
    bus_start(&bus, &c);
    bus_silent(&bus, 1);
    check_int("in the first frame after power-on", told(0), INFO_IDENTITY);
    bus_silent(&bus, 150); /* frames 1 to 150 */
    bus_forget(&bus);
    bus_enable(&bus, true);
    bus_silent(&bus, 1);
    check_int("session opened", bus_cause(&bus, WIRE_ENABLE), CAUSE_OK);
    check_int("in the same frame", told(0), INFO_IDENTITY);
    bus_silent(&bus, INFO_ITEMS - 1);
    check_hex("all of INFO in as many frames", told_items(), (1u << INFO_ITEMS) - 1u);
    bus_forget(&bus);
    bus_enable(&bus, true);
    bus_silent(&bus, 10);
    check_int("a heartbeat asks for nothing", told_items() & ~(1u << INFO_VERSION), 0);
}

/* A listener hears it within 100 frames, whatever the settings. */
TEST(identity_listening)
{
    bus_start_rig(&bus);
    bus_set(&bus, SETTING_FIRST + SET_ECHO_EVERY, 0);
    bus_run(&bus, 20);
    for (int i = 0; i < 5; i++) {
        bus_forget(&bus);
        bus_run(&bus, EVERY);
        check_int("IDENTITY in 100 frames without echoes", bus_count(&bus, WIRE_INFO), 1);
        check_int("and nothing else", told(0), INFO_IDENTITY);
    }
}

/* A bus without room: what waits is not pushed out by another item. */
TEST(identity_pressure)
{
    const struct app_config c = bus_config();
    bus_start(&bus, &c);
    bus_silent(&bus, 50);
    bus_enable(&bus, true);
    bus.wires.port[0].tx_limit = 0;
    bus_forget(&bus);
    bus_silent(&bus, 3 * INFO_ITEMS);
    bus.wires.port[0].tx_limit = UINT32_MAX;
    bus_silent(&bus, INFO_ITEMS + 1);
    check_int("IDENTITY is the first", told(0), INFO_IDENTITY);
    check_hex("and none is missing", told_items(), (1u << INFO_ITEMS) - 1u);
}

/* ---- what it is made of ---- */

/* The identity of a plant as it starts. */
static uint32_t identity(const struct app_config *c)
{
    listen_to(c);
    check_near("told as it is", item(INFO_IDENTITY), bus.app.scene.identity, 0);
    return bus.app.scene.identity;
}

TEST(identity_parts)
{
    double si[MODEL_PARAMETERS], setting[SETTINGS];
    const struct app_config c = bus_config();
    uint32_t rig = identity(&c);
    struct app_config other = c;
    for (int i = 0; i < RIG_PARAMETERS; i++)
        si[i] = hertz_rig.parameter[i].initial;
    for (int i = 0; i < SETTINGS; i++)
        setting[i] = setting_initial(i, &hertz_rig, 1e-3);
    other.base_id = 0x240;
    check_int("another base identifier: the same", identity(&other), rig);
    other = c;
    other.method = &taylor;
    other.scratch = scratch;
    check_int("another method: the same", identity(&other), rig);
    other = c;
    other.substeps = 17;
    check_is("other substeps: another", identity(&other), !=, rig);
    other = c;
    other.frame_s = 0.5e-3;
    check_is("another frame rate: another", identity(&other), !=, rig);
    other = c;
    other.dilation = 1.0001; /* no LSB changes */
    check_is("another dilation: another", identity(&other), !=, rig);
    other = c;
    other.model = &hertz_rig_linear; /* no LSB changes */
    check_is("another model: another", identity(&other), !=, rig);
    other = c;
    other.si = si;
    si[RIG_PRELOAD] = 65.0; /* no LSB changes */
    check_int("a parameter that leaves the LSBs: the same", identity(&other), rig);
    si[RIG_PRELOAD] = 640.0;
    check_is("one that changes them: another", identity(&other), !=, rig);
    other = c;
    other.setting = setting;
    for (int i = 0; i < SETTINGS; i++) {
        const struct parameter *p = &setting_table[i];
        bool means = i >= SET_STREAM_LINEAR && i <= SET_CAPTURE_EVERY_TICKS;
        double initial = setting[i];
        setting[i] = initial < p->max ? initial + 1.0 : initial - 1.0;
        if (!setting_accepts(i, setting[i]) || app_init(&bus.app, &other, &bus.wires.port[0].hal))
            setting[i] = initial < 2.0 ? initial : initial - 1.0;
        if (setting[i] != initial)
            check_int(p->name, identity(&other) != rig, means);
        setting[i] = initial;
    }
}

/* ---- what it is not made of ---- */

TEST(identity_commands)
{
    const struct app_config c = bus_config();
    uint32_t before = identity(&c);
    bus_start_running(&bus, &c);
    bus_set(&bus, RIG_PRELOAD, 640.0);
    bus_set(&bus, SETTING_FIRST + SET_LOCKIN_OUTPUT, 3.0);
    bus_run(&bus, 2 * EVERY);
    check_near("the preload is another", bus.app.plant.si[RIG_PRELOAD], 640.0, 0);
    check_near("the lock-in's output too", bus.app.setting[SET_LOCKIN_OUTPUT], 3.0, 0);
    check_near("frames keep their meaning, and IDENTITY its number", item(INFO_IDENTITY), before, 0);
    check_near("made of what is told", item(INFO_IDENTITY), check_of_items(), 0);
}

/* The reduced model began, so its identity stays, as every LSB does. */
TEST(identity_climb)
{
    struct app_config c = bus_config();
    const struct watch_limits below = {MODEL_TIME, -1.0, 0.05};
    c.model = &hertz_rig_linear;
    c.promote = &hertz_rig;
    c.watch = &below;
    bus_start_running(&bus, &c);
    bus_silent(&bus, INFO_ITEMS);
    uint32_t before = bus.app.scene.identity;
    check_near("of the reduced model", item(INFO_MODEL), 0xF4C8CE, 0);
    bus_set(&bus, SETTING_FIRST + SET_ECHO_EVERY, 1);
    bus_forget(&bus);
    bus_run(&bus, 3 * EVERY);
    check_near("INFO: promoted", item(INFO_PROMOTED), 1, 0);
    check_near("IDENTITY is still that of the start", item(INFO_IDENTITY), before, 0);
    check_near("MODEL too", item(INFO_MODEL), 0xF4C8CE, 0);
}

/* ---- a client ---- */

static int64_t turned_ns;
static struct hal wire;

/* The client's recv: the plant takes a turn whenever nothing is left to hear, at most one in 0.1 ms. */
static int recv_and_meet(void *context, struct frame *f)
{
    struct loopback_port *port = context;
    int got = port->hal.recv(port, f);
    if (got || clock_now_ns() - turned_ns < 100000)
        return got;
    turned_ns = clock_now_ns();
    app_frame(&bus.app);
    return port->hal.recv(port, f);
}

/* A client that assumes `assumed`, before a plant of another tip. */
static void meet(const struct app_config *plant, const struct wire_scene *assumed)
{
    bus_start(&bus, plant);
    bus.app.setting[SET_TIMEOUT_FRAMES] = 10000;
    wire = bus.wires.port[BUS_CONTROLLER].hal;
    wire.recv = recv_and_meet;
    client_init(&client, &wire, assumed);
}

static struct app_config tip(void)
{
    struct app_config c = bus_config();
    c.model = &afm_tip;
    c.dilation = 1000.0;
    c.substeps = 64;
    return c;
}

TEST(identity_client)
{
    const struct app_config rig = bus_config(), c = tip();
    char why[EXPLAIN_REASON];
    listen_to(&rig);
    const struct wire_scene assumed = bus.app.scene;
    meet(&rig, &assumed);
    check_true("the plant that it assumes", client_open(&client, false, 20.0));
    check_int("is the same", client_identity(&client), CLIENT_SAME);
    meet(&c, &assumed);
    check_true("another plant is refused", !client_open(&client, false, 20.0));
    check_int("by its identity", client_identity(&client), CLIENT_OTHER);
    check_int("before any command", bus.app.count[DIAG_FRAMES_RECEIVED], 0);
    explain_no_session(&client, why);
    check_contains("model by name", why, " model afm_tip, not hertz_rig;");
    check_contains("dilation", why, " dilation 1000, not 1;");
    check_contains("substeps", why, " substeps 64, not 16;");
    check_contains("an LSB", why, " lsb_force 2e-15 N, not 0.0005;");
    check_true("not what is equal", strstr(why, "frame_rate") == NULL && strstr(why, "version") == NULL);
    check_contains("and what to do", why, "give the scene");
}

/* A plant too slow to tell it by itself in time: refused behind ENABLE, and left as it was found. */
TEST(identity_client_joining)
{
    const struct app_config rig = bus_config(), c = tip();
    listen_to(&rig);
    const struct wire_scene assumed = bus.app.scene;
    for (int joined = 0; joined < 2; joined++) {
        meet(&c, &assumed);
        bus.app.frame = 1; /* and stays below 100: it forgets what is due */
        bus.app.telemetry.info_pending = 0;
        if (joined) {
            bus_enable(&bus, true);
            app_frame(&bus.app);
            bus.app.telemetry.info_pending = 0;
            bus_collect(&bus);
        }
        check_true("refused", !client_open(&client, true, 20.0));
        check_int("the session of somebody else goes on, ours is closed", bus.app.enabled, joined);
    }
}

TEST(identity_client_untold)
{
    const struct app_config rig = bus_config();
    char why[EXPLAIN_REASON];
    meet(&rig, &(struct wire_scene){.base_id = 0x200, .identity = 1});
    client.latest.count[WIRE_STATUS] = 1;
    check_int("nothing told", client_identity(&client), CLIENT_UNTOLD);
    explain_no_session(&client, why);
    check_contains("is no consent", why, "does not tell its identity");
}
