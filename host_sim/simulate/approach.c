/* approach.c - the subcommand `approach`: a force curve of an AFM lever, to the sample and back. */
#include "host_sim/commands.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "host_sim/afm/force_curve.h"
#include "host_sim/cli/options.h"
#include "host_sim/report/figure.h"
#include "host_sim/scene/plant_of_scene.h"
#include "host_sim/scene/scene_app.h"
#include "host_sim/scene/scene_load.h"
#include "host_sim/scene/scene_range.h"
#include "models/afm_lever.h"

enum { POINTS_MAX = 100000 };
static const double way_ticks_max = 4e9; /* in one direction: a quarter of an hour */

static const struct option approach_options[] = {
    {"to", "M", "nearest height of the base over the sample, metres (-10e-9)", OPTION_NUMBER, -1e-3, 1e-3,
     .initial = "-10e-9"},
    {"speed", "M/S", "speed of the base (1e-6)", OPTION_NUMBER, 1e-12, 1.0, .initial = "1e-6"},
    {"points", "N", "rows in each direction (500)", OPTION_INTEGER, 10.0, POINTS_MAX, .initial = "500"},
    {"set", "NAME=VALUE", "a number of the scene, with its unit; repeatable", OPTION_TEXT, .many = true},
    {"out", "FILE", "rows as CSV (standard output)", OPTION_WRITES, .initial = NULL},
    {"tab", "FILE", "a force curve for afmformats, PyJibe and nanite (.tab)", OPTION_WRITES, .initial = NULL},
    {"svg", "FILE", "a picture of deflection, amplitude and force over the base", OPTION_WRITES,
     .initial = NULL},
    {.name = NULL},
};

static const struct usage approach_usage = {
    .name = "approach",
    .words = "SCENE",
    .summary =
        "Moves the base of an AFM lever to the sample and back, and writes the force curve. Prints where\n"
        "contact begins and ends, beside closed forms where no drive moves the lever.",
    .words_help = SCENE_WORDS_HELP,
    .examples = "  contactplant approach soft --out curve.csv --svg curve.svg\n"
                "  contactplant approach soft --tab curve.tab --out curve.csv\n"
                "  contactplant approach soft --to -20e-9 --speed 2e-7 --set temperature=\"0 K\"\n",
    .min_words = 1,
    .max_words = 1,
    .table = {approach_options},
};

/* Means over one row. */
enum { BASE, DEFLECTION, FORCE, AMPLITUDE, PENETRATION, COLUMNS };

struct approach {
    struct options o;
    struct scene scene;
    enum scene_origin origin;
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    double *scratch;
    struct plant plant;
    size_t n; /* rows in each direction */
    uint64_t ticks;
    double top, low;
    double *row[COLUMNS];  /* [2 n] */
    double touch, release; /* base at the first touch on the way down, at the last lift-off; NaN for none */
    bool released_back;    /* the last lift-off was on the way back */
};

static int read_scene(struct approach *a)
{
    char why[SCENE_REASON];
    a->origin = scene_load(a->o.word[0], &a->scene, why);
    if (a->origin == SCENE_OF_NOTHING)
        return options_misuse(&approach_usage, "%s", why);
    if (!a->scene.model->modal_form) /* afm_lever is the one model with this view */
        return options_misuse(&approach_usage,
                              "%s is no AFM lever; give soft, tapping, stiff or a scene of afm_lever",
                              a->o.word[0]);
    const char *refused = scene_refuses_stages(&a->scene);
    if (refused)
        return options_misuse(&approach_usage, "%s: %s", a->o.word[0], refused);
    return scene_range_settings(&a->o, &a->scene);
}

static int begin(struct approach *a)
{
    scenes_resolve(&a->scene, a->si, a->drive);
    struct plant_config c = plant_config_of_real_scene(&a->scene, a->si, 0.0, NULL);
    int which;
    const char *why = plant_check(a->scene.model, a->si, &which);
    a->scratch = calloc(c.method->n_scratch(a->scene.model) + 1, sizeof *a->scratch);
    for (int i = 0; i < COLUMNS; i++)
        a->row[i] = calloc(2 * a->n, sizeof *a->row[i]);
    for (int i = 0; i < COLUMNS; i++)
        if (!a->row[i] || !a->scratch)
            return options_failure(&approach_usage, "out of memory");
    c.scratch = a->scratch;
    why = why ? why : plant_of_scene(&a->plant, &c, &a->scene, a->drive);
    if (why)
        return options_misuse(&approach_usage, "%s: %s", a->o.word[0], why);
    a->top = a->si[LEVER_HEIGHT];
    a->low = options_number(&a->o, "to");
    if (!(a->low < a->top))
        return options_misuse(&approach_usage, "--to %g is not below the scene's height of %g m; give less",
                              a->low, a->top);
    double ticks = (a->top - a->low) / options_number(&a->o, "speed") / c.tick_s;
    if (!(ticks <= way_ticks_max && ticks >= (double)a->n))
        return options_misuse(&approach_usage,
                              "a way of %.3g steps: give a --speed that makes %zu to %.0e of them", ticks,
                              a->n, way_ticks_max);
    a->ticks = (uint64_t)ticks / a->n * a->n;
    return 0;
}

/* Events since the last row: the base is at `base` then. */
static void take_events(struct approach *a, double base, bool back)
{
    struct event e;
    while (plant_take_event(&a->plant, &e)) {
        if (e.touch && !back && isnan(a->touch))
            a->touch = base;
        if (e.touch)
            continue;
        a->release = base;
        a->released_back = back;
    }
}

/* The means of one row: `ticks` steps. */
static bool carry_row(struct approach *a, uint64_t ticks, size_t row, bool back)
{
    double sum[COLUMNS] = {0.0}, square = 0.0, out[MODEL_OUTPUTS];
    for (uint64_t i = 0; i < ticks; i++) {
        if (!plant_run(&a->plant, 1))
            return false;
        plant_output(&a->plant, out);
        sum[BASE] += out[LEVER_BASE];
        sum[DEFLECTION] += out[LEVER_DEFLECTION];
        square += out[LEVER_DEFLECTION] * out[LEVER_DEFLECTION];
        sum[FORCE] += out[3];
        sum[PENETRATION] = out[2] > sum[PENETRATION] ? out[2] : sum[PENETRATION];
        take_events(a, out[LEVER_BASE], back);
    }
    double n = (double)ticks, mean = sum[DEFLECTION] / n, spread = square / n - mean * mean;
    a->row[BASE][row] = sum[BASE] / n;
    a->row[DEFLECTION][row] = mean;
    a->row[FORCE][row] = sum[FORCE] / n;
    a->row[AMPLITUDE][row] = sqrt(2.0 * (spread > 0.0 ? spread : 0.0));
    a->row[PENETRATION][row] = sum[PENETRATION];
    return true;
}

static int move(struct approach *a)
{
    a->touch = a->release = (double)NAN;
    for (int back = 0; back < 2; back++) {
        plant_sample(&a->plant, LEVER_Z, back ? 0.0 : a->low - a->top, a->ticks);
        for (size_t i = 0; i < a->n; i++)
            if (!carry_row(a, a->ticks / a->n, (size_t)back * a->n + i, back))
                return options_failure(&approach_usage,
                                       "the motion left the finite numbers; take more substeps");
    }
    return 0;
}

/* ---- what is written ---- */

static int write_rows(struct approach *a)
{
    FILE *f = options_given(&a->o, "out") ? options_compose(&a->o, "out") : stdout;
    if (!f)
        return STATUS_FAILED;
    fprintf(f, "retract,base_m,deflection_m,force_N,amplitude_m,penetration_m\n");
    for (size_t i = 0; i < 2 * a->n; i++)
        fprintf(f, "%d,%.9g,%.9g,%.9g,%.9g,%.9g\n", i >= a->n, a->row[BASE][i], a->row[DEFLECTION][i],
                a->row[FORCE][i], a->row[AMPLITUDE][i], a->row[PENETRATION][i]);
    return options_close(&a->o, "out", f, NULL);
}

static int write_tab(struct approach *a)
{
    double time = (double)(a->ticks / a->n) * a->plant.tick_s / a->plant.dilation;
    FILE *f = options_compose(&a->o, "tab");
    if (!f)
        return STATUS_FAILED;
    force_curve_write(f, &(struct force_curve){.n = 2 * a->n,
                                               .base = a->row[BASE],
                                               .deflection = a->row[DEFLECTION],
                                               .step_s = time,
                                               .begin_s = 0.5 * time,
                                               .speed = options_number(&a->o, "speed"),
                                               .z_range = a->top - a->low,
                                               .stiffness = a->si[LEVER_K]});
    return options_close(&a->o, "tab", f, NULL);
}

static void panel(struct figure *g, const struct approach *a, int column, const char *title, const char *unit)
{
    const double *x = a->row[BASE], *y = a->row[column];
    figure_panel(g, title, unit, 180.0);
    figure_put(g, &(struct figure_layer){FIGURE_LINE, .legend = "approach", .n = a->n, .x = x, .y = y});
    figure_put(g, &(struct figure_layer){FIGURE_LINE, .legend = "retract", .colour = CHART_RED, .n = a->n,
                                         .x = x + a->n, .y = y + a->n});
}

static int draw(const struct approach *a)
{
    struct figure g;
    figure_begin_picture(&g, &a->o, a->o.word[0]);
    figure_subtitle(&g, "to the surface, and back");
    figure_axis(&g, &(struct figure_axis){"height of the base", "m", a->low, a->top, false});
    panel(&g, a, DEFLECTION, "deflection", "m");
    panel(&g, a, AMPLITUDE, "amplitude", "m");
    panel(&g, a, FORCE, "mean force of the sample", "N");
    return figure_end(&g, &a->o);
}

/* Where contact begins or ends, or why it does not, beside the closed form of a still lever (0: there is
 * none). */
static void tell_place(FILE *f, const char *what, const char *never, double base_m, double slowly_m)
{
    if (never)
        fprintf(f, "contact %s", never);
    else
        fprintf(f, "contact %s with the base at %.5g nm", what, base_m * 1e9);
    if (slowly_m > 0.0)
        fprintf(f, "; without heat, slowly: %.5g nm", slowly_m * 1e9);
    fputc('\n', f);
}

/* Snap-in of a lever that moves slowly: the gap (H R/(3 k))^(1/3), the base at 1.5 of it. Pull-off: at a0
 * + F_ad/k. */
static void report(const struct approach *a)
{
    FILE *f = options_summary(&a->o);
    const double *si = a->si;
    double snap = 1.5 * cbrt(si[LEVER_HAMAKER] * si[LEVER_RADIUS] / (3.0 * si[LEVER_K]));
    double pull = si[LEVER_HAMAKER_OUT] * si[LEVER_RADIUS] / (6.0 * si[LEVER_A0] * si[LEVER_A0]);
    bool still = true;
    for (int i = 0; i < LEVER_INPUTS; i++)
        still = still && a->drive[i].amplitude == 0.0;
    bool none = isnan(a->touch) && isnan(a->release) && !a->plant.regime;
    const char *ends = a->released_back ? "ends" : "ends, on the way down already,";
    tell_place(f, "begins",
               !isnan(a->touch) ? NULL
               : none           ? "never begins"
                                : "is there from the start",
               a->touch, still && snap > 1.5 * si[LEVER_A0] ? snap : 0.0);
    if (!none)
        tell_place(f, ends, a->plant.regime ? "has not ended with the rows" : NULL, a->release,
                   still ? pull / si[LEVER_K] + si[LEVER_A0] : 0.0);
    double area = 0.0;
    for (size_t i = 1; i < 2 * a->n; i++)
        area += 0.5 * (a->row[FORCE][i] + a->row[FORCE][i - 1]) * (a->row[BASE][i] - a->row[BASE][i - 1]);
    fprintf(f, "work of the base between the two curves: %.4g aJ\n", -area * 1e18 + 0.0);
}

static void drop(struct approach *a)
{
    for (int i = 0; i < COLUMNS; i++)
        free(a->row[i]);
    free(a->scratch);
}

int cmd_approach(int argc, char **argv)
{
    static struct approach a;
    int status;
    memset(&a, 0, sizeof a);
    if (!options_parse(&a.o, &approach_usage, argc, argv, &status))
        return status;
    a.n = (size_t)options_number(&a.o, "points");
    status = read_scene(&a);
    status = status ? status : begin(&a);
    status = status ? status : move(&a);
    status = status ? status : write_rows(&a);
    if (!status && options_given(&a.o, "tab"))
        status = write_tab(&a);
    if (!status)
        report(&a);
    if (!status && options_given(&a.o, "svg"))
        status = draw(&a);
    drop(&a);
    return status;
}
