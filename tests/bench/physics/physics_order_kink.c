/* physics_order_kink.c - error after one period with contact loss against the step, random phase and step. */
#include <math.h>
#include <stdio.h>
#include "tests/bench/physics/physics.h"
#include "tests/fixture/orbit.h"

enum { DRAWS = 41 };
static const double longest = 0.6, shortest = 0.002; /* h omega */

static const struct orbit_way hertz[] = {{"plain RK4", classical_rk4, NULL, 0.0},
                                         {"rk4", NULL, &rk4, 0.0},
                                         {"taylor 1e-6", NULL, &taylor, 1e-6},
                                         {"taylor 1e-12", NULL, &taylor, 1e-12}};
static const struct orbit_way gap[] = {
    {"plain RK4", classical_rk4, NULL, 0.0}, {"rk4", NULL, &rk4, 0.0}, {"exact", NULL, &exact, 0.0}};

static void print_way(const char *plant, enum orbit_kind kind, const struct orbit_way *w)
{
    struct orbit o;
    uint64_t seed = 1;
    orbit_make(&o, kind, 0.0);
    for (double h_omega = longest; h_omega >= shortest; h_omega /= 1.5) {
        double error[DRAWS], step[DRAWS];
        for (int i = 0; i < DRAWS; i++)
            error[i] = orbit_draw(kind, w, o.omega * o.period / h_omega, &seed, &step[i]);
        double low = physics_quantile(error, DRAWS, 0.1), high = physics_quantile(error, DRAWS, 0.9);
        printf("%s,%s,%.4g,%.3g,%.3g,%.3g\n", plant, w->name, physics_quantile(step, DRAWS, 0.5),
               physics_quantile(error, DRAWS, 0.5), low, high);
    }
}

int main(void)
{
    printf("plant,method,h_omega,error,error_10_percent,error_90_percent\n");
    for (size_t i = 0; i < sizeof hertz / sizeof *hertz; i++)
        print_way("hertz", ORBIT_HERTZ, &hertz[i]);
    for (size_t i = 0; i < sizeof gap / sizeof *gap; i++)
        print_way("gap", ORBIT_GAP, &gap[i]);
    return 0;
}
