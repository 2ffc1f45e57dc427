/* test_scene.c - an FMU of any scene goes on with the bits
 * of the plant that the library opens by the scene's name. */
#include "tests/fmi/importer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "tests/unit/test.h"

enum { FRAMES = 60 };

/* Half of the frames that this scene's plant runs, FRAMES at most: some motions escape. */
static int frames(void)
{
    union contactplant_memory memory;
    struct contactplant *p = importer_plant(&memory);
    int n = 0;
    while (n < 2 * FRAMES && contactplant_advance(p, contactplant_substeps(p)) == CONTACTPLANT_OK)
        n++;
    check_above("frames", n, 10.0);
    return n / 2;
}

/* The plant goes on for one step of the default experiment. */
static void advance(struct contactplant *p, int frames)
{
    check_int("plant", contactplant_advance(p, (uint64_t)frames * contactplant_substeps(p)), CONTACTPLANT_OK);
}

TEST(scene_description)
{
    const struct importer *m = importer();
    struct log log;
    fmi3Instance instance = importer_begin(&log);
    int n[3] = {0};
    check_string("version", m->GetVersion(), "3.0");
    check_int("logging", m->SetDebugLogging(instance, true, 0, NULL), fmi3OK);
    for (int i = 0; i < m->n_variables; i++) {
        const struct variable *v = &m->variable[i];
        for (int k = 0; k < i; k++)
            check_true(v->name,
                       strcmp(v->name, m->variable[k].name) && v->reference != m->variable[k].reference);
        n[0] += !strcmp(v->causality, "input");
        n[1] += !strcmp(v->causality, "parameter");
        n[2] += !strcmp(v->causality, "output");
        if (v->starts)
            check_near(v->name, importer_get(instance, v->name), v->start, 0.0);
        check_true("inputs and parameters start, others do not",
                   v->starts == (v->causality[0] == 'i' ? !strcmp(v->causality, "input")
                                                        : !strcmp(v->causality, "parameter")));
    }
    union contactplant_memory memory;
    struct contactplant *p = importer_plant(&memory);
    int inputs = contactplant_count(p, CONTACTPLANT_INPUT);
    check_int("inputs", n[0], inputs);
    check_int("parameters", n[1], 4 * inputs + contactplant_count(p, CONTACTPLANT_PARAMETER));
    check_int("outputs", n[2], 3 + contactplant_count(p, CONTACTPLANT_OUTPUT));
    m->FreeInstance(instance);
}

/* To the end, or to where the motion escapes: there the step
 * is an error, and the instance stands where the plant does. */
TEST(scene_bits)
{
    const struct importer *m = importer();
    union contactplant_memory memory;
    struct log log;
    struct contactplant *p = importer_plant(&memory);
    fmi3Instance instance = importer_begin(&log);
    int code = CONTACTPLANT_OK;
    importer_compare("outputs at the start", instance, p);
    for (int i = 0; i < 2 * FRAMES && code == CONTACTPLANT_OK; i++) {
        code = contactplant_advance(p, contactplant_substeps(p));
        check_int("step", importer_step(instance, i * m->step_s, m->step_s),
                  code == CONTACTPLANT_OK ? fmi3OK : fmi3Error);
        importer_compare("outputs, bit by bit", instance, p);
        check_near("time, s", importer_get(instance, "time"), contactplant_time(p), 1e-9 * m->step_s);
    }
    check_int("errors", log.n, code != CONTACTPLANT_OK);
    check_string("text", log.text, contactplant_error(p));
    check_int("terminate", m->Terminate(instance), fmi3OK);
    importer_compare("outputs after the end", instance, p);
    m->FreeInstance(instance);
}

/* Every tick a communication point, and steps of three ticks. */
TEST(scene_ticks)
{
    const struct importer *m = importer();
    union contactplant_memory memory;
    struct log log;
    struct contactplant *p = importer_plant(&memory);
    fmi3Instance instance = importer_begin(&log);
    double tick = contactplant_tick_time(p);
    for (int i = 0; i < 100; i += i < 50 ? 1 : 3) {
        int ticks = i < 50 ? 1 : 3;
        check_int("step", importer_step(instance, i * tick, ticks * tick), fmi3OK);
        check_int("plant", contactplant_advance(p, (uint64_t)ticks), CONTACTPLANT_OK);
        importer_compare("outputs, bit by bit", instance, p);
    }
    m->FreeInstance(instance);
}

/* Two instances in one process, one of which is pushed: each as if it were alone. */
TEST(scene_two_instances)
{
    const struct importer *m = importer();
    const int n = frames();
    union contactplant_memory memory[2];
    struct contactplant *p[2] = {importer_plant(&memory[0]), importer_plant(&memory[1])};
    struct log log[2];
    fmi3Instance instance[2] = {importer_begin(&log[0]), importer_begin(&log[1])};
    double push = 1e-3 * fabs(contactplant_output(p[0], 3)) + 1e-12;
    for (int i = 0; i < n; i++) {
        double force = push * (i % 5);
        fmi3ValueReference first = 256;
        check_int("push", m->SetFloat64(instance[1], &first, 1, &force, 1), fmi3OK);
        if (i > 0) /* a value that the input has already is nothing */
            check_int("push", contactplant_set_sample(p[1], 0, force, 0), CONTACTPLANT_OK);
        for (int k = 0; k < 2; k++) {
            importer_run(instance[k], i, 1);
            advance(p[k], 1);
        }
    }
    importer_compare("outputs of the first", instance[0], p[0]);
    importer_compare("outputs of the second, pushed", instance[1], p[1]);
    m->FreeInstance(instance[0]);
    importer_run(instance[1], n, 1);
    advance(p[1], 1);
    importer_compare("outputs of the second, alone", instance[1], p[1]);
    m->FreeInstance(instance[1]);
}

TEST(scene_state)
{
    const struct importer *m = importer();
    const int n = frames();
    union contactplant_memory memory;
    struct contactplant *p = importer_plant(&memory);
    struct log log, log2;
    fmi3Instance instance = importer_begin(&log), other = importer_instantiate(&log2);
    fmi3FMUState state = NULL, copy = NULL;
    size_t size = 0;
    importer_run(instance, 0, n);
    check_int("get", m->GetFMUState(instance, &state), fmi3OK);
    importer_run(instance, n, n);
    uint64_t later = importer_fingerprint(instance);
    check_int("back", m->SetFMUState(instance, state), fmi3OK);
    check_near("time, s", importer_get(instance, "time"), n * m->step_s, 1e-9 * m->step_s);
    importer_run(instance, n, n);
    check_hex("the same way again", importer_fingerprint(instance), later);
    check_int("size", m->SerializedFMUStateSize(instance, state, &size), fmi3OK);
    uint8_t *byte = malloc(size);
    check_int("bytes", m->SerializeFMUState(instance, state, byte, size), fmi3OK);
    check_int("free", m->FreeFMUState(instance, &state), fmi3OK);
    check_int("from bytes", m->DeserializeFMUState(other, byte, size, &copy), fmi3OK);
    check_int("into an instance that was not initialized", m->SetFMUState(other, copy), fmi3OK);
    importer_run(other, n, n);
    check_hex("another instance goes the same way", importer_fingerprint(other), later);
    check_int("plant", contactplant_advance(p, 2 * (uint64_t)n * contactplant_substeps(p)), CONTACTPLANT_OK);
    importer_compare("which is the plant's", other, p);
    check_int("free", m->FreeFMUState(other, &copy), fmi3OK);
    free(byte);
    m->FreeInstance(instance);
    m->FreeInstance(other);
}

TEST(scene_reset)
{
    const struct importer *m = importer();
    const int n = frames();
    union contactplant_memory memory;
    struct contactplant *p = importer_plant(&memory);
    struct log log;
    fmi3Instance instance = importer_instantiate(&log);
    uint64_t fresh = importer_fingerprint(instance);
    check_int("enter", m->EnterInitializationMode(instance, true, 1e-6, 12.5, true, 100.0), fmi3OK);
    check_int("exit", m->ExitInitializationMode(instance), fmi3OK);
    for (int i = 0; i < n; i++) {
        check_int("step", importer_step(instance, 12.5 + i * m->step_s, m->step_s), fmi3OK);
        advance(p, 1);
    }
    check_near("time, s", importer_get(instance, "time"), 12.5 + n * m->step_s, 1e-9 * m->step_s);
    importer_compare("from another start time", instance, p);
    check_int("reset", m->Reset(instance), fmi3OK);
    check_hex("as if new", importer_fingerprint(instance), fresh);
    m->FreeInstance(instance);
}
