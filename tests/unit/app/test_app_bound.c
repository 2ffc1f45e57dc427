/* test_app_bound.c - at the edge of every budget a frame still
 * ends: what is left is run through, counted and flagged. */
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { BOUND_FRAMES = 20, HEALTH_ROUND = 400 };

static struct bus bus;
static double bound_scratch[METHOD_SCRATCH];
static step_function *sound;
static int n_calls, n_through;

/* The plant's own method, its calls counted. */
static enum step_status counted(const struct model *m, const double *p, double *w, const struct segment *e,
                                unsigned regime, double *x, struct crossing *c)
{
    n_calls++;
    n_through += (regime & REGIME_ANY) != 0;
    return sound(m, p, w, e, regime, x, c);
}

/* One that gives up half-way whenever it may. */
static enum step_status tired(const struct model *m, const double *p, double *w, const struct segment *e,
                              unsigned regime, double *x, struct crossing *c)
{
    struct segment half;
    n_calls++;
    if (regime & REGIME_ANY) {
        n_through++;
        return sound(m, p, w, e, regime, x, c);
    }
    segment_head(e, m->n_inputs, 0.5 * e->length, &half);
    c->done = half.length;
    enum step_status status = sound(m, p, w, &half, REGIME_ANY, x, c);
    return status == STEP_END ? STEP_BUDGET : status;
}

static void run_and_check(step_function *by, uint32_t *counter, unsigned item)
{
    sound = bus.app.plant.step;
    bus.app.plant.step = by;
    bus.app.plant.bind_run = NULL;
    int longest = 0;
    uint64_t tick = bus.app.plant.now.tick;
    uint32_t before = *counter;
    for (int i = 0; i < BOUND_FRAMES; i++) {
        int calls = n_calls;
        bus_run(&bus, 1);
        longest = n_calls - calls > longest ? n_calls - calls : longest;
    }
    check_int("every frame ends on its tick", (int64_t)(bus.app.plant.now.tick - tick),
              BOUND_FRAMES * BUS_TICKS);
    check_below("calls of the method in the worst frame", longest, BUS_TICKS * PLANT_PIECES);
    check_above("ticks that were run through", n_through, 0);
    check_int("and counted", bus.app.plant.counts.budget, n_through);
    check_int("most pieces", bus.app.plant.counts.pieces_max, PLANT_PIECES);
    check_int("fault bit", bus.app.faults & FAULT_BUDGET, FAULT_BUDGET);
    check_int("it is a warning: the plant goes on", bus.app.state, STATE_RUNNING);
    bus.app.plant.step = sound;
    bus.app.plant.bind_run = NULL;
    before = *counter - before;
    bus_run(&bus, HEALTH_ROUND);
    check_above("STATUS shows the fault",
                (double)((int)bus_value(&bus, WIRE_STATUS, STATUS_FAULTS) & FAULT_BUDGET), 0);
    check_above("HEALTH tells the count", bus_item(&bus, WIRE_HEALTH, item), (double)before - 1.0);
}

/* Ticks of 45 of the rig's times: an undamped mass leaves
 * contact and returns every 6.8 of them, 13 switches a tick. */
TEST(app_bound_switches)
{
    struct app_config c = bus_config();
    double si[MODEL_PARAMETERS], state[2] = {2.0, 0.0};
    for (int i = 0; i < RIG_PARAMETERS; i++)
        si[i] = hertz_rig_parameters[i].initial;
    si[RIG_DAMPING] = 0.0;
    c.si = si;
    c.method = &taylor;
    c.tol = 1e-2;
    c.scratch = bound_scratch;
    c.frame_s = BUS_TICKS * 45.0 / (6.283185307179586477 * 230.0);
    bus_start_running(&bus, &c);
    n_calls = n_through = 0;
    plant_set_state(&bus.app.plant, state);
    run_and_check(counted, &bus.app.plant.counts.budget, DIAG_SWITCH_BUDGET);
    check_int("finite", bus.app.plant.counts.not_finite, 0);
    check_above("switches located", bus.app.plant.counts.switches, BOUND_FRAMES * BUS_TICKS);
}

TEST(app_bound_method)
{
    bus_start_rig(&bus);
    bus_run(&bus, 2);
    n_calls = n_through = 0;
    run_and_check(tired, &bus.app.plant.counts.work, DIAG_METHOD_BUDGET);
    check_int("times the method gave up", bus.app.plant.counts.work,
              BOUND_FRAMES * BUS_TICKS * (PLANT_PIECES - 1));
    check_int("switches", bus.app.plant.counts.switches, 0);
}
