/* test_library_refusals.c - every mistake at the public header is a code and a text, and changes nothing. */
#include "host_sim/library/contactplant.h"

#include <math.h>
#include <string.h>
#include "tests/unit/test.h"

static union contactplant_memory memory;
static union contactplant_client_memory client_memory;
static struct contactplant_error error;

static void check_open(const char *name, void *where, size_t size, const char *scene, int code,
                       const char *text)
{
    memset(&error, 0x55, sizeof error);
    check_true(name, !contactplant_open(where, size, scene, &error));
    check_int(name, error.code, code);
    check_contains(name, error.text, text);
    check_true(name, !contactplant_open(where, size, scene, NULL));
    check_true(name, !contactplant_open_bus(where, size, scene, &error));
    check_int(name, error.code, code);
}

TEST(library_refuses_memory_and_scenes)
{
    size_t size = contactplant_size();
    check_open("no memory", NULL, sizeof memory, "rig", CONTACTPLANT_BAD_MEMORY, "NULL");
    check_open("too small", &memory, size - 1, "rig", CONTACTPLANT_BAD_MEMORY, "too few");
    check_open("misaligned", memory.bytes + 4, sizeof memory - 4, "rig", CONTACTPLANT_BAD_MEMORY,
               "aligned to 8");
    check_true("what it needs will do", contactplant_open(&memory, size, "rig", NULL) != NULL);
    check_true("on a bus, too", contactplant_open_bus(&memory, size, "rig", NULL) != NULL);
    check_open("no scene", &memory, sizeof memory, NULL, CONTACTPLANT_BAD_SCENE, "NULL");
    check_open("a name", &memory, sizeof memory, "hertz_rog", CONTACTPLANT_BAD_SCENE,
               "did you mean hertz_rig?");
    check_open("an empty name", &memory, sizeof memory, "", CONTACTPLANT_BAD_SCENE,
               "no such model or preset");
    check_open("a text's line", &memory, sizeof memory, "# mine\n[plant]\nmodel = hertz_rig\nmas = 5 kg\n",
               CONTACTPLANT_BAD_SCENE,
               "scene:4: mas: no such key in [plant] of hertz_rig; did you mean mass?");
    check_open("a text's range", &memory, sizeof memory, "[plant]\nmodel = hertz_rig\nmass = -5 kg\n",
               CONTACTPLANT_BAD_SCENE, "scene:3: mass: -5 kg is out of range");
    check_open("a text's step", &memory, sizeof memory,
               "[plant]\nmodel = hertz_rig\nmethod = rk4\n[deadline]\nsubsteps = 1\n", CONTACTPLANT_BAD_SCENE,
               "scene:3: method: ");
    check_contains("the handle is NULL", contactplant_error(NULL), "contactplant_open");
}

/* A handle that is none. */
static void check_no_plant(struct contactplant *p)
{
    struct contactplant_number number;
    struct contactplant_event event;
    struct contactplant_frame frame;
    double value[16] = {0};
    check_int("drive", contactplant_set_drive(p, 0, 1, 1, 1, 1), CONTACTPLANT_BAD_HANDLE);
    check_int("noise", contactplant_set_noise(p, 0, 1, 1, 1, 1), CONTACTPLANT_BAD_HANDLE);
    check_int("sample", contactplant_set_sample(p, 0, 1, 1), CONTACTPLANT_BAD_HANDLE);
    check_int("samples", contactplant_advance_samples(p, 0, value, 1, 1), CONTACTPLANT_BAD_HANDLE);
    check_int("silence", contactplant_silence(p, 1), CONTACTPLANT_BAD_HANDLE);
    check_int("parameter", contactplant_set_parameter(p, 0, 1), CONTACTPLANT_BAD_HANDLE);
    check_int("state", contactplant_set_state(p, value, 2), CONTACTPLANT_BAD_HANDLE);
    check_int("advance", contactplant_advance(p, 1), CONTACTPLANT_BAD_HANDLE);
    check_int("advance to", contactplant_advance_to(p, 1), CONTACTPLANT_BAD_HANDLE);
    check_int("outputs", contactplant_outputs(p, value, 6), CONTACTPLANT_BAD_HANDLE);
    check_int("save", contactplant_save(p, value, sizeof value), CONTACTPLANT_BAD_HANDLE);
    check_int("restore", contactplant_restore(p, value, sizeof value), CONTACTPLANT_BAD_HANDLE);
    check_int("describe", contactplant_describe(p, CONTACTPLANT_INPUT, 0, &number), CONTACTPLANT_BAD_HANDLE);
    check_int("put", contactplant_bus_put(p, &frame), CONTACTPLANT_BAD_HANDLE);
    check_int("frame", contactplant_bus_frame(p), CONTACTPLANT_BAD_HANDLE);
    check_int("take", contactplant_bus_take(p, &frame), 0);
    check_int("event", contactplant_next_event(p, &event), 0);
    check_int("find", contactplant_find(p, CONTACTPLANT_INPUT, "force"), -1);
    check_int("count", contactplant_count(p, CONTACTPLANT_INPUT), 0);
    check_nan("time", contactplant_time(p));
    check_nan("tick's time", contactplant_tick_time(p));
    check_nan("input", contactplant_input(p, 0));
    check_nan("output", contactplant_output(p, 0));
    check_nan("state", contactplant_state(p, 0));
    check_nan("parameter", contactplant_parameter(p, 0));
    check_nan("energy", contactplant_energy(p));
    check_nan("residual", contactplant_residual(p));
    check_int("tick", (int64_t)contactplant_tick(p), 0);
    check_int("substeps", contactplant_substeps(p), 0);
    check_int("counter", (int64_t)contactplant_counter(p, CONTACTPLANT_SWITCHES), 0);
    check_int("hash", (int64_t)contactplant_hash(p), 0);
    check_int("size to save", (int64_t)contactplant_save_size(p), 0);
    check_contains("text", contactplant_error(p), "not a plant");
}

TEST(library_refuses_no_plant)
{
    static union contactplant_memory raw;
    memset(&raw, 0xA5, sizeof raw);
    check_no_plant(NULL);
    check_no_plant((struct contactplant *)(void *)&raw);
    check_no_plant((struct contactplant *)(void *)(raw.bytes + 1));
    check_true("no plant any more", contactplant_open(&raw, sizeof raw, "rig", NULL) &&
                                        !contactplant_open(&raw, sizeof raw, "rog", NULL));
    check_no_plant((struct contactplant *)(void *)&raw);
}

/* A refusal: its code, its text, and the plant is as it was. */
static void refused(struct contactplant *p, uint64_t hash, int got, int code, const char *text)
{
    check_int(text, got, code);
    check_contains(text, contactplant_error(p), text);
    check_hex("unchanged", contactplant_hash(p), hash);
}

TEST(library_refuses_values)
{
    struct contactplant *p = contactplant_open(&memory, sizeof memory, "rig", &error);
    const double nan = (double)NAN, infinite = (double)INFINITY, state[2] = {0.0, infinite};
    struct contactplant_event event;
    struct contactplant_number number;
    check_int("begin", contactplant_advance(p, 100), CONTACTPLANT_OK);
    uint64_t h = contactplant_hash(p);
    int bad = CONTACTPLANT_BAD_VALUE;
    refused(p, h, contactplant_set_drive(p, 9, 1, 1, 1, 1), CONTACTPLANT_BAD_INDEX,
            "no input 9; hertz_rig has 0 to 3");
    refused(p, h, contactplant_set_drive(p, -1, 1, 1, 1, 1), CONTACTPLANT_BAD_INDEX, "no input -1");
    refused(p, h, contactplant_set_drive(p, 0, infinite, 1, 1, 1), bad, "amplitude inf is out of range");
    refused(p, h, contactplant_set_drive(p, 0, 1, -1, 1, 1), bad, "frequency -1 is out of range");
    refused(p, h, contactplant_set_drive(p, 0, 1, 1e9, 1, 1), bad, "frequency 1e+09 is out of range");
    refused(p, h, contactplant_set_drive(p, 0, 1, 1, 1e9, 1), bad, "phase 1e+09 is out of range");
    refused(p, h, contactplant_set_drive(p, 0, 1, 1, 1, -1), bad, "ramp -1 is out of range");
    refused(p, h, contactplant_set_noise(p, 0, -1, 1, 1, 0), bad, "deviation -1");
    refused(p, h, contactplant_set_noise(p, 0, nan, 1, 1, 0), bad, "deviation");
    refused(p, h, contactplant_set_noise(p, 0, 1, 0, 1, 0), bad, "hold of the noise in ticks 0");
    refused(p, h, contactplant_set_noise(p, 0, 1, 65536, 1, 0), bad, "give 1 to 65535");
    refused(p, h, contactplant_set_noise(p, 0, 1, 1, 1, nan), bad, "ramp");
    refused(p, h, contactplant_set_sample(p, 0, nan, 0), bad, "sample");
    refused(p, h, contactplant_set_sample(p, 0, 1, UINT64_MAX), bad, "ticks of the sample");
    refused(p, h, contactplant_advance_samples(p, 9, state, 2, 1), CONTACTPLANT_BAD_INDEX, "no input 9");
    refused(p, h, contactplant_advance_samples(p, 0, NULL, 2, 1), bad, "give 2 samples, not NULL");
    refused(p, h, contactplant_advance_samples(p, 0, (double[]){1, nan}, 2, 1), bad, "sample");
    refused(p, h, contactplant_advance_samples(p, 0, (double[]){1, 1}, 2, UINT64_MAX / 2), bad, "more ticks");
    refused(p, h, contactplant_silence(p, infinite), bad, "ramp inf");
    refused(p, h, contactplant_set_state(p, state, 2), bad, "not finite");
    refused(p, h, contactplant_set_state(p, state, 1), bad, "give all 2 states");
    refused(p, h, contactplant_set_state(p, NULL, 2), bad, "give all 2 states");
    refused(p, h, contactplant_advance_to(p, 0.0), bad, "has passed");
    refused(p, h, contactplant_advance_to(p, nan), bad, "out of range");
    refused(p, h, contactplant_advance_to(p, -1.0), bad, "out of range");
    refused(p, h, contactplant_advance_to(p, 1e300), bad, "out of range");
    refused(p, h, contactplant_advance(p, UINT64_MAX), bad, "more ticks");
    refused(p, h, contactplant_outputs(p, NULL, 6), bad, "room for all");
    refused(p, h, contactplant_next_event(p, NULL), 0, "event is NULL");
    refused(p, h, contactplant_describe(p, CONTACTPLANT_INPUT, 0, NULL), bad, "NULL");
    refused(p, h, contactplant_describe(p, (enum contactplant_kind)9, 0, &number), bad, "no such kind");
    refused(p, h, contactplant_find(p, CONTACTPLANT_INPUT, "forse"), -1, "did you mean force?");
    refused(p, h, contactplant_find(p, CONTACTPLANT_PARAMETER, "mass"), -1, "did you mean mass_kg?");
    refused(p, h, contactplant_find(p, CONTACTPLANT_SETTING, "timeout_frame"), -1,
            "did you mean timeout_frames?");
    refused(p, h, contactplant_find(p, CONTACTPLANT_STATE, NULL), -1, "NULL");
    refused(p, h, (int)contactplant_counter(p, (enum contactplant_counter)99), 0, "no such counter");
    check_nan("output 99", contactplant_output(p, 99));
    refused(p, h, 0, 0, "no output 99");
    check_nan("parameter 64 of a plant alone", contactplant_parameter(p, 64));
    check_nan("state -1", contactplant_state(p, -1));
    check_nan("input 4", contactplant_input(p, 4));
    refused(p, h, contactplant_bus_frame(p), CONTACTPLANT_BAD_ORDER, "contactplant_open_bus");
    refused(p, h, contactplant_bus_take(p, NULL), 0, "contactplant_open_bus");
    (void)event;
}

TEST(library_refuses_parameters_as_a_set)
{
    struct contactplant *p = contactplant_open(&memory, sizeof memory, "rig", &error);
    int mass = contactplant_find(p, CONTACTPLANT_PARAMETER, "mass_kg");
    int stiffness = contactplant_find(p, CONTACTPLANT_PARAMETER, "stiffness_N_per_m1_5");
    uint64_t h = contactplant_hash(p);
    const int both[] = {mass, stiffness}, odd[] = {mass, 40}, setting[] = {mass, 64};
    const double good[] = {5.0, 2e9}, bad[] = {5.0, -1.0}, stiff[] = {1e-6, 1e14};
    check_is("there is a stiffness", stiffness, >=, 0);
    refused(p, h, contactplant_set_parameters(p, 2, both, bad), CONTACTPLANT_BAD_VALUE, "out of range; give");
    refused(p, h, contactplant_set_parameters(p, 2, odd, good), CONTACTPLANT_BAD_INDEX, "no parameter 40");
    refused(p, h, contactplant_set_parameters(p, 2, setting, good), CONTACTPLANT_BAD_ORDER,
            "setting of the program");
    refused(p, h, contactplant_set_parameters(p, 2, NULL, good), CONTACTPLANT_BAD_VALUE, "NULL");
    refused(p, h, contactplant_set_parameters(p, -1, both, good), CONTACTPLANT_BAD_VALUE, "below 0");
    check_true("the step guard", contactplant_set_parameters(p, 2, both, stiff) == CONTACTPLANT_BAD_VALUE);
    check_hex("unchanged", contactplant_hash(p), h);
    check_int("both", contactplant_set_parameters(p, 2, both, good), CONTACTPLANT_OK);
    check_near("mass, kg", contactplant_parameter(p, mass), 5.0, 0.0);
    check_near("stiffness", contactplant_parameter(p, stiffness), 2e9, 0.0);
}

/* On a bus: settings before the first frame, and the controller has them after it; nothing from the side. */
TEST(library_refuses_what_the_bus_does)
{
    struct contactplant *p = contactplant_open_bus(&memory, sizeof memory, "rig", &error);
    int timeout = contactplant_find(p, CONTACTPLANT_SETTING, "timeout_frames");
    int lockin = contactplant_find(p, CONTACTPLANT_SETTING, "lockin_channel_0");
    struct contactplant_frame odd = {0x800, 8, 0, {0}}, longer = {0x200, 9, 0, {0}};
    uint64_t h = contactplant_hash(p);
    double state[2] = {0.0, 0.0};
    check_int("a setting", contactplant_set_parameter(p, timeout, 77.0), CONTACTPLANT_OK);
    check_near("it is set", contactplant_parameter(p, timeout), 77.0, 0.0);
    refused(p, h, contactplant_set_parameter(p, timeout, 0.5), CONTACTPLANT_BAD_VALUE, "timeout_frames");
    check_near("still", contactplant_parameter(p, timeout), 77.0, 0.0);
    check_is("there is a lock-in", lockin, >=, CONTACTPLANT_SETTING_FIRST);
    /* inside their ranges, and too fast for the step together: the app begins anew and is refused */
    const int both[] = {contactplant_find(p, CONTACTPLANT_PARAMETER, "mass_kg"),
                        contactplant_find(p, CONTACTPLANT_PARAMETER, "stiffness_N_per_m1_5")};
    const double stiff[] = {1e-6, 1e14};
    refused(p, h, contactplant_set_parameters(p, 2, both, stiff), CONTACTPLANT_BAD_VALUE, "cannot run");
    check_near("still", contactplant_parameter(p, timeout), 77.0, 0.0);
    refused(p, h, contactplant_set_drive(p, 0, 1, 1, 1, 1), CONTACTPLANT_BAD_ORDER, "is on a bus");
    refused(p, h, contactplant_set_state(p, state, 2), CONTACTPLANT_BAD_ORDER, "is on a bus");
    refused(p, h, contactplant_advance(p, 1), CONTACTPLANT_BAD_ORDER, "is on a bus");
    refused(p, h, contactplant_advance_to(p, 1.0), CONTACTPLANT_BAD_ORDER, "is on a bus");
    refused(p, h, contactplant_bus_put(p, &odd), CONTACTPLANT_BAD_VALUE, "not a classic CAN frame");
    refused(p, h, contactplant_bus_put(p, &longer), CONTACTPLANT_BAD_VALUE, "not a classic CAN frame");
    refused(p, h, contactplant_bus_put(p, NULL), CONTACTPLANT_BAD_VALUE, "not a classic CAN frame");
    odd.id = 0x100;
    for (int i = 0; i < 256; i++)
        check_int("room for 256", contactplant_bus_put(p, &odd), CONTACTPLANT_OK);
    refused(p, h, contactplant_bus_put(p, &odd), CONTACTPLANT_FULL, "256 frames wait");
    check_int("a frame", contactplant_bus_frame(p), CONTACTPLANT_OK);
    check_int("room again", contactplant_bus_put(p, &odd), CONTACTPLANT_OK);
    refused(p, contactplant_hash(p), contactplant_set_parameter(p, timeout, 78.0), CONTACTPLANT_BAD_ORDER,
            "the controller's now");
}

static int nothing(void *context, struct contactplant_frame *frame)
{
    (void)context, (void)frame;
    return 0;
}

static int refuse_all(void *context, const struct contactplant_frame *frame)
{
    (void)context, (void)frame;
    return 0;
}

/* Time that does not pass. */
static double stand(void *context, double seconds)
{
    int *left = context;
    (void)seconds;
    return left && --*left < 0 ? -1.0 : 0.0;
}

TEST(library_client_refuses)
{
    struct contactplant_transport t = {NULL, nothing, refuse_all, NULL, stand};
    struct contactplant_latest latest;
    double value = 1.0;
    int index = 0, odd = 50;
    check_true("no memory", !contactplant_client_open(NULL, sizeof client_memory, "rig", &t, &error));
    check_int("code", error.code, CONTACTPLANT_BAD_MEMORY);
    check_true("no transport",
               !contactplant_client_open(&client_memory, sizeof client_memory, "rig", NULL, &error));
    check_int("code", error.code, CONTACTPLANT_BAD_VALUE);
    check_true("no scene",
               !contactplant_client_open(&client_memory, sizeof client_memory, "rog", &t, &error));
    check_contains("text", error.text, "did you mean rig?");
    struct contactplant_client *c =
        contactplant_client_open(&client_memory, sizeof client_memory, "rig", &t, &error);
    check_true("a client", c != NULL);
    check_int("silence ends though no time passes", contactplant_client_begin(c, 0.01), CONTACTPLANT_TIMEOUT);
    check_contains("text", contactplant_client_error(c), "waited in vain for a plant; the plant is silent");
    check_int("for no number of seconds", contactplant_client_begin(c, (double)NAN), CONTACTPLANT_BAD_VALUE);
    check_contains("text", contactplant_client_error(c), "seconds to wait are not a number");
    check_int("end", contactplant_client_end(c, (double)NAN), CONTACTPLANT_BAD_VALUE);
    check_int("wait", contactplant_client_wait(c, CONTACTPLANT_WAIT_ALIVE, 0, (double)NAN),
              CONTACTPLANT_BAD_VALUE);
    check_nan("read", contactplant_client_parameter(c, 0, (double)NAN));
    check_contains("text", contactplant_client_error(c), "seconds to wait are not a number");
    check_int("no room", contactplant_client_heartbeat(c), CONTACTPLANT_FULL);
    check_int("arm", contactplant_client_arm(c, 9, 1, 1, 1, 1), CONTACTPLANT_BAD_INDEX);
    check_contains("text", contactplant_client_error(c), "no input 9");
    check_int("stream", contactplant_client_stream(c, -1, 1, 1), CONTACTPLANT_BAD_INDEX);
    check_int("fire", contactplant_client_fire(c, 1, 1, 1.0), CONTACTPLANT_BAD_VALUE);
    check_int("fire a fifth input", contactplant_client_fire(c, 0x10, 1, 0.0), CONTACTPLANT_BAD_INDEX);
    check_contains("text", contactplant_client_error(c), "hertz_rig has inputs 0 to 3");
    check_int("fire none", contactplant_client_fire(c, 0, 1, 0.0), CONTACTPLANT_BAD_INDEX);
    check_int("control", contactplant_client_control(c, (enum contactplant_operation)9, 0),
              CONTACTPLANT_BAD_VALUE);
    check_int("wait", contactplant_client_wait(c, (enum contactplant_wait)9, 0, 0.0), CONTACTPLANT_BAD_VALUE);
    check_int("set none", contactplant_client_set_parameters(c, 0, &index, &value), CONTACTPLANT_BAD_VALUE);
    check_int("set odd", contactplant_client_set_parameters(c, 1, &odd, &value), CONTACTPLANT_BAD_INDEX);
    check_nan("read odd", contactplant_client_parameter(c, odd, 0.001));
    check_nan("read", contactplant_client_parameter(c, 0, 0.001));
    check_int("latest", contactplant_client_latest(c, NULL, 0), CONTACTPLANT_BAD_VALUE);
    check_int("latest", contactplant_client_latest(c, &latest, sizeof latest), CONTACTPLANT_OK);
    check_nan("nothing known", latest.force_N);
    check_int("an ended session needs no end", contactplant_client_end(c, 0.0), CONTACTPLANT_OK);
    check_int("no client", contactplant_client_begin(NULL, 1.0), CONTACTPLANT_BAD_HANDLE);
    check_int("no client", contactplant_client_end(NULL, 1.0), CONTACTPLANT_BAD_HANDLE);
    check_int("no client", contactplant_client_heartbeat(NULL), CONTACTPLANT_BAD_HANDLE);
    check_int("no client", contactplant_client_control(NULL, CONTACTPLANT_START, 0), CONTACTPLANT_BAD_HANDLE);
    check_int("no client", contactplant_client_arm(NULL, 0, 1, 1, 1, 1), CONTACTPLANT_BAD_HANDLE);
    check_int("no client", contactplant_client_fire(NULL, 0, 1, 0), CONTACTPLANT_BAD_HANDLE);
    check_int("no client", contactplant_client_set_parameters(NULL, 1, &index, &value),
              CONTACTPLANT_BAD_HANDLE);
    check_int("no client", contactplant_client_wait(NULL, CONTACTPLANT_WAIT_ALIVE, 0, 1),
              CONTACTPLANT_BAD_HANDLE);
    check_int("no client", contactplant_client_latest(NULL, &latest, sizeof latest), CONTACTPLANT_BAD_HANDLE);
    check_int("no client", contactplant_client_poll(NULL), 0);
    check_nan("no client", contactplant_client_parameter(NULL, 0, 1));
    check_true("no client", !contactplant_client_plant(NULL));
    check_contains("no client", contactplant_client_error(NULL), "not a client");
    int left = 3;
    t.context = &left;
    c = contactplant_client_open(&client_memory, sizeof client_memory, "rig", &t, &error);
    check_int("the transport ends a wait", contactplant_client_wait(c, CONTACTPLANT_WAIT_ALIVE, 0, 1e9),
              CONTACTPLANT_TIMEOUT);
    check_contains("text", contactplant_client_error(c), "until the transport ended it");
    t.context = NULL;
    left = 1 << 30;
    check_int("the next wait is another", contactplant_client_wait(c, CONTACTPLANT_WAIT_ALIVE, 0, 1e-3),
              CONTACTPLANT_TIMEOUT);
    check_true("it ended by itself", !strstr(contactplant_client_error(c), "until the transport ended it"));
}
