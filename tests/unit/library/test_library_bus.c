/* test_library_bus.c - app and controller in one process through the public header; what is saved goes on
 * with the same bits. */
#include "host_sim/library/contactplant.h"

#include <string.h>
#include "firmware/method/method.h"
#include "models/afm_lever.h"
#include "models/scenes/scenes.h"
#include "models/scenes/scenes_table.h"
#include "tests/unit/test.h"

static union contactplant_memory memory, other;
static union contactplant_client_memory client_memory;
static struct contactplant_error error;
static struct contactplant *plant;
static struct contactplant_client *client;

/* ---- a transport whose other end is `plant`: waiting is a bus frame ---- */

static int receive(void *context, struct contactplant_frame *frame)
{
    (void)context;
    return contactplant_bus_take(plant, frame);
}

static int transmit(void *context, const struct contactplant_frame *frame)
{
    (void)context;
    return contactplant_bus_put(plant, frame) == CONTACTPLANT_OK;
}

static double run_frame(void *context, double seconds)
{
    (void)context, (void)seconds;
    check_int("bus frame", contactplant_bus_frame(plant), CONTACTPLANT_OK);
    return 1e-3;
}

static void bus_begin(const char *scene, const char *assumed)
{
    const struct contactplant_transport t = {NULL, receive, transmit, NULL, run_frame};
    plant = contactplant_open_bus(&memory, sizeof memory, scene, &error);
    check_string("plant", error.text, "");
    client = contactplant_client_open(&client_memory, sizeof client_memory, assumed, &t, &error);
    check_string("client", error.text, "");
}

static struct contactplant_latest heard(void)
{
    struct contactplant_latest latest;
    check_int("latest", contactplant_client_latest(client, &latest, sizeof latest), CONTACTPLANT_OK);
    return latest;
}

/* In session, running, 3 N at 225 Hz: contact is lost. */
static void shake(void)
{
    check_int("session", contactplant_client_begin(client, 5.0), CONTACTPLANT_OK);
    check_int("open", heard().session, 1);
    check_int("start", contactplant_client_control(client, CONTACTPLANT_START, 0), CONTACTPLANT_OK);
    check_int("runs",
              contactplant_client_wait(client, CONTACTPLANT_WAIT_STATE, CONTACTPLANT_STATE_RUNNING, 1.0),
              CONTACTPLANT_OK);
    check_int("arm", contactplant_client_arm(client, 0, 3.0, 225.0, 0.0, 0.1), CONTACTPLANT_OK);
    uint64_t tick = heard().tick + 20 * contactplant_substeps(plant);
    check_int("fire", contactplant_client_fire(client, 1, tick, 0.0), CONTACTPLANT_OK);
}

static void keep_on(int frames)
{
    for (int i = 0; i < frames; i++) {
        if (i % 10 == 0)
            check_int("heartbeat", contactplant_client_heartbeat(client), CONTACTPLANT_OK);
        check_int("a frame more",
                  contactplant_client_wait(client, CONTACTPLANT_WAIT_TICK, heard().tick + 1, 1.0),
                  CONTACTPLANT_OK);
    }
}

TEST(library_bus_session)
{
    bus_begin("hertz_rig", "hertz_rig");
    shake();
    keep_on(600);
    struct contactplant_latest l = heard();
    check_int("nothing refused", (int64_t)l.refused, 0);
    check_int("accepted: the first ENABLE, CONTROL, FIRE", (int64_t)l.accepted, 3);
    check_is("touchdowns", l.touchdowns, >, 0);
    check_near("the plant's tick", (double)l.tick, (double)contactplant_tick(plant), 0.0);
    double now = contactplant_output(plant, contactplant_find(plant, CONTACTPLANT_OUTPUT, "penetration"));
    check_near("penetration, m", l.penetration_m, now, 1e-9);
    int mass = contactplant_find(contactplant_client_plant(client), CONTACTPLANT_PARAMETER, "mass_kg");
    const double five = 5.0;
    check_near("mass, kg", contactplant_client_parameter(client, mass, 1.0),
               contactplant_parameter(plant, mass), 1e-6);
    check_int("mass", contactplant_client_set_parameters(client, 1, &mass, &five), CONTACTPLANT_OK);
    keep_on(5);
    check_near("mass of the plant, kg", contactplant_parameter(plant, mass), 5.0, 0.0);
    check_int("a sample for the past",
              contactplant_client_stream(client, 0, heard().tick / contactplant_substeps(plant) - 10, 1.0),
              CONTACTPLANT_OK);
    uint64_t replies = l.accepted;
    keep_on(5);
    check_is("more replies", heard().accepted, >, replies);
    check_int("it was late", (int64_t)heard().refused_late, 1);
    check_int("and so refused", (int64_t)heard().refused, 1);
    check_int("stop", contactplant_client_control(client, CONTACTPLANT_STOP, 0), CONTACTPLANT_OK);
    check_int("stopped",
              contactplant_client_wait(client, CONTACTPLANT_WAIT_STATE, CONTACTPLANT_STATE_STOPPED, 1.0),
              CONTACTPLANT_OK);
    check_int("end", contactplant_client_end(client, 1.0), CONTACTPLANT_OK);
    check_int("over", heard().session, 0);
}

/* A caller compiled with a shorter struct gets what it knows. */
TEST(library_latest_is_cut)
{
    struct contactplant_latest l;
    memset(&l, 0x77, sizeof l);
    bus_begin("rig", "rig");
    check_int("begin", contactplant_client_begin(client, 1.0), CONTACTPLANT_OK);
    check_int("cut", contactplant_client_latest(client, &l, offsetof(struct contactplant_latest, state)),
              CONTACTPLANT_OK);
    check_int("behind it as it was", l.state, 0x77777777);
    check_is("frame", l.frame, <, 1000);
}

TEST(library_client_of_another_plant)
{
    bus_begin("hertz_rig", "rolling_contact");
    check_int("refused", contactplant_client_begin(client, 2.0), CONTACTPLANT_REFUSED);
    check_contains("text", contactplant_client_error(client), "model hertz_rig, not rolling_contact");
}

/* Scenes that run on a bus alone have names for a client, too. */
TEST(library_client_has_a_plant_of_every_scene)
{
    static const char *const scene[] = {"microscope",
                                        "[plant]\nmodel = hertz_rig\n[stage velocity]\ngain = 2\n"};
    static const char *const name[] = {"z", "base"};
    static const double step_s[] = {1e-3 / 1120, 1e-3 / 64};
    for (int i = 0; i < 2; i++) {
        bus_begin(scene[i], scene[i]);
        struct contactplant *alone = contactplant_client_plant(client);
        check_is(name[i], contactplant_find(alone, CONTACTPLANT_INPUT, name[i]), >, 0);
        check_near("step, s", contactplant_tick_time(alone), step_s[i], 1e-18);
        check_int("no bus of the caller", contactplant_advance(alone, 1), CONTACTPLANT_BAD_ORDER);
        check_int("session", contactplant_client_begin(client, 5.0), CONTACTPLANT_OK);
    }
}

/* ---- save and restore ---- */

static unsigned char saved[400000], again[400000];

/* Runs on from a saved instant twice, in this plant and in another one. */
static void check_goes_on(struct contactplant *p, const char *scene)
{
    struct contactplant *q = contactplant_open(&other, contactplant_size(), scene, &error);
    check_int(scene, contactplant_set_drive(p, 0, 1e-12, 10.0, 0.3, 0.02), CONTACTPLANT_OK);
    (void)contactplant_set_noise(p, 0, 1e-12, 5, 3, 0.0);
    check_int(scene, contactplant_advance(p, 777), CONTACTPLANT_OK);
    size_t size = contactplant_save_size(p);
    check_is(scene, size, <=, sizeof saved);
    check_int(scene, contactplant_save(p, saved, size), CONTACTPLANT_OK);
    uint64_t hash = contactplant_hash(p);
    int code = contactplant_advance(p, 555); /* two presets escape */
    uint64_t later = contactplant_hash(p);
    check_int(scene, contactplant_restore(p, saved, size), CONTACTPLANT_OK);
    check_hex(scene, contactplant_hash(p), hash);
    check_int(scene, contactplant_save(p, again, size), CONTACTPLANT_OK);
    check_bytes(scene, again, saved, size);
    check_int(scene, contactplant_advance(p, 555), code);
    check_hex(scene, contactplant_hash(p), later);
    check_int(scene, contactplant_restore(q, saved, size), CONTACTPLANT_OK);
    check_int(scene, contactplant_advance(q, 555), code);
    check_hex(scene, contactplant_hash(q), later);
}

TEST(library_saves_a_plant)
{
    const char *name;
    int n = 0;
    for (int i = 0; (name = contactplant_scene_name(i)) != NULL; i++) {
        struct contactplant *p = contactplant_open(&memory, sizeof memory, name, &error);
        if (p)
            check_goes_on(p, name);
        n += p != NULL;
    }
    check_is("scenes", n, >=, SCENES + 4);
}

static int take_all(struct contactplant *p, unsigned char *bytes)
{
    struct contactplant_frame f;
    int n = 0;
    for (int i = 0; i < 50; i++) {
        check_int("frame", contactplant_bus_frame(p), CONTACTPLANT_OK);
        while (contactplant_bus_take(p, &f)) {
            memcpy(bytes + 8 * n++, f.data, 8);
            check_is("room", 8 * n, <, (int)sizeof again - 8);
        }
    }
    return n;
}

/* Its bytes on the bus are the same after a restore. */
static void check_saves(const char *scene)
{
    static unsigned char first[400000];
    bus_begin(scene, scene);
    shake();
    keep_on(100);
    size_t size = contactplant_save_size(plant);
    check_is("size", size, <=, sizeof saved);
    check_int("save", contactplant_save(plant, saved, size), CONTACTPLANT_OK);
    int n = take_all(plant, first);
    check_is("frames", n, >, 100);
    check_int("restore", contactplant_restore(plant, saved, size), CONTACTPLANT_OK);
    check_int("as many frames", take_all(plant, again), n);
    check_bytes("the same frames", again, first, (size_t)n * 8);
}

TEST(library_saves_a_bus)
{
    check_saves("hertz_rig");
}

/* With an actuator that rings and a sensor that is noisy and late: their state is saved, too. */
TEST(library_saves_stages)
{
    check_saves("[plant]\nmodel = hertz_rig\n[stage force]\nresonance = 200 Hz\ncreep_per_decade = 0.02\n"
                "[stage displacement]\nnoise_density = 10 nm/sqrt(Hz)\nlag = 300 Hz\ndelay = 70 ticks\n");
}

/* A microscope has functions by address in its memory. None is saved: another program has them elsewhere. */
TEST(library_saves_a_microscope)
{
    static const char scene[] = "[plant]\nmodel = microscope\ntemperature = 295 K\nheight = 30 nm\n"
                                "[stage z]\nresonance = 5 kHz\n[deadline]\nsubsteps = 1120\n";
    check_saves(scene);
    struct contactplant *q = contactplant_open_bus(&other, sizeof other, scene, &error);
    size_t size = contactplant_save_size(plant), at = 0;
    step_function *step = modal.bind(&afm_lever);
    check_int("restore", contactplant_restore(q, saved, size), CONTACTPLANT_OK);
    check_int("save", contactplant_save(q, again, size), CONTACTPLANT_OK);
    check_bytes("the bytes of another one", again, saved, size);
    while (at + sizeof step <= size && memcmp(&saved[at], &step, sizeof step) != 0)
        at++;
    check_is("none has the address of a step", at + sizeof step, >, size);
    (void)take_all(q, again);
    check_hex("it goes on alike", contactplant_hash(q), contactplant_hash(plant));
}

/* A plant alone has actuators, too: half of 10 N is 5 N. A sensor is refused. */
TEST(library_actuator_alone)
{
    static const char half[] =
        "[plant]\nmodel = hertz_rig\n[drive force]\namplitude = 10 N\nfrequency = 0 Hz\n"
        "[stage force]\ngain = 0.5\n";
    static const char plain[] =
        "[plant]\nmodel = hertz_rig\n[drive force]\namplitude = 5 N\nfrequency = 0 Hz\n";
    struct contactplant *p = contactplant_open(&memory, sizeof memory, half, &error);
    struct contactplant *q = contactplant_open(&other, sizeof other, plain, &error);
    check_true("opened", p && q);
    check_int("runs", contactplant_advance(p, 64000 * 5), CONTACTPLANT_OK);
    check_int("runs", contactplant_advance(q, 64000 * 5), CONTACTPLANT_OK);
    check_near("as deep, m", contactplant_output(p, 2), contactplant_output(q, 2), 1e-15);
    p = contactplant_open(&memory, sizeof memory, "[plant]\nmodel = hertz_rig\n[stage velocity]\ngain = 2\n",
                          &error);
    check_true("a sensor is refused", !p);
    check_contains("  with the reason", error.text, "whose reading is on the bus alone");
}

static void check_foreign(struct contactplant *p, const char *name, size_t size, const char *text)
{
    uint64_t hash = contactplant_hash(p);
    check_int(name, contactplant_restore(p, again, size), CONTACTPLANT_BAD_BYTES);
    check_contains(name, contactplant_error(p), text);
    check_hex(name, contactplant_hash(p), hash);
}

TEST(library_refuses_foreign_bytes)
{
    struct contactplant *p = contactplant_open(&memory, sizeof memory, "hertz_rig", &error);
    size_t size = contactplant_save_size(p);
    check_int("too small", contactplant_save(p, saved, size - 1), CONTACTPLANT_BAD_MEMORY);
    check_int("NULL", contactplant_save(p, NULL, size), CONTACTPLANT_BAD_MEMORY);
    check_int("save", contactplant_save(p, saved, size), CONTACTPLANT_OK);
    memcpy(again, saved, size);
    check_int("NULL", contactplant_restore(p, NULL, size), CONTACTPLANT_BAD_BYTES);
    check_foreign(p, "cut", size - 1, "too few");
    check_foreign(p, "nothing", 0, "too few");
    for (size_t i = 0; i < size; i += i < 100 ? 1 : 977) {
        again[i] ^= 0x10;
        check_int("a byte of another value", contactplant_restore(p, again, size), CONTACTPLANT_BAD_BYTES);
        again[i] ^= 0x10;
    }
    again[size - 1] ^= 1;
    check_foreign(p, "damaged", size, "damaged");
    memset(again, 'x', size);
    check_foreign(p, "foreign", size, "not saved by this library");
    struct contactplant *q = contactplant_open(&other, sizeof other, "bbp-fig2-force", &error);
    check_int("of another scene", contactplant_restore(q, saved, size), CONTACTPLANT_BAD_BYTES);
    check_contains("of another scene", contactplant_error(q), "another scene");
    q = contactplant_open_bus(&other, sizeof other, "hertz_rig", &error);
    check_int("of a plant alone", contactplant_restore(q, saved, size), CONTACTPLANT_BAD_BYTES);
    check_int("as it is", contactplant_restore(p, saved, size), CONTACTPLANT_OK);
}

/* Each limit of the watch belongs to the scene. */
TEST(library_refuses_another_watch)
{
    static const char *const scene[] = {"[plant]\nmodel = hertz_rig\n[watch]\nbelow = 1 um\nabove = 20 um\n",
                                        "[plant]\nmodel = hertz_rig\n[watch]\nbelow = 1 um\nabove = 21 um\n",
                                        "[plant]\nmodel = hertz_rig\n[watch]\nbelow = 2 um\nabove = 20 um\n"};
    struct contactplant *p = contactplant_open_bus(&memory, sizeof memory, scene[0], &error);
    check_true("opened", p != NULL);
    size_t size = contactplant_save_size(p);
    check_int("save", contactplant_save(p, saved, size), CONTACTPLANT_OK);
    for (int i = 0; i < 3; i++) {
        struct contactplant *q = contactplant_open_bus(&other, sizeof other, scene[i], &error);
        check_true("opened", q != NULL);
        check_int(i == 0 ? "the same watch" : "another limit", contactplant_restore(q, saved, size),
                  i == 0 ? CONTACTPLANT_OK : CONTACTPLANT_BAD_BYTES);
    }
}

/* ---- packets ---- */

TEST(library_packets)
{
    static struct contactplant_frame frame[300], back[CONTACTPLANT_PACKET_FRAMES];
    uint8_t packet[CONTACTPLANT_PACKET];
    int taken, n = 0;
    for (uint32_t i = 0; i < 300; i++)
        frame[i] = (struct contactplant_frame){
            .id = i, .length = 8, .extended = (uint8_t)(i % 2), .data = {(uint8_t)i}};
    while (n < 300) {
        size_t size = contactplant_pack((uint8_t)n, frame + n, 300 - n, packet, &taken);
        check_is("taken", taken, >, 0);
        check_int("unpacked", contactplant_unpack(packet, size, back, CONTACTPLANT_PACKET_FRAMES), taken);
        check_bytes("the same", back, frame + n, (size_t)taken * sizeof *frame);
        check_int("no room", contactplant_unpack(packet, size, back, taken - 1), -1);
        check_int("cut", contactplant_unpack(packet, size - 1, back, CONTACTPLANT_PACKET_FRAMES), -1);
        n += taken;
    }
    static const uint8_t empty[] = {2, 0, 7, 0, 0};
    check_int("an empty packet", (int64_t)contactplant_pack(7, NULL, 0, packet, NULL), 5);
    check_bytes("is cannelloni's", packet, empty, 5);
    check_int("an empty packet", contactplant_unpack(packet, 5, back, 0), 0);
    check_int("NULL", contactplant_unpack(NULL, 5, back, 1), -1);
    check_int("NULL", (int64_t)contactplant_pack(7, frame, 1, NULL, NULL), 0);
    frame[0].length = 9;
    (void)contactplant_pack(7, frame, 2, packet, &taken);
    check_int("no CAN frame ends it", taken, 0);
}
