/* test_rig.c - parameters, drives and inputs of an FMU of the
 * preset rig, beside the library's plant; and steps of odd size. */
#include "tests/fmi/importer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "tests/unit/test.h"

static union contactplant_memory memory;

/* The scene with a line of another value, opened by the library. */
static struct contactplant *edited(const char *const line[], int n)
{
    static char text[2 * IMPORTER_SCENE];
    struct contactplant_error error;
    snprintf(text, sizeof text, "%s", importer()->scene);
    for (int i = 0; i < n; i++) {
        static char rest[IMPORTER_SCENE];
        char begin[64];
        snprintf(begin, sizeof begin, "\n%.*s", (int)strcspn(line[i], "=") + 1, line[i]);
        char *at = strstr(text, begin);
        check_true(begin, at != NULL);
        if (!at)
            return NULL;
        snprintf(rest, sizeof rest, "%s", strchr(at + 1, '\n'));
        sprintf(at + 1, "%s%s", line[i], rest);
    }
    struct contactplant *p = contactplant_open(&memory, sizeof memory, text, &error);
    check_string("scene", error.text, "");
    return p;
}

/* Numbers set before the first step are those of a scene that has them. */
TEST(rig_numbers_before_the_start)
{
    static const char *const line[] = {"mass = 7 kg", "amplitude = 45 N", "frequency = 170 Hz",
                                       "phase = 0.5 rad"};
    const struct importer *m = importer();
    struct log log;
    for (int mode = 0; mode < 3; mode++) { /* instantiated, initialization, half of them in each */
        struct contactplant *p = edited(line, 4);
        fmi3Instance instance = importer_instantiate(&log);
        if (mode == 1)
            check_int("enter", m->EnterInitializationMode(instance, false, 0.0, 0.0, false, 0.0), fmi3OK);
        check_int("mass", importer_set(instance, "mass_kg", 7.0), fmi3OK);
        check_int("phase", importer_set(instance, "drive.force.phase", 0.5), fmi3OK);
        if (mode != 1)
            check_int("enter", m->EnterInitializationMode(instance, false, 0.0, 0.0, false, 0.0), fmi3OK);
        check_int("amplitude", importer_set(instance, "drive.force.amplitude", 45.0), fmi3OK);
        check_int("frequency", importer_set(instance, "drive.force.frequency", 170.0), fmi3OK);
        check_int("exit", m->ExitInitializationMode(instance), fmi3OK);
        importer_compare("outputs at the start", instance, p);
        importer_run(instance, 0, 200);
        check_int("plant", contactplant_advance(p, 200 * (uint64_t)contactplant_substeps(p)),
                  CONTACTPLANT_OK);
        importer_compare("outputs", instance, p);
        check_above("contact switches", (double)contactplant_counter(p, CONTACTPLANT_SWITCHES), 2.0);
        m->FreeInstance(instance);
    }
}

static int index_of(struct contactplant *p, enum contactplant_kind kind, const char *name)
{
    int i = contactplant_find(p, kind, name);
    check_above(name, i, 0.0);
    return i;
}

/* Numbers set while time runs are what the library's functions set. */
TEST(rig_numbers_while_it_runs)
{
    const struct importer *m = importer();
    struct log log;
    fmi3Instance instance = importer_begin(&log);
    struct contactplant *p = importer_plant(&memory);
    const double tick = contactplant_tick_time(p);
    int force = index_of(p, CONTACTPLANT_INPUT, "force"), base = index_of(p, CONTACTPLANT_INPUT, "base"),
        mass = index_of(p, CONTACTPLANT_PARAMETER, "mass_kg");
    uint64_t at = 0;
    for (int i = 0; i < 300; i++) {
        if (i == 10) {
            check_int("ramp", importer_set(instance, "drive.force.ramp", 0.02), fmi3OK);
            check_int("drive", importer_set(instance, "drive.force.amplitude", 50.0), fmi3OK);
            check_int("drive", contactplant_set_drive(p, force, 50.0, 150.0, 0.0, 0.02), CONTACTPLANT_OK);
        } else if (i == 100) {
            check_int("mass", importer_set(instance, "mass_kg", 6.0), fmi3OK);
            check_int("mass", contactplant_set_parameter(p, mass, 6.0), CONTACTPLANT_OK);
        } else if (i == 150) {
            check_int("base", importer_set(instance, "base", 1e-6), fmi3OK);
            check_int("base", contactplant_set_sample(p, base, 1e-6, 0), CONTACTPLANT_OK);
        }
        double value = 5.0 * (i % 7);
        check_int("force", importer_set(instance, "force", value), fmi3OK);
        if (i > 0)
            check_int("force", contactplant_set_sample(p, force, value, 0), CONTACTPLANT_OK);
        uint64_t ticks = (uint64_t)(1 + i % 50);
        check_int("step", importer_step(instance, (double)at * tick, (double)ticks * tick), fmi3OK);
        check_int("plant", contactplant_advance(p, ticks), CONTACTPLANT_OK);
        at += ticks;
        importer_compare("outputs", instance, p);
        check_near("force, N", importer_get(instance, "force"), value, 0.0);
    }
    check_near("amplitude, N", importer_get(instance, "drive.force.amplitude"), 50.0, 0.0);
    check_near("mass, kg", importer_get(instance, "mass_kg"), 6.0, 0.0);
    m->FreeInstance(instance);
}

/* A ramp is for changes to come: by itself it does nothing to a drive that sounds. */
TEST(rig_ramp_alone)
{
    struct log log;
    fmi3Instance instance = importer_begin(&log);
    struct contactplant *p = importer_plant(&memory);
    importer_run(instance, 0, 20);
    check_int("ramp", importer_set(instance, "drive.force.ramp", 0.5), fmi3OK);
    importer_run(instance, 20, 20);
    check_int("plant", contactplant_advance(p, 40 * (uint64_t)contactplant_substeps(p)), CONTACTPLANT_OK);
    importer_compare("outputs", instance, p);
    check_near("ramp, s", importer_get(instance, "drive.force.ramp"), 0.5, 0.0);
    importer()->FreeInstance(instance);
}

/* An importer may set every start value, and every value again and again. */
TEST(rig_value_that_it_has)
{
    const struct importer *m = importer();
    struct log log;
    for (int when = 0; when < 2; when++) {
        fmi3Instance instance = when ? importer_begin(&log) : importer_instantiate(&log);
        if (when)
            importer_run(instance, 0, 20);
        uint64_t before = importer_fingerprint(instance);
        for (int i = 0; i < m->n_variables; i++)
            if (m->variable[i].starts)
                check_int(m->variable[i].name,
                          m->SetFloat64(instance, &m->variable[i].reference, 1, &m->variable[i].start, 1),
                          fmi3OK);
        check_hex("nothing has changed", importer_fingerprint(instance), before);
        m->FreeInstance(instance);
    }
}

/* Numbers set before a reset are gone; numbers before the start are part of the state. */
TEST(rig_numbers_in_the_state)
{
    const struct importer *m = importer();
    struct log log;
    fmi3FMUState state = NULL;
    fmi3Instance instance = importer_instantiate(&log);
    uint64_t fresh = importer_fingerprint(instance);
    check_int("drive", importer_set(instance, "drive.force.amplitude", 45.0), fmi3OK);
    check_int("mass", importer_set(instance, "mass_kg", 7.0), fmi3OK);
    uint64_t changed = importer_fingerprint(instance);
    check_true("changed", changed != fresh);
    check_int("get", m->GetFMUState(instance, &state), fmi3OK);
    check_int("reset", m->Reset(instance), fmi3OK);
    check_hex("as if new", importer_fingerprint(instance), fresh);
    check_int("set", m->SetFMUState(instance, state), fmi3OK);
    check_hex("as before the reset", importer_fingerprint(instance), changed);
    check_near("mass, kg", importer_get(instance, "mass_kg"), 7.0, 0.0);
    check_int("base", importer_set(instance, "base", 1e-7), fmi3OK); /* the other numbers stay */
    check_near("mass, kg", importer_get(instance, "mass_kg"), 7.0, 0.0);
    check_near("amplitude, N", importer_get(instance, "drive.force.amplitude"), 45.0, 0.0);
    check_int("free", m->FreeFMUState(instance, &state), fmi3OK);
    m->FreeInstance(instance);
}

/* The largest difference in penetration from a plant with four times as many ticks. */
static double error_of(const double *value, const double *fine, int n)
{
    double error = 0.0;
    for (int i = 0; i < n; i++)
        error = fmax(error, fabs(value[i] - fine[i]));
    return error;
}

/* Communication steps that end inside ticks: the error is the method's, as at whole ticks. The measure of
 * both is a plant with a quarter of the tick. */
TEST(rig_odd_steps)
{
    enum { N = 100 };
    static const char *const finer[] = {"substeps = 256", "method = rk4"}, *const own[] = {"method = rk4"};
    static const double part[] = {6.4, 0.37, 37.123456789, 63.999};
    double fine[N], whole[N], odd[N];
    struct log log;
    const struct importer *m = importer();
    struct contactplant *p = edited(finer, 2);
    for (int i = 0; i < N; i++) {
        check_int("plant", contactplant_advance(p, contactplant_substeps(p)), CONTACTPLANT_OK);
        fine[i] = contactplant_output(p, 2);
    }
    p = edited(own, 1);
    const double tick = contactplant_tick_time(p), frame = tick * contactplant_substeps(p);
    for (int i = 0; i < N; i++) {
        check_int("plant", contactplant_advance(p, contactplant_substeps(p)), CONTACTPLANT_OK);
        whole[i] = contactplant_output(p, 2);
    }
    double allowed = 2.0 * error_of(whole, fine, N) + 1e-15;
    check_below("error of whole ticks, m", allowed, 1e-8);
    for (int k = 0; k < 4; k++) {
        fmi3Instance instance = importer_begin(&log);
        double t = 0.0;
        for (int i = 0; i < N; i++) {
            for (double next = t + part[k] * tick; next < (i + 1) * frame - 1e-12;
                 t = next, next = t + part[k] * tick)
                check_int("step", importer_step(instance, t, next - t), fmi3OK);
            check_int("step", importer_step(instance, t, (i + 1) * frame - t), fmi3OK);
            t = (i + 1) * frame;
            odd[i] = importer_get(instance, "penetration");
        }
        check_below("error of odd steps, m", error_of(odd, fine, N), allowed);
        m->FreeInstance(instance);
    }
}

/* A force that throws the mass beyond all numbers: the instance stands where its plant stands, at the last
 * good instant, and not at the end of the step. A step from there is no gap in time. */
TEST(rig_diverges)
{
    const struct importer *m = importer();
    struct log log;
    const double step = 0.37;
    double last = -1.0, t = 0.0;
    bool event, terminate, early;
    fmi3Status status = fmi3OK;
    fmi3Instance instance = importer_begin(&log);
    check_int("no damping", importer_set(instance, "damping_N_s_per_m", 0.0), fmi3OK);
    check_int("a force, N", importer_set(instance, "force", -6e10), fmi3OK);
    for (int i = 0; i < 10000 && status == fmi3OK; i++) {
        t = i * step;
        status = m->DoStep(instance, t, step, true, &event, &terminate, &early, &last);
    }
    check_int("the motion left the finite numbers", status, fmi3Error);
    check_contains("text", log.text, "left the finite numbers");
    check_above("the last good instant is inside the step, s", last, t + 1e-6);
    check_below("the last good instant is inside the step, s", last, t + step - 1e-6);
    check_near("it is the plant's, s", last, importer_get(instance, "time"), 1e-12);
    check_int("from the begin of the step", importer_step(instance, t, step), fmi3Error);
    check_contains("text", log.text, "time runs backwards");
    check_int("from there", importer_step(instance, last, step), fmi3Error);
    check_contains("text", log.text, "left the finite numbers");
    m->FreeInstance(instance);
}
