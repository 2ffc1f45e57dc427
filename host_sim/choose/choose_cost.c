/* choose_cost.c - instructions of one step of the plant, by model and method.
 *
 * A count is one tick of the plant with one drive, the contact kept, 128 ticks a period, tolerance 1e-6;
 * others count the pieces that a motion adds. A run by taylor counts its own series (struct choose_series).
 * A long series costs the difference between coarse and fine ticks, over how many more series begin in a
 * coarse one, and somewhat more for each further drive. A short series costs what a tick that it serves
 * alone costs beyond the plain one; its further orders cost nearly as much each. A series in flight counts
 * as a long one: it costs less, which makes up for the switches. A switch in exact costs as much again for
 * the rest of its tick; in rk4 and rk4_unlocated it is counted whole, and scales with the model's tick.
 * A lever's tick costs more with each mode, and near the sample, by the share of such ticks in a run.
 * Whole runs execute 0.90 to 1.01 times this (tests/choose/test_choose_cost.sh). Boards scale by their own
 * tick of the rig, an estimate. */
#include "host_sim/choose/choose_cost.h"

#include <math.h>
#include "host_sim/scene/scene_check.h"
#include "models/afm_lever.h"
#include "models/reduced/afm_tip_reduced.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/reduced/shaft_mode.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"

/* A model's ticks; `moved`: an input that is no force sounds. 0: not counted. */
struct choose_counts {
    const struct model *model;
    bool moved;
    double tick[COUNTS], series[2]; /* long series that taylor begins in a tick, and in a coarse one */
};
#include "host_sim/choose/choose_counts.h"

const struct method *const choose_method[CHOOSE_METHODS] = {&rk4,   &rk4_float32,   &taylor,
                                                            &exact, &rk4_unlocated, &modal};

/* Nanoseconds an instruction. Host: 1.25 instructions a cycle at 2 GHz, the slow end of desktops. Boards:
 * the latencies one after the other, docs/why/accuracy.md: 480 and 500 MHz; the M4F's 1.4 cycles at 168
 * MHz, docs/guide/porting.md. */
const struct choose_machine choose_machine[CHOOSE_MACHINES] = {
    {"host", {0.4, 0.4, 0.4, 0.4, 0.4, 0.4}},
    {"mps2-an500", {2.8 / 0.48, 2.4 / 0.48, 3.6 / 0.48, 2.6 / 0.48, 2.8 / 0.48, 2.8 / 0.48}},
    {"mps2-an386", {1.4 / 0.168, 1.4 / 0.168, 1.4 / 0.168, 1.4 / 0.168, 1.4 / 0.168, 1.4 / 0.168}},
    {"xlnx-zcu102-r5", {4.3 / 0.5, 3.0 / 0.5, 5.5 / 0.5, 3.7 / 0.5, 4.3 / 0.5, 4.3 / 0.5}},
    {"riscv-virt", {0.0}},
};

bool choose_takes(const struct model *m, int method)
{
    return (choose_method[method] == &modal) == (m->modal_form != NULL);
}

const char *const choose_extra_name[EXTRAS] = {
    "rig_noise_rk4",         "rig_noise_held_rk4",   "rig_switch_rk4",
    "rig_forces_switch_rk4", "rig_switch_unlocated", "rig_forces_switch_unlocated",
    "lever_modes_modal",     "lever_near_modal",     "lever_near_modes_modal"};
const char *const choose_piece_name[CHOOSE_PIECES] = {"rk4_tick",           "rk4_step",       "float32_tick",
                                                      "taylor_smooth_tick", "exact_step",     "drive",
                                                      "taylor_time",        "taylor_regular", "exact_event"};
enum { ROWS = sizeof counts / sizeof counts[0] };

static const double further = 0.2; /* share of a short series' cost that each further order adds */
static const double tone = 340.0;  /* a drive more in a long series */

/* Instructions of `exact` for a switch and the ticks near it, in those of the piece exact_event. On a PC they
 * are from whole runs of two shafts (test_choose_cost.sh). There a tick with two switches is begun in a
 * block, and done again by itself. */
static const double exact_events = 4.6, exact_events_board = 2.0;

/* A model's count; where one with a moved input is missing, that costs no more. NaN: the method does not
 * take the model. */
static double tick(const struct model *m, enum choose_count what, bool moved)
{
    double found = (double)NAN;
    for (int i = 0; i < ROWS; i++)
        if (counts[i].model == m && counts[i].moved <= moved && counts[i].tick[what] > 0.0)
            found = counts[i].tick[what];
    return found;
}

static const double *series(const struct model *m, bool moved)
{
    const double *found = counts[0].series;
    for (int i = 0; i < ROWS; i++)
        if (counts[i].model == m && counts[i].moved <= moved && counts[i].tick[COUNT_TAYLOR] > 0.0)
            found = counts[i].series;
    return found;
}

static double long_series(const struct model *m, bool moved)
{
    const double *n = series(m, moved);
    return (tick(m, COUNT_COARSE, moved) - tick(m, COUNT_TAYLOR, moved)) / (n[1] - n[0]);
}

/* A tick in which no series begins. */
static double plain(const struct model *m, int method, bool moved)
{
    double all = tick(m, (enum choose_count)method, moved);
    return method == COUNT_TAYLOR ? all - series(m, moved)[0] * long_series(m, moved) : all;
}

/* A short series of the first orders over a step. */
static double short_series(const struct model *m, bool moved)
{
    bool own = false; /* one with a moved input was counted */
    for (int i = 0; i < ROWS; i++)
        own |= moved && counts[i].model == m && counts[i].moved && counts[i].tick[COUNT_SHORT] > 0.0;
    return tick(m, COUNT_SHORT, own) - plain(m, COUNT_TAYLOR, own);
}

/* The rig's plain tick on a machine. */
static double plain_on(int machine, int method)
{
    const double *n = pieces[machine], *host = pieces[0];
    double begun = series(&hertz_rig, false)[0] * long_series(&hertz_rig, false);
    const double of[CHOOSE_METHODS] = {n[PIECE_RK4_TICK],
                                       n[PIECE_FLOAT32_TICK],
                                       n[PIECE_TAYLOR_TICK] - begun * n[PIECE_SERIES] / host[PIECE_SERIES],
                                       n[PIECE_RK4_TICK] - n[PIECE_RK4_STEP] + n[PIECE_EXACT_STEP],
                                       n[PIECE_RK4_TICK],
                                       n[PIECE_RK4_TICK]};
    return of[method];
}

static double series_cost(const struct choose_work *w, int machine)
{
    const struct model *model = w->scene->model;
    const struct choose_series *n = &w->series;
    double cost = n->time * long_series(model, w->moved) + (w->drives - 1) * (n->time + n->regular) * tone;
    if (n->brief > 0.0)
        cost += (n->brief + further * n->further) * short_series(model, w->moved);
    return cost * (pieces[machine][PIECE_SERIES] / pieces[0][PIECE_SERIES]) +
           n->regular * pieces[machine][PIECE_SERIES_LOST];
}

/* Instructions of the rig's tick beyond the plain one of this method. */
static double beyond(int method, enum choose_extra what)
{
    return extra[what] - tick(&hertz_rig, (enum choose_count)method, false);
}

/* Noise of the inputs in a step: a sum each, and a new deviate where a hold begins. */
static double noise_cost(const struct scene *s)
{
    double all = beyond(COUNT_RK4, EXTRA_NOISE),
           anew = (all - beyond(COUNT_RK4, EXTRA_HELD)) / (1.0 - 1.0 / CHOOSE_HOLD), cost = 0.0;
    double step = scene_check_step(s);
    for (int i = 0; i < s->model->n_inputs; i++)
        if (s->drive[i].noise > 0.0)
            cost += (all - anew) + anew * fmin(1.0, step / fmax(s->drive[i].noise_hold, step));
    return cost;
}

/* A switch that Runge-Kutta steps locate, by shortened steps, or tell at their end: each with every drive
 * anew. */
static double switch_cost(const struct choose_work *w, int method)
{
    bool through = method == COUNT_UNLOCATED;
    int as = through ? COUNT_UNLOCATED : COUNT_RK4;
    double first = beyond(as, through ? EXTRA_THROUGH : EXTRA_SWITCH),
           two = beyond(as, through ? EXTRA_THROUGH_TWO : EXTRA_SWITCH_TWO) - pieces[0][PIECE_DRIVE];
    double one = first + (w->drives - 1) * (two - first);
    return one * plain(w->scene->model, method, false) / plain(&hertz_rig, as, false);
}

/* A lever's tick beyond that of one mode far from the sample. */
static double lever_cost(const struct choose_work *w)
{
    double far = tick(w->scene->model, COUNT_MODAL, false), near = extra[EXTRA_NEAR] - far;
    double more = (w->scene->value[LEVER_MODES] - 1.0) / (MODEL_MODES - 1);
    double far_more = extra[EXTRA_MODES] - far,
           near_more = extra[EXTRA_NEAR_MODES] - extra[EXTRA_NEAR] - far_more;
    return more * far_more + w->series.near * (near + more * near_more);
}

double choose_cost_step(const struct choose_work *w, int method, int machine)
{
    double ratio = plain_on(machine, method) / plain_on(0, method),
           switches = w->switches * scene_check_step(w->scene);
    double cost = (plain(w->scene->model, method, w->moved) + noise_cost(w->scene)) * ratio;
    cost += (w->drives - 1) * pieces[machine][PIECE_DRIVE];
    if (method == COUNT_MODAL)
        cost += lever_cost(w) * ratio;
    else if (choose_method[method]->order > 0)
        cost += switches * switch_cost(w, method) * ratio;
    if (method == COUNT_TAYLOR)
        cost += series_cost(w, machine);
    if (method == COUNT_EXACT)
        cost += (machine == 0 ? exact_events : exact_events_board) * switches * pieces[machine][PIECE_SWITCH];
    return cost;
}
