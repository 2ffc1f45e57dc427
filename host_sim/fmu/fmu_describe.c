/* fmu_describe.c - see fmu_describe.h. */
#include "host_sim/fmu/fmu_describe.h"

#include <math.h>
#include <string.h>
#include "host_sim/out/xml.h"

/* Units by the exponents of their base units. Those that need broken ones have a name only. */
static const struct {
    const char *name;
    int kg, m, s, rad;
} unit_table[] = {{"1", 0, 0, 0, 0},    {"kg", 1, 0, 0, 0},     {"m", 0, 1, 0, 0},    {"s", 0, 0, 1, 0},
                  {"rad", 0, 0, 0, 1},  {"Hz", 0, 0, -1, 0},    {"m/s", 0, 1, -1, 0}, {"N", 1, 1, -2, 0},
                  {"N/m", 1, 0, -2, 0}, {"N s/m", 1, 0, -1, 0}, {"J", 1, 2, -2, 0}};
enum { UNITS = sizeof unit_table / sizeof unit_table[0] };

/* ---- units ---- */

static void put_unit(FILE *out, const char *name)
{
    xml_put(out, "    <Unit name='%s'", name);
    for (int i = 0; i < UNITS; i++)
        if (!strcmp(name, unit_table[i].name)) {
            const struct {
                const char *name;
                int exponent;
            } base[] = {{"kg", unit_table[i].kg},
                        {"m", unit_table[i].m},
                        {"s", unit_table[i].s},
                        {"rad", unit_table[i].rad}};
            xml_put(out, "><BaseUnit");
            for (int k = 0; k < 4; k++)
                if (base[k].exponent)
                    xml_put(out, " %r='%i'", base[k].name, base[k].exponent);
            xml_put(out, "/></Unit>\n");
            return;
        }
    xml_put(out, "/>\n");
}

/* A variable before number `i` has this unit. */
static bool is_told(struct contactplant *p, int i, const char *unit)
{
    struct fmu_variable v;
    for (int k = 0; k < i && fmu_variable(p, k, &v); k++)
        if (!strcmp(v.unit, unit))
            return true;
    return false;
}

static void put_units(FILE *out, struct contactplant *p)
{
    struct fmu_variable v;
    xml_put(out, "  <UnitDefinitions>\n");
    for (int i = 0; fmu_variable(p, i, &v); i++)
        if (!is_told(p, i, v.unit))
            put_unit(out, v.unit);
    xml_put(out, "  </UnitDefinitions>\n");
}

/* ---- variables ---- */

static const struct {
    const char *causality, *variability;
    bool starts; /* has a start value: it can be set */
} kind_table[FMU_KINDS] = {
    [FMU_TIME] = {"independent", "continuous", false}, [FMU_INPUT] = {"input", "discrete", true},
    [FMU_OUTPUT] = {"output", "continuous", false},    [FMU_SWITCHES] = {"output", "discrete", false},
    [FMU_RESIDUAL] = {"output", "continuous", false},  [FMU_PARAMETER] = {"parameter", "tunable", true},
    [FMU_DRIVE] = {"parameter", "tunable", true},      [FMU_CONTACT] = {"output", "discrete", false}};

static double start_of(struct contactplant *p, const struct fmu_variable *v)
{
    return v->kind == FMU_PARAMETER ? contactplant_parameter(p, v->index)
           : v->kind == FMU_DRIVE   ? fmu_drive_begin(p, v->index, v->field)
                                    : 0.0;
}

static void put_variable(FILE *out, struct contactplant *p, const struct fmu_variable *v)
{
    xml_put(out, "    <%r name='%s' valueReference='%u' description='%s'", fmu_type_name[v->type], v->name,
            (unsigned)v->reference, v->meaning);
    xml_put(out, " causality='%s' variability='%s'", kind_table[v->kind].causality,
            kind_table[v->kind].variability);
    if (v->type == FMU_CLOCK)
        xml_put(out, " intervalVariability='triggered'");
    if (v->type == FMU_FLOAT64)
        xml_put(out, " unit='%s'", v->unit);
    if (isfinite(v->min))
        xml_put(out, " min='%n'", v->min);
    if (isfinite(v->max))
        xml_put(out, " max='%n'", v->max);
    if (kind_table[v->kind].starts)
        xml_put(out, " start='%n'", start_of(p, v));
    xml_put(out, "/>\n");
}

static void put_variables(FILE *out, struct contactplant *p)
{
    struct fmu_variable v;
    xml_put(out, "  <ModelVariables>\n");
    for (int i = 0; fmu_variable(p, i, &v); i++)
        put_variable(out, p, &v);
    xml_put(out, "  </ModelVariables>\n  <ModelStructure>\n");
    for (int unknown = 0; unknown < 2; unknown++)
        for (int i = 0; fmu_variable(p, i, &v); i++)
            if (!strcmp(kind_table[v.kind].causality, "output") && !(unknown && v.type == FMU_CLOCK))
                xml_put(out, "    <%r valueReference='%u'/>\n", unknown ? "InitialUnknown" : "Output",
                        (unsigned)v.reference);
    xml_put(out, "  </ModelStructure>\n");
}

/* ---- the document ---- */

void fmu_describe(FILE *out, struct contactplant *p, const char *name, const char *title, const char *scene)
{
    char token[FMU_TOKEN];
    const struct scene *s = &p->scene.scene;
    fmu_token(scene, token);
    xml_put(out, XML_HEAD "<fmiModelDescription fmiVersion='3.0' modelName='%s' instantiationToken='%s'",
            name, token);
    xml_put(out, " description='%s' version='%s' generationTool='contactplant %s'", title,
            CONTACTPLANT_VERSION, CONTACTPLANT_VERSION);
    xml_put(out,
            " variableNamingConvention='structured'>\n  <CoSimulation modelIdentifier='contactplant'"
            " canHandleVariableCommunicationStepSize='true' fixedInternalStepSize='%n'"
            " canGetAndSetFMUState='true' canSerializeFMUState='true' mightReturnEarlyFromDoStep='true'"
            " hasEventMode='true'/>\n",
            contactplant_tick_time(p));
    put_units(out, p);
    xml_put(out,
            "  <LogCategories>\n    <Category name='error' description='why a call was refused'/>\n"
            "  </LogCategories>\n  <DefaultExperiment startTime='0' stopTime='%n' stepSize='%n'/>\n",
            s->over * s->dilation, s->frame_s);
    put_variables(out, p);
    xml_put(out, "</fmiModelDescription>\n");
}
