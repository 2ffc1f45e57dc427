/* test_app_stream.c - sampled commands: each names the plant frame at whose start it takes effect. */
#include <math.h>
#include <stdio.h>
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

static struct bus bus;

static uint64_t plant_frame(void)
{
    return bus.app.plant.now.tick / BUS_TICKS;
}

/* Deflection and velocity of y'' + 2 xi y' + y = (2/3) u after
 * a step of 1 (or a ramp 1 per time), t after its start. */
static void step_response(double two_xi, double t, double *y, double *v)
{
    double xi = 0.5 * two_xi, w = sqrt(1.0 - xi * xi), e = exp(-xi * t);
    *y = 2.0 / 3.0 * (1.0 - e * (cos(w * t) + xi / w * sin(w * t)));
    *v = 2.0 / 3.0 * e * sin(w * t) / w;
}

/* Its integral, the response to a ramp. */
static void ramp_response(double two_xi, double t, double *y, double *v)
{
    double step, rate;
    step_response(two_xi, t, &step, &rate);
    *v = step;
    *y = t > 0.0 ? 2.0 / 3.0 * t - rate - two_xi * step : 0.0; /* the equation, integrated once */
}

/* A step so small that the Hertz contact is linear to 1e-6, in frame 10, seen from frame 9 to frame 30. */
TEST(app_stream_hold)
{
    bus_start_rig(&bus);
    bus_run(&bus, 5);
    bus_stream(&bus, RIG_FORCE, 10, 64e-6);
    double worst = 0.0, before = 0.0, two_xi = bus.app.plant.p[RIG_P_TWO_XI], h = bus.app.plant.h;
    while (plant_frame() < 30) {
        bus_run(&bus, 1);
        double t = ((double)bus.app.plant.now.tick - 10 * BUS_TICKS) * h, y, v;
        if (t <= 0.0)
            before = fmax(before, fabs(bus.app.plant.x[0] - 1.0) + fabs(bus.app.plant.x[1]));
        if (t <= 0.0)
            continue;
        step_response(two_xi, t, &y, &v);
        worst = fmax(worst, fabs(bus.app.plant.x[0] - 1.0 - 1e-6 * y) + fabs(bus.app.plant.x[1] - 1e-6 * v));
    }
    check_near("before frame 10: motion", before, 0.0, 1e-15);
    check_below("from frame 10 on: off the closed step response, over the step", worst / 1e-6, 1e-5);
    check_int("applied", bus.app.count[DIAG_STREAM_APPLIED], 1);
    check_int("frames of the stream without a sample", bus.app.count[DIAG_STREAM_MISSED], 19);
    check_near("the last sample is held", bus.app.plant.drive[RIG_FORCE].sample, 1e-6, 1e-13);
}

TEST(app_stream_linear)
{
    bus_start_rig(&bus);
    bus_set(&bus, SETTING_FIRST + SET_STREAM_LINEAR + RIG_FORCE, 1);
    bus_run(&bus, 5);
    bus_stream(&bus, RIG_FORCE, 10, 64e-6);
    double worst = 0.0, two_xi = bus.app.plant.p[RIG_P_TWO_XI], h = bus.app.plant.h;
    while (plant_frame() < 30) {
        bus_run(&bus, 1);
        double t = ((double)bus.app.plant.now.tick - 10 * BUS_TICKS) * h, y, v, y1, v1;
        double frame = BUS_TICKS * h;
        ramp_response(two_xi, fmax(t, 0.0), &y, &v);
        ramp_response(two_xi, fmax(t - frame, 0.0), &y1, &v1);
        worst = fmax(worst, fabs(bus.app.plant.x[0] - 1.0 - 1e-6 * (y - y1) / frame) +
                                fabs(bus.app.plant.x[1] - 1e-6 * (v - v1) / frame));
    }
    check_below("ramp over frame 10: off the closed response, over the step", worst / 1e-6, 1e-5);
    /* The base cannot jump: linear without being asked, and `hold` is refused. */
    bus_stream(&bus, RIG_BASE, 32, 1e-6);
    bus_run(&bus, 3);
    bus_run(&bus, 1);
    double zs = bus.app.plant.scale.length_m;
    check_near("base at the end of its frame, m", bus.app.plant.segment.at[2][RIG_BASE].value * zs, 1e-6,
               1e-13);
    bus_write(&bus, SETTING_FIRST + SET_STREAM_LINEAR + RIG_BASE, 0);
    bus_run(&bus, 1);
    check_int("hold for the base", bus_cause(&bus, WIRE_PARAM_WRITE), CAUSE_RANGE);
}

/* The echoes of input i and the SYNCs before them, since bus_forget: each names the frame that ends with its
 * SYNC. Returns how many came; the last ones first in sample[]. */
static int echoes_of(int i, double *sample, int room, int *wrong)
{
    int n = 0;
    double tick = -1.0;
    for (int k = bus.n_seen - 1; k >= 0 && n < room; k--) {
        const struct message *m = &bus.seen[k];
        if (m->kind == WIRE_STREAM_ECHO + i)
            sample[n++] = m->value[STREAM_ECHO_SAMPLE], tick = m->value[STREAM_ECHO_FRAME];
        if (m->kind == WIRE_SYNC && tick >= 0.0)
            *wrong += m->value[SYNC_TICK] != (tick + 1.0) * BUS_TICKS, tick = -1.0;
    }
    return n;
}

/* Each input's sample in each frame, as it was streamed: late ones never, held ones again, in its own unit.
 */
TEST(app_stream_echo)
{
    double sample[64];
    int wrong = 0;
    bus_start_rig(&bus);
    bus_run(&bus, 5);
    check_int("by default there is none", bus_count(&bus, WIRE_STREAM_ECHO), 0);
    bus_set(&bus, SETTING_FIRST + SET_STREAM_ECHO_EVERY, 1);
    bus_set(&bus, SETTING_FIRST + SET_MOTION_EVERY, 0);
    bus_set(&bus, SETTING_FIRST + SET_CONTACT_EVERY, 0);
    bus_set_now(&bus, SETTING_FIRST + SET_SYNC_EVERY, 100);
    bus_forget(&bus);
    uint64_t first = plant_frame();
    bus_stream(&bus, RIG_FORCE, first + 1, (double)0.1f);
    bus_stream(&bus, RIG_FORCE, first + 3, -7.5);
    bus_stream(&bus, RIG_FORCE, first - 1, 99.0);
    bus_stream(&bus, RIG_BASE, first + 2, 1e-7);
    bus_run(&bus, 5);
    check_int("force: echoes in five frames", echoes_of(RIG_FORCE, sample, 64, &wrong), 5);
    const double force[5] = {-7.5, -7.5, (double)0.1f, (double)0.1f, 0.0};
    for (int i = 0; i < 5; i++)
        check_near("  the last ones first, N", sample[i], force[i], 0.0);
    check_int("base: echoes", echoes_of(RIG_BASE, sample, 64, &wrong), 5);
    check_near("  in m, on its line at the end of its frame", sample[2], (double)1e-7f, 0.0);
    check_near("  before it", sample[3], 0.0, 0.0);
    check_int("an input that nothing drives: echoes", echoes_of(RIG_STIFFNESS, sample, 64, &wrong), 5);
    check_int("echoes that are not of the frame before their SYNC", wrong, 0);
    bus_order_now(&bus, CONTROL_PAUSE);
    bus_forget(&bus);
    bus_run(&bus, 10);
    check_int("while plant time stands: none", bus_count(&bus, WIRE_STREAM_ECHO), 0);
}

TEST(app_stream_guards)
{
    bus_start_rig(&bus);
    bus_run(&bus, 20);
    bus_stream(&bus, RIG_FORCE, plant_frame() - 1, 1.0);
    bus_run(&bus, 1);
    check_int("the frame before: late", bus_cause(&bus, WIRE_STREAM), CAUSE_LATE);
    check_near("late by, ticks", bus_value(&bus, WIRE_REPLY, REPLY_TICKS_LATE), BUS_TICKS, 0);
    check_int("counted", bus.app.count[DIAG_LATE], 1);
    check_true("and not applied", !drive_active(&bus.app.plant.drive[RIG_FORCE]));
    bus_stream(&bus, RIG_FORCE, plant_frame(), 1.0);
    bus_run(&bus, 1);
    check_near("the frame that begins now: applied, N", bus.app.plant.drive[0].sample * 64.0, 1.0, 1e-12);
    check_near("of one frame, the newest wins, N",
               (bus_stream(&bus, 0, plant_frame() + 1, 7.0), bus_stream(&bus, 0, plant_frame() + 1, -8.0),
                bus_run(&bus, 2), bus.app.plant.drive[0].sample * 64.0),
               -8.0, 1e-12);
    /* Out of order: each waits for its own frame. */
    uint64_t now = plant_frame();
    bus_stream(&bus, 0, now + 2, 30.0);
    bus_stream(&bus, 0, now, 10.0);
    bus_stream(&bus, 1, now + 1, 5.0);
    bus_stream(&bus, 0, now + 1, 20.0);
    for (int i = 1; i <= 3; i++) {
        bus_run(&bus, 1);
        check_near("in frame order, N", bus.app.plant.drive[0].sample * 64.0, 10.0 * i, 1e-12);
    }
    check_near("another channel, N", bus.app.plant.drive[1].sample * 64.0, 5.0, 1e-12);
    uint32_t missed = bus.app.count[DIAG_STREAM_MISSED];
    bus_run(&bus, 10);
    check_int("two silent streams over 10 frames: missed", bus.app.count[DIAG_STREAM_MISSED] - missed, 20);
    bus_order(&bus, CONTROL_PAUSE);
    bus_run(&bus, 10);
    check_int("paused: plant frames stand and none is missed", bus.app.count[DIAG_STREAM_MISSED] - missed,
              20);
    bus_stream(&bus, 0, plant_frame(), 3.0);
    bus_control(&bus, CONTROL_STEP, 1);
    bus_run(&bus, 1);
    check_near("a sample while paused applies to the next frame stepped, N",
               bus.app.plant.drive[0].sample * 64.0, 3.0, 1e-12);
    bus_forget(&bus);
    bus_stream(&bus, 0, plant_frame(), 64.0001e9);
    bus_run(&bus, 1);
    check_int("beyond the drive's limit", bus_cause(&bus, WIRE_STREAM), CAUSE_RANGE);
    bus_order(&bus, CONTROL_STOP);
    bus_silent(&bus, 1);
    bus_next_session(&bus);
    bus_run(&bus, 1);
    bus_stream(&bus, 0, plant_frame(), 1.0);
    bus_run(&bus, 1);
    check_int("stopped", bus_cause(&bus, WIRE_STREAM), CAUSE_STATE);
    missed = bus.app.count[DIAG_STREAM_MISSED];
    bus_order(&bus, CONTROL_START);
    bus_run(&bus, 10);
    check_int("after a stop no stream goes on: missed", bus.app.count[DIAG_STREAM_MISSED] - missed, 0);
}

/* A sample and a FIRE on both sides of a wrap: of the frame's 16 bits, of the tick's 32 bits. */
static void across(uint64_t wrap_tick, const char *what)
{
    bus_start_rig(&bus);
    bus.app.plant.now.tick = wrap_tick - 3 * BUS_TICKS;
    printf("      across %s\n", what);
    bus_stream(&bus, 0, (wrap_tick / BUS_TICKS) - 1, 1.0);
    bus_stream(&bus, 0, wrap_tick / BUS_TICKS, 2.0);
    bus_stream(&bus, 0, wrap_tick / BUS_TICKS + 1, 3.0);
    bus_arm(&bus, 1, ARM_AMPLITUDE, 4.0);
    bus_fire(&bus, 2, false, wrap_tick + 5, 0);
    bus_run(&bus, 2);
    check_near("two frames before: sample, N", bus.app.plant.drive[0].sample, 0.0, 0.0);
    for (int i = 1; i <= 3; i++) {
        bus_run(&bus, 1);
        check_near("sample, N", bus.app.plant.drive[0].sample * 64.0, i, 1e-12);
        check_near("fired, N", drive_target(&bus.app.plant.drive[1]).amplitude * 64.0, i > 1 ? 4.0 : 0.0,
                   1e-12);
        if (i == 1)
            check_near("SYNC: tick, low 32 bits", bus_value(&bus, WIRE_SYNC, SYNC_TICK),
                       (double)(uint32_t)wrap_tick, 0);
    }
    bus_stream(&bus, 0, wrap_tick / BUS_TICKS - 1, 9.0);
    bus_arm(&bus, 1, ARM_AMPLITUDE, 9.0);
    bus_fire(&bus, 2, false, wrap_tick - 1, 0);
    bus_run(&bus, 1);
    check_int("both from before the wrap, after it: late", bus.app.count[DIAG_LATE], 2);
    bus_forget(&bus);
    bus_order(&bus, CONTROL_PAUSE);
    bus_control(&bus, CONTROL_RUN_UNTIL, (double)(uint32_t)(wrap_tick + 20 * BUS_TICKS));
    bus_run(&bus, 30);
    check_int("RUN_UNTIL", (int64_t)bus.app.plant.now.tick, (int64_t)(wrap_tick + 20 * BUS_TICKS));
}

TEST(app_stream_wrap)
{
    across(UINT64_C(65536) * BUS_TICKS, "frame 2^16");
    across(UINT64_C(1) << 32, "tick 2^32");
    across(UINT64_C(3) << 32, "tick 3 * 2^32");
}

TEST(app_stream_full)
{
    bus_start_rig(&bus);
    bus_run(&bus, 1);
    for (uint64_t i = 0; i < MAILBOX_SAMPLES; i++)
        bus_stream(&bus, (int)(i % 4), 20 + i, 1e-3);
    bus_run(&bus, 1);
    check_int("as many samples as there is room for: refused", bus.app.count[DIAG_FULL], 0);
    bus_stream(&bus, 0, 19, 1e-3);
    bus_run(&bus, 1);
    check_int("one more", bus_cause(&bus, WIRE_STREAM), CAUSE_FULL);
    bus_stream(&bus, 0, 20, 2e-3);
    bus_run(&bus, 1);
    check_int("but a newer one of a frame that waits has room", bus.app.count[DIAG_FULL], 1);
    bus_run(&bus, 140);
    check_int("all applied", bus.app.count[DIAG_STREAM_APPLIED], MAILBOX_SAMPLES);
    check_int("nothing left waiting", bus.app.mailbox.n_samples, 0);
}
