/* physics_floquet.c - Floquet multipliers of a method with its step beside the plant's own.
 *
 * x'' + 0.02 x' + (1 + k1 cos(omega t)) x = 0, the rig's linear part. `steps` is per period of
 * the modulation, 0 for the plant itself (taylor at 1e-13).
 *   magnitude: the larger |multiplier| against omega across the principal tongue, k1 = 0.12
 *   edge:      the smallest k1 whose larger |multiplier| is 1 */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "tests/bench/physics/physics.h"
#include "tests/fixture/mathieu.h"

enum { BISECTIONS = 40 };
static const double damping = 0.02;
static const double depth = 0.12;

/* A method of ours by name, else a classical one. */
struct way {
    const char *name;
    int steps;
};

static double magnitude(const struct way *w, double k1, double omega)
{
    const struct mathieu m = {damping, 1.0, k1, omega};
    double map[2][2];
    double complex mu[2];
    if (w->steps == 0)
        mathieu_map(&m, &taylor, 1e-13, 40, map);
    else if (strcmp(w->name, "rk4") == 0)
        mathieu_map(&m, &rk4, 0.0, w->steps, map);
    for (int i = 0; i < CLASSICAL_METHODS; i++) {
        if (strcmp(w->name, classical_table[i].name) == 0)
            mathieu_classical(&m, classical_table[i].step, w->steps, map);
    }
    mathieu_multipliers(map, mu);
    return cabs(mu[0]);
}

static double edge(const struct way *w, double omega)
{
    double lo = 0.0, hi = 0.0;
    while (hi < 1.0 && magnitude(w, hi, omega) < 1.0) {
        lo = hi;
        hi += 0.02;
    }
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (lo + hi);
        *(magnitude(w, middle, omega) < 1.0 ? &lo : &hi) = middle;
    }
    return 0.5 * (lo + hi);
}

static void print_row(const char *panel, const struct way *w, double x, double y)
{
    printf("%s,%s,%d,%.4g,%.6g\n", panel, w->name, w->steps, x, y);
}

int main(void)
{
    static const struct way tongue[] = {
        {"plant", 0},  {"rk4", 4},     {"rk4", 8},     {"Verlet", 4},
        {"Verlet", 8}, {"Newmark", 4}, {"Newmark", 8}, {"semi-implicit Euler", 8}};
    static const struct way edges[] = {{"plant", 0},  {"rk4", 4},     {"Verlet", 4},
                                       {"Verlet", 8}, {"Newmark", 4}, {"Newmark", 8}};
    printf("panel,method,steps,x,y\n");
    for (size_t i = 0; i < sizeof tongue / sizeof *tongue; i++) {
        for (int k = 0; k <= 32; k++)
            print_row("magnitude", &tongue[i], 1.84 + 0.01 * k,
                      magnitude(&tongue[i], depth, 1.84 + 0.01 * k));
    }
    for (size_t i = 0; i < sizeof edges / sizeof *edges; i++) {
        for (int k = 0; k <= 32; k++)
            print_row("edge", &edges[i], 1.84 + 0.01 * k, edge(&edges[i], 1.84 + 0.01 * k));
    }
    return 0;
}
