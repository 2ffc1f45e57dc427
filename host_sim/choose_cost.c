/* choose_cost.c - instructions of one step of the plant, by model and method.
 *
 * The counts are those of tests/data/instructions.txt (gcc; a test compares them): one tick of the plant with one drive, the
 * contact kept, 128 ticks a period, tolerance 1e-6, and the pieces that a motion adds. What taylor's long series cost for a
 * radian of the fastest motion is the difference to ticks of half a period, times (1e-6 a/tol)^(1/16) under drives of an
 * amplitude a above one model unit, by which their last terms grow; where contact is lost a series covers about 2.7 tol^(1/16) of
 * the regularised variable, which is fitted; an input that changes its course begins one, too. Where a short series holds over a
 * tick it serves instead if it costs less; that it holds is guessed from its last term for the motion of linear theory and
 * its second harmonic, times a fitted factor. A switch in exact costs as much
 again for the rest of its tick; with rk4 it is lost among the many short steps. Whole runs execute 0.79 to 1.27 of this
 * (tests/test_choose_cost.sh). Boards: by the ratio of the same method's tick of the rig on the board and here
 * (tests/data/board_instructions.txt), an estimate.
 */
#include <math.h>
#include <string.h>

#include "host_sim/choose.h"
#include "host_sim/scene_check.h"
#include "models/afm_tip_rungs.h"
#include "models/elementary.h"
#include "models/hertz_rig_rungs.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"

enum { RK4, FLOAT32, TAYLOR, EXACT, COARSE, SHORT /* by taylor, too */ };
const struct method *const choose_method[CHOOSE_METHODS] = {&rk4, &rk4_float32, &taylor, &exact};

static const struct {
    const char *name;
    const struct model *model;
    int method;
    bool moved; /* an input that is no force sounds */
    double instructions;
} tick[] = {
    {"rig_rk4", &hertz_rig, RK4, false, 585.0},
    {"rig_float32", &hertz_rig, FLOAT32, false, 886.0},
    {"rig_taylor", &hertz_rig, TAYLOR, false, 693.0},
    {"rig_linear_rk4", &hertz_rig_linear, RK4, false, 537.0},
    {"rig_linear_float32", &hertz_rig_linear, FLOAT32, false, 808.0},
    {"rig_linear_taylor", &hertz_rig_linear, TAYLOR, false, 682.0},
    {"rig_linear_exact", &hertz_rig_linear, EXACT, false, 564.0},
    {"rig_cubic_rk4", &hertz_rig_cubic, RK4, false, 570.0},
    {"rig_cubic_float32", &hertz_rig_cubic, FLOAT32, false, 822.0},
    {"rig_cubic_taylor", &hertz_rig_cubic, TAYLOR, false, 706.0},
    {"rig_averaged_rk4", &hertz_rig_averaged, RK4, false, 563.0},
    {"rig_averaged_float32", &hertz_rig_averaged, FLOAT32, false, 822.0},
    {"rig_averaged_taylor", &hertz_rig_averaged, TAYLOR, false, 706.0},
    {"rolling_rk4", &rolling_contact, RK4, false, 588.0},
    {"rolling_float32", &rolling_contact, FLOAT32, false, 885.0},
    {"rolling_taylor", &rolling_contact, TAYLOR, false, 692.0},
    {"rolling_linear_rk4", &rolling_contact_linear, RK4, false, 533.0},
    {"rolling_linear_float32", &rolling_contact_linear, FLOAT32, false, 808.0},
    {"rolling_linear_taylor", &rolling_contact_linear, TAYLOR, false, 682.0},
    {"rolling_linear_exact", &rolling_contact_linear, EXACT, false, 564.0},
    {"tip_rk4", &afm_tip, RK4, false, 601.0},
    {"tip_float32", &afm_tip, FLOAT32, false, 896.0},
    {"tip_taylor", &afm_tip, TAYLOR, false, 692.0},
    {"tip_linear_rk4", &afm_tip_linear, RK4, false, 533.0},
    {"tip_linear_float32", &afm_tip_linear, FLOAT32, false, 808.0},
    {"tip_linear_taylor", &afm_tip_linear, TAYLOR, false, 678.0},
    {"tip_linear_exact", &afm_tip_linear, EXACT, false, 564.0},
    {"tip_cubic_rk4", &afm_tip_cubic, RK4, false, 566.0},
    {"tip_cubic_float32", &afm_tip_cubic, FLOAT32, false, 822.0},
    {"tip_cubic_taylor", &afm_tip_cubic, TAYLOR, false, 697.0},
    {"tip_averaged_rk4", &afm_tip_averaged, RK4, false, 563.0},
    {"tip_averaged_float32", &afm_tip_averaged, FLOAT32, false, 822.0},
    {"tip_averaged_taylor", &afm_tip_averaged, TAYLOR, false, 697.0},
    {"shaft_rk4", &shaft_bearing, RK4, false, 1536.0},
    {"shaft_float32", &shaft_bearing, FLOAT32, false, 2721.0},
    {"shaft_exact", &shaft_bearing, EXACT, false, 976.0},
    {"shaft_linear_rk4", &shaft_bearing_linear, RK4, false, 1134.0},
    {"shaft_linear_float32", &shaft_bearing_linear, FLOAT32, false, 2268.0},
    {"shaft_linear_exact", &shaft_bearing_linear, EXACT, false, 893.0},
    {"shaft_mode_rk4", &shaft_bearing_mode, RK4, false, 984.0},
    {"shaft_mode_float32", &shaft_bearing_mode, FLOAT32, false, 1584.0},
    {"shaft_mode_exact", &shaft_bearing_mode, EXACT, false, 678.0},
    {"rig_stiffness_rk4", &hertz_rig, RK4, true, 714.0},
    {"rig_stiffness_float32", &hertz_rig, FLOAT32, true, 1062.0},
    {"rig_stiffness_taylor", &hertz_rig, TAYLOR, true, 797.0},
    {"rig_linear_stiffness_rk4", &hertz_rig_linear, RK4, true, 669.0},
    {"rig_linear_stiffness_float32", &hertz_rig_linear, FLOAT32, true, 982.0},
    {"rig_linear_stiffness_taylor", &hertz_rig_linear, TAYLOR, true, 773.0},
    {"rig_linear_stiffness_exact", &hertz_rig_linear, EXACT, true, 673.0},
    {"rig_cubic_stiffness_rk4", &hertz_rig_cubic, RK4, true, 692.0},
    {"rig_cubic_stiffness_float32", &hertz_rig_cubic, FLOAT32, true, 986.0},
    {"rig_cubic_stiffness_taylor", &hertz_rig_cubic, TAYLOR, true, 856.0},
    {"rolling_waviness_rk4", &rolling_contact, RK4, true, 603.0},
    {"rolling_waviness_float32", &rolling_contact, FLOAT32, true, 956.0},
    {"rolling_waviness_taylor", &rolling_contact, TAYLOR, true, 776.0},
    {"rolling_linear_waviness_rk4", &rolling_contact_linear, RK4, true, 597.0},
    {"rolling_linear_waviness_float32", &rolling_contact_linear, FLOAT32, true, 882.0},
    {"rolling_linear_waviness_taylor", &rolling_contact_linear, TAYLOR, true, 729.0},
    {"rolling_linear_waviness_exact", &rolling_contact_linear, EXACT, true, 616.0},
    {"tip_stiffness_rk4", &afm_tip, RK4, true, 620.0},
    {"tip_stiffness_float32", &afm_tip, FLOAT32, true, 942.0},
    {"tip_stiffness_taylor", &afm_tip, TAYLOR, true, 721.0},
    {"tip_linear_stiffness_rk4", &afm_tip_linear, RK4, true, 597.0},
    {"tip_linear_stiffness_float32", &afm_tip_linear, FLOAT32, true, 882.0},
    {"tip_linear_stiffness_taylor", &afm_tip_linear, TAYLOR, true, 722.0},
    {"tip_linear_stiffness_exact", &afm_tip_linear, EXACT, true, 616.0},
    {"tip_cubic_stiffness_rk4", &afm_tip_cubic, RK4, true, 621.0},
    {"tip_cubic_stiffness_float32", &afm_tip_cubic, FLOAT32, true, 882.0},
    {"tip_cubic_stiffness_taylor", &afm_tip_cubic, TAYLOR, true, 784.0},
    {"rig_coarse", &hertz_rig, COARSE, false, 3217.0},
    {"rig_linear_coarse", &hertz_rig_linear, COARSE, false, 2295.0},
    {"rig_cubic_coarse", &hertz_rig_cubic, COARSE, false, 2971.0},
    {"rig_averaged_coarse", &hertz_rig_averaged, COARSE, false, 2971.0},
    {"rolling_coarse", &rolling_contact, COARSE, false, 3216.0},
    {"rolling_linear_coarse", &rolling_contact_linear, COARSE, false, 2295.0},
    {"tip_coarse", &afm_tip, COARSE, false, 2648.0},
    {"tip_linear_coarse", &afm_tip_linear, COARSE, false, 2168.0},
    {"tip_cubic_coarse", &afm_tip_cubic, COARSE, false, 2446.0},
    {"tip_averaged_coarse", &afm_tip_averaged, COARSE, false, 2446.0},
    {"rig_stiffness_coarse", &hertz_rig, COARSE, true, 4046.0},
    {"rig_linear_stiffness_coarse", &hertz_rig_linear, COARSE, true, 2404.0},
    {"rig_cubic_stiffness_coarse", &hertz_rig_cubic, COARSE, true, 7290.0},
    {"rolling_waviness_coarse", &rolling_contact, COARSE, true, 3361.0},
    {"rolling_linear_waviness_coarse", &rolling_contact_linear, COARSE, true, 2395.0},
    {"tip_stiffness_coarse", &afm_tip, COARSE, true, 3298.0},
    {"tip_linear_stiffness_coarse", &afm_tip_linear, COARSE, true, 2101.0},
    {"tip_cubic_stiffness_coarse", &afm_tip_cubic, COARSE, true, 5901.0},
    {"rig_short", &hertz_rig, SHORT, false, 1033.0},
    {"rig_linear_short", &hertz_rig_linear, SHORT, false, 904.0},
    {"rig_cubic_short", &hertz_rig_cubic, SHORT, false, 927.0},
    {"rig_averaged_short", &hertz_rig_averaged, SHORT, false, 927.0},
    {"rolling_short", &rolling_contact, SHORT, false, 1032.0},
    {"rolling_linear_short", &rolling_contact_linear, SHORT, false, 904.0},
    {"tip_short", &afm_tip, SHORT, false, 955.0},
    {"tip_linear_short", &afm_tip_linear, SHORT, false, 891.0},
    {"tip_cubic_short", &afm_tip_cubic, SHORT, false, 918.0},
    {"tip_averaged_short", &afm_tip_averaged, SHORT, false, 918.0},
    {"rig_stiffness_short", &hertz_rig, SHORT, true, 1238.0},
    {"rolling_waviness_short", &rolling_contact, SHORT, true, 1115.0},
    {"tip_stiffness_short", &afm_tip, SHORT, true, 1069.0},
};
enum { TICKS = sizeof tick / sizeof tick[0] };

const char *const choose_piece_name[CHOOSE_PIECES] = {"rk4_tick",           "rk4_step",       "float32_tick",
                                                      "taylor_smooth_tick", "exact_step",     "drive",
                                                      "taylor_time",        "taylor_regular", "exact_event"};

/* Nanoseconds an instruction. Host: 1.25 instructions a cycle at 2 GHz, the slow end of desktops. Boards: the latencies one
 * after the other, docs/ACCURACY.md: 480 and 500 MHz; the M4F's 1.4 cycles at 168 MHz, docs/PORTING.md. */
const struct choose_machine choose_machine[CHOOSE_MACHINES] = {
    {"host", {589.0, 159.0, 890.0, 719.0, 248.0, 85.0, 1568.0, 3419.0, 2791.0}, {0.4, 0.4, 0.4, 0.4}},
    {"mps2-an500",
     {600.0, 148.0, 963.0, 758.0, 612.0, 91.0, 1797.0, 3839.0, 3920.0},
     {2.8 / 0.48, 2.4 / 0.48, 3.6 / 0.48, 2.6 / 0.48}},
    {"mps2-an386",
     {11796.0, 4904.0, 7770.0, 13748.0, 8825.0, 1253.0, 44738.0, 125170.0, 88766.0},
     {1.4 / 0.168, 1.4 / 0.168, 1.4 / 0.168, 1.4 / 0.168}},
    {"xlnx-zcu102-r5",
     {626.0, 152.0, 966.0, 784.0, 628.0, 100.0, 1817.0, 3842.0, 3970.0},
     {4.3 / 0.5, 3.0 / 0.5, 5.5 / 0.5, 3.7 / 0.5}},
    {"riscv-virt", {602.0, 152.0, 1017.0, 855.0, 510.0, 84.0, 1997.0, 4385.0, 4468.0}, {0.0}},
};

/* Angle of the eigenfrequency in the counted ticks, and taylor's tolerance there. */
static const double fine = 2.0 * ELEMENTARY_PI / 128.0, coarse = 2.0 * ELEMENTARY_PI / 2.0,
                    counted_tol = 1e-6;

/* The counted tick; where a moved one is not counted it costs no more. NaN where there is none. */
static double counted(const struct model *m, int method, bool moved)
{
    double cost = (double)NAN;
    for (int i = 0; i < TICKS; i++) {
        if (tick[i].model == m && tick[i].method == method && tick[i].moved <= moved)
            cost = tick[i].instructions;
    }
    return cost;
}

/* What taylor's series cost for a radian at the counted tolerance. */
static double series(const struct model *m, bool moved)
{
    return (counted(m, COARSE, moved) - counted(m, TAYLOR, moved)) / (coarse - fine);
}

/* The tick without the series that begin in it. */
static double plain(const struct model *m, int method, bool moved)
{
    return counted(m, method, moved) - (method == TAYLOR ? fine * series(m, moved) : 0.0);
}

/* The same of the rig, on a machine. */
static double plain_tick(const struct choose_machine *m, int method)
{
    const double *n = m->piece;
    double begun = fine * series(&hertz_rig, false) / choose_machine[0].piece[PIECE_SERIES];
    const double of[CHOOSE_METHODS] = {n[PIECE_RK4_TICK], n[PIECE_FLOAT32_TICK],
                                       n[PIECE_TAYLOR_TICK] - begun * n[PIECE_SERIES],
                                       n[PIECE_RK4_TICK] - n[PIECE_RK4_STEP] + n[PIECE_EXACT_STEP]};
    return of[method];
}

/* A short series over a step, beyond the plain tick; NaN where there is none. */
static double short_series(const struct model *m, bool moved)
{
    double cost = (double)NAN;
    for (int i = 0; i < TICKS; i++)
        if (tick[i].model == m && tick[i].method == SHORT && tick[i].moved == moved)
            cost = tick[i].instructions - plain(m, TAYLOR, moved);
    return cost;
}

/* The last term of a series of this order over a tick in which a motion turns by this angle, and its second harmonic. */
static double last_term(double amplitude, double angle, int order)
{
    double one = amplitude, two = 0.125 * amplitude * amplitude;
    for (int n = 1; n <= order; n++) {
        one *= angle / n;
        two *= 2.0 * angle / n;
    }
    return one + two;
}

/* Order of the rate's last term but one, and how much larger than for a harmonic motion the terms are. */
static bool short_holds(const struct choose_work *w)
{
    bool contact = w->scene->model->n_contacts > 0;
    double term = 0.0, step = scene_check_step(w->scene);
    for (int i = 0; i < 2; i++)
        term += last_term(w->motion[i].amplitude, w->motion[i].rate * step, contact ? 8 : 12);
    return (contact ? 30.0 : 3.0) * term <= w->scene->tolerance;
}

/* Taylor's series over a step. */
static double series_of(const struct choose_work *w, const struct choose_machine *m)
{
    const struct model *model = w->scene->model;
    double angle = w->rate * scene_check_step(w->scene) / pow(w->scene->tolerance, 1.0 / 16.0);
    double ratio = m->piece[PIECE_SERIES] / choose_machine[0].piece[PIECE_SERIES];
    if (w->lost)
        return fmax(angle / 2.7, w->fresh) * m->piece[PIECE_SERIES_LOST];
    angle *= pow(counted_tol * fmax(w->strength, 1.0), 1.0 / 16.0);
    double runs_on = angle * series(model, w->moved) * ratio, begun = m->piece[PIECE_SERIES];
    double brief = short_series(model, w->moved) * ratio;
    if (short_holds(w) && !isnan(brief)) {
        begun = fmin(begun, brief);
        runs_on = fmin(runs_on, brief);
    }
    return fmax(runs_on, w->fresh * begun);
}

double choose_cost_step(const struct choose_work *w, int method, int machine)
{
    const struct choose_machine *m = &choose_machine[machine];
    double cost = plain(w->scene->model, method, w->moved) * plain_tick(m, method) /
                  plain_tick(&choose_machine[0], method);
    cost += (w->drives - 1) * m->piece[PIECE_DRIVE];
    if (method == TAYLOR)
        cost += series_of(w, m);
    if (method == EXACT)
        cost += 2.0 * w->switches * scene_check_step(w->scene) * m->piece[PIECE_SWITCH];
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
