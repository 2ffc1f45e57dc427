/* test_action.c - one reader of verbs: what send and the `at` lines of tests take, and what they refuse. */
#include "firmware/bus/wire.h"
#include "host_sim/live/action.h"
#include "models/hertz_rig.h"
#include "tests/unit/test.h"

#include <string.h>

static struct word word_of(const char *text)
{
    return (struct word){text, strlen(text)};
}

/* "" where the words are taken. */
static const char *read_text(enum action_verb verb, const char *words, struct action *a)
{
    static char why[SCENE_REASON];
    return action_read(&hertz_rig, verb, word_of(words), a, why) ? "" : why;
}

TEST(action_takes)
{
    struct action a;
    double field[DRIVE_FIELDS];
    check_string("arm", read_text(ACTION_ARM, "base amplitude=2 um frequency=0.2 kHz", &a), "");
    check_int("  input", a.input, RIG_BASE);
    action_fields(&a, field);
    check_near("  amplitude, m", field[DRIVE_AMPLITUDE], 2e-6, 1e-18);
    check_near("  frequency, Hz", field[DRIVE_FREQUENCY], 200.0, 1e-12);
    check_nan("  a field that is not given", field[DRIVE_PHASE]);
    check_string("stream with a unit", read_text(ACTION_STREAM, "force 2 kN", &a), "");
    check_near("  N", a.sample, 2000.0, 0.0);
    check_string("stream in SI", read_text(ACTION_STREAM, "force 2", &a), "");
    check_string("set", read_text(ACTION_SET, "mass=5 kg timeout_frames=100", &a), "");
    check_int("  how many", a.n, 2);
    check_near("  mass, kg", a.set[0].value, 5.0, 0.0);
    check_string("read", read_text(ACTION_READ, "mass", &a), "");
    check_int("  index", a.set[0].index, RIG_MASS);
    check_string("step", read_text(ACTION_STEP, "1e3", &a), "");
    check_int("  frames", (int64_t)a.argument, 1000);
    check_string("capture", read_text(ACTION_CAPTURE, "read 5 10", &a), "");
    check_true("  read", a.operation == CAPTURE_READ && a.first == 5 && a.count == 10);
    check_string("faults", read_text(ACTION_FAULTS, "drop=0.1", &a), "");
    check_string("  their list", a.text, "drop=0.1");
}

TEST(action_refuses)
{
    static const struct {
        enum action_verb verb;
        const char *words, *why;
    } bad[] = {
        {ACTION_START, "now", "start: write start alone"},
        {ACTION_STEP, "", "step: write step N"},
        {ACTION_STEP, "1.5", "step 1.5: give a number of frames, 1 to 4294967295"},
        {ACTION_RUN_UNTIL, "soon", "run-until soon: give a plant tick, a multiple of --substeps"},
        {ACTION_ARM, "force", "arm: write arm INPUT amplitude=5 N frequency=200 Hz, say"},
        {ACTION_ARM, "forse amplitude=1", "hertz_rig has no input \"forse\"; did you mean force?"},
        {ACTION_ARM, "force amplitude=1 m", "arm: amplitude: "},
        {ACTION_FIRE, "force", "fire: write fire alone"},
        {ACTION_FIRE_INPUT, "", "fire: write fire INPUT"},
        {ACTION_FIRE_INPUT, "force base", "a line for each input"},
        {ACTION_STREAM, "force", "stream: write stream INPUT VALUE"},
        {ACTION_SET, "mass", "write NAME=VALUE"},
        {ACTION_SET, "mas=1 kg", "did you mean mass?"},
        {ACTION_SET, "mass_kh=1", "did you mean mass_kg?"},
        {ACTION_READ, "mass damping", "read: write read NAME"},
        {ACTION_CAPTURE, "tirgger", "capture tirgger: no such operation; did you mean trigger?"},
        {ACTION_CAPTURE, "arm 1 2", "capture: write capture arm, trigger, stop, or read [FIRST COUNT]"},
        {ACTION_FAULTS, "", "faults: write faults drop=0.1, say, or faults none"},
    };
    struct action a;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        check_contains(bad[i].words, read_text(bad[i].verb, bad[i].words, &a), bad[i].why);
    char many[16 * (ACTION_SETS + 1)] = "";
    for (int i = 0; i <= ACTION_SETS; i++)
        strcat(many, "mass=5 kg ");
    check_string("one value too many", read_text(ACTION_SET, many, &a), "set: more than 32 values");
}

TEST(action_find)
{
    const unsigned test = 1u << ACTION_FIRE_INPUT | 1u << ACTION_SET,
                   send = 1u << ACTION_FIRE | 1u << ACTION_STOP;
    check_int("fire of a test", action_find(test, word_of("fire")), ACTION_FIRE_INPUT);
    check_int("fire of send", action_find(send, word_of("fire")), ACTION_FIRE);
    check_int("a verb that is not theirs", action_find(test, word_of("stop")), ACTION_VERBS);
}
