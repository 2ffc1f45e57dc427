/* afm_tapping.c - amplitude, phase and peak force of a tapping lever over its height:
 * docs/img/afm_tapping.csv, over which docs/img/afm_tapping.svg draws the orbits of
 * tests/data/tapping_orbits.txt.
 *
 * Cases A, B, C of tests/fixture/afm/tapping.h by `modal`, 64 ticks a period: once from far away to the
 * sample, and once from the lowest repulsive orbit of that file away from it. The base moves from one height
 * to the next in 200 periods and waits for 2200, seven times as long as the lever remembers. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "tests/fixture/afm/tapping.h"

#define TWO_PI 6.283185307179586

enum { TICKS = 64, MOVE = 200, SETTLE = 2200, MEASURE = 16, CASES = 3 };
static const char *const name[CASES] = {"A", "B", "C"};
static const double far = 1.3, step = 0.01; /* heights over the free amplitude */

static struct lever lever;

static void print(const struct tapping_case *c, const char *way, double ratio)
{
    double peak;
    double complex a = lever_lock_in(&lever, 0, TICKS, MEASURE, &peak);
    printf("%s,%s,%.3f,%.6f,%.4f,%.5f\n", c->name, way, ratio, cabs(a) / c->free, carg(a) * 360.0 / TWO_PI,
           peak * 1e9);
}

/* The lever `start` high on a motion, and from there to `end`. */
static bool travel(const struct tapping_case *c, const char *way, const struct tapping_orbit *start,
                   double end)
{
    int steps = (int)lround(fabs(end - start->ratio) / step);
    double each = end < start->ratio ? -step : step;
    tapping_set(&lever, c, start->ratio);
    if (lever_start(&lever, &modal, TICKS))
        return false;
    tapping_begin(&lever, c, start->amplitude, start->lag, 0.0);
    for (int i = 0; i <= steps; i++) {
        plant_sample(&lever.plant, LEVER_Z, each * i * c->free, (uint64_t)TICKS * MOVE);
        if (!plant_run(&lever.plant, (uint64_t)TICKS * (MOVE + SETTLE)))
            return false;
        print(c, way, start->ratio + each * i);
    }
    return true;
}

/* The lowest repulsive orbit that is known. */
static bool find_lowest(const char *which, struct tapping_orbit *lowest)
{
    struct tapping_orbit o;
    FILE *file = fopen("tests/data/tapping_orbits.txt", "r");
    lowest->ratio = far;
    while (file && tapping_read(file, &o))
        if (!strcmp(o.name, which) && o.branch == 1 && o.ratio < lowest->ratio)
            *lowest = o;
    if (file)
        fclose(file);
    return lowest->ratio < far;
}

int main(void)
{
    printf("case,way,height,amplitude,lag_deg,peak_nN\n");
    for (int k = 0; k < CASES; k++) {
        const struct tapping_case *c = tapping_find(name[k]);
        struct tapping_orbit lowest, above = {.ratio = far, .amplitude = c->free * 1e9, .lag = 90.0};
        if (!find_lowest(name[k], &lowest) || !travel(c, "approach", &above, lowest.ratio) ||
            !travel(c, "retract", &lowest, far))
            return 1;
    }
    return 0;
}
