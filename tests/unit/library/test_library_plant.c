/* test_library_plant.c - a plant through the public header: the same bits as inside, for every scene, model
 * and way to advance; names, ranges, events. */
#include "host_sim/library/contactplant.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/method/method.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "host_sim/scene/scene.h"
#include "models/hertz_rig.h"
#include "models/models.h"
#include "models/scenes/scenes_table.h"
#include "tests/unit/test.h"

static union contactplant_memory memory, other;
static struct contactplant_error error;

static struct contactplant *open_plant(const char *scene)
{
    struct contactplant *p = contactplant_open(&memory, sizeof memory, scene, &error);
    check_string("opened", error.text, "");
    return p;
}

TEST(library_versions)
{
    char text[32];
    snprintf(text, sizeof text, "%d.%d.%d", CONTACTPLANT_VERSION_MAJOR, CONTACTPLANT_VERSION_MINOR,
             CONTACTPLANT_VERSION_PATCH);
    check_string("version of the header's numbers", CONTACTPLANT_VERSION, text);
    check_string("version that runs", contactplant_version(), CONTACTPLANT_VERSION);
    check_int("ABI", contactplant_abi(), CONTACTPLANT_ABI);
    check_int("protocol", contactplant_protocol(), WIRE_VERSION);
    check_is("size", contactplant_size(), <=, sizeof memory);
    check_is("size of a client", contactplant_client_size(), <=, CONTACTPLANT_CLIENT_SIZE);
}

/* The example of contactplant.h, and the same by the plant's own functions. */
TEST(library_has_the_plants_bits)
{
    static struct plant rig;
    const struct plant_config c = {.model = &hertz_rig, .method = &rk4, .tick_s = 1e-3 / 64, .dilation = 1.0};
    struct contactplant *p = open_plant("hertz_rig");
    check_no_error("plant", plant_init(&rig, &c));
    check_hex("hash at the begin", contactplant_hash(p), plant_hash(&rig));
    int force = contactplant_find(p, CONTACTPLANT_INPUT, "force");
    check_int("input", force, RIG_FORCE);
    check_int("drive", contactplant_set_drive(p, force, 3.0, 225.0, 0.0, 0.1), CONTACTPLANT_OK);
    plant_drive(&rig, RIG_FORCE, 3.0, 225.0, 0.0, 0.1);
    check_int("advance", contactplant_advance(p, 64 * 500), CONTACTPLANT_OK);
    check_true("plant runs", plant_run(&rig, 64 * 500));
    check_hex("hash after 0.5 s", contactplant_hash(p), plant_hash(&rig));
    check_int("switches", (int64_t)contactplant_counter(p, CONTACTPLANT_SWITCHES), rig.counts.switches);
    check_is("contact was lost", rig.counts.switches, >, 0);
    check_near("time, s", contactplant_time(p), 0.5, 0.0);
    check_near("force, N", contactplant_output(p, contactplant_find(p, CONTACTPLANT_OUTPUT, "contact_force")),
               plant_read(&rig, "contact_force"), 0.0);
    check_near("energy, J", contactplant_energy(p), plant_energy(&rig), 0.0);
    check_near("residual, J", contactplant_residual(p), plant_residual(&rig), 0.0);
    check_int("sample", contactplant_set_sample(p, force, 2.0, 7), CONTACTPLANT_OK);
    check_int("noise", contactplant_set_noise(p, force, 0.5, 3, 42, 0.01), CONTACTPLANT_OK);
    check_int("parameter",
              contactplant_set_parameter(p, contactplant_find(p, CONTACTPLANT_PARAMETER, "mass_kg"), 5.0),
              CONTACTPLANT_OK);
    plant_sample(&rig, RIG_FORCE, 2.0, 7);
    plant_noise(&rig, RIG_FORCE, 0.5, 3, 42, 0.01);
    double si[MODEL_PARAMETERS];
    memcpy(si, rig.si, sizeof si);
    si[contactplant_find(p, CONTACTPLANT_PARAMETER, "mass_kg")] = 5.0;
    check_no_error("mass", plant_change(&rig, si));
    check_int("advance", contactplant_advance(p, 999), CONTACTPLANT_OK);
    check_true("plant runs", plant_run(&rig, 999));
    check_hex("hash after all of it", contactplant_hash(p), plant_hash(&rig));
    check_int("silence", contactplant_silence(p, 0.0), CONTACTPLANT_OK);
    plant_drives_to_zero(&rig, 0.0);
    check_int("advance", contactplant_advance(p, 64), CONTACTPLANT_OK);
    check_true("plant runs", plant_run(&rig, 64));
    check_hex("hash in silence", contactplant_hash(p), plant_hash(&rig));
    const double value[] = {2.0, -3.0, 0.0, 1.0};
    check_int("samples", contactplant_advance_samples(p, force, value, 4, 3), CONTACTPLANT_OK);
    check_int("no sample", contactplant_advance_samples(p, force, NULL, 0, 3), CONTACTPLANT_OK);
    for (int i = 0; i < 4; i++) {
        plant_sample(&rig, RIG_FORCE, value[i], 0);
        check_true("plant runs", plant_run(&rig, 3));
    }
    check_hex("hash after four samples of three ticks", contactplant_hash(p), plant_hash(&rig));
}

/* A scene alone, on a bus, and as the program runs it: the same begin and the same run; or the same
 * refusal. False: refused. */
static bool check_scene(const char *name)
{
    static struct scene_app inside;
    char why[SCENE_REASON] = "";
    struct contactplant *p = contactplant_open(&memory, sizeof memory, name, &error);
    struct contactplant *on_bus = contactplant_open_bus(&other, sizeof other, name, NULL);
    bool runs = scene_init(&inside, name, why) && scene_start(&inside, NULL, why);
    check_string(name, error.text, runs ? "" : why);
    check_true(name, (p != NULL) == runs && (on_bus != NULL) == runs);
    if (runs) {
        check_hex(name, contactplant_hash(p), plant_hash(&inside.app.plant));
        check_hex(name, contactplant_hash(on_bus), plant_hash(&inside.app.plant));
        check_int(name, contactplant_advance(p, 64), CONTACTPLANT_OK);
        check_true(name, plant_run(&inside.app.plant, 64));
        check_hex(name, contactplant_hash(p), plant_hash(&inside.app.plant));
    }
    scene_free(&inside);
    return runs;
}

TEST(library_opens_every_scene)
{
    int n = 0, run = 0;
    for (const char *name; (name = contactplant_scene_name(n)) != NULL; n++) {
        run += check_scene(name);
        check_true(name, *contactplant_scene_title(n) != '\0');
    }
    check_int("models and presets", n, MODELS + SCENES);
    check_is("all run but models that are too fast for 64 ticks a millisecond", run, >=, SCENES + 4);
    check_true("none before the first", !contactplant_scene_name(-1) && !contactplant_scene_title(n));
}

/* The name in a number's description finds it. */
static void check_kind(struct contactplant *p, enum contactplant_kind kind, int first)
{
    struct contactplant_number number;
    int n = contactplant_count(p, kind);
    for (int i = first; i < first + n; i++) {
        check_int("described", contactplant_describe(p, kind, i, &number), CONTACTPLANT_OK);
        check_int(number.name, contactplant_find(p, kind, number.name), i);
        check_true(number.name, *number.meaning && number.unit && number.min <= number.max);
    }
    check_int("one more", contactplant_describe(p, kind, first + n, &number), CONTACTPLANT_BAD_INDEX);
    check_int("one less", contactplant_describe(p, kind, first - 1, &number), CONTACTPLANT_BAD_INDEX);
}

TEST(library_names)
{
    for (int i = 0; i < MODELS; i++) {
        struct contactplant *p = contactplant_open(&memory, sizeof memory, model_table[i]->name, NULL);
        if (!p)
            continue; /* too fast for 64 ticks a millisecond */
        check_int("inputs", contactplant_count(p, CONTACTPLANT_INPUT), model_table[i]->n_inputs);
        check_kind(p, CONTACTPLANT_INPUT, 0);
        check_kind(p, CONTACTPLANT_OUTPUT, 0);
        check_kind(p, CONTACTPLANT_STATE, 0);
        check_kind(p, CONTACTPLANT_PARAMETER, 0);
        check_kind(p, CONTACTPLANT_SETTING, CONTACTPLANT_SETTING_FIRST);
    }
}

/* Half a tick is the method's own shorter step; whole ticks are the same bits however they are reached. */
TEST(library_advances_to_an_instant)
{
    struct contactplant *p = open_plant("rig");
    check_int("0.1 s", contactplant_advance_to(p, 0.1), CONTACTPLANT_OK);
    uint64_t hash = contactplant_hash(p), tick = contactplant_tick(p);
    double state = contactplant_state(p, 0);
    check_near("tick", (double)tick, 0.1 / contactplant_tick_time(p), 1e-9);
    p = open_plant("rig");
    for (uint64_t i = 1; i <= tick; i++)
        check_int("a tick", contactplant_advance_to(p, (double)i * contactplant_tick_time(p)),
                  CONTACTPLANT_OK);
    check_hex("tick by tick", contactplant_hash(p), hash);
    p = open_plant("rig");
    for (int i = 1; i <= 77; i++)
        check_int("a part", contactplant_advance_to(p, 0.1 * i / 77), CONTACTPLANT_OK);
    check_near("other steps, displacement in m", contactplant_state(p, 0), state, 1e-9 * fabs(state) + 1e-12);
    check_near("time, s", contactplant_time(p), 0.1, 1e-12);
}

/* Free fall onto the contact: the touchdown's instant and speed are the parabola's. No damping, the gap
 * opened by 10 um. */
TEST(library_tells_events)
{
    struct contactplant_event e;
    struct contactplant_number number;
    struct contactplant *p = open_plant("hertz_rig");
    double preload = contactplant_parameter(p, contactplant_find(p, CONTACTPLANT_PARAMETER, "preload_N"));
    double mass = contactplant_parameter(p, contactplant_find(p, CONTACTPLANT_PARAMETER, "mass_kg"));
    check_int(
        "no damping",
        contactplant_set_parameter(p, contactplant_find(p, CONTACTPLANT_PARAMETER, "damping_N_s_per_m"), 0.0),
        CONTACTPLANT_OK);
    check_int("state", contactplant_describe(p, CONTACTPLANT_STATE, 0, &number), CONTACTPLANT_OK);
    int penetration = contactplant_find(p, CONTACTPLANT_OUTPUT, "penetration");
    double here = contactplant_output(p, penetration), drop = 10e-6;
    double above[2] = {contactplant_state(p, 0), 0.0};
    above[0] -= here + drop;
    check_int("set", contactplant_set_state(p, above, 2), CONTACTPLANT_OK);
    check_int("nothing yet", contactplant_next_event(p, &e), 0);
    double fall = sqrt(2.0 * drop * mass / preload);
    check_int("0.9 of the fall", contactplant_advance_to(p, 0.9 * fall), CONTACTPLANT_OK);
    check_int("nothing yet", contactplant_next_event(p, &e), 0);
    check_int("1.1 of it", contactplant_advance_to(p, 1.1 * fall), CONTACTPLANT_OK);
    check_int("touchdown", contactplant_next_event(p, &e), 1);
    check_int("touches", e.touch, 1);
    check_near("instant, s", e.time_s, fall, 1e-9 * fall);
    check_near("speed, m/s", e.speed, preload / mass * fall, 1e-9);
    check_near("its tick", ((double)e.tick + e.fraction) * contactplant_tick_time(p), e.time_s, 1e-18);
    check_int("no more", contactplant_next_event(p, &e), 0);
    check_int("counted", (int64_t)contactplant_counter(p, CONTACTPLANT_SWITCHES), 1);
    check_int("none lost", (int64_t)contactplant_counter(p, CONTACTPLANT_EVENTS_LOST), 0);
}

TEST(library_reads_a_text)
{
    static const char text[] = "[plant]\nmodel = hertz_rig\nmass = 5 kg\n[drive force]\namplitude = 3 N\n"
                               "frequency = 225 Hz\n[deadline]\nframe = 500 us\nsubsteps = 32\n";
    struct contactplant *p = open_plant(text);
    check_near("mass, kg", contactplant_parameter(p, contactplant_find(p, CONTACTPLANT_PARAMETER, "mass_kg")),
               5.0, 0.0);
    check_int("substeps", contactplant_substeps(p), 32);
    check_near("tick, s", contactplant_tick_time(p), 500e-6 / 32, 0.0);
    check_int("advance", contactplant_advance(p, 32), CONTACTPLANT_OK);
    check_near("input now, N", contactplant_input(p, RIG_FORCE), 3.0 * cos(2.0 * acos(-1.0) * 225.0 * 500e-6),
               1e-12);
}
