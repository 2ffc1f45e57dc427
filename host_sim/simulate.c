/* simulate.c - a plant without a bus, as fast as it goes.
 *
 * Between two of the times asked for, the state is carried by a whole number of equal steps, none longer than --step:
 * rows are exact, not interpolated. Each row starts with the drives' phases computed from its time, so that nothing
 * accumulates. */
#include "firmware/plant.h"
#include "host_sim/commands.h"
#include "host_sim/options.h"
#include "models/models.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_SIZE = 64, STEPS_PER_PERIOD = 4096, REASON = 256 };
static const double rows_max = 1e8, steps_max = 1e12;
static const double rounding = 1e-9; /* of a count: absorbs the rounding of T/DT and of interval/step */

static const struct option own[] = {
    {"set", "NAME=VALUE", "a parameter of the units in use, see contactplant list; repeatable", OPTION_TEXT,
     .many = true},
    {"units", "model|si",
     "the paper's dimensionless numbers, or SI (model when --set names a paper parameter, else si)",
     OPTION_TEXT, .initial = NULL},
    {"drive", "CH=A,HZ,RAD", "SI only: drive input CH with A cos(2 pi HZ t + RAD); repeatable", OPTION_TEXT,
     .many = true},
    {"state", "A,B,...", "initial state (the static equilibrium)", OPTION_TEXT, .initial = NULL},
    {"at", "T1,T2,...", "times of the rows, ascending; the run begins at 0", OPTION_TEXT, .initial = NULL},
    {"until", "T", "last time, with --every (10)", OPTION_NUMBER, 0.0, 1e12, .initial = "10"},
    {"every", "DT", "time from row to row (0.1)", OPTION_NUMBER, 1e-12, 1e12, .initial = "0.1"},
    {"method", "NAME", "integration method (rk4)", OPTION_TEXT, .initial = "rk4"},
    {"step", "H", "longest step (1/4096 of the contact's period)", OPTION_NUMBER, 1e-15, 1e6,
     .initial = NULL},
    {"out", "FILE", "rows as CSV: time and states, 17 digits (standard output)", OPTION_TEXT,
     .initial = NULL},
    {"events", "FILE", "contact events as CSV: time, kind, contact, side (1: the only one), states",
     OPTION_TEXT, .initial = NULL},
    {.name = NULL},
};

static const struct usage usage = {
    .name = "simulate",
    .words = "[MODEL]",
    .summary =
        "Runs a plant offline and writes its states at the times asked for. Exits with 0 only when every\n"
        "step was valid: finite, every contact switch located.",
    .words_help =
        "MODEL is hertz_rig when it is not given. In model units, parameters, states and time are the\n"
        "paper's (hertz_rig: xi sigma omega phi Omega a_force a_base a_stiff; q, q_dot; t in 1/nu).\n",
    .examples =
        "  contactplant simulate hertz_rig --set xi=0.01 --set sigma=0.04 --set omega=0.98 --until 200 "
        "--every 0.5\n"
        "  contactplant simulate hertz_rig --set xi=0 --state 2,0 --at 1,2,5,10 --step 0.001 --events "
        "events.csv\n"
        "  contactplant simulate --units si --drive force=10,225,0 --until 0.5 --every 0.001 --out run.csv\n",
    .max_words = 1,
    .table = {own},
};

/* The run as it was asked for, and its files. */
struct run {
    const struct options *o;
    const struct model *model;
    const struct method *method;
    bool paper;
    double paper_value[MODEL_PARAMETERS];
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];             /* SI: omega in rad/s */
    double state[MODEL_STATES];                      /* model units */
    double gain[MODEL_STATES], offset[MODEL_STATES]; /* shown = gain * model + offset */
    double step;                                     /* longest, in the units shown */
    double *at;                                      /* times asked for, or NULL */
    size_t n_rows;
    FILE *out, *events;
    double *work;
    struct plant plant;
};

static int misuse(const struct run *r, const char *text, const char *reason)
{
    return options_misuse(r->o->usage, "%s: %s", text, reason);
}

static const struct parameter *table_of(const struct run *r, int *n)
{
    *n = r->paper ? r->model->n_paper : r->model->n_parameters;
    return r->paper ? r->model->paper : r->model->parameter;
}

static int find(const struct parameter *p, int n, const char *name, size_t length)
{
    for (int i = 0; i < n; i++)
        if (strlen(p[i].name) == length && !strncmp(p[i].name, name, length))
            return i;
    return -1;
}

/* Model units when asked for, or when a parameter of the paper is set. */
static int choose_units(struct run *r)
{
    const char *units = options_text(r->o, "units", 0);
    if (units && strcmp(units, "model") && strcmp(units, "si"))
        return misuse(r, units, "--units is model or si");
    r->paper = units && !strcmp(units, "model");
    for (int i = 0; !units && i < options_count(r->o, "set"); i++) {
        const char *text = options_text(r->o, "set", i);
        r->paper = r->paper || find(r->model->paper, r->model->n_paper, text, strcspn(text, "=")) >= 0;
    }
    if (r->paper && !r->model->paper)
        return misuse(r, r->model->name, "this model has no paper parameters; use --units si");
    return 0;
}

static int set_one(struct run *r, const char *text, double *value)
{
    char name[NAME_SIZE], reason[REASON];
    const char *names[MODEL_PARAMETERS];
    double x;
    int n;
    const struct parameter *table = table_of(r, &n);
    if (!options_read_setting(text, name, sizeof name, &x))
        return misuse(r, text, "write --set NAME=VALUE with a finite number");
    int i = find(table, n, name, strlen(name));
    for (int k = 0; k < n; k++)
        names[k] = table[k].name;
    const char *nearest = options_nearest(name, names, n);
    if (i < 0) {
        snprintf(reason, sizeof reason, "no such parameter in %s units; did you mean %s?",
                 r->paper ? "model" : "si", nearest ? nearest : names[0]);
        return misuse(r, text, reason);
    }
    if (!(x >= table[i].min && x <= table[i].max)) {
        snprintf(reason, sizeof reason, "out of range; give %g to %g %s", table[i].min, table[i].max,
                 table[i].unit);
        return misuse(r, text, reason);
    }
    value[i] = x;
    return 0;
}

static int read_parameters(struct run *r)
{
    int n, status = 0;
    const struct parameter *table = table_of(r, &n);
    double *value = r->paper ? r->paper_value : r->si;
    for (int i = 0; i < n; i++)
        value[i] = table[i].initial;
    for (int i = 0; i < options_count(r->o, "set") && !status; i++)
        status = set_one(r, options_text(r->o, "set", i), value);
    if (r->paper && !status)
        r->model->from_paper(r->paper_value, r->si, r->drive);
    return status;
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

static int read_drives(struct run *r)
{
    if (r->paper && options_given(r->o, "drive"))
        return misuse(r, "--drive", "needs --units si; model units have sigma, omega, a_force, ..");
    for (int k = 0; k < options_count(r->o, "drive"); k++) {
        const char *text = options_text(r->o, "drive", k), *equal = strchr(text, '=');
        double x[3];
        int i = 0;
        while (i < r->model->n_inputs && (strlen(r->model->input_signal[i].name) != strcspn(text, "=") ||
                                          strncmp(r->model->input_signal[i].name, text, strcspn(text, "="))))
            i++;
        if (i == r->model->n_inputs)
            return misuse(r, text, "no such input; contactplant list shows them");
        if (!equal || !read_list(equal + 1, 3, x) || x[1] < 0.0)
            return misuse(r, text, "write --drive INPUT=AMPLITUDE,HZ,RAD with three finite numbers, HZ >= 0");
        r->drive[i] = (struct harmonic){x[0], 2.0 * acos(-1.0) * x[1], x[2]};
    }
    return 0;
}

/* How states are shown, and the initial one. */
static int read_state(struct run *r)
{
    double shown[MODEL_STATES], p[MODEL_DERIVED] = {0};
    const char *text = options_text(r->o, "state", 0);
    const struct model *m = r->model;
    struct scale scale;
    m->prepare(r->si, p, &scale);
    m->rest(p, r->state);
    for (int i = 0; i < m->n_states; i++) {
        const struct signal *s = &m->state_signal[i];
        r->gain[i] = r->paper ? s->paper_gain : scale_of(&scale, s->quantity);
        r->offset[i] = r->paper ? s->paper_offset : 0.0;
    }
    double period = 2.0 * acos(-1.0) / m->eigenfrequency(p) * scale.time_s;
    r->step = options_given(r->o, "step") ? options_number(r->o, "step") : period / STEPS_PER_PERIOD;
    if (!text)
        return 0;
    if (!read_list(text, m->n_states, shown))
        return options_misuse(r->o->usage, "--state %s: %s has %d states; give that many finite numbers",
                              text, m->name, m->n_states);
    for (int i = 0; i < m->n_states; i++)
        r->state[i] = (shown[i] - r->offset[i]) / r->gain[i];
    return 0;
}

/* The rows' times: --at, or multiples of --every up to --until. */
static int read_times(struct run *r)
{
    const char *text = options_text(r->o, "at", 0);
    double rows = floor(options_number(r->o, "until") / options_number(r->o, "every") + rounding) + 1.0;
    if (text && (options_given(r->o, "until") || options_given(r->o, "every")))
        return misuse(r, "--at", "goes without --until and --every");
    if (!text) {
        r->n_rows = (size_t)rows;
        return rows <= rows_max ? 0 : misuse(r, "--every", "more than 1e8 rows; make it longer");
    }
    r->n_rows = 1;
    for (const char *c = text; *c; c++)
        r->n_rows += *c == ',';
    r->at = malloc(r->n_rows * sizeof *r->at);
    if (!r->at)
        return options_failure(r->o->usage, "out of memory");
    if (!read_list(text, (int)r->n_rows, r->at))
        return misuse(r, "--at", "write finite numbers separated by commas");
    for (size_t i = 0; i < r->n_rows; i++)
        if (r->at[i] < (i ? r->at[i - 1] : 0.0))
            return misuse(r, "--at", "times begin at 0 and ascend");
    return 0;
}

static double time_of(const struct run *r, size_t row)
{
    return r->at ? r->at[row] : (double)row * options_number(r->o, "every");
}

static void write_states(const struct run *r, FILE *f, const double *x)
{
    for (int i = 0; i < r->model->n_states; i++)
        fprintf(f, ",%.17g", r->gain[i] * x[i] + r->offset[i]);
    fputc('\n', f);
}

static void write_header(const struct run *r, FILE *f, const char *first)
{
    fputs(first, f);
    for (int i = 0; i < r->model->n_states; i++)
        fprintf(f, ",%s", r->paper ? r->model->state_signal[i].paper_name : r->model->state_signal[i].name);
    fputc('\n', f);
}

static void write_events(struct run *r, double start)
{
    struct event e;
    while (plant_take_event(&r->plant, &e)) {
        double t = start + ((double)e.tick + e.fraction) * r->plant.tick_s;
        if (!r->events)
            continue;
        fprintf(r->events, "%.17g,%s,%d,1", t, e.touch ? "touchdown" : "liftoff", e.contact);
        write_states(r, r->events, e.x);
    }
}

/* The plant at time `start` with steps that divide `length`; a reason when it cannot be. */
static const char *place(struct run *r, double start, double length, double *n)
{
    const double turn = 2.0 * acos(-1.0);
    *n = ceil(length / r->step - rounding);
    *n = *n < 1.0 ? 1.0 : *n;
    if (!(*n <= steps_max))
        return "more than 1e12 steps between two rows; take a longer --step";
    const struct plant_config c = {.model = r->model,
                                   .si = r->si,
                                   .method = r->method,
                                   .tick_s = length / *n,
                                   .dilation = 1.0,
                                   .work = r->work};
    const char *why = plant_init(&r->plant, &c);
    for (int i = 0; i < r->model->n_inputs && !why; i++) {
        const struct harmonic *d = &r->drive[i];
        double phase = fmod(fmod(d->omega * start, turn) + d->phase, turn);
        if (d->amplitude < 0.0 || d->amplitude > 0.0)
            plant_drive_start(&r->plant, i, d->amplitude, d->omega / turn, phase);
    }
    if (!why)
        plant_set_state(&r->plant, r->state);
    return why;
}

/* From one row's time to the next. */
static int carry(struct run *r, double start, double length)
{
    double n;
    const char *why = place(r, start, length, &n);
    if (why)
        return misuse(r, "this run cannot be done", why);
    for (double i = 0.0; i < n; i += 1.0) {
        if (!plant_run(&r->plant, 1))
            return options_failure(r->o->usage,
                                   "the state left the finite numbers at t = %.9g; the rows end before it",
                                   start + i * r->plant.tick_s);
        write_events(r, start);
    }
    memcpy(r->state, r->plant.x, sizeof r->state);
    if (r->plant.counts.budget || r->plant.counts.residual)
        return options_failure(
            r->o->usage, "a contact switch near t = %.9g was not located; take a shorter --step", start);
    return 0;
}

static int run_rows(struct run *r)
{
    double now = 0.0;
    int status = 0;
    write_header(r, r->out, "t");
    if (r->events)
        write_header(r, r->events, "t,kind,contact,side");
    for (size_t row = 0; row < r->n_rows && !status; row++) {
        double t = time_of(r, row);
        if (t > now)
            status = carry(r, now, t - now);
        if (status)
            break;
        fprintf(r->out, "%.17g", t);
        write_states(r, r->out, r->state);
        now = t;
    }
    return status;
}

/* Opens a file to write; 0, or the exit status after a line. */
static int open_file(const struct run *r, const char *option, FILE **f)
{
    const char *path = options_text(r->o, option, 0);
    if (!path)
        return 0;
    *f = fopen(path, "w");
    return *f ? 0
              : options_failure(r->o->usage, "cannot write %s: %s; choose another --%s", path,
                                strerror(errno), option);
}

static int close_file(const struct run *r, const char *option, FILE *f)
{
    bool bad = f && (fflush(f) != 0 || ferror(f));
    int error = errno;
    if (f && f != stdout)
        bad = fclose(f) != 0 || bad;
    return bad ? options_failure(r->o->usage, "--%s is not complete: %s; make room and run again", option,
                                 strerror(error))
               : 0;
}

static int prepare(struct run *r)
{
    int status = choose_units(r);
    status = status ? status : read_parameters(r);
    status = status ? status : read_drives(r);
    status = status ? status : read_state(r);
    status = status ? status : read_times(r);
    if (status)
        return status;
    r->work = calloc(r->method->n_work(r->model) + 1, sizeof *r->work);
    r->out = stdout;
    status = r->work ? open_file(r, "out", &r->out) : options_failure(r->o->usage, "out of memory");
    return status ? status : open_file(r, "events", &r->events);
}

/* The model's name is optional: the first model is the default. */
static int find_model(struct run *r)
{
    const char *name = r->o->n_words ? r->o->word[0] : model_table[0]->name;
    for (int i = 0; i < MODELS && !r->model; i++)
        r->model = strcmp(model_table[i]->name, name) ? NULL : model_table[i];
    r->method = method_find(options_text(r->o, "method", 0));
    if (!r->model)
        return misuse(r, name, "no such model; contactplant list shows them");
    return r->method
               ? 0
               : misuse(r, options_text(r->o, "method", 0), "no such method; contactplant list shows them");
}

int cmd_simulate(int argc, char **argv)
{
    struct options o;
    int status;
    if (!options_parse(&o, &usage, argc, argv, &status))
        return status;
    struct run r = {.o = &o};
    status = find_model(&r);
    status = status ? status : prepare(&r);
    status = status ? status : run_rows(&r);
    int closed = r.out ? close_file(&r, "out", r.out) : 0;
    int closed_events = close_file(&r, "events", r.events);
    free(r.at);
    free(r.work);
    return status ? status : closed ? closed : closed_events;
}
