/* test_plant.c - the plant's time, regimes, parameters and books against closed forms and identities. */
#include "tests/unit/test.h"

#include <math.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/hertz_rig.h"
#include "tests/fixture/rig.h"

#define TWO_PI 6.283185307179586477

TEST(plant_instants)
{
    const struct instant t[] = {{0, 0}, {0, 1}, {0, 65535}, {1, 0}, {1, 1}, {UINT64_C(1) << 33, 0}};
    int wrong = 0;
    for (int i = 0; i < 6; i++) {
        for (int k = 0; k < 6; k++)
            wrong += instant_compare(t[i], t[k]) != (i > k) - (i < k);
    }
    check_int("instants out of order", wrong, 0);
}

static void smooth_paper(double paper[PAPER])
{
    rig_paper(paper);
    paper[XI] = 0.02;
    paper[SIGMA] = 0.05;
    paper[OMEGA] = 0.8;
    paper[FAST_OMEGA] = 3.1;
    paper[A_FORCE] = 0.1;
    paper[A_BASE] = 0.02;
    paper[A_STIFF] = 0.05;
}

/* The state after 20 model times, ticks cut at arbitrary fractions or not. */
static void run_cut(struct plant *pl, int n, int cut)
{
    double paper[PAPER];
    uint64_t seed = 9;
    smooth_paper(paper);
    rig_start(pl, paper, 20.0 / n, 0.2, 0.1);
    while (cut && pl->now.tick < (uint64_t)n - 1) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        struct instant to = {pl->now.tick + (seed >> 63), (uint32_t)(seed >> 40) & 0xFFFFu};
        if (instant_compare(to, pl->now) <= 0)
            to.tick++;
        if (!plant_advance(pl, to) || instant_compare(pl->now, to) != 0)
            check_true("stands exactly at the fraction asked for", 0);
    }
    if (!plant_advance(pl, (struct instant){(uint64_t)n, 0}))
        check_true("reaches the end", 0);
}

/* Cutting a tick is another discretisation of the same
 * motion: the difference falls with the method's order. */
TEST(plant_fractions)
{
    struct plant whole, parts;
    double off[2];
    const int n[] = {200, 400};
    for (int i = 0; i < 2; i++) {
        run_cut(&whole, n[i], 0);
        run_cut(&parts, n[i], 1);
        off[i] = hypot(whole.x[0] - parts.x[0], whole.x[1] - parts.x[1]);
    }
    check_near("order of the difference that cuts make", log(off[0] / off[1]) / log(2.0), 4.0, 0.6);
    run_cut(&whole, 20000, 0);
    run_cut(&parts, 20000, 1);
    check_near("position, cut and whole", parts.x[0], whole.x[0], 1e-12);
    check_near("velocity, cut and whole", parts.x[1], whole.x[1], 1e-12);
    check_int("tick", (int64_t)parts.now.tick, 20000);
    check_int("fraction", parts.now.fraction, 0);
    for (int i = 0; i < 4; i++) {
        int64_t lost = (int64_t)(whole.drive[i].carrier - parts.drive[i].carrier);
        check_is("drive phase: at most 2^-64 turn a cut is lost", lost, >=, 0);
        check_is("drive phase: at most 2^-64 turn a cut is lost", lost, <, 40000);
        check_near("work, cut and whole", sum_of(&parts.ledger.work[i]), sum_of(&whole.ledger.work[i]),
                   1e-11);
    }
    check_near("time that pieces add up to", parts.total_time, 20.0, 1e-11);
    check_true("to the last fraction", plant_advance(&whole, (struct instant){20000, 65535}));
    check_int("tick not ended", (int64_t)whole.now.tick, 20000);
    check_int("fraction", whole.now.fraction, 65535);
    check_near("seconds of bus time", plant_time(&parts), 20.0, 1e-14);
    check_true("to an instant that is over: nothing to do",
               plant_advance(&parts, (struct instant){19999, 5}));
    check_int("tick", (int64_t)parts.now.tick, 20000);
    check_int("fraction", parts.now.fraction, 0);
}

/* Tick by tick and all at once are the same bits; a copy of the struct goes on as the original does. */
TEST(plant_step_by_step)
{
    double paper[PAPER];
    struct plant once, steps, copy;
    smooth_paper(paper);
    paper[SIGMA] = 0.9;
    rig_start(&once, paper, 0.01, 0.2, 0.1);
    steps = once;
    rig_run(&once, 5000);
    for (int i = 0; i < 2500; i++)
        rig_run(&steps, 1);
    copy = steps;
    for (int i = 0; i < 2500; i++) {
        rig_run(&steps, 1);
        rig_run(&copy, 1);
    }
    check_above("switches on the way", once.counts.switches, 10.0);
    check_hex("tick by tick against all at once", plant_hash(&steps), plant_hash(&once));
    check_hex("continued from a copy", plant_hash(&copy), plant_hash(&once));
    uint64_t hash = plant_hash(&once);
    const char *const name[] = {"tick", "velocity", "carrier", "sample", "work", "damping", "regime"};
    for (int i = 0; i < 7; i++) {
        copy = once;
        copy.now.tick += i == 0;
        copy.x[1] += i == 1 ? 1e-15 : 0.0;
        copy.drive[3].carrier += i == 2;
        copy.drive[1].sample += i == 3 ? 1e-300 : 0.0;
        copy.ledger.work[2].carry += i == 4 ? 1e-14 : 0.0;
        copy.ledger.damping.value += i == 5 ? 1e-14 : 0.0;
        copy.regime ^= i == 6;
        check_is(name[i], plant_hash(&copy), !=, hash);
    }
}

/* A small held force u on y'' + 2 xi y' + y = (2/3) u: the closed form. Half the difference of +u and -u has
 * no quadratic term, what is left is of third order: (1/20) u^2 relative. */
TEST(plant_step_response)
{
    const double u = 1e-5, xi = 0.05, h = 0.01;
    double paper[PAPER], worst = 0.0, worst_rate = 0.0;
    struct plant plus, minus;
    rig_paper(paper);
    paper[XI] = xi;
    rig_start(&plus, paper, h, 0.0, 0.0);
    minus = plus;
    plant_sample(&plus, RIG_FORCE, u, 0);
    plant_sample(&minus, RIG_FORCE, -u, 0);
    double wd = sqrt(1.0 - xi * xi);
    for (int i = 1; i <= 10000; i++) {
        double t = i * h, e = exp(-xi * t);
        rig_run(&plus, 1);
        rig_run(&minus, 1);
        double y = 0.5 * (plus.x[0] - minus.x[0]) / (2.0 / 3.0 * u);
        double v = 0.5 * (plus.x[1] - minus.x[1]) / (2.0 / 3.0 * u);
        worst = fmax(worst, fabs(y - (1.0 - e * (cos(wd * t) + xi / wd * sin(wd * t)))));
        worst_rate = fmax(worst_rate, fabs(v - e / wd * sin(wd * t)));
    }
    check_below("step response, displacement over the static one", worst, 1e-9);
    check_below("step response, velocity", worst_rate, 1e-9);
}

/* Steady amplitude and phase in the linear limit, for each input: transfer function times the drive. */
TEST(plant_forced_response)
{
    const char *const name[] = {"force", "fast force", "base", "stiffness"};
    const double xi = 0.1, a = 1e-5, phase = 0.7;
    enum { N = 500, SETTLE = 70 };
    for (int i = 0; i < 4; i++) {
        double w = 0.6 + 0.3 * i, h = TWO_PI / w / N, paper[PAPER], in_phase = 0.0, quadrature = 0.0;
        struct plant pl;
        rig_paper(paper);
        paper[XI] = xi;
        rig_start(&pl, paper, h, 0.0, 0.0);
        plant_drive_start(&pl, i, a, w / TWO_PI, phase);
        rig_run(&pl, N * SETTLE);
        for (int k = 0; k < N; k++) {
            double angle = TWO_PI * k / N;
            in_phase += (pl.x[0] - 1.0) * cos(angle) * 2.0 / N;
            quadrature -= (pl.x[0] - 1.0) * sin(angle) * 2.0 / N;
            rig_run(&pl, 1);
        }
        /* gain g: 2/3 for forces, -2/3 for the stiffness, 1 + 2 xi i w for the base */
        double re = i == 2 ? 1.0 : i == 3 ? -2.0 / 3.0 : 2.0 / 3.0, im = i == 2 ? 2.0 * xi * w : 0.0;
        double d_re = 1.0 - w * w, d_im = 2.0 * xi * w, d = d_re * d_re + d_im * d_im;
        double t_re = (re * d_re + im * d_im) / d, t_im = (im * d_re - re * d_im) / d;
        check_near(name[i], hypot(in_phase, quadrature) / a, hypot(t_re, t_im), 1e-8);
        check_near("its phase, rad",
                   remainder(atan2(quadrature, in_phase) - phase - atan2(t_im, t_re), TWO_PI), 0.0, 1e-8);
    }
}

/* The bus slowed D-fold: the same motion in metres and newtons, velocities over D. */
TEST(plant_dilation)
{
    const double D = 1000.0, tick = 1e-3 / 64.0;
    struct plant real, slow;
    struct plant_config c = {.model = &hertz_rig, .method = &rk4, .tick_s = tick, .dilation = 1.0};
    struct event a = {0}, b = {0};
    check_no_error("real rig", plant_init(&real, &c));
    c.tick_s = tick * D;
    c.dilation = D;
    check_no_error("slow rig", plant_init(&slow, &c));
    check_near("model step", slow.h / real.h, 1.0, 1e-15);
    plant_drive_start(&real, RIG_FORCE, 40.0, 220.0, 0.3);
    plant_drive_start(&slow, RIG_FORCE, 40.0, 220.0 / D, 0.3);
    plant_drive(&real, RIG_BASE, 5e-7, 1500.0, 0.0, 0.01);
    plant_drive(&slow, RIG_BASE, 5e-7, 1500.0 / D, 0.0, 0.01 * D);
    rig_run(&real, 4000);
    rig_run(&slow, 4000);
    check_near("displacement, m", plant_read(&slow, "displacement"), plant_read(&real, "displacement"),
               1e-14);
    check_near("velocity times D, m/s", plant_read(&slow, "velocity") * D, plant_read(&real, "velocity"),
               1e-11);
    check_near("contact force, N", plant_read(&slow, "contact_force"), plant_read(&real, "contact_force"),
               1e-6);
    check_near("energy, J", plant_energy(&slow), plant_energy(&real), 1e-12);
    check_int("contact switches", slow.counts.switches, real.counts.switches);
    check_above("of which there are", real.counts.switches, 20.0);
    check_true("events", plant_take_event(&real, &a) && plant_take_event(&slow, &b));
    check_near("speed at the first switch times D, m/s", b.speed * D, a.speed, 1e-11);
    check_near("tick of the first switch", (double)b.tick + b.fraction, (double)a.tick + a.fraction, 1e-7);
    check_near("peak force before it, N", b.peak_force, a.peak_force, 1e-6);
    check_nan("no such output", plant_read(&real, "displacements"));
}

/* Drives in newtons, hertz, radians and seconds; a ramp
 * of 0.3 s at ticks of 0.1 s is three ticks, not two. */
TEST(plant_units)
{
    struct plant pl;
    double si[4] = {1.0, 1.0, 8.0, 0.0}; /* compression (8/1)^(2/3) = 4 m */
    struct scale scale;
    double p[MODEL_DERIVED];
    hertz_rig.prepare(si, p, &scale);
    check_near("compression, m", scale.length_m, 4.0, 1e-14);
    double paper[PAPER];
    rig_paper(paper);
    rig_start(&pl, paper, 0.1, 0.0, 0.0);
    plant_drive(&pl, RIG_FORCE, 0.5, 0.25, TWO_PI / 8.0, 0.3);
    plant_drive(&pl, RIG_BASE, 0.25, 0.0, 0.0, 0.0);
    struct drive_setting t = drive_target(&pl.drive[RIG_FORCE]);
    check_near("turns per tick", t.turns_per_tick, 0.025, 1e-16);
    check_near("phase, turns", t.phase_turns, 0.125, 1e-16);
    check_int("ramp, 1/65536 tick", (int64_t)drive_corner(&pl.drive[RIG_FORCE]), 3 * TICK_FRACTIONS);
    struct plant_config c = {.model = &hertz_rig, .method = &rk4, .tick_s = 1e-5, .dilation = 1.0};
    check_no_error("default rig", plant_init(&pl, &c));
    double compression = pow(64.0 / 3.4e9, 2.0 / 3.0);
    plant_drive(&pl, RIG_FORCE, 16.0, 100.0, 0.0, 0.0);
    plant_drive(&pl, RIG_BASE, 0.5 * compression, 100.0, 0.0, 0.0);
    plant_drive(&pl, RIG_STIFFNESS, 0.3, 100.0, 0.0, 0.0);
    check_near("a force over the preload of 64 N", drive_target(&pl.drive[RIG_FORCE]).amplitude, 0.25, 1e-15);
    check_near("a length over the compression", drive_target(&pl.drive[RIG_BASE]).amplitude, 0.5, 1e-14);
    check_near("a ratio as it is", drive_target(&pl.drive[RIG_STIFFNESS]).amplitude, 0.3, 0.0);
    plant_sample(&pl, RIG_FAST_FORCE, 32.0, 0);
    check_near("a sample over the preload", pl.drive[RIG_FAST_FORCE].sample, 0.5, 0.0);
    plant_sample(&pl, RIG_STIFFNESS, 0.25, 3);
    check_int("or over 3 ticks", (int64_t)pl.drive[RIG_STIFFNESS].sample_left, 3 * TICK_FRACTIONS);
    for (unsigned ticks = 0; ticks < 3; ticks++) {
        plant_sample(&pl, RIG_BASE, 0.1 * compression, ticks);
        check_int("the base never jumps", (int64_t)pl.drive[RIG_BASE].sample_left,
                  (ticks > 1 ? 2 : 1) * TICK_FRACTIONS);
    }
}

/* A cos(phase) and -A omega sin(phase) from the first instant on; the books start there. */
TEST(plant_drive_start)
{
    const double a = 0.2, frequency = 0.3, phase = 0.7;
    double paper[PAPER];
    struct plant pl;
    rig_paper(paper);
    rig_start(&pl, paper, 0.01, 0.5, 0.1);
    plant_drive_start(&pl, RIG_BASE, a, frequency, phase);
    const struct input *u = &pl.segment.at[2][RIG_BASE];
    check_near("base", u->value, a * cos(phase), 1e-15);
    check_near("its velocity", u->rate, -a * TWO_PI * frequency * sin(phase), 1e-15);
    check_near("nothing is unaccounted for", plant_residual(&pl), 0.0, 0.0);
    double before[] = {u->value, u->rate};
    rig_run(&pl, 1);
    u = &pl.segment.at[0][RIG_BASE];
    check_near("the first tick begins there", u->value, before[0], 1e-15);
    check_near("with this velocity", u->rate, before[1], 1e-14);
}

TEST(plant_set_state)
{
    double paper[PAPER];
    struct plant pl;
    rig_paper(paper);
    rig_start(&pl, paper, 0.01, 0.0, 0.0);
    check_int("closed at rest", pl.regime, 1);
    plant_set_state(&pl, (double[]){-0.1, 0.0});
    check_int("open above the base", pl.regime, 0);
    check_near("in_contact", plant_read(&pl, "in_contact"), 0.0, 0.0);
    plant_set_state(&pl, (double[]){0.1, 0.0});
    check_int("closed below it", pl.regime, 1);
    check_near("in_contact", plant_read(&pl, "in_contact"), 1.0, 0.0);
    plant_drive_start(&pl, RIG_BASE, 0.2, 0.1, 0.0);
    check_int("open when the base starts at 0.2", pl.regime, 0);
    plant_drive_start(&pl, RIG_BASE, 0.2, 0.1, TWO_PI / 2.0);
    check_int("closed when it starts at -0.2", pl.regime, 1);
    check_near("penetration follows the base", plant_read(&pl, "penetration"), 0.3, 1e-15);
    plant_set_state(&pl, (double[]){0.0, 1.0});
    plant_drive_start(&pl, RIG_BASE, 0.0, 0.0, 0.0);
    check_int("a gap of zero is open", pl.regime, 0);
    rig_run(&pl, 1);
    check_int("and closes when it moves on", pl.regime, 1);
    check_int("with one switch", pl.counts.switches, 1);
}

TEST(plant_reset)
{
    double paper[PAPER], output[MODEL_OUTPUTS];
    struct plant pl;
    smooth_paper(paper);
    paper[SIGMA] = 0.9;
    rig_start(&pl, paper, 0.01, 0.2, 0.1);
    plant_sample(&pl, RIG_FORCE, 0.2, 0);
    check_true("runs", plant_advance(&pl, (struct instant){1234, 999}));
    plant_reset(&pl);
    check_int("the tick goes on", (int64_t)pl.now.tick, 1234);
    check_int("so does the fraction", pl.now.fraction, 999);
    check_is("at rest", pl.x[0], ==, 1.0);
    check_is("at rest", pl.x[1], ==, 0.0);
    check_int("at rest", pl.regime, 1);
    check_near("penetration, the base is at rest at once", plant_read(&pl, "penetration"), 1.0, 0.0);
    check_near("books are empty", fabs(plant_residual(&pl)) + sum_of(&pl.ledger.damping), 0.0, 0.0);
    rig_run(&pl, 1000);
    check_near("stays at rest: every drive is silent", pl.x[0], 1.0, 0.0);
    plant_output(&pl, output);
    check_near("contact force is the preload", output[3], 1.0, 0.0);
    check_near("nothing flowed", sum_of(&pl.ledger.work[0]) + sum_of(&pl.ledger.damping), 0.0, 0.0);
}
