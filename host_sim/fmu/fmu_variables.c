/* fmu_variables.c - see fmu_variables.h. */
#include "host_sim/fmu/fmu_variables.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "models/math/elementary.h"

STATIC_ASSERT(MODEL_INPUTS *FMU_DRIVE_FIELDS < FMU_REFERENCES && (int)MODEL_PARAMETERS < FMU_REFERENCES,
              references_of_a_kind);

/* Ranges as contactplant_set_drive has them; those that depend on the scene are checked there. */
static const struct {
    const char *name, *unit, *meaning;
    double min, max;
} field_table[FMU_DRIVE_FIELDS] = {
    [FMU_AMPLITUDE] = {"amplitude", NULL, "amplitude of the harmonic drive", -HUGE_VAL, HUGE_VAL},
    [FMU_FREQUENCY] = {"frequency", "Hz", "frequency of the harmonic drive", 0.0, HUGE_VAL},
    [FMU_PHASE] = {"phase", "rad", "phase of the harmonic drive", -1e6, 1e6},
    [FMU_RAMP] = {"ramp", "s", "time that a later change of the harmonic drive takes", 0.0, 1e4}};

const char *const fmu_type_name[] = {
    [FMU_FLOAT64] = "Float64", [FMU_UINT64] = "UInt64", [FMU_CLOCK] = "Clock"};

/* A kind is one variable with this name; or, without one, those numbers of the plant. */
static const struct {
    enum fmu_type type;
    const char *name, *unit, *meaning;
    enum contactplant_kind of;
} kind_table[FMU_KINDS] = {
    [FMU_TIME] = {FMU_FLOAT64, "time", "s", "plant time, from the start time on", 0},
    [FMU_INPUT] = {FMU_FLOAT64, NULL, NULL, NULL, CONTACTPLANT_INPUT},
    [FMU_OUTPUT] = {FMU_FLOAT64, NULL, NULL, NULL, CONTACTPLANT_OUTPUT},
    [FMU_SWITCHES] = {FMU_UINT64, "contact_switches", "1", "contacts made or broken since the start", 0},
    [FMU_RESIDUAL] = {FMU_FLOAT64, "energy_residual", "J", "what the energy balance cannot account for", 0},
    [FMU_PARAMETER] = {FMU_FLOAT64, NULL, NULL, NULL, CONTACTPLANT_PARAMETER},
    [FMU_DRIVE] = {FMU_FLOAT64, NULL, NULL, NULL, CONTACTPLANT_INPUT},
    [FMU_CONTACT] = {FMU_CLOCK, "contact", "1", "ticks where a contact closes, in event mode", 0}};

/* How many variables there are of a kind. */
static int count(struct contactplant *p, enum fmu_kind kind)
{
    int n = kind_table[kind].name ? 1 : contactplant_count(p, kind_table[kind].of);
    return kind == FMU_DRIVE ? n * FMU_DRIVE_FIELDS : n;
}

static void of_plant(struct contactplant *p, enum contactplant_kind kind, struct fmu_variable *v)
{
    struct contactplant_number n = {.name = NULL};
    (void)contactplant_describe(p, kind, v->index, &n);
    v->unit = n.unit;
    v->min = n.min;
    v->max = n.max;
    snprintf(v->name, sizeof v->name, "%s", n.name);
    snprintf(v->meaning, sizeof v->meaning, "%s", n.meaning);
}

static void of_drive(struct contactplant *p, struct fmu_variable *v)
{
    struct contactplant_number n = {.name = NULL};
    (void)contactplant_describe(p, CONTACTPLANT_INPUT, v->index, &n);
    v->unit = field_table[v->field].unit ? field_table[v->field].unit : n.unit;
    v->min = field_table[v->field].min;
    v->max = field_table[v->field].max;
    snprintf(v->name, sizeof v->name, "drive.%s.%s", n.name, field_table[v->field].name);
    snprintf(v->meaning, sizeof v->meaning, "%s: %s", n.meaning, field_table[v->field].meaning);
}

static void of_instance(struct fmu_variable *v)
{
    v->unit = kind_table[v->kind].unit;
    snprintf(v->name, sizeof v->name, "%s", kind_table[v->kind].name);
    snprintf(v->meaning, sizeof v->meaning, "%s", kind_table[v->kind].meaning);
}

static void fill(struct contactplant *p, enum fmu_kind kind, int slot, struct fmu_variable *v)
{
    *v = (struct fmu_variable){.kind = kind,
                               .type = kind_table[kind].type,
                               .index = kind == FMU_DRIVE ? slot / FMU_DRIVE_FIELDS : slot,
                               .field = kind == FMU_DRIVE ? slot % FMU_DRIVE_FIELDS : 0,
                               .reference = (uint32_t)kind * FMU_REFERENCES + (uint32_t)slot,
                               .min = -HUGE_VAL,
                               .max = HUGE_VAL};
    if (kind_table[kind].name)
        of_instance(v);
    else if (kind == FMU_DRIVE)
        of_drive(p, v);
    else
        of_plant(p, kind_table[kind].of, v);
}

bool fmu_variable_find(struct contactplant *p, uint32_t reference, struct fmu_variable *v)
{
    uint32_t kind = reference / FMU_REFERENCES;
    int slot = (int)(reference % FMU_REFERENCES);
    if (kind >= FMU_KINDS || slot >= count(p, (enum fmu_kind)kind))
        return false;
    fill(p, (enum fmu_kind)kind, slot, v);
    return true;
}

bool fmu_variable(struct contactplant *p, int i, struct fmu_variable *v)
{
    for (int kind = 0; kind < FMU_KINDS; kind++) {
        int n = count(p, (enum fmu_kind)kind);
        if (i < n) {
            fill(p, (enum fmu_kind)kind, i, v);
            return true;
        }
        i -= n;
    }
    return false;
}

double fmu_drive_begin(const struct contactplant *p, int input, int field)
{
    const struct harmonic *d = &p->scene.drive[input];
    switch (field) {
    case FMU_AMPLITUDE:
        return d->amplitude;
    case FMU_FREQUENCY:
        return d->omega / (2.0 * ELEMENTARY_PI * p->scene.config.dilation);
    case FMU_PHASE:
        return d->phase;
    default:
        return 0.0;
    }
}

void fmu_token(const char *scene, char token[FMU_TOKEN])
{
    static const char before[] = CONTACTPLANT_VERSION "\n", between[] = "\n" CONTACTPLANT_VERSION;
    size_t n = strlen(scene);
    uint64_t a = library_hash(library_hash(LIBRARY_HASH, before, sizeof before - 1), scene, n);
    uint64_t b = library_hash(library_hash(a, between, sizeof between - 1), scene, n);
    snprintf(token, FMU_TOKEN, "{%08x-%04x-%04x-%04x-%012llx}", (unsigned)(a >> 32),
             (unsigned)(a >> 16 & 0xFFFF), (unsigned)(a & 0xFFFF), (unsigned)(b >> 48),
             (unsigned long long)(b & 0xFFFFFFFFFFFFu));
}
