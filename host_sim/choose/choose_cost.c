/* choose_cost.c - instructions of one step of the plant, by model and method.
 *
 * The counts are those of tests/data/instructions.txt (gcc; a test compares them): one tick of the plant with one drive, the
 * contact kept, 128 ticks a period, tolerance 1e-6, and the pieces that a motion adds. Method taylor counts its series itself
 * (struct taylor_tally), so what they cost is known where a run was made. A long one costs the difference to ticks of half a period,
 * over how many more of them begin there (a test counts them, too), and somewhat more for each further drive; a short one that of
 * ticks which it serves alone, and more by its further orders, nearly as many instructions each. Pieces of flight are taken as
 * long ones: they cost less, which makes up for the switches. A switch in exact costs as much again for the rest of its tick;
 * in rk4 and rk4_unlocated it is counted whole, and goes with the model's tick. Whole runs execute 0.88 to 1.08 times this
 * (tests/choose/test_choose_cost.sh). Boards: by the ratio of the same method's tick of the rig on the board and here
 * (tests/data/board_instructions.txt), an estimate.
 */
#include <math.h>
#include <string.h>

#include "host_sim/choose/choose.h"
#include "host_sim/scene/scene_check.h"
#include "models/reduced/afm_tip_reduced.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"

/* COARSE and SHORT by taylor, too; then by rk4: noise new in each tick and held for HOLD, a switch under one drive and two; such
 * switches by rk4_unlocated */
enum {
    RK4,
    FLOAT32,
    TAYLOR,
    EXACT,
    UNLOCATED,
    COARSE,
    SHORT,
    NOISE,
    HELD,
    SWITCH,
    SWITCH_TWO,
    THROUGH,
    THROUGH_TWO
};
static const double hold = 64.0;
const struct method *const choose_method[CHOOSE_METHODS] = {&rk4, &rk4_float32, &taylor, &exact,
                                                            &rk4_unlocated};

/* A tick: instructions, and how many of taylor's pieces begin in it. */
struct counted {
    double instructions, series;
};

static const struct {
    const char *name;
    const struct model *model;
    int method;
    bool moved; /* an input that is no force sounds */
    struct counted counted;
} tick[] = {
    {"rig_rk4", &hertz_rig, RK4, false, {585.0, 0.0}},
    {"rig_float32", &hertz_rig, FLOAT32, false, {886.0, 0.0}},
    {"rig_unlocated", &hertz_rig, UNLOCATED, false, {649.0, 0.0}},
    {"rig_taylor", &hertz_rig, TAYLOR, false, {711.0, 0.0275}},
    {"rig_linear_rk4", &hertz_rig_linear, RK4, false, {537.0, 0.0}},
    {"rig_linear_float32", &hertz_rig_linear, FLOAT32, false, {808.0, 0.0}},
    {"rig_linear_taylor", &hertz_rig_linear, TAYLOR, false, {698.0, 0.02}},
    {"rig_linear_exact", &hertz_rig_linear, EXACT, false, {564.0, 0.0}},
    {"rig_cubic_rk4", &hertz_rig_cubic, RK4, false, {570.0, 0.0}},
    {"rig_cubic_float32", &hertz_rig_cubic, FLOAT32, false, {822.0, 0.0}},
    {"rig_cubic_taylor", &hertz_rig_cubic, TAYLOR, false, {725.0, 0.0275}},
    {"rig_averaged_rk4", &hertz_rig_averaged, RK4, false, {563.0, 0.0}},
    {"rig_averaged_float32", &hertz_rig_averaged, FLOAT32, false, {822.0, 0.0}},
    {"rig_averaged_taylor", &hertz_rig_averaged, TAYLOR, false, {725.0, 0.0275}},
    {"rolling_rk4", &rolling_contact, RK4, false, {588.0, 0.0}},
    {"rolling_float32", &rolling_contact, FLOAT32, false, {885.0, 0.0}},
    {"rolling_unlocated", &rolling_contact, UNLOCATED, false, {657.0, 0.0}},
    {"rolling_taylor", &rolling_contact, TAYLOR, false, {710.0, 0.0275}},
    {"rolling_linear_rk4", &rolling_contact_linear, RK4, false, {533.0, 0.0}},
    {"rolling_linear_float32", &rolling_contact_linear, FLOAT32, false, {808.0, 0.0}},
    {"rolling_linear_taylor", &rolling_contact_linear, TAYLOR, false, {698.0, 0.02}},
    {"rolling_linear_exact", &rolling_contact_linear, EXACT, false, {564.0, 0.0}},
    {"tip_rk4", &afm_tip, RK4, false, {601.0, 0.0}},
    {"tip_float32", &afm_tip, FLOAT32, false, {896.0, 0.0}},
    {"tip_unlocated", &afm_tip, UNLOCATED, false, {678.0, 0.0}},
    {"tip_taylor", &afm_tip, TAYLOR, false, {711.0, 0.022}},
    {"tip_linear_rk4", &afm_tip_linear, RK4, false, {533.0, 0.0}},
    {"tip_linear_float32", &afm_tip_linear, FLOAT32, false, {808.0, 0.0}},
    {"tip_linear_taylor", &afm_tip_linear, TAYLOR, false, {699.0, 0.0205}},
    {"tip_linear_exact", &afm_tip_linear, EXACT, false, {564.0, 0.0}},
    {"tip_cubic_rk4", &afm_tip_cubic, RK4, false, {566.0, 0.0}},
    {"tip_cubic_float32", &afm_tip_cubic, FLOAT32, false, {822.0, 0.0}},
    {"tip_cubic_taylor", &afm_tip_cubic, TAYLOR, false, {716.0, 0.022}},
    {"tip_averaged_rk4", &afm_tip_averaged, RK4, false, {563.0, 0.0}},
    {"tip_averaged_float32", &afm_tip_averaged, FLOAT32, false, {822.0, 0.0}},
    {"tip_averaged_taylor", &afm_tip_averaged, TAYLOR, false, {716.0, 0.022}},
    {"shaft_rk4", &shaft_bearing, RK4, false, {1536.0, 0.0}},
    {"shaft_float32", &shaft_bearing, FLOAT32, false, {2721.0, 0.0}},
    {"shaft_unlocated", &shaft_bearing, UNLOCATED, false, {1550.0, 0.0}},
    {"shaft_exact", &shaft_bearing, EXACT, false, {976.0, 0.0}},
    {"shaft_linear_rk4", &shaft_bearing_linear, RK4, false, {1134.0, 0.0}},
    {"shaft_linear_float32", &shaft_bearing_linear, FLOAT32, false, {2268.0, 0.0}},
    {"shaft_linear_exact", &shaft_bearing_linear, EXACT, false, {893.0, 0.0}},
    {"shaft_mode_rk4", &shaft_bearing_mode, RK4, false, {984.0, 0.0}},
    {"shaft_mode_float32", &shaft_bearing_mode, FLOAT32, false, {1584.0, 0.0}},
    {"shaft_mode_unlocated", &shaft_bearing_mode, UNLOCATED, false, {1005.0, 0.0}},
    {"shaft_mode_exact", &shaft_bearing_mode, EXACT, false, {678.0, 0.0}},
    {"rig_stiffness_rk4", &hertz_rig, RK4, true, {714.0, 0.0}},
    {"rig_stiffness_float32", &hertz_rig, FLOAT32, true, {1062.0, 0.0}},
    {"rig_stiffness_unlocated", &hertz_rig, UNLOCATED, true, {780.0, 0.0}},
    {"rig_stiffness_taylor", &hertz_rig, TAYLOR, true, {816.0, 0.0275}},
    {"rig_linear_stiffness_rk4", &hertz_rig_linear, RK4, true, {666.0, 0.0}},
    {"rig_linear_stiffness_float32", &hertz_rig_linear, FLOAT32, true, {979.0, 0.0}},
    {"rig_linear_stiffness_taylor", &hertz_rig_linear, TAYLOR, true, {786.0, 0.02}},
    {"rig_linear_stiffness_exact", &hertz_rig_linear, EXACT, true, {670.0, 0.0}},
    {"rig_cubic_stiffness_rk4", &hertz_rig_cubic, RK4, true, {688.0, 0.0}},
    {"rig_cubic_stiffness_float32", &hertz_rig_cubic, FLOAT32, true, {983.0, 0.0}},
    {"rig_cubic_stiffness_taylor", &hertz_rig_cubic, TAYLOR, true, {879.0, 0.0275}},
    {"rolling_waviness_rk4", &rolling_contact, RK4, true, {603.0, 0.0}},
    {"rolling_waviness_float32", &rolling_contact, FLOAT32, true, {956.0, 0.0}},
    {"rolling_waviness_unlocated", &rolling_contact, UNLOCATED, true, {672.0, 0.0}},
    {"rolling_waviness_taylor", &rolling_contact, TAYLOR, true, {799.0, 0.0275}},
    {"rolling_linear_waviness_rk4", &rolling_contact_linear, RK4, true, {590.0, 0.0}},
    {"rolling_linear_waviness_float32", &rolling_contact_linear, FLOAT32, true, {875.0, 0.0}},
    {"rolling_linear_waviness_taylor", &rolling_contact_linear, TAYLOR, true, {737.0, 0.02}},
    {"rolling_linear_waviness_exact", &rolling_contact_linear, EXACT, true, {609.0, 0.0}},
    {"tip_stiffness_rk4", &afm_tip, RK4, true, {620.0, 0.0}},
    {"tip_stiffness_float32", &afm_tip, FLOAT32, true, {942.0, 0.0}},
    {"tip_stiffness_unlocated", &afm_tip, UNLOCATED, true, {697.0, 0.0}},
    {"tip_stiffness_taylor", &afm_tip, TAYLOR, true, {745.0, 0.025}},
    {"tip_linear_stiffness_rk4", &afm_tip_linear, RK4, true, {590.0, 0.0}},
    {"tip_linear_stiffness_float32", &afm_tip_linear, FLOAT32, true, {875.0, 0.0}},
    {"tip_linear_stiffness_taylor", &afm_tip_linear, TAYLOR, true, {738.0, 0.0205}},
    {"tip_linear_stiffness_exact", &afm_tip_linear, EXACT, true, {609.0, 0.0}},
    {"tip_cubic_stiffness_rk4", &afm_tip_cubic, RK4, true, {614.0, 0.0}},
    {"tip_cubic_stiffness_float32", &afm_tip_cubic, FLOAT32, true, {875.0, 0.0}},
    {"tip_cubic_stiffness_taylor", &afm_tip_cubic, TAYLOR, true, {814.0, 0.025}},
    {"rig_coarse", &hertz_rig, COARSE, false, {3710.0, 1.6815}},
    {"rig_linear_coarse", &hertz_rig_linear, COARSE, false, {2692.0, 1.1865}},
    {"rig_cubic_coarse", &hertz_rig_cubic, COARSE, false, {3488.0, 1.68}},
    {"rig_averaged_coarse", &hertz_rig_averaged, COARSE, false, {3488.0, 1.68}},
    {"rolling_coarse", &rolling_contact, COARSE, false, {3709.0, 1.6815}},
    {"rolling_linear_coarse", &rolling_contact_linear, COARSE, false, {2692.0, 1.1865}},
    {"tip_coarse", &afm_tip, COARSE, false, {3304.0, 1.4315}},
    {"tip_linear_coarse", &afm_tip_linear, COARSE, false, {2870.0, 1.2985}},
    {"tip_cubic_coarse", &afm_tip_cubic, COARSE, false, {3094.0, 1.4315}},
    {"tip_averaged_coarse", &afm_tip_averaged, COARSE, false, {3094.0, 1.4315}},
    {"rig_stiffness_coarse", &hertz_rig, COARSE, true, {4557.0, 1.695}},
    {"rig_linear_stiffness_coarse", &hertz_rig_linear, COARSE, true, {2817.0, 1.1865}},
    {"rig_cubic_stiffness_coarse", &hertz_rig_cubic, COARSE, true, {8103.0, 1.6945}},
    {"rolling_waviness_coarse", &rolling_contact, COARSE, true, {4146.0, 1.65}},
    {"rolling_linear_waviness_coarse", &rolling_contact_linear, COARSE, true, {2697.0, 1.157}},
    {"tip_stiffness_coarse", &afm_tip, COARSE, true, {4288.0, 1.5975}},
    {"tip_linear_stiffness_coarse", &afm_tip_linear, COARSE, true, {2930.0, 1.3035}},
    {"tip_cubic_stiffness_coarse", &afm_tip_cubic, COARSE, true, {7627.0, 1.5975}},
    {"rig_short", &hertz_rig, SHORT, false, {1097.0, 0.0}},
    {"rig_linear_short", &hertz_rig_linear, SHORT, false, {1009.0, 0.0}},
    {"rig_cubic_short", &hertz_rig_cubic, SHORT, false, {1024.0, 0.0}},
    {"rig_averaged_short", &hertz_rig_averaged, SHORT, false, {1024.0, 0.0}},
    {"rolling_short", &rolling_contact, SHORT, false, {1096.0, 0.0}},
    {"rolling_linear_short", &rolling_contact_linear, SHORT, false, {1009.0, 0.0}},
    {"tip_short", &afm_tip, SHORT, false, {1107.0, 0.0}},
    {"tip_linear_short", &afm_tip_linear, SHORT, false, {1073.0, 0.0}},
    {"tip_cubic_short", &afm_tip_cubic, SHORT, false, {1087.0, 0.0}},
    {"tip_averaged_short", &afm_tip_averaged, SHORT, false, {1087.0, 0.0}},
    {"rig_stiffness_short", &hertz_rig, SHORT, true, {1292.0, 0.0}},
    {"rolling_waviness_short", &rolling_contact, SHORT, true, {1197.0, 0.0}},
    {"tip_stiffness_short", &afm_tip, SHORT, true, {1215.0, 0.0}},
    {"rig_cubic_stiffness_short", &hertz_rig_cubic, SHORT, true, {1331.0, 0.0}},
    {"tip_cubic_stiffness_short", &afm_tip_cubic, SHORT, true, {1365.0, 0.0}},
    {"rig_noise_rk4", &hertz_rig, NOISE, false, {954.0, 0.0}},
    {"rig_noise_held_rk4", &hertz_rig, HELD, false, {766.0, 0.0}},
    {"rig_switch_rk4", &hertz_rig, SWITCH, false, {5956.0, 0.0}},
    {"rig_forces_switch_rk4", &hertz_rig, SWITCH_TWO, false, {7813.0, 0.0}},
    {"rig_switch_unlocated", &hertz_rig, THROUGH, false, {1985.0, 0.0}},
    {"rig_forces_switch_unlocated", &hertz_rig, THROUGH_TWO, false, {2829.0, 0.0}},
};
enum { TICKS = sizeof tick / sizeof tick[0] };

const char *const choose_piece_name[CHOOSE_PIECES] = {"rk4_tick",           "rk4_step",       "float32_tick",
                                                      "taylor_smooth_tick", "exact_step",     "drive",
                                                      "taylor_time",        "taylor_regular", "exact_event"};

/* Nanoseconds an instruction. Host: 1.25 instructions a cycle at 2 GHz, the slow end of desktops. Boards: the latencies one
 * after the other, docs/why/boards.md: 480 and 500 MHz; the M4F's 1.4 cycles at 168 MHz, docs/why/boards.md. */
const struct choose_machine choose_machine[CHOOSE_MACHINES] = {
    {"host", {589.0, 159.0, 890.0, 743.0, 248.0, 85.0, 1847.0, 3633.0, 2791.0}, {0.4, 0.4, 0.4, 0.4, 0.4}},
    {"mps2-an500",
     {600.0, 148.0, 963.0, 783.0, 612.0, 91.0, 2175.0, 4088.0, 3920.0},
     {2.8 / 0.48, 2.4 / 0.48, 3.6 / 0.48, 2.6 / 0.48, 2.8 / 0.48}},
    {"mps2-an386",
     {11796.0, 4904.0, 7770.0, 14208.0, 8825.0, 1253.0, 51267.0, 125170.0, 88766.0},
     {1.4 / 0.168, 1.4 / 0.168, 1.4 / 0.168, 1.4 / 0.168, 1.4 / 0.168}},
    {"xlnx-zcu102-r5",
     {626.0, 152.0, 966.0, 810.0, 628.0, 100.0, 2194.0, 4091.0, 3970.0},
     {4.3 / 0.5, 3.0 / 0.5, 5.5 / 0.5, 3.7 / 0.5, 4.3 / 0.5}},
    {"riscv-virt", {602.0, 152.0, 1017.0, 855.0, 510.0, 84.0, 2330.0, 4630.0, 4468.0}, {0.0}},
};

/* What a further order of a short series costs of the first ones tried. */
static const double further = 0.2;
/* A drive more in a long series. */
static const double tone = 340.0;

/* The counted tick; where a moved one is not counted it costs no more. */
static struct counted counted(const struct model *m, int method, bool moved)
{
    struct counted found = {(double)NAN, 0.0};
    for (int i = 0; i < TICKS; i++) {
        if (tick[i].model == m && tick[i].method == method && tick[i].moved <= moved)
            found = tick[i].counted;
    }
    return found;
}

/* A piece of taylor's. */
static double piece(const struct model *m, bool moved)
{
    struct counted many = counted(m, COARSE, moved), few = counted(m, TAYLOR, moved);
    return (many.instructions - few.instructions) / (many.series - few.series);
}

/* The tick without the pieces that begin in it. */
static double plain(const struct model *m, int method, bool moved)
{
    struct counted n = counted(m, method, moved);
    return n.instructions - (method == TAYLOR ? n.series * piece(m, moved) : 0.0);
}

/* The same of the rig, on a machine. */
static double plain_tick(const struct choose_machine *m, int method)
{
    const double *n = m->piece, *host = choose_machine[0].piece;
    double pieces = counted(&hertz_rig, TAYLOR, false).series * piece(&hertz_rig, false);
    const double of[CHOOSE_METHODS] = {n[PIECE_RK4_TICK], n[PIECE_FLOAT32_TICK],
                                       n[PIECE_TAYLOR_TICK] - pieces * n[PIECE_SERIES] / host[PIECE_SERIES],
                                       n[PIECE_RK4_TICK] - n[PIECE_RK4_STEP] + n[PIECE_EXACT_STEP],
                                       n[PIECE_RK4_TICK]};
    return of[method];
}

/* A short series of the first orders over a step, beyond the plain tick. */
static double brief(const struct model *m, bool moved)
{
    bool own = false; /* one with a moved input is counted */
    for (int i = 0; i < TICKS; i++)
        own |= tick[i].model == m && tick[i].method == SHORT && tick[i].moved && moved;
    return counted(m, SHORT, own).instructions - plain(m, TAYLOR, own);
}

/* Taylor's series in a step. */
static double series_of(const struct choose_work *w, const struct choose_machine *m)
{
    const struct model *model = w->scene->model;
    const struct choose_series *n = &w->series;
    double ratio = m->piece[PIECE_SERIES] / choose_machine[0].piece[PIECE_SERIES];
    double cost = n->time * piece(model, w->moved) + (w->drives - 1) * (n->time + n->regular) * tone;
    if (n->brief > 0.0)
        cost += (n->brief + further * n->further) * brief(model, w->moved);
    return cost * ratio + n->regular * m->piece[PIECE_SERIES_LOST];
}

/* What the rig's tick has beyond the plain one of this method. */
static double beyond(int method, int what)
{
    return counted(&hertz_rig, what, false).instructions - counted(&hertz_rig, method, false).instructions;
}

/* Noise of the inputs in a step: a sum each, and a new deviate where a hold begins. */
static double noise_of(const struct scene *s)
{
    double anew = (beyond(RK4, NOISE) - beyond(RK4, HELD)) / (1.0 - 1.0 / hold),
           each = beyond(RK4, NOISE) - anew, cost = 0.0;
    double step = scene_check_step(s);
    for (int i = 0; i < s->model->n_inputs; i++)
        if (s->drive[i].noise > 0.0)
            cost += each + anew * fmin(1.0, step / fmax(s->drive[i].noise_hold, step));
    return cost;
}

/* A switch that Runge-Kutta steps locate, by shortened steps, or tell at their end: each with every drive anew. */
static double switched(const struct choose_work *w, int method)
{
    int as = method == UNLOCATED ? UNLOCATED : RK4;
    double first = beyond(as, as == UNLOCATED ? THROUGH : SWITCH),
           two =
               beyond(as, as == UNLOCATED ? THROUGH_TWO : SWITCH_TWO) - choose_machine[0].piece[PIECE_DRIVE];
    double one = first + (w->drives - 1) * (two - first);
    return one * plain(w->scene->model, method, false) / plain(&hertz_rig, as, false);
}

double choose_cost_step(const struct choose_work *w, int method, int machine)
{
    const struct choose_machine *m = &choose_machine[machine];
    double ratio = plain_tick(m, method) / plain_tick(&choose_machine[0], method),
           switches = w->switches * scene_check_step(w->scene);
    double cost = (plain(w->scene->model, method, w->moved) + noise_of(w->scene)) * ratio;
    cost += (w->drives - 1) * m->piece[PIECE_DRIVE];
    if (choose_method[method]->order > 0)
        cost += switches * switched(w, method) * ratio;
    if (method == TAYLOR)
        cost += series_of(w, m);
    if (method == EXACT)
        cost += 2.0 * switches * m->piece[PIECE_SWITCH];
    return cost;
}

bool choose_cost_entry(int i, const char **name, double *instructions, double *series)
{
    if (i >= TICKS)
        return false;
    *name = tick[i].name;
    *instructions = tick[i].counted.instructions;
    *series = tick[i].counted.series;
    return true;
}
