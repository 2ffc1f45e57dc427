/* test_scene_file.c - scene files: units to the last bit, each
 * mistake with its line and key, limits, both ways round. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/scene/scene.h"
#include "host_sim/scene/scene_file.h"
#include "host_sim/scene/scene_keys.h"
#include "host_sim/scene/scene_print.h"
#include "host_sim/cli/unit.h"
#include "models/hertz_rig.h"
#include "models/models.h"
#include "models/scenes/scenes_table.h"
#include "tests/fixture/silent_bus.h"

static char why[SCENE_FILE_REASON];

static bool parse(const char *text, struct scene *s)
{
    why[0] = 0;
    return scene_file_parse("a.ini", text, strlen(text), s, why);
}

/* ---- units ---- */

static const struct {
    const char *text, *unit;
    double value;
} read_well[] = {
    {"6.5 kg", "kg", 6.5},
    {"6.5kg", "kg", 6.5},
    {"1130 g", "kg", 1.13},
    {"11.3 ng", "kg", 11.3e-12},
    {"254 um", "m", 2.54e-4},
    {"2.54e-4 m", "m", 2.54e-4},
    {"2.54e2um", "m", 2.54e-4},
    {"260 fm", "m", 2.6e-13},
    {"30.09 kHz", "Hz", 30090.0},
    {"25.6 mN", "N", 0.0256},
    {"1.2 MN", "N", 1.2e6},
    {"3.4 GN/m^1.5", "N/m^1.5", 3.4e9},
    {"188  N \t s/m", "N s/m", 188.0},
    {"79161 N m/rad", "N m/rad", 79161.0},
    {"-.5 mm/s", "m/s", -5e-4},
    {"+5. ms", "s", 5e-3},
    {"0 us", "s", 0.0},
    {"1e-400 s", "s", 0.0},
    {"0.98", "", 0.98},
    {"64", "1", 64.0},
    {"0.1 rad", "rad", 0.1},
    {"125 kg/s", "N s/m", 125.0},
    {"125 g/s", "N s/m", 0.125},
    {"125 Ns/m", "N s/m", 125.0},
    {"125 mN  s/m", "N s/m", 0.125},
    {"180 deg", "rad", 3.14159265358979323846},
    {"90deg", "deg", 90.0},
    {"3000 rpm", "Hz", 50.0},
    {"12 nm/min", "m/s", 2e-10},
    {"3 V/min", "V/s", 0.05},
    {"2 min", "s", 120.0},
    {"5 %", "", 0.05},
    {"5%", "1", 0.05},
    {"5 %", "%", 5.0},
};

static const struct {
    const char *text, *unit, *reason;
} read_badly[] = {
    {"6.5", "kg", "the unit is missing; it is kg"},
    {"6.5 N", "kg", "\"N\" does not fit"},
    {"6.5 m", "kg", "does not fit"},
    {"6.5 kN", "Hz", "does not fit"},
    {"5 Min", "s", "did you mean min?"},
    {"5 h", "s", "does not fit"},
    {"6.5 KG", "kg", "did you mean kg?"},
    {"65 MG", "kg", "did you mean Mg?"},
    {"3 n", "N", "did you mean N?"},
    {"3 KN", "N", "did you mean kN?"},
    {"3 hz", "Hz", "did you mean Hz?"},
    {"1 MHZ", "Hz", "did you mean MHz?"},
    {"1 mM", "m", "did you mean mm?"},
    {"1 Kg/s", "N s/m", "did you mean kg/s?"},
    {"100 N/s", "N s/m", "does not fit"},
    {"6,5 kg", "kg", "write the decimal comma as a point, 6.5.."},
    {"0,5", "", "write the decimal comma as a point, 0.5.."},
    {"1,", "", "has no unit"},
    {"5 % %", "", "has no unit"},
    {"5 %", "kg", "does not fit"},
    {"5 rpm", "s", "does not fit"},
    {"5 nm/min", "m", "does not fit"},
    {"5 /min", "m/s", "does not fit"},
    {"5 nm/hour", "m/s", "does not fit"},
    {"5 mkHz", "Hz", "does not fit"},
    {"5 M", "m", "does not fit"},
    {"3 N/mm^1.5", "N/m^1.5", "does not fit"},
    {"3 N/m", "N/m^1.5", "does not fit"},
    {"3 degrees", "rad", "does not fit"},
    {"0x10 kg", "kg", "does not fit"},
    {"1 2 kg", "kg", "does not fit"},
    {"0.98 s", "", "has no unit"},
    {"0.98x", "", "not a finite number"},
    {"nan", "", "not a finite number"},
    {"inf kg", "kg", "not a finite number"},
    {"kg", "kg", "not a finite number"},
    {"1.2.3 kg", "kg", "not a finite number"},
    {"- kg", "kg", "not a finite number"},
    {"1e999 kg", "kg", "too large"},
    {"1e99999999999999999999 kg", "kg", "too large"},
    {"11111111111111111111111111111111111111111 kg", "kg", "more than 40 digits"},
};

TEST(scene_units)
{
    char reason[UNIT_REASON];
    for (size_t i = 0; i < sizeof read_well / sizeof read_well[0]; i++) {
        double value = -1.0;
        bool good =
            unit_read(read_well[i].text, strlen(read_well[i].text), read_well[i].unit, &value, reason);
        check_near(read_well[i].text, good ? value : -1.0, read_well[i].value, 0.0);
    }
    for (size_t i = 0; i < sizeof read_badly / sizeof read_badly[0]; i++) {
        double value = -1.0;
        bool good =
            unit_read(read_badly[i].text, strlen(read_badly[i].text), read_badly[i].unit, &value, reason);
        check_true(read_badly[i].text, !good && strstr(reason, read_badly[i].reason));
    }
    double zero = 1.0; /* silence has one form, as what is silent is not printed */
    check_true("-0 N is 0, without a sign", unit_read("-0 N", 4, "N", &zero, reason));
    check_is("-0 N is 0, without a sign", zero, ==, 0.0);
    check_true("-0 N is 0, without a sign", !signbit(zero));
}

/* Random doubles over all exponents, and round ones. */
TEST(scene_unit_round_trip)
{
    static const char *const unit[] = {"m", "s", "N", "Hz", "kg", "N/m^1.5", "", "rad"};
    uint64_t word = 1;
    int bad = 0;
    for (int i = 0; i < 20000; i++) {
        char text[UNIT_TEXT], reason[UNIT_REASON];
        double value, again;
        word = word * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        uint64_t bits = i % 2 ? word ^ (word >> 29) : word & UINT64_C(0xFFFFF00000000000);
        bits = (bits & UINT64_C(0x800FFFFFFFFFFFFF)) | ((823 + (bits >> 20) % 400) << 52); /* 1e-60 to 1e60 */
        memcpy(&value, &bits, sizeof value);
        unit_write(value, unit[i % 8], text);
        bool good = unit_read(text, strlen(text), unit[i % 8], &again, reason);
        bad += !good || memcmp(&value, &again, sizeof value) != 0;
    }
    check_int("numbers that did not read back, of 20000", bad, 0);
    char text[UNIT_TEXT];
    unit_write(2.54e-4, "m", text);
    check_string("2.54e-4 m", text, "254 um");
    unit_write(20.0, "N", text);
    check_string("20 N", text, "20 N");
    unit_write(-0.0015, "N", text);
    check_string("-0.0015 N", text, "-1.5 mN");
    unit_write(0.98, "", text);
    check_string("0.98", text, "0.98");
}

/* ---- mistakes ---- */

#define RIG     "[plant]\nmodel = hertz_rig\n"
#define PAPER   RIG "[paper]\nxi = 0.01\n"
#define REDUCED "[plant]\nmodel = hertz_rig_linear\n"
#define WATCH   REDUCED "[watch]\nbelow = 0 m\n"

static const struct {
    const char *text, *reason;
} mistake[] = {
    {"", "a.ini: no model"},
    {"[ask]\nover = 1 s\n", "a.ini: no model"},
    {"model = hertz_rig\n", "a.ini:1: model: stands before the first section"},
    {"[plnt]\n", "a.ini:1: [plnt]: no such section; did you mean plant?"},
    {"\n\n[plant\n", "a.ini:3: [plant: the bracket ]"},
    {"[plant]\nmodel\n", "a.ini:2: \"model\": write KEY = VALUE"},
    {"[plant]\nmodel =\n", "a.ini:2: \"model =\": the value is missing"},
    {"[plant]\n= 3\n", "a.ini:2: \"= 3\": the key is missing"},
    {"[plant]\nmodel = # hertz_rig\n", "a.ini:2: \"model =\": the value is missing"},
    {"[plant]\nmodel = hertz_rog\n", "a.ini:2: model: no model \"hertz_rog\"; did you mean hertz_rig?"},
    {"[plant]\nmodel = zzz\n", "a.ini:2: model: no model \"zzz\"; there are hertz_rig, "},
    {RIG "[plant]\n", "a.ini:3: [plant] stands there already, in line 1"},
    {RIG "[drive]\n", "a.ini:3: [drive]: which input?"},
    {RIG "[ask me]\n", "a.ini:3: [ask]: one word too many"},
    {RIG "[drive forse]\n", "a.ini:3: [drive forse]: hertz_rig has no such input; did you mean force?"},
    {RIG "[drive force]\n[drive base]\n[drive force]\n",
     "a.ini:5: [drive force] stands there already, in line 3"},
    {RIG "mas = 3 kg\n", "a.ini:3: mas: no such key in [plant] of hertz_rig; did you mean mass?"},
    {RIG "quux = 3 kg\n", "there are model, method, mass, stiffness, preload, damping"},
    {RIG "mass = 3\n", "a.ini:3: mass: the unit is missing; it is kg; 1e-09 to 1e+06 kg is allowed"},
    {RIG "mass = 3 N\n", "a.ini:3: mass: the unit \"N\" does not fit; give kg, g, mg"},
    {RIG "mass = 0 kg\n", "a.ini:3: mass: 0 kg is out of range; give 1e-09 to 1e+06 kg"},
    {RIG "mass = 3 kg\nmass = 3 kg\n", "a.ini:4: mass: set in line 3 already"},
    {RIG "mass = 3 kg\nmass_kg = 4 kg\n", "a.ini:4: mass: set in line 3 already"},
    {RIG "model = hertz_rig\n", "a.ini:3: model: set in line 2 already"},
    {RIG "method = taylr\n", "a.ini:3: method: no method \"taylr\"; did you mean taylor?"},
    {RIG "method = RK4\n", "a.ini:3: method: no method \"RK4\"; did you mean rk4?"},
    {RIG "[ask]\nobservable = force\n",
     "a.ini:4: observable: no observable \"force\"; did you mean contact_force?"},
    {"[plant]\nmodel = rig\n",
     "a.ini:2: model: rig is a preset, of which contactplant scene rig prints the file"},
    {RIG "mass = 6.5 KG\n", "a.ini:3: mass: the unit \"KG\" does not fit; did you mean kg?"},
    {RIG "mass = 6,5 kg\n", "a.ini:3: mass: \"6,5 kg\": write the decimal comma as a point, 6.5"},
    {RIG "method = exact\n", "a.ini:3: method: exact is for piecewise linear"},
    {RIG "method = rk4\n[deadline]\nsubsteps = 2\n", "a.ini:3: method: step too coarse for rk4"},
    {RIG "method = taylor\n[ask]\ntolerance = 1e-14\n", "a.ini:5: tolerance: taylor: tolerance outside"},
    {RIG "damping = 1e6 N s/m\n", "a.ini:2: model: overdamped"},
    {RIG "[ask]\nobservable = depth\n",
     "a.ini:4: observable: no observable \"depth\"; there are displacement, "},
    {RIG "[ask]\nover = 0 s\n", "a.ini:4: over: 0 s is out of range; give 1e-12 to 1e+12 s"},
    {RIG "[ask]\nover = 1e9 s\n", "a.ini:4: over: more than 1e8 frames; give at most 100000"},
    {RIG "[ask]\ntolerance = 1\n", "a.ini:4: tolerance: 1 is out of range; give 1e-15 to 0.1"},
    {RIG "[deadline]\nframe = 1 Hz\n", "a.ini:4: frame: the unit \"Hz\" does not fit"},
    {RIG "[deadline]\nsubsteps = 1.5\n", "a.ini:4: substeps: 1.5 is not a whole number"},
    {RIG "[deadline]\ncost = 20 us\n",
     "a.ini:4: cost: 64 steps of 20 us take longer than the frame of 1000 us"},
    {RIG "[drive force]\namplitude = 1 um\n", "a.ini:4: amplitude: the unit \"um\" does not fit; give N"},
    {RIG "[drive base]\namplitude = 1 N\n", "a.ini:4: amplitude: the unit \"N\" does not fit; give m"},
    {RIG "[drive stiffness]\namplitude = 1e10\n",
     "a.ini:4: amplitude: the drive of stiffness is more than a plant takes"},
    {RIG "[drive force]\namplitude = 1 N\nfrequency = 16001 Hz\n",
     "a.ini:5: frequency: fewer than 4 steps in a period of the drive of force; 65 substeps would do"},
    {RIG "[drive force]\nnoise = 1 N\nnoise_hold = 20 us\n",
     "a.ini:5: noise_hold: not a whole number of steps"},
    {RIG "[drive force]\nnoise = 1 N\nnoise_hold = 2 s\n",
     "a.ini:5: noise_hold: not a whole number of steps"},
    {RIG "[drive force]\nnoise_seed = -1\n", "a.ini:4: noise_seed: -1 is out of range"},
    {RIG "[start]\nposition = 1 um\n", "a.ini:3: velocity: missing in [start]"},
    {RIG "[start]\n", "a.ini:3: position: missing in [start]"},
    {RIG "[start]\nposition = 1e9 m\nvelocity = 0 m/s\n", "a.ini:4: position: more than 1e12"},
    {RIG "mass = 3 kg\n[paper]\nxi = 0.1\n",
     "a.ini:3: mass: [plant] has model and method only beside [paper]"},
    {PAPER "[drive force]\namplitude = 1\n", "a.ini:6: amplitude: contradicts [paper]"},
    {PAPER "[drive base]\nnoise = 1\n", "a.ini:6: noise: noise of a length needs a scene in SI"},
    {PAPER "[ask]\nover = 1 s\n", "a.ini:6: over: \"s\" behind the number; this one has no unit"},
    {PAPER "xj = 1\n", "a.ini:5: xj: no such key in [paper] of hertz_rig; did you mean xi?"},
    {PAPER "omega = 1001\n", "a.ini:5: omega: 1001 is out of range; give 0 to 1000"},
    {PAPER "sigma = 1\nomega = 1000\n[deadline]\nframe = 1 s\n",
     "a.ini:2: model: fewer than 4 steps in a period of the drive of force"},
    {"[plant]\nmodel = afm_tip\n[paper]\nbeta = 2\n",
     "a.ini:2: model: Kirrou & Belhaq 2013 leave their range (29.7 in section 3.3): beta"},
    {"[plant]\nmodel = hertz_rig_averaged\nfast_force = 1 N\nfast_base = 1 um\n",
     "a.ini:2: model: averaged over one fast drive only"},
    {REDUCED "[watch]\n", "a.ini:3: [watch]: no limit; give above, below or both"},
    {REDUCED "[watch]\npromote = hertz_rig\n", "a.ini:3: [watch]: no limit"},
    {REDUCED "[watch]\nobservable = depth\nbelow = 0 m\n",
     "a.ini:4: observable: no observable \"depth\"; there are displacement, velocity, penetration, "
     "contact_force, position, drive_frequency, time, changes, eigenfrequency"},
    {REDUCED "[watch]\nobservable = eigenfrequenzy\nabove = 1 kHz\n",
     "a.ini:4: observable: no observable \"eigenfrequenzy\"; did you mean eigenfrequency?"},
    {REDUCED "[watch]\nobservable = eigenfrequency\nabove = 1 um\n",
     "a.ini:5: above: the unit \"um\" does not fit; give Hz"},
    {RIG "[watch]\nobservable = eigenfrequency\nabove = 200 Hz\n",
     "a.ini:5: above: eigenfrequency starts with 229.932 Hz, outside"},
    {"[plant]\nmodel = afm_tip_linear\n[paper]\nbeta = 0.5\n[watch]\nobservable = eigenfrequency\nabove = "
     "0.7\n",
     "a.ini:7: above: eigenfrequency starts with 0.707107, outside"},
    {RIG "[watch]\nobservable = change\nabove = 0\n",
     "a.ini:4: observable: no observable \"change\"; did you mean changes?"},
    {RIG "[watch]\nobservable = changes\nabove = 0 Hz\n",
     "a.ini:5: above: \"Hz\" behind the number; this one has no unit"},
    {RIG "[watch]\nobservable = changes\nabove = -1\n",
     "a.ini:5: above: changes starts with 0, outside; begin inside"},
    {RIG "[watch]\nobservable = drive_frequency\nabove = 1 um\n",
     "a.ini:5: above: the unit \"um\" does not fit; give Hz"},
    {RIG "[drive force]\namplitude = 1 N\nfrequency = 90 Hz\n[watch]\nobservable = drive_frequency\n"
         "above = 80 Hz\n",
     "a.ini:8: above: drive_frequency starts with 90 Hz, outside; begin inside"},
    {RIG "[ask]\nobservable = changes\n", "a.ini:4: observable: no observable \"changes\""},
    {RIG "[ask]\nobservable = eigenfrequency\n", "a.ini:4: observable: no observable \"eigenfrequency\""},
    {REDUCED "[watch]\nbelow = 0 N\n", "a.ini:4: below: the unit \"N\" does not fit; give m"},
    {REDUCED "[watch]\nbelow = 0 m\nobservable = contact_force\n",
     "a.ini:4: below: the unit \"m\" does not fit; give N"},
    {REDUCED "[watch]\nover = 0 m\n", "a.ini:4: over: no such key in [watch] of hertz_rig_linear"},
    {WATCH "below = 1 um\n", "a.ini:5: below: set in line 4 already"},
    {WATCH "[watch]\n", "a.ini:5: [watch] stands there already, in line 3"},
    {WATCH "above = -1 um\n", "a.ini:4: below: not less than above"},
    {REDUCED "[watch]\nbelow = 1 mm\n",
     "a.ini:4: below: penetration starts with 7.07621e-06 m, outside; begin inside"},
    {WATCH "above = 1 um\n", "a.ini:5: above: penetration starts with 7.07621e-06 m, outside"},
    {WATCH "above = 1 mm\n[start]\nposition = -1 um\nvelocity = 0 m/s\n",
     "a.ini:4: below: penetration starts with -1e-06 m, outside"},
    {WATCH "promote = hertz_rog\n", "a.ini:5: promote: no model \"hertz_rog\"; did you mean hertz_rig?"},
    {WATCH "promote = rolling_contact\n",
     "a.ini:5: promote: not the full model that this reduced model stands for"},
    {WATCH "promote = hertz_rig_cubic\n",
     "a.ini:5: promote: not the full model that this reduced model stands for"},
    {RIG "[watch]\nbelow = 0 m\npromote = hertz_rig\n", "a.ini:5: promote: this is a full model already"},
    {"[plant]\nmodel = hertz_rig_averaged\n[watch]\nbelow = 0 m\npromote = hertz_rig\n",
     "a.ini:5: promote: an averaged model cannot climb: its state is the slow motion"},
    {REDUCED "method = exact\n[watch]\nbelow = 0 m\npromote = hertz_rig\n",
     "a.ini:6: promote: exact is for piecewise linear"},
    {"[plant]\nmodel = shaft_bearing_mode\nmethod = rk4\n[deadline]\nsubsteps = 32\n[watch]\n"
     "above = 1 um\npromote = shaft_bearing\n",
     "a.ini:8: promote: step too coarse for rk4"},
    {"[plant]\nmodel = afm_tip_linear\n[paper]\nbeta = 0.5\n[watch]\nabove = 2 m\n",
     "a.ini:6: above: \"m\" behind the number; this one has no unit"},
};

#define STAGE RIG "[stage force]\nresonance = 0.8 kHz\n"

/* Mistakes in stages: the line and what to do. */
static const struct {
    const char *text, *reason;
} stage_mistake[] = {
    {RIG "[stage]\n", "a.ini:3: [stage]: which signal? write [stage INPUT] or [stage OUTPUT]"},
    {RIG "[stage forces]\n", "a.ini:3: [stage forces]: hertz_rig has no such signal; did you mean force?"},
    {STAGE "damping_ratio = 0\n", "a.ini:3: [stage force]: a resonance has 1e-6 to 1e9 Hz"},
    {STAGE "damping_ratio = 2\n", "a.ini:5: damping_ratio: 2 is out of range; give 0 to 1"},
    {STAGE "clop = 3 N\n", "a.ini:5: clop: no such key in [stage] of hertz_rig; did you mean clip?"},
    {STAGE "clip = 3 m\n", "a.ini:5: clip: the unit \"m\" does not fit; give N"},
    {STAGE "delay = 511 ticks\n", "a.ini:5: delay: 511 ticks is out of range; give 0 to 510 ticks"},
    {STAGE "resonance = 3 Hz\n", "a.ini:5: resonance: set in line 4 already; keep one"},
    {STAGE "[stage force]\n", "a.ini:5: [stage force] stands there already, in line 3"},
    {STAGE "[stage base]\n[stage velocity]\n[stage penetration]\n[stage contact_force]\n",
     "a.ini:8: [stage contact_force]: a scene has at most 4 stages"},
    {RIG "[stage force]\npreset = piezo_tube\n",
     "a.ini:4: preset: those are for lengths, and force has the unit N"},
    {RIG "[stage base]\npreset = piezo_tub\n",
     "a.ini:4: preset: no preset of a stage is called \"piezo_tub\"; did you mean piezo_tube?"},
    {RIG "[stage base]\nlag = 1 Hz\npreset = piezo_tube\n", "a.ini:5: preset: it stands first in its stage"},
};

TEST(scene_stage_mistakes)
{
    for (size_t i = 0; i < sizeof stage_mistake / sizeof stage_mistake[0]; i++) {
        struct scene s;
        check_true("refused", !parse(stage_mistake[i].text, &s));
        check_contains("reason", why, stage_mistake[i].reason);
    }
}

TEST(scene_mistakes)
{
    for (size_t i = 0; i < sizeof mistake / sizeof mistake[0]; i++) {
        struct scene s, before;
        memset(&s, 0x55, sizeof s);
        before = s;
        bool good = parse(mistake[i].text, &s);
        bool said = !good && strstr(why, mistake[i].reason);
        if (!said)
            printf("      said: %s\n", why);
        check_true(mistake[i].reason, said && !strchr(why, '\n') && !memcmp(&s, &before, sizeof s));
    }
}

/* ---- limits ---- */

static char big[SCENE_FILE_BYTES + 2];

static bool parse_bytes(size_t n)
{
    struct scene s;
    return scene_file_parse("a.ini", big, n, &s, why);
}

static size_t put(const char *text)
{
    memcpy(big, text, strlen(text));
    return strlen(text);
}

TEST(scene_limits)
{
    size_t n = put(RIG);
    memset(big + n, '\n', sizeof big - n);
    check_true("as many bytes as are allowed", parse_bytes(SCENE_FILE_BYTES));
    check_true("one more", !parse_bytes(SCENE_FILE_BYTES + 1));
    check_string("  is said", why, "a.ini: larger than 65536 bytes: not a scene");

    memset(big + n, '#', SCENE_FILE_LINE);
    check_true("the longest line", parse_bytes(n + SCENE_FILE_LINE));
    memset(big + n, '#', SCENE_FILE_LINE + 1);
    check_true("one more", !parse_bytes(n + SCENE_FILE_LINE + 1));
    check_string("  is said", why, "a.ini:3: longer than 255 characters");

    check_true("CRLF", parse_bytes(put("[plant]\r\nmodel = hertz_rig\r\n")));
    check_true("no end of line", parse_bytes(put("[plant]\nmodel = hertz_rig")));
    check_true("comments and blanks", parse_bytes(put("; a\n # b\n[ plant ]\n\tmodel=hertz_rig;c\n")));
    for (int byte = 0; byte < 256; byte++) {
        n = put(RIG "# x");
        big[n - 1] = (char)byte;
        bool plain = (byte >= ' ' && byte <= '~') || byte == '\t' || byte == '\r' || byte == '\n';
        if (parse_bytes(n) != plain)
            check_int("byte in a comment, refused or taken wrongly", byte, -1);
    }
    check_true("a null byte is refused",
               !scene_file_parse("a.ini", RIG, sizeof RIG, &(struct scene){0}, why));
    check_string("  is said", why,
                 "a.ini:3: byte 0x00: a scene is text in UTF-8 without control characters; save it so");
    check_true("a byte order mark, a comment in UTF-8, and a unit with each micro",
               parse_bytes(put("\xEF\xBB\xBF" RIG "# µ ü\n[ask]\nover = 2e6 µs\ntolerance = 1e-3")) &&
                   parse_bytes(put(RIG "[ask]\nover = 2e6 μs")));
    check_true("  but a control of two bytes", !parse_bytes(put(RIG "# \xC2\x9B")));
    n = put(RIG);
    memset(big + n, '#', SCENE_FILE_LINE);
    memcpy(big + n + SCENE_FILE_LINE - 1, "ü", 2); /* begins as the last byte that a line may have */
    check_true("one byte more than a line", !parse_bytes(n + SCENE_FILE_LINE + 1));
    check_string("  is said", why, "a.ini:3: longer than 255 characters");

    n = put(RIG "[ask]\n");
    for (int i = 3; i < SCENE_FILE_KEYS; i++)
        n += (size_t)sprintf(big + n, "k = 1\n");
    check_true("as many keys as are allowed, all wrong", !parse_bytes(n));
    check_contains("  the key is said", why, "a.ini:4: k: no such key");
    n += (size_t)sprintf(big + n, "k = 1\n");
    check_true("one more", !parse_bytes(n));
    check_string("  is said", why, "a.ini:129: more than 128 lines with a key or section");

    static char name[1000];
    memset(name, 'n', sizeof name - 1);
    check_true("a long file name", !scene_file_parse(name, "", 0, &(struct scene){0}, why));
    check_below("  length of the line", (double)strlen(why), SCENE_FILE_REASON - 1);
}

/* ---- both ways ---- */

/* The text of a scene. */
static size_t print_scene(const struct scene *s)
{
    FILE *f = fmemopen(big, sizeof big, "w");
    if (!f)
        return 0;
    scene_print(f, "title", s);
    long n = ftell(f);
    (void)fclose(f);
    return n > 0 ? (size_t)n : 0;
}

#define SAME(member) (memcmp(&a->member, &b->member, sizeof a->member) == 0)

static bool equal_drive(const struct scene_drive *a, const struct scene_drive *b)
{
    return SAME(amplitude) && SAME(frequency_Hz) && SAME(phase_rad) && SAME(noise) && SAME(noise_hold) &&
           SAME(noise_seed);
}

/* Member by member, for there is padding between them. */
static bool equal(const struct scene *a, const struct scene *b)
{
    bool same = SAME(model) && !strcmp(a->method, b->method) && SAME(paper) && SAME(started) && SAME(value) &&
                SAME(start) && SAME(observable) && SAME(over) && SAME(tolerance) && SAME(frame_s) &&
                SAME(substeps) && SAME(dilation) && SAME(cost_s) && SAME(watch.on) &&
                SAME(watch.observable) && SAME(watch.above) && SAME(watch.below) && SAME(watch.promote) &&
                SAME(stage);
    for (int i = 0; i < MODEL_INPUTS; i++)
        same = same && equal_drive(&a->drive[i], &b->drive[i]);
    return same;
}

static bool goes_round(const struct scene *s)
{
    struct scene again;
    size_t n = print_scene(s);
    bool good = scene_file_parse("a.ini", big, n, &again, why) && equal(s, &again);
    if (!good)
        printf("      %s\n%.*s", why, (int)n, big);
    return good;
}

TEST(scene_round_trip)
{
    struct scene s;
    for (int i = 0; i < SCENES; i++)
        check_true(scenes_table[i].name, goes_round(&scenes_table[i].scene));
    for (int i = 0; i < MODELS; i++) {
        scenes_default(&s, model_table[i]);
        check_true(model_table[i]->name, goes_round(&s));
    }
    check_true("every key", parse(RIG "method = rk4\nmass = 7 kg\nstiffness = 3 GN/m^1.5\npreload = 60 N\n"
                                      "damping = 100 N s/m\n[drive force]\namplitude = -1 N\n"
                                      "frequency = 100 Hz\nphase = 1 rad\nnoise = 2 mN\n"
                                      "noise_hold = 62.5 us\nnoise_seed = 4294967295\n[drive base]\n"
                                      "noise = 3 nm\n[start]\nposition = 7 um\nvelocity = -1 mm/s\n"
                                      "[ask]\nobservable = contact_force\nover = 3 s\ntolerance = 1e-6\n"
                                      "[deadline]\nframe = 2 ms\nsubsteps = 128\ndilation = 0.5\n"
                                      "cost = 3 us\n",
                                  &s));
    check_true("  goes round", goes_round(&s));
    check_near("  frequency", s.drive[RIG_FORCE].frequency_Hz, 100.0, 0.0);
    check_near("  noise of the base", s.drive[RIG_BASE].noise, 3e-9, 0.0);
    check_near("  noise_seed", s.drive[RIG_FORCE].noise_seed, 4294967295.0, 0.0);
    check_near("  stiffness", s.value[RIG_CONTACT_STIFFNESS], 3e9, 0.0);
    check_near("  velocity", s.start[1], -1e-3, 0.0);
    check_near("  observable", s.observable, 3.0, 0.0);
    check_near("  cost", s.cost_s, 3e-6, 0.0);
    check_near("  nothing is watched", s.watch.on, 0.0, 0.0);
}

/* Stages keep their numbers, become settings of the app, and stand in the plant that runs. */
TEST(scene_stages)
{
    static struct scene_app app;
    char reason[SCENE_REASON];
    struct scene *s = &app.scene;
    check_true("in any order",
               parse(RIG "[stage velocity]\nnoise_density = 300 nm/s/sqrt(Hz)\ndelay = 2.5 ticks\n"
                         "[stage force]\nslew = 2 MN/s\nresonance = 0.8 kHz\ncreep_per_decade = 0.01\n",
                     s));
    check_true("  goes round", goes_round(s));
    app.origin = SCENE_OF_FILE;
    scene_app_configure(&app);
    const double *sensor = &app.setting[SET_STAGE], *actuator = sensor + STAGE_SETTINGS;
    check_near("output 1", sensor[STAGE_AT], 6.0, 0.0);
    check_near("density", sensor[STAGE_SET_NOISE], 3e-7, 0.0);
    check_near("delay", sensor[STAGE_SET_DELAY], 2.5, 0.0);
    check_near("input 0", actuator[STAGE_AT], 1.0, 0.0);
    check_near("slew", actuator[STAGE_SET_SLEW], 2e6, 0.0);
    check_near("resonance", actuator[STAGE_SET_RESONANCE], 800.0, 0.0);
    check_near("default", actuator[STAGE_SET_DAMPING], 0.05, 0.0);
    check_near("no third one", actuator[STAGE_SETTINGS], 0.0, 0.0);
    check_true("the plant has them", scene_start(&app, &silent_bus, reason) && app.app.plant.staged);
    scene_free(&app);
}

TEST(scene_watch)
{
    struct scene s;
    check_true("limits before what they limit",
               parse(REDUCED "[watch]\nbelow = 1 N\nabove = 1 kN\n"
                             "promote = hertz_rig\nobservable = contact_force\n",
                     &s));
    check_true("  goes round", goes_round(&s));
    check_is("  as it was given", s.watch.on, >, 0.0);
    check_true("  as it was given", s.watch.promote == &hertz_rig);
    check_near("  observable", s.watch.observable, 3.0, 0.0);
    check_near("  below", s.watch.below, 1.0, 0.0);
    check_near("  above", s.watch.above, 1000.0, 0.0);
    check_true("one limit, penetration", parse(WATCH, &s));
    check_true("  goes round", goes_round(&s));
    check_near("  observable", s.watch.observable, 2.0, 0.0);
    check_is("  no other limit", s.watch.above, >=, SCENE_UNBOUNDED);
    check_true("  no other limit", !s.watch.promote);
    check_true("a state", parse(REDUCED "[watch]\nobservable = position\nabove = 8 um\n", &s));
    check_true("  goes round", goes_round(&s));
    check_near("  behind the outputs", s.watch.observable, 4.0, 0.0);
    check_true("a paper's, without unit",
               parse("[plant]\nmodel = afm_tip_cubic\n[paper]\nbeta = 0.5\n[watch]\nbelow = 0.5\n", &s));
    check_true("  goes round", goes_round(&s));
    check_true("the eigenfrequency",
               parse(RIG "[watch]\nobservable = eigenfrequency\nabove = 0.868 kHz\n", &s) && goes_round(&s));
    check_near("  observable", s.watch.observable, MODEL_EIGENFREQUENCY, 0.0);
    check_near("  above", s.watch.above, 868.0, 0.0);
    check_true(
        "  a shaft's",
        parse("[plant]\nmodel = shaft_bearing\n[watch]\nobservable = eigenfrequency\nabove = 1 MHz\n", &s) &&
            goes_round(&s));
    check_near("  observable", s.watch.observable, MODEL_EIGENFREQUENCY, 0.0);
    check_true("changes", parse(RIG "[watch]\nobservable = changes\nabove = 0\n", &s) && goes_round(&s));
    check_near("  observable", s.watch.observable, MODEL_CHANGES, 0.0);
    check_true("the drives' frequency",
               parse(RIG "[watch]\nobservable = drive_frequency\nabove = 0.3 kHz\n", &s) && goes_round(&s));
    check_near("  observable", s.watch.observable, MODEL_DRIVE_FREQUENCY, 0.0);
    check_near("  above", s.watch.above, 300.0, 0.0);
    check_true("any model may be watched", parse(RIG "[watch]\nabove = 8 um\n", &s) && goes_round(&s));
}

/* ---- garbage ---- */

/* Printed presets with random bytes changed, cut, doubled:
 * a scene that is sound, or one line that says why not. */
TEST(scene_garbage)
{
    static const char bytes[] = "[]=#;. \t\n\r-+eE0123456789kmnN/^abz\x01\xff";
    uint64_t word = 7;
    int taken = 0, refused = 0, bad = 0;
    struct scene watched;
    check_true("a watched scene", parse(WATCH "promote = hertz_rig\n", &watched));
    for (int i = 0; i < 20000; i++) {
        struct scene s;
        size_t n = print_scene(i % 5 ? &scenes_table[i % SCENES].scene : &watched);
        for (int k = 0; k <= i % 4; k++) {
            word = word * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            size_t at = (size_t)(word >> 33) % n;
            if (i % 3 == 0)
                n = at + 1;
            else
                big[at] = bytes[(word >> 20) % (sizeof bytes - 1)];
        }
        memset(why, 0, sizeof why);
        if (scene_file_parse("a.ini", big, n, &s, why)) {
            taken++;
            bad += !goes_round(&s);
        } else {
            refused++;
            bad += strncmp(why, "a.ini:", 6) != 0 || strchr(why, '\n') != NULL || strlen(why) < 12;
        }
    }
    check_int("neither a scene that goes round nor one line", bad, 0);
    check_above("scenes taken (changes in comments, digits)", taken, 1000);
    check_above("scenes refused", refused, 1000);
}

/* A preset of a scene is the chain that the reference says: equal bits
 * of a piezo, equal numbers of a photodiode in metres. */
TEST(scene_stage_presets)
{
    static const struct stage_part tube[] = {{STAGE_SLEW, 5e-3, 0.0},
                                             {STAGE_HYSTERESIS, 5e-6, 0.15},
                                             {STAGE_CREEP, 0.015, 0.0},
                                             {STAGE_RESONANCE, 5e3, 0.05}};
    static struct stage chain, own;
    struct scene s;
    double tick_s = 1e-6;
    check_true("read",
               parse("[plant]\nmodel = afm_lever\n[stage z]\npreset = piezo_tube\n[stage deflection]\n"
                     "preset = photodiode\nclip = 300 nm\n",
                     &s));
    check_no_error("chain", stage_init(&chain, tick_s, 0, tube, 4));
    check_no_error("settings", stages_build(&own, tick_s, 0.0, 0, s.stage[0]));
    double largest = 0.0;
    for (int i = 0; i < 5000; i++) {
        double u = i < 100 ? 1e-6 : 2e-6 * (i % 1000) / 1000.0, a = stage_run(&chain, u),
               b = stage_run(&own, u);
        largest = fabs(a - b) > largest ? fabs(a - b) : largest;
    }
    check_near("piezo_tube, difference", largest, 0.0, 0.0);
    check_near("photodiode: noise", s.stage[1][STAGE_SET_NOISE], 100e-15, 1e-27);
    check_near("  lag", s.stage[1][STAGE_SET_LAG], 2e6, 0.0);
    check_near("  quantum, 16 bits over +-500 nm", s.stage[1][STAGE_SET_QUANTUM], 1e-6 / 65536.0, 1e-24);
    check_near("  clip, changed by a key behind it", s.stage[1][STAGE_SET_CLIP], 300e-9, 1e-21);
    check_near("  gain", s.stage[1][STAGE_SET_GAIN], 1.0, 0.0);
}
