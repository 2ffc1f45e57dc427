/* physics_phasor.c - how far a drive's phase is off after n ticks, by several ways to count it.
 *
 * Each way gives (cosine, sine) of 2 pi f n; the truth is the same phase by 128-bit integers on the digits of
 * f. The error is the distance between the two points, radians while it is small: worst of the last 512 ticks
 * for the drive, which takes its phasor from the integer every 256. */
#include <math.h>
#include <stdio.h>
#include "firmware/plant/drive.h"
#include "tests/fixture/exact.h"

enum { WINDOW = 512 };
#define TICKS 1000000000u
static const double turns = 0.0080123456789; /* per tick */
static const double tick = 1e-3;             /* seconds, for those that sum time */

enum way { DRIVE, ROTATION, SUMMED_TIME, ROTATION_FLOAT, SUMMED_TIME_FLOAT, WAYS };
static const char *const way_name[WAYS] = {"drive", "rotation", "cos of t += h", "rotation float32",
                                           "cos of t += h float32"};

static double off(uint64_t n, double cosine, double sine)
{
    long double angle = exact_angle(exact_phase(turns, n));
    return (double)hypotl((long double)cosine - cosl(angle), (long double)sine - sinl(angle));
}

static void print_row(enum way way, uint64_t n, double error)
{
    printf("%s,%llu,%.3g\n", way_name[way], (unsigned long long)n, error);
}

/* 1000, 2000, 5000, 10000, ... */
static uint64_t next_row(uint64_t n)
{
    uint64_t power = 1;
    while (10 * power <= n)
        power *= 10;
    return n / power == 2 ? 5 * power : 2 * n;
}

static void count_drive(void)
{
    struct drive d;
    struct wave w;
    struct input at[3];
    double worst = 0.0;
    uint64_t row = 1000;
    drive_init(&d);
    drive_start(&d, &(struct drive_setting){1.0, turns, 0.0, 0});
    for (uint64_t n = 1; n <= TICKS; n++) {
        drive_segment(&d, TICK_FRACTIONS, 1.0, &w, &at[0], &at[1], &at[2]);
        if (n + WINDOW <= row)
            continue;
        exact_worst(&worst, (long double)off(n, d.cosine, d.sine));
        if (n == row) {
            print_row(DRIVE, n, worst);
            worst = 0.0;
            row = next_row(row);
        }
    }
}

static void count_rotation(void)
{
    long double angle = EXACT_TURN * (long double)turns;
    double rc = (double)cosl(angle), rs = (double)sinl(angle), c = 1.0, s = 0.0;
    float rc_float = (float)rc, rs_float = (float)rs, c_float = 1.0f, s_float = 0.0f;
    uint64_t row = 1000;
    for (uint64_t n = 1; n <= TICKS; n++) {
        double turned = c * rc - s * rs;
        float turned_float = c_float * rc_float - s_float * rs_float;
        s = s * rc + c * rs;
        c = turned;
        s_float = s_float * rc_float + c_float * rs_float;
        c_float = turned_float;
        if (n == row) {
            print_row(ROTATION, n, off(n, c, s));
            print_row(ROTATION_FLOAT, n, off(n, (double)c_float, (double)s_float));
            row = next_row(row);
        }
    }
}

static void count_time(void)
{
    const double omega = (double)(EXACT_TURN * (long double)turns / (long double)tick);
    const float omega_float = (float)omega, tick_float = (float)tick;
    double t = 0.0;
    float t_float = 0.0f;
    uint64_t row = 1000;
    for (uint64_t n = 1; n <= TICKS; n++) {
        t += tick;
        t_float += tick_float;
        if (n == row) {
            print_row(SUMMED_TIME, n, off(n, cos(omega * t), sin(omega * t)));
            print_row(SUMMED_TIME_FLOAT, n,
                      off(n, (double)cosf(omega_float * t_float), (double)sinf(omega_float * t_float)));
            row = next_row(row);
        }
    }
}

int main(void)
{
    printf("way,ticks,error_rad\n");
    count_drive();
    count_rotation();
    count_time();
    return 0;
}
