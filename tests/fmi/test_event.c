/* test_event.c - event mode: steps end at the touchdown that the library's plant locates, and the clock ticks
 * there. A plant of the library that is led to the same instants has the same bits. */
#include "tests/fmi/importer.h"

#include <math.h>
#include <stdlib.h>
#include "tests/unit/test.h"

enum { STEPS = 60 };

static bool take_touchdown(struct contactplant *p, struct contactplant_event *first)
{
    struct contactplant_event e;
    bool found = false;
    while (contactplant_next_event(p, &e))
        if (e.touch && !found) {
            *first = e;
            found = true;
        }
    return found;
}

/* The results of a step of an FMU. */
struct said {
    bool event, terminate, early;
    double last;
};

static struct said step(fmi3Instance instance, double from, double to)
{
    struct said s = {.last = -1.0};
    check_int("step",
              importer()->DoStep(instance, from, to - from, true, &s.event, &s.terminate, &s.early, &s.last),
              fmi3OK);
    return s;
}

static bool clock_ticks(fmi3Instance instance)
{
    bool ticks = false;
    check_int("clock", importer()->GetClock(instance, &importer_variable("contact")->reference, 1, &ticks),
              fmi3OK);
    return ticks;
}

/* Event mode from its begin to its end: whether the clock has ticked. */
static bool handle_event(fmi3Instance instance)
{
    const struct importer *m = importer();
    bool flag[5] = {true, true, true, true, true};
    double next = 0.0;
    check_int("event mode", m->EnterEventMode(instance), fmi3OK);
    bool ticked = clock_ticks(instance);
    check_true("read twice: the same", clock_ticks(instance) == ticked);
    check_int("update",
              m->UpdateDiscreteStates(instance, &flag[0], &flag[1], &flag[2], &flag[3], &flag[4], &next),
              fmi3OK);
    check_true("one iteration is enough", !flag[0] && !flag[1] && !flag[2] && !flag[3] && !flag[4]);
    check_true("then it no longer ticks", !clock_ticks(instance));
    check_int("step mode", m->EnterStepMode(instance), fmi3OK);
    return ticked;
}

static fmi3Instance begin(struct log *log, bool early_return)
{
    const struct importer *m = importer();
    fmi3Instance instance = importer_instantiate_events(log, early_return);
    check_int("enter", m->EnterInitializationMode(instance, false, 0.0, 0.0, false, 0.0), fmi3OK);
    check_int("exit", m->ExitInitializationMode(instance), fmi3OK);
    check_true("it begins in event mode, and no contact closes", !clock_ticks(instance));
    check_int("step mode", m->EnterStepMode(instance), fmi3OK);
    return instance;
}

/* When the next touchdown is, seen from where the plant stands; `to` where none is before. The plant stays.
 */
static double scout(struct contactplant *p, double to, struct contactplant_event *e)
{
    size_t size = contactplant_save_size(p);
    void *bytes = malloc(size);
    bool found = false;
    check_int("save", contactplant_save(p, bytes, size), CONTACTPLANT_OK);
    (void)take_touchdown(p, e);
    while (!found && contactplant_time(p) < to - 1e-7 * contactplant_tick_time(p)) {
        double end = (double)(contactplant_tick(p) + 1) * contactplant_tick_time(p);
        if (contactplant_advance_to(p, fmin(end, to)) != CONTACTPLANT_OK)
            break;
        found = take_touchdown(p, e);
    }
    check_int("restore", contactplant_restore(p, bytes, size), CONTACTPLANT_OK);
    free(bytes);
    return found ? e->time_s : to;
}

/* Behind a touchdown, on the grid of instants that a plant knows. */
static void follow(struct contactplant *p, const struct contactplant_event *e)
{
    struct contactplant_event again;
    (void)take_touchdown(p, &again);
    for (double ahead = 1.0; ahead <= 65536.0; ahead *= 2.0) {
        double part = (floor(e->fraction * 65536.0) + ahead) / 65536.0;
        check_int("plant", contactplant_advance_to(p, ((double)e->tick + part) * contactplant_tick_time(p)),
                  CONTACTPLANT_OK);
        if (take_touchdown(p, &again))
            return;
    }
}

/* Steps of the default experiment with every touchdown on the way; how many there were. */
static int follow_steps(fmi3Instance instance, struct contactplant *p, int steps)
{
    double tick = contactplant_tick_time(p), frame = importer()->step_s, worst = 0.0;
    int n = 0;
    for (int i = 0; i < steps; i++) {
        double t = i * frame, to = (i + 1) * frame;
        while (t < to) {
            struct contactplant_event e;
            double reached = scout(p, to, &e);
            struct said s = step(instance, t, to);
            worst = fmax(worst, fabs(s.last - reached) / tick);
            check_true("early, and an event, where the plant has a touchdown",
                       s.early == (reached < to) && s.event == s.early && !s.terminate);
            if (s.early)
                follow(p, &e);
            else
                check_int("plant", contactplant_advance_to(p, to), CONTACTPLANT_OK);
            importer_compare("outputs", instance, p);
            check_near("time, s", importer_get(instance, "time"), s.last, 0.0);
            if (s.event)
                check_true("the clock has ticked", handle_event(instance));
            n += s.early;
            t = s.last;
        }
    }
    check_below("early returns beside EVENT_TIME, ticks", worst, 1e-9);
    return n;
}

/* Half of what the scene's plant runs: some motions escape. */
static int steps_of(void)
{
    union contactplant_memory memory;
    struct contactplant *p = importer_plant(&memory);
    int n = 0;
    while (n < 2 * STEPS && contactplant_advance(p, contactplant_substeps(p)) == CONTACTPLANT_OK)
        n++;
    return n / 2;
}

TEST(scene_touchdowns)
{
    union contactplant_memory memory;
    struct log log;
    struct contactplant *p = importer_plant(&memory);
    fmi3Instance instance = begin(&log, true);
    check_above("touchdowns", follow_steps(instance, p, steps_of()), 0.0);
    check_int("texts in the log", log.n, 0);
    importer()->FreeInstance(instance);
}

/* Without early return the steps are whole and have the plant's bits; the clock ticks at their ends. */
TEST(scene_touchdowns_late)
{
    union contactplant_memory memory;
    struct log log;
    struct contactplant *p = importer_plant(&memory);
    struct contactplant_event e;
    fmi3Instance instance = begin(&log, false);
    double frame = importer()->step_s;
    int n = steps_of();
    for (int i = 0; i < n; i++) {
        struct said s = step(instance, i * frame, (i + 1) * frame);
        check_int("plant", contactplant_advance(p, contactplant_substeps(p)), CONTACTPLANT_OK);
        check_true("an event where the plant had one, and no early return",
                   s.event == take_touchdown(p, &e) && !s.early && s.last == (i + 1) * frame);
        if (s.event)
            check_true("the clock has ticked", handle_event(instance));
    }
    importer_compare("outputs", instance, p);
    importer()->FreeInstance(instance);
}

/* A rig that is shaken loose. */
static fmi3Instance begin_shaken(struct log *log)
{
    fmi3Instance instance = begin(log, true);
    check_int("shaken", importer_set(instance, "drive.force.amplitude", 60.0), fmi3OK);
    return instance;
}

static void shake(struct contactplant *p, fmi3Instance like)
{
    check_int("shaken",
              contactplant_set_drive(p, contactplant_find(p, CONTACTPLANT_INPUT, "force"), 60.0,
                                     importer_get(like, "drive.force.frequency"),
                                     importer_get(like, "drive.force.phase"), 0.0),
              CONTACTPLANT_OK);
}

TEST(rig_touchdowns)
{
    union contactplant_memory memory;
    struct log log;
    struct contactplant *p = importer_plant(&memory);
    fmi3Instance instance = begin_shaken(&log);
    shake(p, instance);
    check_above("touchdowns", follow_steps(instance, p, 5 * STEPS), 20.0);
    importer()->FreeInstance(instance);
}

/* The first touchdown of the shaken rig, beside a plant that nobody has stopped: its time, and there
 * the contact is closed and has no depth yet. */
TEST(rig_first_touchdown)
{
    union contactplant_memory memory;
    struct log log;
    struct contactplant_event e = {.tick = 0};
    struct contactplant *p = importer_plant(&memory);
    fmi3Instance instance = begin_shaken(&log);
    shake(p, instance);
    bool found = false;
    while (!found && contactplant_advance(p, 1) == CONTACTPLANT_OK)
        found = take_touchdown(p, &e);
    struct said s = step(instance, 0.0, 1.0);
    check_true("early", s.early && s.event);
    check_near("time of the first touchdown, ticks", s.last / contactplant_tick_time(p),
               e.time_s / contactplant_tick_time(p), 1e-9);
    check_near("in contact", importer_get(instance, "in_contact"), 1.0, 0.0);
    double depth = importer_get(instance, "penetration");
    double most = 2.0 * e.speed * contactplant_tick_time(p) / 65536.0;
    check_above("depth, m", depth, 0.0);
    check_below("depth, m", depth, most);
    check_true("the clock has ticked", handle_event(instance));
    importer()->FreeInstance(instance);
}

/* A state that stands in event mode, and modes out of order. */
TEST(rig_event_order)
{
    const struct importer *m = importer();
    struct log log, other;
    fmi3FMUState state = NULL;
    bool flag;
    double number;
    fmi3Instance instance = begin_shaken(&log), plain = importer_begin(&other);
    struct said s = step(instance, 0.0, 1.0);
    check_true("a touchdown of the rig", s.early);
    check_int("no clock in step mode",
              m->GetClock(instance, &importer_variable("contact")->reference, 1, &flag), fmi3Error);
    check_contains("text", log.text, "fmi3GetClock is not allowed now: the instance is in step mode");
    check_int("event mode", m->EnterEventMode(instance), fmi3OK);
    check_int("no step in event mode", importer_step(instance, s.last, 1e-3), fmi3Error);
    check_contains("text", log.text, "in event mode");
    check_int("no clock", m->GetClock(instance, &importer_variable("force")->reference, 1, &flag), fmi3Error);
    check_contains("text", log.text, "force is a Float64");
    check_int("NULL", m->GetClock(instance, NULL, 1, &flag), fmi3Error);
    check_int("NULL", m->UpdateDiscreteStates(instance, NULL, &flag, &flag, &flag, &flag, &number),
              fmi3Error);
    check_contains("text", log.text, "NULL");
    check_int("a clock is no number", importer_set(instance, "contact", 1.0), fmi3Error);
    check_int("an input", importer_set(instance, "force", 0.5), fmi3OK);
    check_int("state", m->GetFMUState(instance, &state), fmi3OK);
    check_int("on", m->EnterStepMode(instance), fmi3OK);
    struct said first = step(instance, s.last, 1.0);
    check_int("back", m->SetFMUState(instance, state), fmi3OK);
    check_true("it ticks again", clock_ticks(instance));
    check_int("on", m->EnterStepMode(instance), fmi3OK);
    check_near("the next touchdown, s", step(instance, s.last, 1.0).last, first.last, 0.0);
    check_int("an instance without event mode", m->SetFMUState(plain, state), fmi3Error);
    check_contains("text", other.text, "in event mode, which this instance has not");
    check_int("nor does it enter", m->EnterEventMode(plain), fmi3Error);
    check_contains("text", other.text, "eventModeUsed");
    check_int("free", m->FreeFMUState(instance, &state), fmi3OK);
    check_int("event mode", m->EnterEventMode(instance), fmi3OK);
    check_int("the end", m->Terminate(instance), fmi3OK);
    check_int("anew", m->Reset(instance), fmi3OK);
    m->FreeInstance(instance);
    m->FreeInstance(plain);
}

/* Steps shorter than the grain of plant time, from an instant that was rounded up. */
TEST(rig_touchdown_then_short_steps)
{
    struct log log;
    fmi3Instance instance = begin_shaken(&log);
    double t = step(instance, 0.0, 1.0).last, grain = importer()->step_s / 64.0 / 65536.0;
    for (int i = 0; i < 20; i++, t += 0.2 * grain)
        check_near("time, s", step(instance, t, t + 0.2 * grain).last, t + 0.2 * grain, 0.0);
    check_int("texts in the log", log.n, 0);
    importer()->FreeInstance(instance);
}
