/* test_orbit.c - periodic motions of a rig: the closed form at a small drive, the plant left to settle,
 * slopes against differences, and the jump of a swept rig. */
#include "host_sim/fit/motion/follow.h"
#include "host_sim/fit/motion/linear.h"
#include "models/hertz_rig.h"
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>

static const double rig[] = {6.1, 3.9e9, 80.0, 150.0};

static struct orbit_task task_of(double amplitude, double preload)
{
    static double scratch[METHOD_SCRATCH];
    struct orbit_task t = {.model = &hertz_rig,
                           .method = &taylor,
                           .tol = 1e-11,
                           .scratch = scratch,
                           .input = RIG_FORCE,
                           .amplitude = amplitude};
    memcpy(t.si, rig, sizeof rig);
    t.si[RIG_PRELOAD] = preload;
    return t;
}

static struct orbit motion_of(struct orbit_task *t, double frequency_Hz)
{
    struct orbit o = {.frequency_Hz = frequency_Hz};
    double unit[MODEL_STATES];
    orbit_rest(t, o.x, unit);
    check_true("there is a motion with the period of the drive", orbit_find(t, &o));
    return o;
}

/* F/(k - m w^2 + i w c) with k = 3/2 k^(2/3) N^(1/3). */
TEST(orbit_of_a_small_drive)
{
    struct orbit_task t = task_of(1e-3, 80.0);
    double stiffness = 1.5 * pow(rig[1], 2.0 / 3.0) * cbrt(rig[2]), re, im;
    const double frequency[] = {150.0, 240.0, 256.0, 300.0};
    for (int i = 0; i < 4; i++) {
        double w = 2.0 * 3.14159265358979 * frequency[i], a = stiffness - rig[0] * w * w, b = w * rig[3];
        double exact_re = 1e-3 * a / (a * a + b * b), exact_im = -1e-3 * b / (a * a + b * b);
        double size = hypot(exact_re, exact_im);
        struct orbit o = motion_of(&t, frequency[i]);
        check_near("real part, over its size", (o.re - exact_re) / size, 0.0, 1e-6);
        check_near("imaginary part", (o.im - exact_im) / size, 0.0, 1e-6);
        check_true("the linear plant responds", linear_response(&t, frequency[i], &re, &im));
        check_near("its real part", (re - exact_re) / size, 0.0, 1e-6);
        check_near("its imaginary part", (im - exact_im) / size, 0.0, 1e-6);
    }
}

TEST(orbit_is_where_the_plant_settles)
{
    struct orbit_task t = task_of(3.0, 80.0);
    struct orbit o = motion_of(&t, 262.0), settled = o;
    check_true("it is stable", orbit_is_stable(&t, &o));
    settled.x[0] *= 1.2;
    check_true("the plant runs", orbit_settle(&t, &settled, 600));
    check_near("position, over the static one", (settled.x[0] - o.x[0]) / 7.5e-6, 0.0, 1e-8);
}

TEST(orbit_slopes)
{
    struct orbit_task below = task_of(2.0, 80.0 * (1.0 - 1e-4)), above = task_of(2.0, 80.0 * (1.0 + 1e-4)),
                      t = task_of(2.0, 80.0);
    struct orbit o = motion_of(&t, 264.0), low = motion_of(&below, 264.0), high = motion_of(&above, 264.0);
    double re, im, size = hypot(o.re, o.im);
    check_true("map and slopes", orbit_sharpen(&t, &o));
    check_true("a slope over the preload", orbit_slope(&below, &above, &o, 2e-4, &re, &im));
    check_near("real part", (re - (high.re - low.re) / 2e-4) / size, 0.0, 1e-5);
    check_near("imaginary part", (im - (high.im - low.im) / 2e-4) / size, 0.0, 1e-5);
}

/* tests/fit/rig_curves.c, another integrator, swept in steps of 5 Hz: up it jumps between 245 and 250 Hz. */
TEST(branch_jumps_where_a_rig_does)
{
    enum { POINTS = 35, BEFORE = 19 };
    static struct follow_point at[POINTS];
    double frequency[POINTS];
    struct orbit_task t = task_of(3.0, 80.0);
    for (int i = 0; i < POINTS; i++)
        frequency[i] = 150.0 + 5.0 * i;
    check_int("jumps on the way up", follow_curve(&t, frequency, POINTS, 1, at), 1);
    check_true("between 245 and 250 Hz", at[BEFORE + 1].jump_Hz > 245.0 && at[BEFORE + 1].jump_Hz < 250.0);
    check_near("amplitude before, um", 1e6 * hypot(at[BEFORE].orbit.re, at[BEFORE].orbit.im), 2.036, 0.02);
    check_int("jumps on the way down", follow_curve(&t, frequency, POINTS, -1, at), 1);
    check_true("the upper branch goes further down", hypot(at[BEFORE].orbit.re, at[BEFORE].orbit.im) > 6e-6);
}
