/* simulate_read.c - see simulate_read.h. */
#include "firmware/bus/wire_table.h"
#include "firmware/plant/plant_change.h"
#include "host_sim/cli/names.h"
#include "host_sim/commands.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/cli/ticks.h"
#include "host_sim/scene/scene_check.h"
#include "host_sim/scene/scene_range.h"
#include "host_sim/simulate/simulate_read.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_SIZE = 64, STEPS_PER_PERIOD = 4096 };
static const double rows_max = 1e8;

int simulate_misuse(const struct simulation *r, const char *text, const char *reason)
{
    return options_misuse(r->o->usage, "%s: %s", text, reason);
}

static bool bare(const struct simulation *r)
{
    return r->origin == SCENE_OF_MODEL;
}

/* NAME=VALUE is a parameter of the paper, or near one; a number in SI counts first. */
static bool is_paper(const struct simulation *r, const char *text)
{
    const struct model *m = r->model;
    const char *names[MODEL_PARAMETERS];
    char own[NAME_SIZE];
    struct scene_range k;
    snprintf(own, sizeof own, "%.*s", (int)strcspn(text, "="), text);
    for (int i = 0; scene_range_nth(&r->scene, i, &k); i++)
        if (!strcmp(own, k.key.name) || !strcmp(own, k.key.full))
            return false;
    for (int i = 0; i < m->n_paper; i++)
        names[i] = m->paper[i].name;
    return options_nearest(own, names, m->n_paper) != NULL;
}

/* The scene's own; with a bare model, model units when asked for, or when a parameter of the paper is set. */
static int choose_units(struct simulation *r)
{
    static const char *const known[] = {"model", "si"};
    const char *units = options_text(r->o, "units", 0);
    r->paper = r->scene.paper;
    if (!bare(r))
        return units ? simulate_misuse(r, "--units", "a scene has its own units; take the option away") : 0;
    int which = units ? options_find(r->o, "units", known, 2, "no such units") : 1;
    if (which < 0)
        return STATUS_MISUSED;
    r->paper = !which;
    for (int i = 0; !units && i < options_count(r->o, "set"); i++)
        r->paper = r->paper || is_paper(r, options_text(r->o, "set", i));
    if (r->paper && !r->model->paper)
        return simulate_misuse(r, r->model->name, "this model has no paper parameters; use --units si");
    return 0;
}

/* A bare model in model units is a scene with the paper's parameters. */
static int read_parameters(struct simulation *r)
{
    int n, status;
    struct scene *s = &r->scene;
    for (int i = 0; bare(r) && r->paper && i < MODEL_PARAMETERS; i++)
        s->value[i] = i < r->model->n_paper ? r->model->paper[i].initial : 0.0;
    s->paper = r->paper;
    status = scene_range_settings(r->o, s);
    scenes_resolve(s, r->si, r->drive);
    const char *why = status ? NULL : plant_check(r->model, r->si, &n);
    return why ? simulate_misuse(r, r->model->name, why) : status;
}

/* Exactly n numbers separated by commas. */
static bool read_list(const char *text, int n, double *x)
{
    char part[NAME_SIZE];
    for (int i = 0; i < n; i++) {
        size_t length = strcspn(text, ",");
        if (length >= sizeof part || (text[length] == ',') != (i + 1 < n))
            return false;
        memcpy(part, text, length);
        part[length] = 0;
        if (!options_read_number(part, &x[i]))
            return false;
        text += length + (text[length] == ',');
    }
    return true;
}

static int no_input(const struct simulation *r, const char *text)
{
    const char *name[MODEL_INPUTS];
    for (int i = 0; i < r->model->n_inputs; i++)
        name[i] = r->model->input_signal[i].name;
    return options_misuse(r->o->usage, "%s: no such input%s", text,
                          options_advise(text, strlen(text), name, r->model->n_inputs, NULL));
}

/* INPUT=A,B,C: 0, or the exit status after a line that says how `form` is written. */
static int read_input(const struct simulation *r, const char *text, const char *form, int *i_input, double *x)
{
    char name[NAME_SIZE];
    const char *equal = strchr(text, '=');
    snprintf(name, sizeof name, "%.*s", (int)strcspn(text, "="), text);
    *i_input = names_find(r->model, NAMES_INPUT, name);
    if (*i_input < 0)
        return no_input(r, name);
    return equal && read_list(equal + 1, 3, x) ? 0 : simulate_misuse(r, text, form);
}

static int read_drives(struct simulation *r)
{
    static const char form[] = "write --drive INPUT=AMPLITUDE,HZ,RAD with three finite numbers, HZ >= 0";
    if (r->paper && options_given(r->o, "drive"))
        return simulate_misuse(r, "--drive", "needs --units si; model units have sigma, omega, a_force, ..");
    for (int k = 0; k < options_count(r->o, "drive"); k++) {
        const char *text = options_text(r->o, "drive", k);
        double x[3];
        int i, status = read_input(r, text, form, &i, x);
        if (status)
            return status;
        if (x[1] < 0.0)
            return simulate_misuse(r, text, form);
        r->drive[i] = (struct harmonic){x[0], 2.0 * acos(-1.0) * x[1], x[2]};
    }
    return 0;
}

static bool is_whole_within(double x, double min, double max)
{
    return x >= min && x <= max && !(x < floor(x)) && !(x > floor(x));
}

static int read_noise(struct simulation *r)
{
    for (int i = 0; i < r->model->n_inputs; i++) {
        const struct scene_drive *d = &r->scene.drive[i];
        double steps = scenes_noise_steps(d, r->step);
        if (!(d->noise > 0.0))
            continue;
        if (steps > NOISE_HOLD_MAX)
            return simulate_misuse(r, r->model->input_signal[i].name,
                                   "more than 65535 steps in a hold time of the noise; take a longer --step");
        r->noise[i] = (struct noise_setting){d->noise, (uint32_t)steps, d->noise_seed};
    }
    for (int k = 0; k < options_count(r->o, "noise"); k++) {
        const char *text = options_text(r->o, "noise", k);
        double x[3];
        int i, status = read_input(
                   r, text, "write --noise INPUT=DEVIATION,STEPS,SEED with three finite numbers", &i, x);
        if (status)
            return status;
        enum quantity q = r->model->input_signal[i].quantity;
        if (!(x[0] >= 0.0 && x[0] <= NOISE_LIMIT * scale_of(&r->scale, q)))
            return simulate_misuse(r, text, "DEVIATION is 0 or more, and at most 1.5e8 of the model's unit");
        if (!is_whole_within(x[1], 1.0, NOISE_HOLD_MAX) || !is_whole_within(x[2], 0.0, UINT32_MAX))
            return simulate_misuse(r, text, "STEPS is a whole number 1 to 65535, SEED 0 to 4294967295");
        /* the paper's state may contain the input and its rate, and a line between random points has no
         * rate there */
        if (r->paper && q == QUANTITY_LENGTH)
            return simulate_misuse(r, text, "noise of a length needs --units si");
        r->noise[i] = (struct noise_setting){x[0], (uint32_t)x[1], (uint32_t)x[2]};
    }
    return 0;
}

void simulate_inputs(const struct simulation *r, double t, struct input *u)
{
    for (int i = 0; i < r->model->n_inputs; i++) {
        const struct harmonic *d = &r->drive[i];
        double unit = scale_of(&r->scale, r->model->input_signal[i].quantity),
               angle = d->omega * t + d->phase;
        u[i].value = d->amplitude * cos(angle) / unit;
        u[i].rate = -d->amplitude * d->omega * sin(angle) / unit * r->scale.time_s;
    }
}

/* The scale, the longest step and the initial state. */
static int read_state(struct simulation *r)
{
    double shown[MODEL_STATES];
    struct input u[MODEL_INPUTS];
    const char *text = options_text(r->o, "state", 0);
    const struct model *m = r->model;
    m->prepare(r->si, r->p, &r->scale);
    m->rest(r->p, r->state);
    double period = 2.0 * acos(-1.0) / m->eigenfrequency(r->p) * r->scale.time_s;
    r->step = options_given(r->o, "step") ? options_number(r->o, "step")
              : bare(r)                   ? period / STEPS_PER_PERIOD
                                          : scene_check_step(&r->scene);
    if (!bare(r))
        scenes_begin(&r->scene, r->si, r->drive, r->state);
    if (!text)
        return 0;
    if (!read_list(text, m->n_states, shown))
        return options_misuse(r->o->usage, "--state %s: %s has %d states; give that many finite numbers",
                              text, m->name, m->n_states);
    simulate_inputs(r, 0.0, u);
    scenes_take_state(&r->scene, r->p, &r->scale, u, shown, r->state);
    double size = 0.0;
    for (int i = 0; i < m->n_states; i++)
        size += fabs(r->state[i]);
    return size <= PLANT_STATE_LIMIT
               ? 0
               : simulate_misuse(r, text,
                                 "--state is more than 1e12 times the contact's own length; begin nearer");
}

/* The rows' times: --at, or multiples of --every up to --until. */
static int read_times(struct simulation *r)
{
    const char *text = options_text(r->o, "at", 0);
    bool own = !bare(r);
    r->until = own && !options_given(r->o, "until") ? r->scene.over : options_number(r->o, "until");
    r->every = own && !options_given(r->o, "every") ? r->scene.frame_s / r->scene.dilation
                                                    : options_number(r->o, "every");
    double rows = floor(ticks_in(r->until, r->every)) + 1.0;
    if (text && (options_given(r->o, "until") || options_given(r->o, "every")))
        return simulate_misuse(r, "--at", "lists all rows; take --until and --every away");
    if (!text) {
        r->n_rows = (size_t)rows;
        return rows <= rows_max ? 0 : simulate_misuse(r, "--every", "more than 1e8 rows; make it longer");
    }
    r->n_rows = 1;
    for (const char *c = text; *c; c++)
        r->n_rows += *c == ',';
    r->at = malloc(r->n_rows * sizeof *r->at);
    if (!r->at)
        return options_failure(r->o->usage, "out of memory");
    if (!read_list(text, (int)r->n_rows, r->at))
        return simulate_misuse(r, "--at", "write finite numbers separated by commas");
    for (size_t i = 0; i < r->n_rows; i++)
        if (r->at[i] < (i ? r->at[i - 1] : 0.0))
            return simulate_misuse(r, "--at", "times begin at 0 and ascend");
    return 0;
}

int simulate_read(struct simulation *r)
{
    int status = choose_units(r);
    status = status ? status : read_parameters(r);
    status = status ? status : read_drives(r);
    status = status ? status : read_state(r);
    status = status ? status : read_noise(r);
    return status ? status : read_times(r);
}
