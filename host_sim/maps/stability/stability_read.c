/* stability_read.c - see stability_read.h. */
#include "host_sim/commands.h"
#include "host_sim/maps/stability/stability_read.h"

#include <math.h>
#include <stddef.h>
#include <string.h>
#include "firmware/plant/plant.h"
#include "firmware/plant/plant_change.h"
#include "host_sim/scene/scene_check.h"
#include "host_sim/maps/stability/stability_floquet.h"
#include "models/math/elementary.h"

#define misuse(s, ...) options_misuse((s)->m.o.usage, __VA_ARGS__)

enum { X_DEFAULT = 200, Y_DEFAULT = 100, CONTACT_DEFAULT = 40 };

/* The fewest steps in a period of the modulation: fewer do not sample the drive. */
static const double steps_min = 2.0;

/* ---- the step ---- */

/* The step as a number of the scene, like its keys: read_step makes a frame one step, without dilation. */
static void step_key(const struct scene *sc, struct scene_range *r)
{
    const char *unit = scenes_dimensionless(sc) ? "" : "s";
    *r = (struct scene_range){.input = -1,
                              .key = {.kind = KEY_NUMBER,
                                      .name = "step",
                                      .full = "step",
                                      .unit = unit,
                                      .min = 1e-12,
                                      .max = 1e6,
                                      .offset = offsetof(struct scene, frame_s)}};
    scene_range_spell(r->column, sizeof r->column, "step", unit);
    snprintf(r->words, sizeof r->words, "step of the method");
    r->unit = unit;
}

static int read_step(struct stability *s)
{
    struct scene *sc = &s->m.scene;
    double step = scene_check_step(sc);
    int status = maps_read_time(&s->m, "step", &step);
    sc->frame_s = step;
    sc->substeps = sc->dilation = 1.0;
    return status;
}

/* ---- axes ---- */

static int read_axis(const struct stability *s, const char *option, struct scene_range *r)
{
    const char *text = options_text(&s->m.o, option, 0);
    if (strncmp(text, "step=", 5))
        return scene_range_read(s->m.o.usage, &s->m.scene, option, text, r);
    step_key(&s->m.scene, r);
    return scene_range_limits(s->m.o.usage, option, text, r);
}

/* Default axes of a floquet map: the modulation's frequency about the contact's, its amplitude up to the
 * stiffness. */
static const char *choose_floquet(struct stability *s)
{
    struct scene sc = s->m.scene;
    struct stability_tangent t;
    double unit;
    const char *why = stability_tangent_of(&sc, &t);
    if (why)
        return why;
    if (!s->x.values.n) {
        if (!maps_find_drive_number(&sc, t.input, true, &s->x, &unit))
            return "no number of this scene is the modulation's frequency alone; give --x";
        double natural = sqrt(t.stiffness) / t.time_s / unit;
        s->x.values = (struct range){0.25 * natural, 2.5 * natural, X_DEFAULT, false};
    }
    if (!s->y.values.n) {
        if (!maps_find_drive_number(&sc, t.input, false, &s->y, &unit))
            return "no number of this scene is the modulation's amplitude alone; give --y";
        scene_range_set(&sc, &s->x, s->x.values.to);
        scene_range_set(&sc, &s->y, 1.0);
        (void)stability_tangent_of(&sc, &t);
        s->y.values = (struct range){0.0, t.stiffness / t.modulation, Y_DEFAULT, false};
    }
    return NULL;
}

/* Default axes of a contact map: steps about the stability limit, and a tenth to ten times the stiffness. */
static const char *choose_contact(struct stability *s)
{
    const struct scene *sc = &s->m.scene;
    struct scene_point q;
    point_of_scene(sc, &q);
    double time_s = q.scale.time_s / sc->model->eigenfrequency(q.p);
    if (!s->x.values.n) {
        step_key(sc, &s->x);
        s->x.values = (struct range){0.05 * time_s, 3.0 * time_s, CONTACT_DEFAULT, true};
    }
    for (int i = 0; !s->y.values.n && scene_range_nth(sc, i, &s->y); i++) {
        if (s->y.input >= 0 || s->y.key.kind != KEY_NUMBER || !strstr(s->y.key.name, "stiffness"))
            continue;
        double value = scene_keys_value(sc, &s->y.key);
        s->y.values = (struct range){0.1 * value, 10.0 * value, CONTACT_DEFAULT, true};
    }
    return s->y.values.n ? NULL : "no number of this scene is called stiffness; give --y";
}

static int read_axes(struct stability *s)
{
    int status = options_given(&s->m.o, "x") ? read_axis(s, "x", &s->x) : 0;
    if (!status && options_given(&s->m.o, "y"))
        status = read_axis(s, "y", &s->y);
    if (status)
        return status;
    const char *why = (s->map == STABILITY_FLOQUET ? choose_floquet : choose_contact)(s);
    if (why)
        return misuse(s, "%s", why);
    if (s->x.key.offset == s->y.key.offset)
        return misuse(s, "--x and --y are both %s; take two different numbers", s->x.column);
    return 0;
}

/* ---- conditions ---- */

static const char *check_floquet(const struct stability *s, const struct scene *sc)
{
    struct stability_tangent t;
    const char *why = stability_tangent_of(sc, &t);
    if (why)
        return why;
    if (!(t.omega > 0.0))
        return "the modulation has no frequency there";
    double turn = 2.0 * ELEMENTARY_PI / t.omega;
    return turn < steps_min * sc->frame_s / t.time_s ? "fewer than 2 steps in a period of the modulation; "
                                                       "give a shorter --step"
                                                     : stability_refuse(s->m.method, s->m.tol);
}

static const char *check_contact(const struct stability *s, const struct scene *sc)
{
    struct scene_point q;
    int which;
    scenes_resolve(sc, q.si, q.drive);
    const char *why = plant_check(sc->model, q.si, &which);
    if (why)
        return why;
    point_of_scene(sc, &q);
    for (int i = 0; i < sc->model->n_inputs; i++)
        if (sc->drive[i].noise > 0.0)
            return "noise is held for whole steps, and would be another one at each step; take it out";
    for (int i = 0; i < sc->model->n_inputs; i++)
        if (q.drive[i].omega * sc->frame_s > ELEMENTARY_PI && fabs(q.drive[i].amplitude) > 0.0)
            return "fewer than 2 steps in a period of a drive; give shorter steps";
    return s->m.method->refuse(sc->model, q.p, 1e-3 / sc->model->eigenfrequency(q.p), s->m.tol);
}

static int check_corners(const struct stability *s)
{
    for (int i = 0; i < 4; i++) {
        struct scene sc = s->m.scene;
        double x = i % 2 ? s->x.values.to : s->x.values.from, y = i / 2 ? s->y.values.to : s->y.values.from;
        scene_range_set(&sc, &s->y, y);
        scene_range_set(&sc, &s->x, x);
        const char *why = (s->map == STABILITY_FLOQUET ? check_floquet : check_contact)(s, &sc);
        if (why)
            return misuse(s, "at %s = %g and %s = %g: %s", s->y.column, y, s->x.column, x, why);
    }
    return 0;
}

#define AT(i) ((i) * sizeof(double))

static const struct rows_column floquet_columns[] = {
    {"ratio", "", "frequency of the modulation over the contact's", ROWS_NUMBER, 10,
     .offset = AT(FLOQUET_RATIO)},
    {"steps_per_period", "", "of the modulation", ROWS_NUMBER, 10, .offset = AT(FLOQUET_STEPS)},
    {"plant_multiplier", "", "the larger one", ROWS_NUMBER, 10, .offset = AT(FLOQUET_PLANT)},
    {"method_multiplier", "", "with the step", ROWS_NUMBER, 10, .offset = AT(FLOQUET_METHOD)},
};
static const struct rows_column contact_columns[] = {
    {"step_rad", "", "times the contact's eigenfrequency", ROWS_NUMBER, 10, .offset = AT(CONTACT_STEP)},
    {"switches", "", "of the plant", ROWS_NUMBER, 10, .offset = AT(CONTACT_SWITCHES)},
    {"method_switches", "", "with the step", ROWS_NUMBER, 10, .offset = AT(CONTACT_OF_METHOD)},
    {"energy_ratio", "", "of the method over the plant's; inf: it escaped", ROWS_NUMBER, 10,
     .offset = AT(CONTACT_ENERGY)},
};

static void describe_rows(struct stability *s)
{
    const struct rows_column y = {s->y.column, "", "upwards", ROWS_NUMBER, 10, .offset = AT(0)};
    const struct rows_column x = {s->x.column, "", "across", ROWS_NUMBER, 10, .offset = AT(1)};
    rows_begin(&s->m.rows, AT(s->map == STABILITY_FLOQUET ? FLOQUET_COLUMNS : CONTACT_COLUMNS));
    rows_add(&s->m.rows, &y);
    rows_add(&s->m.rows, &x);
    for (int i = 0; i < 4; i++)
        rows_add(&s->m.rows, s->map == STABILITY_FLOQUET ? &floquet_columns[i] : &contact_columns[i]);
}

static bool say(const void *context, const char *option, FILE *f)
{
    const struct stability *s = context;
    if (!strcmp(option, "x"))
        scene_range_print(f, &s->x);
    else if (!strcmp(option, "y"))
        scene_range_print(f, &s->y);
    else if (!strcmp(option, "step"))
        fprintf(f, "%.17g", s->m.scene.frame_s);
    else
        return false;
    return true;
}

int stability_read(struct stability *s)
{
    static const char *const kind[] = {"floquet", "contact"};
    int map = options_find(&s->m.o, "map", kind, 2, "no such map");
    if (map < 0)
        return STATUS_MISUSED;
    s->map = map ? STABILITY_CONTACT : STABILITY_FLOQUET;
    if (s->map == STABILITY_FLOQUET && options_given(&s->m.o, "periods"))
        return misuse(s, "--periods is for --map contact; take it away");
    s->periods = (int)options_number(&s->m.o, "periods");
    int status = maps_load(&s->m);
    status = status ? status : maps_load_method(&s->m, METHOD_TOL_MAX);
    if (status)
        return status;
    s->m.scene.method = s->m.method->name;
    s->m.scene.tolerance = s->m.tol;
    status = read_step(s);
    status = status ? status : read_axes(s);
    status = status ? status : check_corners(s);
    status = status ? status : maps_check_files(&s->m, options_text(&s->m.o, "out", 0));
    describe_rows(s);
    return status ? status : maps_identify(&s->m, "stability", say, s);
}
