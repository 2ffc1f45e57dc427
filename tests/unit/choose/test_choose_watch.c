/* test_choose_watch.c - the conditions that void a certificate, tried on the bus.
 *
 * The scene that choose --out writes stays quiet in the motion that was certified. It trips when a command
 * brings the condition about, and climbs where it can. */
#include <math.h>
#include <string.h>
#include "firmware/app/plant_scene.h"
#include "host_sim/choose/choose.h"
#include "host_sim/choose/choose_print.h"
#include "host_sim/choose/choose_run.h"
#include "host_sim/choose/choose_search.h"
#include "host_sim/choose/choose_watch.h"
#include "host_sim/scene/scene_file.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/rolling_contact.h"
#include "models/shaft_views.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

static struct bus bus;
static struct choose_certificate certificate;
static double scratch[METHOD_SCRATCH];

static const struct choose_attempt *chosen_attempt(void)
{
    return &certificate.verdict[certificate.choice].attempt[certificate.method];
}

static void certify_sweep(const struct scene *s, const struct choose_sweep *w, const char *model)
{
    bool escaped;
    memset(&certificate, 0, sizeof certificate);
    certificate.title = "test";
    certificate.scene = *s;
    certificate.sweep = *w;
    check_no_error("a certificate", choose_search(&certificate, NULL, &escaped));
    check_true("a certificate", certificate.met);
    check_string("of", chosen_attempt()->scene.model->name, model);
    check_true("with a watch, which is the first condition",
               choose_watched(&certificate) == &certificate.condition[0].watch);
    for (int i = 1; i < certificate.n_conditions; i++)
        check_true("the only one, and not farther than any that is not refused",
                   certificate.condition[i].guard == GUARD_BUS ||
                       (certificate.condition[i].guard == GUARD_NONE &&
                        certificate.condition[i].factor >= certificate.condition[0].factor));
}

static void certify(const struct scene *s, const char *model)
{
    certify_sweep(s, &(struct choose_sweep){.input = 0}, model);
}

/* The scene as choose --out writes it, running on the bus from its start. */
static void run_written(struct scene *s)
{
    static char text[SCENE_FILE_BYTES];
    char why[SCENE_FILE_REASON];
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    struct watch_limits l;
    FILE *f = tmpfile();
    choose_write(f, &certificate);
    rewind(f);
    check_true("it is a scene", scene_file_parse("written", text, fread(text, 1, sizeof text, f), s, why));
    fclose(f);
    scenes_resolve(s, si, drive);
    struct app_config a = bus_config();
    a.model = s->model;
    a.si = si;
    a.method = method_find(s->method);
    a.tol = s->tolerance;
    a.frame_s = s->frame_s;
    a.substeps = (uint32_t)s->substeps;
    a.dilation = s->dilation;
    a.scratch = scratch;
    check_true("with a watch", plant_scene_watch(s, s->dilation, &l));
    a.watch = &l;
    a.promote = s->watch.promote;
    bus_start(&bus, &a);
    plant_scene_begin(&bus.app.plant, s, si, drive);
    bus_run(&bus, 1);
    bus_order(&bus, CONTROL_START);
}

/* Over all the time asked; told only now and then what has been seen, for there is much. */
static void check_quiet(void)
{
    for (double left = choose_frames(&certificate.scene); left > 0.0; left -= 100.0) {
        bus_run(&bus, left < 100.0 ? (int)left : 100);
        bus_forget(&bus);
    }
    check_int("quiet in the motion that was certified", bus.app.count[DIAG_WATCH_TRIPS], 0);
}

static void check_tripped(int observable, const struct model *model)
{
    check_int("it trips", bus.app.count[DIAG_WATCH_TRIPS], 1);
    check_near("the flag", bus_value(&bus, WIRE_STATUS, STATUS_WATCH), 1, 0);
    check_near("WATCH says by what", bus_value(&bus, WIRE_WATCH, WATCH_OBSERVABLE), observable, 0);
    check_near("no fault", bus_value(&bus, WIRE_STATUS, STATUS_FAULTS), 0, 0);
    check_string("the plant is", bus.app.plant.model->name, model->name);
}

/* The drive of an input as it will be from the next ticks on. */
static void drive(int input, double amplitude, double Hz)
{
    bus_drive(&bus, input, amplitude, Hz, 0.0, 0.01);
    bus_fire(&bus, 1u << input, false, bus.app.plant.now.tick + 4, 0);
}

/* A shaft in soft gap springs under a force at its middle, which
 * touches them: the other modes move by 5e-4 of the first. */
TEST(choose_watch_mode)
{
    struct scene s;
    double reach = 0.0;
    scenes_default(&s, &shaft_bearing);
    s.value[SHAFT_KG1] = s.value[SHAFT_KG3] = 2e4;
    s.frame_s = 2.5e-4; /* so short a step the full shaft takes as well */
    s.substeps = 4.0;
    s.drive[1] = (struct scene_drive){.amplitude = 3.0, .frequency_Hz = 12.0};
    s.observable = 0.0;
    s.over = 1.0;
    s.tolerance = 0.05;
    certify(&s, "shaft_bearing_mode");
    const struct scene_watch *w = choose_watched(&certificate);
    check_is("of its position either way", w->observable, ==, SHAFT_OUTPUTS);
    check_is("of its position either way", w->above, >, 0.0);
    check_near("by as much", w->below, -w->above, 0.0);
    run_written(&s);
    for (int i = 0; i < (int)choose_frames(&certificate.scene); i++) {
        bus_run(&bus, 1);
        bus_forget(&bus);
        reach = fmax(reach, fabs(watch_read(&bus.app.plant, SHAFT_OUTPUTS)));
    }
    check_int("quiet in the motion that was certified", bus.app.count[DIAG_WATCH_TRIPS], 0);
    check_near("the factor is that of its largest position", certificate.condition[0].factor,
               w->above / reach, 1e-6);
    check_above("farther than it goes", certificate.condition[0].factor, 1.2);
    drive(1, 3.0 * 6.0, 12.0);
    bus_run(&bus, 500);
    check_tripped(SHAFT_OUTPUTS, &shaft_bearing);
    check_above("beyond its limit", fabs(bus_value(&bus, WIRE_WATCH, WATCH_VALUE)), w->above * (1.0 - 1e-7));
}

/* The linear model is the shaft itself up to the first touch. */
TEST(choose_watch_gap)
{
    struct scene s = scenes_find("shaft-fig16-705")->scene;
    s.over = 0.5;
    certify(&s, "shaft_bearing_linear");
    const struct scene_watch *w = choose_watched(&certificate);
    check_is("of penetration, from 0 on", w->observable, ==, 2.0);
    check_is("of penetration, from 0 on", fabs(w->above), <=, 0.0);
    run_written(&s);
    check_quiet();
    drive(1, 10.0 * certificate.condition[0].factor * s.value[SHAFT_PAPER_P1 + 1], 705.0);
    bus_run(&bus, 500);
    check_tripped(2, &shaft_bearing);
}

/* A linear law that was good enough though contact is lost: the watch is around that motion. Far above
 * resonance the velocity is nearly that of a free mass. */
TEST(choose_watch_lost)
{
    struct scene s;
    scenes_default(&s, &hertz_rig);
    s.drive[RIG_FORCE] = (struct scene_drive){.amplitude = 4000.0, .frequency_Hz = 2000.0};
    s.observable = 1.0;
    s.over = 0.5;
    s.tolerance = 0.1;
    certify(&s, "hertz_rig_linear");
    const struct scene_watch *w = choose_watched(&certificate);
    check_is("of penetration, apart as well", w->observable, ==, 2.0);
    check_is("of penetration, apart as well", w->below, <, 0.0);
    check_near("here already", certificate.condition[0].factor, 1.0, 0.0);
    run_written(&s);
    check_quiet();
    drive(RIG_FAST_FORCE, 1800.0, 800.0);
    bus_run(&bus, 300);
    check_tripped(2, &hertz_rig);
}

/* Free and undamped, the phase drifts: the certificate has a time, and the watch ends it. */
TEST(choose_watch_time)
{
    struct scene s = scenes_find("nayak-fig3")->scene;
    certify(&s, "rolling_contact");
    const struct scene_watch *w = choose_watched(&certificate);
    check_is("of time, above only", w->observable, ==, MODEL_TIME);
    check_is("of time, above only", w->below, <=, -SCENE_UNBOUNDED);
    check_true("nothing to climb to", !w->promote);
    check_above("longer than was asked", w->above, s.over);
    check_near("factor", certificate.condition[0].factor, w->above / s.over, 1e-12);
    check_string("another motion is farther", certificate.condition[1].name, "motion");
    run_written(&s);
    check_quiet();
    double frame = floor(w->above * s.dilation / s.frame_s);
    while ((double)bus.app.plant.now.tick < (frame - 1.0) * s.substeps) {
        bus_run(&bus, 1);
        bus_forget(&bus);
    }
    check_int("quiet until then", bus.app.count[DIAG_WATCH_TRIPS], 0);
    bus_run(&bus, 3);
    check_tripped(MODEL_TIME, &rolling_contact);
    double late = bus_value(&bus, WIRE_WATCH, WATCH_VALUE) - w->above * s.dilation;
    check_is("within a tick of it, bus seconds", late, >, -1e-7);
    check_is("within a tick of it, bus seconds", late, <, s.frame_s / s.substeps + 1e-7);
}

static struct scene averaged(double amplitude, double slow_Hz, double fast_Hz)
{
    struct scene s;
    scenes_default(&s, &hertz_rig);
    s.drive[RIG_FORCE] = (struct scene_drive){.amplitude = amplitude, .frequency_Hz = slow_Hz};
    s.drive[RIG_STIFFNESS] = (struct scene_drive){.amplitude = 0.001, .frequency_Hz = fast_Hz};
    s.observable = 0.0;
    s.over = 0.6;
    s.tolerance = 0.03;
    return s;
}

/* Averaged over a fast modulation of the stiffness: it is
 * fast no more beside a mass so light, and nothing can climb. */
TEST(choose_watch_averaged)
{
    struct scene s = averaged(0.2, 100.0, 900.0);
    certify(&s, "hertz_rig_averaged");
    const struct scene_watch *w = choose_watched(&certificate);
    check_is("of the eigenfrequency", w->observable, ==, MODEL_EIGENFREQUENCY);
    check_true("of the eigenfrequency", !w->promote);
    check_near("a third of the fast drive's, Hz", w->above, 300.0, 1e-9);
    run_written(&s);
    check_quiet();
    bus_set(&bus, RIG_MASS, s.value[RIG_MASS] / 4.0);
    bus_run(&bus, 3);
    check_tripped(MODEL_EIGENFREQUENCY, &hertz_rig_averaged);
}

/* An averaged model whose slow drive is nearer to a third of the fast one than its eigenfrequency is. */
TEST(choose_watch_slow_drive)
{
    struct scene s = averaged(0.2, 270.0, 900.0);
    certify(&s, "hertz_rig_averaged");
    const struct scene_watch *w = choose_watched(&certificate);
    check_is("of the drives' frequency", w->observable, ==, MODEL_DRIVE_FREQUENCY);
    check_true("of the drives' frequency", !w->promote);
    check_near("a third of the fast drive's, Hz", w->above, 300.0, 1e-9);
    check_near("factor", certificate.condition[0].factor, 300.0 / 270.0, 1e-12);
    run_written(&s);
    check_quiet();
    drive(RIG_FORCE, 0.2, 299.0);
    bus_run(&bus, 50);
    check_int("just below", bus.app.count[DIAG_WATCH_TRIPS], 0);
    drive(RIG_FORCE, 0.2, 301.0);
    bus_run(&bus, 50);
    check_tripped(MODEL_DRIVE_FREQUENCY, &hertz_rig_averaged);
    check_near("at its first tick above", bus_value(&bus, WIRE_WATCH, WATCH_VALUE), 300.0, 0.2);
}

/* A third of it exactly: within, whatever is rounded. */
TEST(choose_watch_third)
{
    static const double third[] = {250.79799999999972, 251.5089999999997, 252.45699999999968};
    for (int i = 0; i < 3; i++) {
        struct scene s = averaged(0.05, third[i], 3.0 * third[i]);
        certify(&s, "hertz_rig_averaged");
        check_near("here", certificate.condition[0].factor, 1.0, 1e-8);
        run_written(&s);
        bus_run(&bus, 50);
        check_int("quiet", bus.app.count[DIAG_WATCH_TRIPS], 0);
    }
}

/* The full model by taylor: nothing that a plant shows
 * says when another motion begins, so any change trips. */
TEST(choose_watch_changes)
{
    struct scene s = scenes_find("rig")->scene;
    certify(&s, "hertz_rig");
    const struct scene_watch *w = choose_watched(&certificate);
    check_is("of changes, nothing to climb to", w->observable, ==, MODEL_CHANGES);
    check_true("of changes, nothing to climb to", !w->promote);
    check_near("none", w->above, 0.0, 0.0);
    check_near("as far as its error may grow", certificate.condition[0].factor,
               certificate.scene.tolerance / chosen_attempt()->error, 1e-12);
    check_contains("it says so", certificate.condition[0].text, "so any change counts");
    run_written(&s);
    check_quiet();
    uint64_t tick = bus.app.plant.now.tick + 4;
    drive(RIG_FORCE, 20.0, 150.0); /* as it was: a change all the same */
    bus_run(&bus, 10);
    check_tripped(MODEL_CHANGES, &hertz_rig);
    check_int("at the tick of the fire", (int64_t)bus.app.watch.tick, (int64_t)tick);
}

/* One mode that a force elsewhere would void before a
 * larger one: its state has no trace of that. It climbs. */
TEST(choose_watch_asymmetry)
{
    struct scene s;
    scenes_default(&s, &shaft_bearing);
    s.value[SHAFT_KG1] = s.value[SHAFT_KG3] = 2e4;
    s.frame_s = 2.5e-4;
    s.substeps = 4.0;
    s.drive[1] = (struct scene_drive){.amplitude = 0.1, .frequency_Hz = 12.0};
    s.observable = 0.0;
    s.over = 1.0;
    s.tolerance = 5e-4;
    certify(&s, "shaft_bearing_mode");
    check_is("of changes", choose_watched(&certificate)->observable, ==, MODEL_CHANGES);
    check_string("for the modes left out", certificate.condition[0].name, "dropped modes");
    check_above("nearer than the mode's own position", certificate.condition[1].factor,
                certificate.condition[0].factor);
    run_written(&s);
    check_quiet();
    drive(0, 0.05, 12.0);
    bus_run(&bus, 10);
    check_tripped(MODEL_CHANGES, &shaft_bearing);
}

/* A sweep is made of commands: those that were certified are no change. */
TEST(choose_watch_sweep)
{
    const struct choose_sweep sweep = {.input = RIG_FORCE, .Hz = {100.0, 240.0, 10, false}};
    struct scene s = scenes_find("rig")->scene;
    s.tolerance = 0.005;
    certify_sweep(&s, &sweep, "hertz_rig");
    check_near("as many changes as holds", choose_watched(&certificate)->above, 20.0, 0.0);
    check_near("a drive's frequency counts from the highest", certificate.condition[1].factor, 250.0 / 240.0,
               1e-12);
    run_written(&s);
    for (int i = 0; i < 20; i++) {
        drive(RIG_FORCE, 20.0, 100.0 + 140.0 / 9.0 * (i < 10 ? i : 19 - i));
        bus_run(&bus, 50);
    }
    check_int("quiet in the sweep that was certified", bus.app.count[DIAG_WATCH_TRIPS], 0);
    drive(RIG_FORCE, 20.0, 100.0);
    bus_run(&bus, 50);
    check_tripped(MODEL_CHANGES, &hertz_rig);
}

/* A plant at rest on a reduced model: no motion whose
 * limits could be carried over, and a watch all the same. */
TEST(choose_watch_rest)
{
    struct scene s;
    scenes_default(&s, &hertz_rig);
    s.over = 0.2;
    s.tolerance = 0.01;
    certify(&s, "hertz_rig_linear");
    check_is("of changes", choose_watched(&certificate)->observable, ==, MODEL_CHANGES);
    check_true("that climbs", choose_watched(&certificate)->promote == &hertz_rig);
    run_written(&s);
    check_quiet();
    drive(RIG_FORCE, 2.0, 50.0);
    bus_run(&bus, 10);
    check_int("trips", bus.app.count[DIAG_WATCH_TRIPS], 1);
}

/* The bus refuses the commands that the certificate says it refuses, and takes the others. */
TEST(choose_watch_guards)
{
    struct app_config a = bus_config();
    const struct choose_condition *k = &certificate.condition[1];
    struct scene s = scenes_find("rig")->scene;
    s.drive[RIG_FORCE].frequency_Hz = 200.0; /* near the 250 Hz that four ticks of a frame each allow */
    s.drive[RIG_FORCE].amplitude *= 0.2;
    certify(&s, "hertz_rig");
    check_string("the condition behind it", choose_guard_name[k->guard], "refused on the bus");
    check_string("is a drive's frequency", k->name, "drive frequency");
    check_below("and nearer", k->factor, certificate.condition[0].factor);
    a.substeps = (uint32_t)chosen_attempt()->scene.substeps;
    a.method = method_find(chosen_attempt()->scene.method);
    a.tol = chosen_attempt()->scene.tolerance;
    a.scratch = scratch;
    bus_start_running(&bus, &a);
    double Hz = k->factor * certificate.scene.drive[RIG_FORCE].frequency_Hz;
    bus_arm(&bus, RIG_FORCE, ARM_FREQUENCY, 1.001 * Hz);
    bus_run(&bus, 1);
    check_int("just above", bus_cause(&bus, WIRE_ARM), CAUSE_RANGE);
    bus_forget(&bus);
    bus_arm(&bus, RIG_FORCE, ARM_FREQUENCY, 0.999 * Hz);
    bus_run(&bus, 1);
    check_is("just below", bus_cause(&bus, WIRE_ARM), !=, CAUSE_RANGE);
}

static double growth_of(double rate, double least)
{
    enum { N = 800 };
    double a[N], b[N] = {0.0};
    for (int i = 0; i < N; i++)
        a[i] = 1e-9 * exp(rate * (i + 1) / N);
    const struct choose_record ra = {.value = a, .n_values = N}, rb = {.value = b, .n_values = N};
    return choose_growth(&ra, &rb, 1.0, least);
}

TEST(choose_growth)
{
    check_near("e-folds of the eighth part", growth_of(8.0, 0.0), exp(1.0), 1e-12);
    check_near("what decays does not grow", growth_of(-8.0, 0.0), 1.0, 0.0);
    check_near("what means nothing does not grow", growth_of(8.0, 1.0), 1.0, 1e-5);
}
