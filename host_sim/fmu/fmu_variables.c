/* fmu_variables.c - see fmu_variables.h. */
#include "host_sim/fmu/fmu_variables.h"

#include <math.h>
#include <stdio.h>
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

/* How many variables there are of a kind. */
static int count(struct contactplant *p, enum fmu_kind kind)
{
    switch (kind) {
    case FMU_INPUT:
        return contactplant_count(p, CONTACTPLANT_INPUT);
    case FMU_OUTPUT:
        return contactplant_count(p, CONTACTPLANT_OUTPUT);
    case FMU_PARAMETER:
        return contactplant_count(p, CONTACTPLANT_PARAMETER);
    case FMU_DRIVE:
        return contactplant_count(p, CONTACTPLANT_INPUT) * FMU_DRIVE_FIELDS;
    default:
        return 1;
    }
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

static void of_instance(struct fmu_variable *v, const char *name, const char *unit, const char *meaning)
{
    v->unit = unit;
    snprintf(v->name, sizeof v->name, "%s", name);
    snprintf(v->meaning, sizeof v->meaning, "%s", meaning);
}

static void fill(struct contactplant *p, enum fmu_kind kind, int slot, struct fmu_variable *v)
{
    *v = (struct fmu_variable){.kind = kind,
                               .type = kind == FMU_SWITCHES  ? FMU_UINT64
                                       : kind == FMU_CONTACT ? FMU_CLOCK
                                                             : FMU_FLOAT64,
                               .index = kind == FMU_DRIVE ? slot / FMU_DRIVE_FIELDS : slot,
                               .field = kind == FMU_DRIVE ? slot % FMU_DRIVE_FIELDS : 0,
                               .reference = (uint32_t)kind * FMU_REFERENCES + (uint32_t)slot,
                               .min = -HUGE_VAL,
                               .max = HUGE_VAL};
    switch (kind) {
    case FMU_INPUT:
        of_plant(p, CONTACTPLANT_INPUT, v);
        break;
    case FMU_OUTPUT:
        of_plant(p, CONTACTPLANT_OUTPUT, v);
        break;
    case FMU_PARAMETER:
        of_plant(p, CONTACTPLANT_PARAMETER, v);
        break;
    case FMU_DRIVE:
        of_drive(p, v);
        break;
    case FMU_SWITCHES:
        of_instance(v, "contact_switches", "1", "contacts made or broken since the start");
        break;
    case FMU_CONTACT:
        of_instance(v, "contact", "1", "ticks where a contact closes, in event mode");
        break;
    case FMU_RESIDUAL:
        of_instance(v, "energy_residual", "J", "what the energy balance cannot account for");
        break;
    default:
        of_instance(v, "time", "s", "plant time, from the start time on");
        break;
    }
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

static uint64_t mix(uint64_t hash, const char *text)
{
    for (; *text; text++)
        hash = (hash ^ (unsigned char)*text) * 0x100000001B3u;
    return hash;
}

void fmu_token(const char *scene, char token[FMU_TOKEN])
{
    uint64_t a = mix(mix(0xCBF29CE484222325u, CONTACTPLANT_VERSION "\n"), scene);
    uint64_t b = mix(mix(a, "\n" CONTACTPLANT_VERSION), scene);
    snprintf(token, FMU_TOKEN, "{%08x-%04x-%04x-%04x-%012llx}", (unsigned)(a >> 32),
             (unsigned)(a >> 16 & 0xFFFF), (unsigned)(a & 0xFFFF), (unsigned)(b >> 48),
             (unsigned long long)(b & 0xFFFFFFFFFFFFu));
}
