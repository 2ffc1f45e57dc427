/* test_app_delay.c - a loop closed over the bus with a declared delay of d frames behaves as delayed feedback
 * must.
 *
 * Theory. Near rest the rig is y'' + 2 xi y' + y = (2/3) u. The controller sees the state at the end of frame
 * k and streams u = -g c z_k for the frame that begins d frames later, held for one frame T. With the exact
 * solution of the rig over a frame, z_{k+1} = A z_k + B u_k, a mode grows by lambda a frame where
 *
 *   det(lambda I - A + g lambda^{-d} B c) = 0 .
 *
 * The root that continues the rig's own, exp((-xi + i w) T), is followed from g = 0. For small g and T it
 * says that feedback of displacement delayed by tau = (d + 1/2) T has the damping ratio xi - (2/3) g tau/2:
 * half a frame is the hold. */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { DELAY_FRAMES = 400, DELAYS = 5 };
static struct bus bus;

struct loop {
    double gain, c[2]; /* u = -gain (c[0] y + c[1] y') */
    int delay;         /* frames */
    double xi, frame;  /* damping ratio; T in rig time */
};

static double complex characteristic(const struct loop *l, double gain, double complex lambda)
{
    double w = sqrt(1.0 - l->xi * l->xi), e = exp(-l->xi * l->frame);
    double c = e * cos(w * l->frame), s = e * sin(w * l->frame) / w;
    const double a[2][2] = {{c + l->xi * s, s}, {-s, c - l->xi * s}};
    const double b[2] = {2.0 / 3.0 * (1.0 - a[0][0]), 2.0 / 3.0 * s};
    double complex m[2][2], late = gain * cpow(lambda, -(double)l->delay);
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++)
            m[i][k] = (i == k ? lambda : 0.0) - a[i][k] + late * b[i] * l->c[k];
    }
    return m[0][0] * m[1][1] - m[0][1] * m[1][0];
}

static double complex root(const struct loop *l)
{
    double w = sqrt(1.0 - l->xi * l->xi);
    double complex lambda =
        exp(-l->xi * l->frame) * (cos(w * l->frame) + (double complex)I * sin(w * l->frame));
    for (int i = 1; i <= 100; i++) {
        double gain = l->gain * i / 100.0;
        for (int k = 0; k < 20; k++) {
            double complex f = characteristic(l, gain, lambda);
            double complex slope =
                (characteristic(l, gain, lambda + 1e-7) - characteristic(l, gain, lambda - 1e-7)) / 2e-7;
            lambda -= f / slope;
        }
    }
    return lambda;
}

/* Closes the loop over the bus and measures growth and angle of the signal per frame. They come from the
 * least squares fit of s_{k+1} = p s_k - r s_{k-1} to the signal, r = |lambda|^2, p = 2 Re lambda. */
static void measure(struct loop *l, double dilation, double *growth, double *angle)
{
    static double seen[DELAY_FRAMES];
    struct app_config c = bus_config();
    c.dilation = dilation;
    bus_start_running(&bus, &c);
    bus_run(&bus, 1);
    /* A finer unit of MOTION than the scene's, on both sides: motion so small that the rig is linear. */
    const double finer[2] = {5e-2, 1e-4};
    for (int i = 0; i < 2; i++)
        bus.scene.lsb[i] = bus.app.scene.lsb[i] *= finer[i];
    const struct plant *pl = &bus.app.plant;
    double unit[2] = {pl->scale.length_m, pl->scale.length_m / pl->scale.time_s};
    l->xi = 0.5 * pl->p[RIG_P_TWO_XI];
    l->frame = pl->h * c.substeps;
    plant_set_state(&bus.app.plant, (const double[]){1.0 + 1e-3, 0.0});
    for (int k = 0; k < DELAY_FRAMES; k++) {
        bus_run(&bus, 1);
        double y = bus_value(&bus, WIRE_MOTION, MOTION_DISPLACEMENT) / unit[0] - 1.0;
        double v = bus_value(&bus, WIRE_MOTION, MOTION_VELOCITY) / unit[1];
        seen[k] = l->c[0] * y + l->c[1] * v;
        bus_stream(&bus, RIG_FORCE, pl->now.tick / c.substeps + (unsigned)l->delay,
                   -64.0 * l->gain * seen[k]);
        bus_forget(&bus);
    }
    double aa = 0.0, ab = 0.0, bb = 0.0, ay = 0.0, by = 0.0;
    for (int k = 40; k + 1 < DELAY_FRAMES; k++) { /* other motions of the loop have died out by then */
        double a = seen[k], b = -seen[k - 1], next = seen[k + 1];
        aa += a * a, ab += a * b, bb += b * b, ay += a * next, by += b * next;
    }
    double determinant = aa * bb - ab * ab;
    double p = (ay * bb - by * ab) / determinant, r = (aa * by - ab * ay) / determinant;
    *growth = sqrt(r);
    *angle = acos(0.5 * p / sqrt(r));
}

static void check_loop(struct loop *l, double dilation, double tolerance, double *growth)
{
    double angle;
    measure(l, dilation, growth, &angle);
    double complex lambda = root(l);
    printf("      gain %g, delay %d frames of %.3g rad\n", l->gain, l->delay, l->frame);
    check_near("growth a frame", *growth, cabs(lambda), tolerance);
    check_near("angle a frame, rad", angle, fabs(carg(lambda)), tolerance);
    check_int("late or missed samples", bus.app.count[DIAG_LATE] + bus.app.count[DIAG_STREAM_MISSED], 0);
}

/* Velocity feedback at 1.4 rad a frame: a delay of one frame already turns damping into something else. */
TEST(app_delay_velocity)
{
    for (int d = 0; d < DELAYS; d++) {
        struct loop l = {.gain = 0.02, .c = {0.0, 1.0}, .delay = d};
        double growth;
        check_loop(&l, 1.0, 1e-5, &growth);
    }
}

/* Displacement feedback at 0.07 rad a frame: the delay is negative damping. */
TEST(app_delay_displacement)
{
    for (int d = 0; d < DELAYS; d++) {
        struct loop l = {.gain = 0.06, .c = {1.0, 0.0}, .delay = d};
        double growth;
        check_loop(&l, 20.0, 2e-5, &growth);
        double ratio = -log(growth) / l.frame, tau = (d + 0.5) * l.frame;
        check_near("damping ratio, first order: xi - (2/3) g tau/2", ratio,
                   l.xi - 2.0 / 3.0 * l.gain * tau / 2.0, 3e-4);
    }
}
