/* worst_cases.c - see worst_cases.h. */
#include "tests/bench/cost/worst_cases.h"

#include "models/hertz_rig.h"
#include "models/shaft_bearing.h"

/* The undamped rig released 1e-6 above (5/2)^{2/3} static
 * compressions, where it just leaves contact: q = 1.5 (eta - 1). */
#define GRAZE(name)                                                                                          \
    {                                                                                                        \
        name, &hertz_rig, {{"xi", 0.0}, {"sigma", 0.0}, {"omega", 1.0}}, 1.2630263869, RIG_FORCE, 10, 1,     \
            false                                                                                            \
    }
#define CHATTER(name)                                                                                        \
    {                                                                                                        \
        name, &shaft_bearing, {{"c1", 139.0}, {"c2", 139.0}, {"c3", 139.0}, {"p2", 25.0}, {"freq_hz", 5.0}}, \
            0.9 * 2.54e-4, 1, 10, 1, false                                                                   \
    }
#define BASE(name)                                                                                           \
    {                                                                                                        \
        name, &hertz_rig, {{"xi", 0.01}, {"sigma", 0.04}, {"omega", 0.99}, {"Omega", 8.0}, {"a_base", 8.0}}, \
            0.0, RIG_FORCE, 10, 1, false                                                                     \
    }

const struct worst_case worst_case[WORST_CASES] = {
    {GRAZE("graze_rk4"), {&rk4, 64, 0}},
    {GRAZE("graze_float32"), {&rk4_float32, 64, 0}},
    {GRAZE("graze_taylor_1e-6"), {&taylor, 64, 6}},
    {GRAZE("graze_taylor_1e-9"), {&taylor, 64, 9}},
    {GRAZE("graze_taylor_1e-11"), {&taylor, 64, 11}},
    {CHATTER("chatter_rk4"), {&rk4, 10000, 0}},
    {CHATTER("chatter_exact"), {&exact, 1600, 0}},
    {BASE("base8_rk4"), {&rk4, 128, 0}},
    {BASE("base8_taylor_1e-6"), {&taylor, 128, 6}},
};
