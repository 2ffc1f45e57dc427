/* choose_cost.c - instructions of one step of the plant, by model and method.
 *
 * The counts are those of tests/data/instructions.txt (gcc; a test compares them): one tick of the plant with one drive, the
 * contact kept, 128 ticks a period, tolerance 1e-6, and the pieces that a motion adds. A series of taylor covers about
 * 4 tol^(1/16) rad of the fastest motion, or 2.7 tol^(1/16) of the regularised variable where contact is lost; an input that
 * changes its course begins one, too. A switch in exact costs as much again for the rest of its tick; with rk4 it is
 * lost among the many short steps. Whole runs execute 0.82 to 1.25 of this (tests/test_choose_cost.sh). Boards: by
 * the ratio of the same method's tick of the rig on the board and here (tests/data/board_instructions.txt), an estimate. */
#include <math.h>
#include <string.h>

#include "host_sim/choose.h"
#include "host_sim/scene_check.h"
#include "models/afm_tip_rungs.h"
#include "models/elementary.h"
#include "models/hertz_rig_rungs.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"

enum { RK4, FLOAT32, TAYLOR, EXACT };
const struct method *const choose_method[CHOOSE_METHODS] = {&rk4, &rk4_float32, &taylor, &exact};

static const struct {
    const char *name;
    const struct model *model;
    int method;
    bool moved; /* an input that is no force sounds */
    double instructions;
} tick[] = {
    {"rig_rk4", &hertz_rig, 0, false, 606.0},
    {"rig_float32", &hertz_rig, 1, false, 908.0},
    {"rig_taylor", &hertz_rig, 2, false, 733.0},
    {"rig_linear_rk4", &hertz_rig_linear, 0, false, 552.0},
    {"rig_linear_float32", &hertz_rig_linear, 1, false, 822.0},
    {"rig_linear_taylor", &hertz_rig_linear, 2, false, 720.0},
    {"rig_linear_exact", &hertz_rig_linear, 3, false, 578.0},
    {"rig_cubic_rk4", &hertz_rig_cubic, 0, false, 589.0},
    {"rig_cubic_float32", &hertz_rig_cubic, 1, false, 840.0},
    {"rig_cubic_taylor", &hertz_rig_cubic, 2, false, 749.0},
    {"rig_averaged_rk4", &hertz_rig_averaged, 0, false, 589.0},
    {"rig_averaged_float32", &hertz_rig_averaged, 1, false, 840.0},
    {"rig_averaged_taylor", &hertz_rig_averaged, 2, false, 749.0},
    {"rolling_rk4", &rolling_contact, 0, false, 603.0},
    {"rolling_float32", &rolling_contact, 1, false, 901.0},
    {"rolling_taylor", &rolling_contact, 2, false, 726.0},
    {"rolling_linear_rk4", &rolling_contact_linear, 0, false, 552.0},
    {"rolling_linear_float32", &rolling_contact_linear, 1, false, 822.0},
    {"rolling_linear_taylor", &rolling_contact_linear, 2, false, 720.0},
    {"rolling_linear_exact", &rolling_contact_linear, 3, false, 578.0},
    {"tip_rk4", &afm_tip, 0, false, 618.0},
    {"tip_float32", &afm_tip, 1, false, 913.0},
    {"tip_taylor", &afm_tip, 2, false, 782.0},
    {"tip_linear_rk4", &afm_tip_linear, 0, false, 552.0},
    {"tip_linear_float32", &afm_tip_linear, 1, false, 822.0},
    {"tip_linear_taylor", &afm_tip_linear, 2, false, 721.0},
    {"tip_linear_exact", &afm_tip_linear, 3, false, 578.0},
    {"tip_cubic_rk4", &afm_tip_cubic, 0, false, 589.0},
    {"tip_cubic_float32", &afm_tip_cubic, 1, false, 840.0},
    {"tip_cubic_taylor", &afm_tip_cubic, 2, false, 796.0},
    {"tip_averaged_rk4", &afm_tip_averaged, 0, false, 589.0},
    {"tip_averaged_float32", &afm_tip_averaged, 1, false, 840.0},
    {"tip_averaged_taylor", &afm_tip_averaged, 2, false, 796.0},
    {"shaft_rk4", &shaft_bearing, 0, false, 1638.0},
    {"shaft_float32", &shaft_bearing, 1, false, 2816.0},
    {"shaft_exact", &shaft_bearing, 3, false, 1071.0},
    {"shaft_linear_rk4", &shaft_bearing_linear, 0, false, 1700.0},
    {"shaft_linear_float32", &shaft_bearing_linear, 1, false, 2501.0},
    {"shaft_linear_exact", &shaft_bearing_linear, 3, false, 1126.0},
    {"shaft_mode_rk4", &shaft_bearing_mode, 0, false, 1829.0},
    {"shaft_mode_float32", &shaft_bearing_mode, 1, false, 2092.0},
    {"shaft_mode_exact", &shaft_bearing_mode, 3, false, 1186.0},
    {"rig_stiffness_rk4", &hertz_rig, 0, true, 757.0},
    {"rig_stiffness_float32", &hertz_rig, 1, true, 1105.0},
    {"rig_stiffness_taylor", &hertz_rig, 2, true, 858.0},
    {"rig_linear_stiffness_rk4", &hertz_rig_linear, 0, true, 731.0},
    {"rig_linear_stiffness_float32", &hertz_rig_linear, 1, true, 1023.0},
    {"rig_linear_stiffness_taylor", &hertz_rig_linear, 2, true, 838.0},
    {"rig_linear_stiffness_exact", &hertz_rig_linear, 3, true, 714.0},
    {"rig_cubic_stiffness_rk4", &hertz_rig_cubic, 0, true, 887.0},
    {"rig_cubic_stiffness_float32", &hertz_rig_cubic, 1, true, 1080.0},
    {"rig_cubic_stiffness_taylor", &hertz_rig_cubic, 2, true, 968.0},
    {"rolling_linear_waviness_rk4", &rolling_contact_linear, 0, true, 614.0},
    {"rolling_linear_waviness_float32", &rolling_contact_linear, 1, true, 891.0},
    {"rolling_linear_waviness_taylor", &rolling_contact_linear, 2, true, 762.0},
    {"rolling_linear_waviness_exact", &rolling_contact_linear, 3, true, 626.0},
    {"tip_linear_stiffness_rk4", &afm_tip_linear, 0, true, 614.0},
    {"tip_linear_stiffness_float32", &afm_tip_linear, 1, true, 891.0},
    {"tip_linear_stiffness_taylor", &afm_tip_linear, 2, true, 761.0},
    {"tip_linear_stiffness_exact", &afm_tip_linear, 3, true, 626.0},
    {"tip_cubic_stiffness_rk4", &afm_tip_cubic, 0, true, 708.0},
    {"tip_cubic_stiffness_float32", &afm_tip_cubic, 1, true, 924.0},
    {"tip_cubic_stiffness_taylor", &afm_tip_cubic, 2, true, 923.0},
};
enum { TICKS = sizeof tick / sizeof tick[0] };

const char *const choose_piece_name[CHOOSE_PIECES] = {"rk4_tick",           "rk4_step",       "float32_tick",
                                                      "taylor_smooth_tick", "exact_step",     "drive",
                                                      "taylor_time",        "taylor_regular", "exact_event"};

/* Nanoseconds an instruction. Host: 1.25 instructions a cycle at 2 GHz, the slow end of desktops. Boards: the latencies one
 * after the other, docs/ACCURACY.md: 480 and 500 MHz. */
const struct choose_machine choose_machine[CHOOSE_MACHINES] = {
    {"host", {610.0, 159.0, 912.0, 759.0, 248.0, 85.0, 1610.0, 3461.0, 2791.0}, {0.4, 0.4, 0.4, 0.4}},
    {"mps2-an500",
     {596.0, 148.0, 952.0, 762.0, 612.0, 91.0, 1915.0, 3518.0, 3934.0},
     {2.8 / 0.48, 2.4 / 0.48, 3.6 / 0.48, 2.6 / 0.48}},
    {"mps2-an386", {10482.0, 4904.0, 6456.0, 12420.0, 8825.0, 1252.0, 44937.0, 107833.0, 88714.0}, {0.0}},
    {"xlnx-zcu102-r5",
     {627.0, 152.0, 968.0, 801.0, 628.0, 99.0, 1932.0, 3516.0, 3974.0},
     {4.3 / 0.5, 3.0 / 0.5, 5.5 / 0.5, 3.7 / 0.5}},
    {"riscv-virt", {611.0, 151.0, 1026.0, 889.0, 510.0, 84.0, 2112.0, 3968.0, 4454.0}, {0.0}},
};

/* Conditions of the counted ticks. */
static const double counted_tol = 1e-6, counted_ticks = 128.0;

/* Series that begin in a step of this angle of the fastest motion. */
static double series(double angle, double tol, bool lost)
{
    return angle / ((lost ? 2.7 : 4.0) * pow(tol, 1.0 / 16.0));
}

/* Of a counted tick. */
static double counted_series(void)
{
    return series(2.0 * ELEMENTARY_PI / counted_ticks, counted_tol, false);
}

/* The tick of a method on the rig, without the series that begin in it. */
static double plain_tick(const struct choose_machine *m, int method)
{
    const double *n = m->piece;
    const double of[CHOOSE_METHODS] = {n[PIECE_RK4_TICK], n[PIECE_FLOAT32_TICK],
                                       n[PIECE_TAYLOR_TICK] - counted_series() * n[PIECE_SERIES],
                                       n[PIECE_RK4_TICK] - n[PIECE_RK4_STEP] + n[PIECE_EXACT_STEP]};
    return of[method];
}

/* The tick of a model and method on the host, without the series that begin in it; NaN where there is none. Where a moved one
 * is not counted it costs no more. */
static double plain(const struct model *m, int method, bool moved)
{
    double counted = method == TAYLOR ? counted_series() * choose_machine[0].piece[PIECE_SERIES] : 0.0;
    double cost = (double)NAN;
    for (int i = 0; i < TICKS; i++) {
        if (tick[i].model == m && tick[i].method == method && tick[i].moved <= moved)
            cost = tick[i].instructions - counted;
    }
    return cost;
}

double choose_cost_step(const struct choose_work *w, int method, int machine)
{
    const struct choose_machine *m = &choose_machine[machine];
    const struct scene *s = w->scene;
    double step = scene_check_step(s);
    double cost =
        plain(s->model, method, w->moved) * plain_tick(m, method) / plain_tick(&choose_machine[0], method);
    cost += (w->drives - 1) * m->piece[PIECE_DRIVE];
    if (method == TAYLOR)
        cost += fmax(series(w->rate * step, s->tolerance, w->lost), w->fresh) *
                m->piece[w->lost ? PIECE_SERIES_LOST : PIECE_SERIES];
    if (method == EXACT)
        cost += 2.0 * w->switches * step * m->piece[PIECE_SWITCH];
    return cost;
}

bool choose_cost_entry(int i, const char **name, double *instructions)
{
    if (i >= TICKS)
        return false;
    *name = tick[i].name;
    *instructions = tick[i].instructions;
    return true;
}
