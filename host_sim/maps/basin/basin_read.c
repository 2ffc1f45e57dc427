/* basin_read.c - see basin_read.h. */
#include "firmware/method/auto.h"
#include "host_sim/batch/batch_taylor_set.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/maps/basin/basin_read.h"
#include "firmware/plant/drive.h"
#include "host_sim/batch/batch_taylor.h"
#include "host_sim/maps/basin/basin_rows.h"

#include <math.h>
#include <string.h>

static const double around = 4.0; /* default box: this many units of the contact around rest */
/* The method's tolerance, and the distance that counts as a return. A return is only seen where the
 * method's error is far below it. */
static const double method_tolerance = 1e-10;
static const double repeat = 1e-8;
enum { STEPS_FEWEST = 8, STEPS_MOST = 65536 };

static int read_plant(struct basin *b)
{
    struct basin_plant *q = &b->plant;
    const char *why = basin_map_read(q, &b->m.scene);
    q->tol = method_tolerance;
    for (int i = 0; i < q->model->n_inputs; i++) {
        if (b->m.scene.drive[i].noise > 0.0)
            return options_misuse(b->m.o.usage,
                                  "%s: noise of %s: a random input has no attractors; take it away",
                                  b->m.name, q->model->input_signal[i].name);
    }
    return why ? options_misuse(b->m.o.usage, "%s: %s", b->m.name, why) : 0;
}

static const char series[] = "batch_taylor";

/* NULL, or why batch_taylor refuses this plant. */
static const char *refuse_series(const struct basin_plant *q)
{
    struct batch_trajectory t = {.model = q->model, .p = q->p, .interval = q->period};
    memcpy(t.drive, q->drive, sizeof t.drive);
    return batch_taylor_refuse(&t);
}

/* Takes this many steps a period, and chooses where auto is wanted; wanted: NULL for batch_taylor. NULL,
 * or why the steps are too few. */
static const char *try_steps(struct basin_plant *q, const struct method *wanted, int steps)
{
    double fastest = 0.0, h = basin_map_tick_s(q, steps) / q->scale.time_s;
    for (int i = 0; i < q->model->n_inputs; i++)
        fastest = fmax(fastest, q->turns[i]);
    q->steps = steps;
    if (fastest * DRIVE_TICKS_MIN > steps)
        return DRIVE_TICKS_TOO_FEW "a drive";
    q->series = !wanted || (wanted == &auto_method && !refuse_series(q));
    q->method = q->series ? &taylor : wanted;
    if (q->method == &auto_method)
        q->method = auto_choice(q->model, q->p, h, q->tol, q->si_drive, &q->scale);
    return q->method->refuse(q->model, q->p, h, q->tol);
}

static int no_method(const struct basin *b, const char *method)
{
    const char *name[METHODS + 1] = {series};
    int n = 1 + scene_method_names(name + 1);
    return options_misuse(b->m.o.usage, "--method %s: no such method%s", method,
                          options_advise(method, strlen(method), name, n, NULL));
}

static int read_method(struct basin *b)
{
    const char *name =
        options_given(&b->m.o, "method") ? options_text(&b->m.o, "method", 0) : b->m.scene.method;
    const struct method *wanted = method_find(name);
    const char *why = NULL;
    if (!wanted && strcmp(name, series) != 0)
        return no_method(b, name);
    if (!wanted && !b->plant.model->hertz_form)
        return options_misuse(b->m.o.usage,
                              "--method %s: %s has no single Hertzian contact; leave it to auto", name,
                              b->plant.model->name);
    if (!wanted && (why = refuse_series(&b->plant)) != NULL)
        return options_misuse(b->m.o.usage, "--method %s: %s; give --method taylor", name, why);
    if (options_given(&b->m.o, "steps")) {
        why = try_steps(&b->plant, wanted, (int)options_number(&b->m.o, "steps"));
    } else {
        for (int n = STEPS_FEWEST; n <= STEPS_MOST; n *= 2) {
            why = try_steps(&b->plant, wanted, n);
            if (!why)
                break;
        }
    }
    return why ? options_misuse(b->m.o.usage, "%s with %d steps a period: %s", name, b->plant.steps, why) : 0;
}

/* Positions within `around` units of rest. The energy of all speeds together is the one stored at that
 * distance. */
static void default_box(const struct basin_plant *q, struct basin_box *box)
{
    const struct input u[MODEL_INPUTS] = {{0.0, 0.0}};
    double rest[MODEL_STATES], x[MODEL_STATES];
    int half = q->model->n_states / 2;
    q->model->rest(q->p, rest);
    double begin = q->model->energy(q->p, u, rest);
    memcpy(x, rest, sizeof x);
    for (int i = 0; i < half; i++)
        x[i] += around;
    double stored = fabs(q->model->energy(q->p, u, x) - begin);
    memcpy(x, rest, sizeof x);
    for (int i = half; i < 2 * half; i++)
        x[i] += 1.0;
    double speed = sqrt(stored / fabs(q->model->energy(q->p, u, x) - begin));
    for (int i = 0; i < 2 * half; i++) {
        double reach = i < half ? around : speed;
        box->low[i] = rest[i] - reach;
        box->high[i] = rest[i] + reach;
    }
}

/* The state that --box NAME=.. is about. 0, or the exit status after a line. */
static int find_state(const struct basin *b, const char *text, int *which)
{
    const char *names[MODEL_STATES];
    char name[64];
    int n = b->plant.model->n_states;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(text, "="), text);
    for (*which = 0; *which < n; ++*which) {
        names[*which] = scenes_state_name(&b->m.scene, *which);
        if (!strcmp(names[*which], name))
            return 0;
    }
    return options_misuse(b->m.o.usage, "--box %s: %s has no such state%s", text, b->m.name,
                          options_advise(name, strlen(name), names, n, NULL));
}

/* The place of state `which`, given as the scene writes it, in model units. Each state alone decides its own
 * place. */
static double place_of(const struct basin *b, int which, double shown)
{
    double all[MODEL_STATES] = {0.0}, x[MODEL_STATES];
    all[which] = shown;
    basin_take(b, all, x);
    return x[which];
}

/* NAME=FROM:TO. A paper may count the other way. */
static int read_side(const struct basin *b, const char *text, struct basin_box *box)
{
    struct range_rules rules = {
        .named = true, .bare = true, .min = -HUGE_VAL, .max = HUGE_VAL, .order = RANGE_UPWARDS_OR_EQUAL};
    struct range side;
    char why[RANGE_REASON];
    int which, status = find_state(b, text, &which);
    if (status)
        return status;
    rules.unit = basin_unit(b, which);
    if (!range_read(text, &rules, &side, why))
        return options_misuse(b->m.o.usage, "--box %s: %s", text, why);
    double from = place_of(b, which, side.from), to = place_of(b, which, side.to);
    box->low[which] = fmin(from, to);
    box->high[which] = fmax(from, to);
    bool near = box->low[which] >= -BASIN_LIMIT && box->high[which] <= BASIN_LIMIT;
    return near ? 0
                : options_misuse(b->m.o.usage,
                                 "--box %s: give ends within 1e6 of the contact's length or speed", text);
}

static int read_starts(struct basin *b)
{
    struct basin_box box;
    int status = 0;
    default_box(&b->plant, &box);
    for (int i = 0; i < options_count(&b->m.o, "box") && !status; i++)
        status = read_side(b, options_text(&b->m.o, "box", i), &box);
    if (status)
        return status;
    b->patience = (struct basin_patience){(int)options_number(&b->m.o, "periods"), repeat};
    return basin_starts_make(&b->starts, (int)options_number(&b->m.o, "starts"), b->plant.model->n_states,
                             (uint32_t)options_number(&b->m.o, "seed"), &box)
               ? 0
               : options_failure(b->m.o.usage, "out of memory");
}

static bool say(const void *context, const char *option, FILE *f)
{
    const struct basin *b = context;
    const struct basin_box *box = &b->starts.box;
    if (!strcmp(option, "method"))
        fprintf(f, "%s %g %g", b->plant.series ? series : b->plant.method->name, b->plant.tol, repeat);
    else if (!strcmp(option, "steps"))
        fprintf(f, "%d", b->plant.steps);
    else if (!strcmp(option, "box"))
        for (int i = 0; i < b->plant.model->n_states; i++)
            fprintf(f, "%.17g %.17g ", box->low[i], box->high[i]);
    else
        return false;
    return true;
}

int basin_read(struct basin *b)
{
    int status = maps_load(&b->m);
    status = status ? status : read_plant(b);
    status = status ? status : read_method(b);
    status = status ? status : read_starts(b);
    if (!status)
        basin_describe_rows(b);
    return status ? status : maps_identify(&b->m, "basin 4", say, b);
}
