/* scene_keys.c - see scene_keys.h. */
#include "host_sim/scene/scene_keys.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include "firmware/bus/settings.h"
#include "models/check.h"

const char *const scene_section_name[SECTIONS] = {"plant", "paper", "drive",    "stage",
                                                  "start", "ask",   "deadline", "watch"};

/* Bounds on numbers without a table of their own: far beyond any rig, far from overflow. */
#define LARGE    1e12
#define TIME_MIN 1e-12

#define AT(member) offsetof(struct scene, member)

enum own_unit { UNIT_FIXED, UNIT_TIME, UNIT_INPUT, UNIT_WATCHED };

struct own_key {
    const char *name;
    enum scene_key_kind kind;
    enum own_unit of; /* time, input and what is watched have no unit in a dimensionless scene */
    const char *unit, *meaning;
    double min, max;
    size_t offset;
};

static const struct own_key plant_keys[] = {
    {"model", KEY_MODEL, UNIT_FIXED, "", "what the plant is, see contactplant list models", 0, 0, AT(model)},
    {"method", KEY_METHOD, UNIT_FIXED, "", "integration method, auto for the right one", 0, 0, AT(method)},
};

/* Offsets in struct scene_drive. */
#define IN(member) offsetof(struct scene_drive, member)
static const struct own_key drive_keys[] = {
    {"amplitude", KEY_NUMBER, UNIT_INPUT, "", "of amplitude cos(2 pi frequency t + phase)", -LARGE, LARGE,
     IN(amplitude)},
    {"frequency", KEY_NUMBER, UNIT_FIXED, "Hz", "of the real plant", 0.0, LARGE, IN(frequency_Hz)},
    {"phase", KEY_NUMBER, UNIT_FIXED, "rad", "at the start", -1e3, 1e3, IN(phase_rad)},
    {"noise", KEY_NUMBER, UNIT_INPUT, "", "standard deviation of added noise", 0.0, LARGE, IN(noise)},
    {"noise_hold", KEY_NUMBER, UNIT_TIME, "", "from one value of the noise to the next; 0: one step", 0.0,
     LARGE, IN(noise_hold)},
    {"noise_seed", KEY_COUNT, UNIT_FIXED, "", "another seed is another noise", 0.0, UINT32_MAX,
     IN(noise_seed)},
};

static const struct own_key ask_keys[] = {
    {"observable", KEY_OBSERVABLE, UNIT_FIXED, "", "the output that is asked for", 0, 0, AT(observable)},
    {"over", KEY_NUMBER, UNIT_TIME, "", "duration, of the real plant", TIME_MIN, LARGE, AT(over)},
    {"tolerance", KEY_NUMBER, UNIT_FIXED, "", "of the method, relative", 1e-15, 1e-1, AT(tolerance)},
};

static const struct own_key deadline_keys[] = {
    {"frame", KEY_NUMBER, UNIT_FIXED, "s", "bus time from one exchange to the next", 5e-5, 1.0, AT(frame_s)},
    {"substeps", KEY_COUNT, UNIT_FIXED, "", "steps in a frame", 1.0, SCENE_SUBSTEPS_MAX, AT(substeps)},
    {"dilation", KEY_NUMBER, UNIT_FIXED, "", "bus time over the real plant's", 1e-6, 1e6, AT(dilation)},
    {"cost", KEY_NUMBER, UNIT_FIXED, "s", "time that one step may take; 0: no limit", 0.0, 1.0, AT(cost_s)},
};

static const struct own_key watch_keys[] = {
    {"observable", KEY_WATCHED, UNIT_FIXED, "",
     "an output, a state, time, eigenfrequency, drive_frequency or changes: what is watched", 0, 0,
     AT(watch.observable)},
    {"above", KEY_NUMBER, UNIT_WATCHED, "", "trips above this", -LARGE, LARGE, AT(watch.above)},
    {"below", KEY_NUMBER, UNIT_WATCHED, "", "trips below this", -LARGE, LARGE, AT(watch.below)},
    {"promote", KEY_PROMOTE, UNIT_FIXED, "", "the full model that run --promote climbs to then", 0, 0,
     AT(watch.promote)},
};

static const struct {
    const struct own_key *key;
    int n;
} own_keys[SECTIONS] = {
    [SECTION_PLANT] = {plant_keys, sizeof plant_keys / sizeof plant_keys[0]},
    [SECTION_DRIVE] = {drive_keys, sizeof drive_keys / sizeof drive_keys[0]},
    [SECTION_ASK] = {ask_keys, sizeof ask_keys / sizeof ask_keys[0]},
    [SECTION_DEADLINE] = {deadline_keys, sizeof deadline_keys / sizeof deadline_keys[0]},
    [SECTION_WATCH] = {watch_keys, sizeof watch_keys / sizeof watch_keys[0]},
};

static const char *unit_of(const struct scene *s, const char *unit)
{
    return scenes_dimensionless(s) || !strcmp(unit, "1") ? "" : unit;
}

static void get_own(const struct scene *s, const struct own_key *o, int input, struct scene_key *k)
{
    const char *unit = o->of == UNIT_TIME    ? unit_of(s, "s")
                       : o->of == UNIT_INPUT ? unit_of(s, s->model->input_signal[input].unit)
                       : o->of == UNIT_WATCHED
                           ? unit_of(s, model_observable(s->model, s->watch.observable)->unit)
                           : o->unit;
    *k = (struct scene_key){.kind = o->kind,
                            .full = o->name,
                            .unit = unit,
                            .meaning = o->meaning,
                            .min = o->min,
                            .max = o->max,
                            .offset = o->offset};
    snprintf(k->name, sizeof k->name, "%s", o->name);
}

void scene_keys_spell(const char *unit, char *text, size_t size)
{
    size_t n = 0;
    for (; *unit && n + 6 < size; unit++) {
        if (*unit == '/')
            n += (size_t)snprintf(text + n, size - n, "_per_");
        else if (*unit != '^')
            text[n++] = *unit == ' ' || *unit == '.' ? '_' : *unit;
    }
    text[n] = 0;
}

void scene_keys_parameter(const struct parameter *p, size_t offset, struct scene_key *k)
{
    char suffix[SCENE_KEY_NAME];
    *k = (struct scene_key){.kind = KEY_NUMBER,
                            .full = p->name,
                            .unit = strcmp(p->unit, "1") ? p->unit : "",
                            .meaning = p->meaning,
                            .min = p->min,
                            .max = p->max,
                            .offset = offset};
    scene_keys_spell(p->unit, suffix, sizeof suffix);
    size_t length = strlen(p->name), n = strlen(suffix);
    bool ends = length > n + 1 && p->name[length - n - 1] == '_' && !strcmp(p->name + length - n, suffix);
    snprintf(k->name, sizeof k->name, "%.*s", (int)(ends ? length - n - 1 : length), p->name);
}

static void get_state(const struct scene *s, int i, struct scene_key *k)
{
    const struct signal *g = &s->model->state_signal[i];
    *k = (struct scene_key){.kind = KEY_NUMBER,
                            .full = scenes_state_name(s, i),
                            .unit = unit_of(s, g->unit),
                            .meaning = g->meaning,
                            .min = -LARGE,
                            .max = LARGE,
                            .offset = AT(start) + (size_t)i * sizeof(double)};
    snprintf(k->name, sizeof k->name, "%s", k->full);
}

static bool is_rate(int number)
{
    return number == STAGE_SET_SLEW || number == STAGE_SET_DRIFT;
}

/* The unit of a stage's number that is the signal's, of it per second or per root hertz. */
static const char *stage_unit(const char *unit, int number)
{
    static const char *const of[][3] = {{"m", "m/s", "m/sqrt(Hz)"},
                                        {"m/s", "m/s^2", "m/s/sqrt(Hz)"},
                                        {"N", "N/s", "N/sqrt(Hz)"},
                                        {"1", "1/s", "1/sqrt(Hz)"}};
    const struct parameter *p = &setting_table[SET_STAGE + number];
    int form = is_rate(number) ? 1 : number == STAGE_SET_NOISE ? 2 : 0;
    for (int i = 0; !*p->unit && i < 4; i++)
        if (!strcmp(unit, of[i][0]))
            return strcmp(of[i][form], "1") ? of[i][form] : "";
    return strcmp(p->unit, "1") ? p->unit : "";
}

STATIC_ASSERT((int)SCENE_STAGES == (int)STAGE_SLOTS, a_scene_has_all_stages);
STATIC_ASSERT((int)SCENE_STAGE_NUMBERS == (int)STAGE_SETTINGS, with_all_their_settings);

int scene_keys_stage(const struct scene *s, int signal)
{
    for (int i = 0; i < SCENE_STAGES; i++)
        if (s->stage[i][STAGE_AT] == signal + 1)
            return i;
    return -1;
}

bool scene_keys_add_stage(struct scene *s, int signal)
{
    int i = scene_keys_stage(s, -1); /* one that is off */
    if (i < 0)
        return false;
    for (int k = 0; k < STAGE_SETTINGS; k++)
        s->stage[i][k] = setting_table[SET_STAGE + k].initial;
    s->stage[i][STAGE_AT] = signal + 1;
    return true;
}

/* The optical lever has 50 nm/V, and its ADC 16 bits over +-10 V. */
static const struct {
    const char *name;
    double setting[STAGE_SETTINGS]; /* 0: as without the preset */
} presets[SCENE_STAGE_PRESETS] = {
    {"piezo_tube",
     {[STAGE_SET_SLEW] = 5e-3,
      [STAGE_SET_RANGE] = 5e-6,
      [STAGE_SET_SHARE] = 0.15,
      [STAGE_SET_CREEP] = 0.015,
      [STAGE_SET_RESONANCE] = 5e3,
      [STAGE_SET_DAMPING] = 0.05}},
    {"piezo_stack",
     {[STAGE_SET_SLEW] = 0.05,
      [STAGE_SET_RANGE] = 5e-6,
      [STAGE_SET_SHARE] = 0.15,
      [STAGE_SET_CREEP] = 0.01,
      [STAGE_SET_RESONANCE] = 50e3,
      [STAGE_SET_DAMPING] = 0.05}},
    {"photodiode",
     {[STAGE_SET_NOISE] = 100e-15,
      [STAGE_SET_LAG] = 2e6,
      [STAGE_SET_CLIP] = 500e-9,
      [STAGE_SET_QUANTUM] = 1e-6 / 65536.0}},
};

bool scene_keys_stage_preset(struct scene *s, int slot, const char *text, size_t n, const char **name)
{
    bool found = false;
    for (int i = 0; i < SCENE_STAGE_PRESETS; i++) {
        bool named = strlen(presets[i].name) == n && !memcmp(presets[i].name, text, n);
        name[i] = presets[i].name;
        found |= named;
        for (int k = 0; named && k < STAGE_SETTINGS; k++)
            if (presets[i].setting[k] > 0.0)
                s->stage[slot][k] = presets[i].setting[k];
    }
    return found;
}

/* Number 1 and on of a stage: stage_0_resonance_Hz is `resonance`, 5 kHz. */
static bool get_stage(const struct scene *s, int signal, int number, struct scene_key *k)
{
    const struct model *m = s->model;
    int slot = scene_keys_stage(s, signal);
    if (slot < 0 || number >= STAGE_SETTINGS)
        return false;
    const struct parameter *p = &setting_table[SET_STAGE + number];
    const struct signal *of =
        signal < MODEL_INPUTS ? &m->input_signal[signal] : &m->output_signal[signal - MODEL_INPUTS];
    scene_keys_parameter(p, AT(stage) + (size_t)(slot * STAGE_SETTINGS + number) * sizeof(double), k);
    memmove(k->name, k->name + strlen("stage_0_"), strlen(k->name) + 1 - strlen("stage_0_"));
    k->full = p->name + strlen("stage_0_");
    k->unit = stage_unit(of->unit, number);
    if (is_rate(number))
        k->name[strlen(k->name) - strlen("_per_s")] = '\0';
    return true;
}

bool scene_keys_get(const struct scene *s, enum scene_section section, int input, int index,
                    struct scene_key *k)
{
    const struct model *m = s->model;
    if (section == SECTION_STAGE)
        return get_stage(s, input, index + 1, k);
    int rest = index - own_keys[section].n, silent = section == SECTION_DRIVE && s->paper ? 3 : 0;
    if (index + silent < own_keys[section].n) {
        get_own(s, &own_keys[section].key[index + silent], input, k);
        if (section == SECTION_DRIVE)
            k->offset += AT(drive) + (size_t)input * sizeof(struct scene_drive);
        return true;
    }
    const struct parameter *table = section == SECTION_PAPER ? m->paper : m->parameter;
    int n = section == SECTION_PAPER                ? m->n_paper
            : section == SECTION_PLANT && !s->paper ? m->n_parameters
            : section == SECTION_START              ? m->n_states
                                                    : 0;
    if (rest < 0 || rest >= n)
        return false;
    if (section == SECTION_START)
        get_state(s, rest, k);
    else
        scene_keys_parameter(&table[rest], AT(value) + (size_t)rest * sizeof(double), k);
    return true;
}

double scene_keys_value(const struct scene *s, const struct scene_key *k)
{
    double value;
    uint32_t count;
    const char *at = (const char *)s + k->offset;
    if (k->kind == KEY_COUNT) {
        memcpy(&count, at, sizeof count);
        return count;
    }
    memcpy(&value, at, sizeof value);
    return value;
}

void scene_keys_set(struct scene *s, const struct scene_key *k, double value)
{
    char *at = (char *)s + k->offset;
    if (k->kind == KEY_COUNT)
        memcpy(at, &(uint32_t){(uint32_t)value}, sizeof(uint32_t));
    else
        memcpy(at, &value, sizeof value);
}
