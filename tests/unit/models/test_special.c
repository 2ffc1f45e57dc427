/* test_special.c - NaN, infinities, subnormals and huge values in every field of every message, in every
 * parameter, setting and scene: what is no number never gets in, is counted and changes nothing. The fields
 * are those of the wire's own table. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/bus/wire_table.h"
#include "firmware/plant/plant_change.h"
#include "host_sim/scene/scene_file.h"
#include "host_sim/scene/scene_print.h"
#include "models/models.h"
#include "models/scenes/scenes_table.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { FLOAT_BITS = 32 };

static const double special[] = {(double)NAN, (double)INFINITY, -(double)INFINITY, DBL_MAX, -DBL_MAX, 1e39,
                                 -1e39,       5e-324,           -5e-324,           1e-310,  1e-40,    -1e-40};
enum { SPECIALS = sizeof special / sizeof special[0] };

static uint64_t raw_of(const struct frame *f, const struct field *d)
{
    uint64_t word = 0;
    for (int i = 0; i < FRAME_DATA; i++)
        word |= (uint64_t)f->data[i] << (8 * i);
    return word >> d->start & (((uint64_t)1 << d->bits) - 1);
}

/* ---- telemetry and commands encoded ---- */

static uint64_t float_raw(double x)
{
    float narrow = isnan(x) ? NAN : fabs(x) > (double)FLT_MAX ? (x < 0.0 ? -INFINITY : INFINITY) : (float)x;
    uint32_t bits;
    memcpy(&bits, &narrow, sizeof bits);
    return bits;
}

/* docs/reference/protocol.md: a float as it is; an unsigned field holds at its ends; a signed one has a code
 * for "not available", which an angle has not. Nothing here is as large as one unit, or it is out of every
 * range. */
static uint64_t expected_raw(const struct field *d, double x)
{
    uint64_t max = ((uint64_t)1 << d->bits) - 1;
    bool huge = fabs(x) > 1.0;
    if (d->kind == FIELD_FLOAT)
        return float_raw(x);
    if (d->kind == FIELD_UNSIGNED)
        return huge && x > 0.0 ? max : 0;
    if (d->scale == SCALE_ANGLE)
        return 0;
    return huge || isnan(x) ? (uint64_t)1 << (d->bits - 1) : 0;
}

TEST(special_encode)
{
    const struct wire_scene scene = {.base_id = 0x200, .lsb = {1e-9, 1e-5, 2e-9, 0.01}};
    int fields = 0, wrong = 0, spilt = 0, refused = 0;
    for (unsigned kind = 0; kind < WIRE_KINDS; kind++) {
        const struct message_layout *l = wire_layout(kind);
        for (int i = 0; l && i < l->n_fields; i++, fields++) {
            for (int s = 0; s < SPECIALS; s++) {
                struct message m = {.kind = (uint8_t)kind}, back;
                struct frame f;
                m.value[i] = special[s];
                wire_encode(&scene, &m, &f);
                wrong += raw_of(&f, &l->field[i]) != expected_raw(&l->field[i], special[s]);
                for (int k = 0; k < l->n_fields; k++)
                    spilt += k != i && raw_of(&f, &l->field[k]) != 0;
                refused += wire_decode(&scene, &f, &back) != WIRE_OK;
            }
        }
    }
    check_above("fields of all messages", fields, 90);
    check_int("specials encoded as anything else than the protocol says", wrong, 0);
    check_int("that reached into another field", spilt, 0);
    check_int("frames that did not decode", refused, 0);
}

/* ---- commands to an app ---- */

static struct bus bus;
static struct app before;

static const uint32_t pattern[] = {0x7FC00000, 0xFFC00000, 0x7F800001, 0xFFFFFFFF, 0x7F800000, 0xFF800000,
                                   0x7F7FFFFF, 0xFF7FFFFF, 0x00000001, 0x80000001, 0x007FFFFF, 0x807FFFFF};
enum { PATTERNS = sizeof pattern / sizeof pattern[0], OUT_OF_EVERY_RANGE = 8 };

static void start_paused(void)
{
    bus_start_rig(&bus);
    bus_order_now(&bus, CONTROL_PAUSE);
}

static bool same_as_before(void)
{
    const struct app *a = &bus.app;
    return memcmp(&a->plant, &before.plant, sizeof a->plant) == 0 &&
           memcmp(&a->mailbox, &before.mailbox, sizeof a->mailbox) == 0 &&
           memcmp(a->setting, before.setting, sizeof a->setting) == 0 &&
           memcmp(a->telemetry.echo_pending, before.telemetry.echo_pending,
                  sizeof a->telemetry.echo_pending) == 0 &&
           a->state == before.state && a->session == before.session && a->enabled == before.enabled &&
           a->faults == before.faults && a->step_left == before.step_left;
}

/* A frame with these very bits in a field: encoding would make one NaN of all. */
static void put_bits(unsigned kind, double index, const struct field *d, uint32_t bits)
{
    struct frame f;
    uint64_t word;
    bool stream = kind >= WIRE_STREAM && kind < WIRE_STREAM + MODEL_INPUTS;
    double frame = (double)(bus.app.plant.now.tick / BUS_TICKS + 1);
    bus_encode(&bus, kind, (double[WIRE_FIELDS]){0, stream ? frame : index}, &f);
    memcpy(&word, f.data, sizeof word); /* little endian, as the machines that run the tests */
    word |= (uint64_t)bits << d->start;
    memcpy(f.data, &word, sizeof word);
    f.data[0] = wire_crc8(f.id, f.data, FRAME_DATA);
    bus_put(&bus, &f);
}

struct tally {
    int sent, bad_cause, not_counted, changed;
};

static void one_command(unsigned kind, double index, const struct field *d, int p, struct tally *t)
{
    before = bus.app;
    bus_forget(&bus);
    put_bits(kind, index, d, pattern[p]);
    bus_run(&bus, 1);
    bool refused = bus_cause(&bus, kind) == CAUSE_RANGE;
    t->sent++;
    t->bad_cause += p < OUT_OF_EVERY_RANGE && !refused;
    t->not_counted += refused != (bus.app.count[DIAG_RANGE] == before.count[DIAG_RANGE] + 1);
    t->changed += refused && !same_as_before();
}

static void every_pattern(unsigned kind, double index, struct tally *t)
{
    const struct message_layout *l = wire_layout(kind);
    for (int i = 0; i < l->n_fields; i++)
        for (int p = 0; l->field[i].kind == FIELD_FLOAT && p < PATTERNS; p++)
            one_command(kind, index, &l->field[i], p, t);
}

TEST(special_commands)
{
    struct tally t = {0};
    int floats = 0, known = 0;
    for (unsigned kind = 0; kind < WIRE_COMMANDS; kind++) {
        const struct message_layout *l = wire_layout(kind);
        for (int i = 0; l && i < l->n_fields; i++)
            floats += l->field[i].kind == FIELD_FLOAT;
    }
    start_paused();
    for (unsigned i = 0; i < MODEL_INPUTS; i++, known += 2) {
        for (int field = 0; field < ARM_FIELDS; field++)
            every_pattern(WIRE_ARM + i, field, &t);
        every_pattern(WIRE_STREAM + i, 0, &t);
    }
    for (int i = 0; i < RIG_PARAMETERS; i++)
        every_pattern(WIRE_PARAM_WRITE, i, &t);
    for (int i = 0; i < SETTINGS; i++)
        every_pattern(WIRE_PARAM_WRITE, SETTING_FIRST + i, &t);
    known++;
    check_int("command fields that hold a float, all of them tried", known, floats);
    check_above("frames", t.sent, 1000);
    check_int("NaN, infinite and huge ones not refused as out of range", t.bad_cause, 0);
    check_int("refusals not counted, or counted twice", t.not_counted, 0);
    check_int("refusals that changed plant, mailbox, settings or state", t.changed, 0);
    bus_order(&bus, CONTROL_START);
    bus_run(&bus, 100);
    check_true("the plant goes on", isfinite(bus.app.plant.x[0]));
    check_int("the plant goes on", bus.app.plant.counts.not_finite, 0);
}

/* ---- set-up ---- */

TEST(special_parameters)
{
    int tried = 0, taken = 0, not_finite = 0;
    for (int k = 0; k < MODELS; k++) {
        const struct model *m = model_table[k];
        for (int i = 0; i < m->n_parameters; i++) {
            for (int s = 0; s < SPECIALS; s++) {
                struct plant pl;
                double si[MODEL_PARAMETERS];
                for (int j = 0; j < m->n_parameters; j++)
                    si[j] = j == i ? special[s] : m->parameter[j].initial;
                struct plant_config c = {
                    .model = m, .si = si, .method = &rk4, .tick_s = 1e-6, .dilation = 1.0, .force = true};
                bool inside = special[s] >= m->parameter[i].min && special[s] <= m->parameter[i].max;
                bool good = plant_init(&pl, &c) == NULL;
                tried++;
                taken += good && !inside;
                not_finite += good && !(plant_run(&pl, 10) && isfinite(pl.x[0]));
            }
        }
    }
    check_above("special parameters of all models", tried, 13 * 4 * SPECIALS);
    check_int("outside their range and taken", taken, 0);
    check_int("inside it, and the plant does not run", not_finite, 0);
}

TEST(special_settings)
{
    static struct app a;
    struct app_config c = bus_config();
    double setting[SETTINGS];
    int taken = 0;
    c.setting = setting;
    for (int i = 0; i < SETTINGS; i++) {
        for (int s = 0; s < SPECIALS; s++) {
            for (int k = 0; k < SETTINGS; k++)
                setting[k] = k == i ? special[s] : setting_initial(k, c.model, c.frame_s);
            bool inside = special[s] >= setting_table[i].min && special[s] <= setting_table[i].max;
            taken += app_init(&a, &c, NULL) == NULL && !inside;
        }
    }
    check_int("settings outside their range and taken", taken, 0);
    c.setting = NULL;
    for (int s = 0; s < SPECIALS; s++) {
        struct app_config frame = c, dilation = c;
        frame.frame_s = special[s];
        dilation.dilation = special[s];
        taken += app_init(&a, &frame, NULL) == NULL;
        taken += app_init(&a, &dilation, NULL) == NULL;
    }
    check_int("frame periods and dilations taken", taken, 0);
}

/* ---- scenes: each value of each preset's file ---- */

/* The text with the value of line `begin` replaced; false for a line without one. */
static bool replaced(const char *text, const char *begin, const char *value, char *out, size_t n)
{
    const char *end = strchr(begin, '\n'), *sign = strstr(begin, " = ");
    const char *note = strchr(begin, '#');
    if (!end || !sign || sign > end || *begin == '#')
        return false;
    if (!note || note > end)
        note = end;
    int used = snprintf(out, n, "%.*s = %s %s", (int)(sign - text), text, value, note);
    return used > 0 && (size_t)used < n;
}

static void every_value(const char *text, const struct scene *good, int *tried, int *taken, int *changed)
{
    static const char *const no_number[] = {"nan", "inf", "-inf", "1e999", "-1e999"};
    static char other[SCENE_FILE_BYTES];
    char why[SCENE_FILE_REASON];
    for (const char *line = text; line && *line; line = strchr(line, '\n'), line += line != NULL) {
        for (size_t k = 0; k < sizeof no_number / sizeof no_number[0]; k++) {
            struct scene s = *good;
            if (!replaced(text, line, no_number[k], other, sizeof other))
                continue;
            ++*tried;
            *taken += scene_file_parse("file", other, strlen(other), &s, why);
            *changed += memcmp(&s, good, sizeof s) != 0;
        }
    }
}

TEST(special_scenes)
{
    int tried = 0, taken = 0, changed = 0;
    for (int i = 0; i < SCENES; i++) {
        static char text[SCENE_FILE_BYTES];
        FILE *out = fmemopen(text, sizeof text, "w");
        scene_print(out, scenes_table[i].title, &scenes_table[i].scene);
        fclose(out);
        every_value(text, &scenes_table[i].scene, &tried, &taken, &changed);
    }
    check_above("values of all presets replaced by no number", tried, SCENES * 10 * 5);
    check_int("taken", taken, 0);
    check_int("refused, and the scene changed", changed, 0);
}
