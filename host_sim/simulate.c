/* simulate.c - a plant without a bus, as fast as it goes.
 *
 * Between two of the times asked for, the state is carried by a whole number of equal steps, none longer than --step:
 * rows are exact, not interpolated. Each row starts with the drives' phases computed from its time, so that nothing
 * accumulates. */
#include "host_sim/clock.h"
#include "host_sim/commands.h"
#include "host_sim/simulate.h"
#include "models/models.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double steps_max = 1e12; /* between two rows */
enum { HALVINGS = 60 };               /* of a step, in search of one that would do */
static const double rounding = 1e-9;  /* of a step: interval/step may come out just above a whole number */

static const struct option own[] = {
    {"set", "NAME=VALUE", "a parameter of the units in use, see contactplant list; repeatable", OPTION_TEXT,
     .many = true},
    {"units", "model|si",
     "the paper's dimensionless numbers, or SI (model when --set names a paper parameter, else si)",
     OPTION_TEXT, .initial = NULL},
    {"drive", "CH=A,HZ,RAD", "SI only: drive input CH with A cos(2 pi HZ t + RAD); repeatable", OPTION_TEXT,
     .many = true},
    {"noise", "CH=SD,STEPS,SEED",
     "add noise of standard deviation SD to input CH, a new value every STEPS steps; repeatable", OPTION_TEXT,
     .many = true},
    {"state", "A,B,...", "initial state (the static equilibrium)", OPTION_TEXT, .initial = NULL},
    {"at", "T1,T2,...", "times of the rows, ascending; the run begins at 0", OPTION_TEXT, .initial = NULL},
    {"until", "T", "last time, with --every (10)", OPTION_NUMBER, 0.0, 1e12, .initial = "10"},
    {"every", "DT", "time from row to row (0.1)", OPTION_NUMBER, 1e-12, 1e12, .initial = "0.1"},
    {"method", "NAME", "integration method (auto: the right one for model, step and tolerance)", OPTION_TEXT,
     .initial = "auto"},
    {"step", "H", "longest step (1/4096 of the contact's period)", OPTION_NUMBER, 1e-15, 1e6,
     .initial = NULL},
    {"tol", "E", "tolerance of a method that has one (1e-12: offline it costs next to nothing)",
     OPTION_NUMBER, 1e-15, 1e-1, .initial = "1e-12"},
    {.name = "force", .meaning = "run a step that the method refuses as unsound; the output says so"},
    {"out", "FILE", "rows as CSV: time and states, 17 digits (standard output)", OPTION_TEXT,
     .initial = NULL},
    {"events", "FILE", "contact events as CSV: time, kind, contact, side (1 or -1), states", OPTION_TEXT,
     .initial = NULL},
    {.name = NULL},
};

static const struct usage usage = {
    .name = "simulate",
    .words = "[SCENE]",
    .summary =
        "Runs a plant offline and writes its states at the times asked for. Exits with 0 only when every\n"
        "step was valid: finite, every contact switch located; with 3 when the motion escaped.",
    .words_help = SCENE_WORDS_HELP
    "A preset or file brings its own parameters, drives, start, times, method and tolerance, and its\n"
    "observable as the last column. Of a model, in model units parameters, states and time are the\n"
    "paper's (hertz_rig: xi sigma omega phi Omega a_force a_base a_stiff; q, q_dot; t in 1/nu).\n",
    .examples =
        "  contactplant simulate hertz_rig --set xi=0.01 --set sigma=0.04 --set omega=0.98 --until 200 "
        "--every 0.5\n"
        "  contactplant simulate bbp-fig2-force --every 0.1 --out fig2.csv\n"
        "  contactplant simulate my.ini --set damping_N_s_per_m=100 --out run.csv\n"
        "  contactplant simulate hertz_rig --set xi=0 --state 2,0 --at 1,2,5,10 --step 0.001 --events "
        "events.csv\n"
        "  contactplant simulate --units si --drive force=10,225,0 --until 0.5 --every 0.001 --out run.csv\n"
        "  contactplant simulate rolling_contact --set zeta=0.05 --noise force=0.84,1,7 --step 0.1 --until "
        "1000\n",
    .max_words = 1,
    .table = {own},
};

static double time_of(const struct simulation *r, size_t row)
{
    return r->at ? r->at[row] : (double)row * r->every;
}

/* The asked output, from the inputs that the plant ended with (noise included). */
static double observed(const struct simulation *r, double t)
{
    double output[MODEL_OUTPUTS];
    struct input u[MODEL_INPUTS];
    simulate_inputs(r, t, u);
    r->model->output(r->p, r->plant.model ? r->plant.excitation.at[2] : u, r->state, output);
    return output[r->observable] * scale_of(&r->scale, r->model->output_signal[r->observable].quantity);
}

/* The end of a row: the states, and for rows in time the observable. */
static void write_states(const struct simulation *r, FILE *f, double t, const double *x)
{
    double shown[MODEL_STATES];
    struct input u[MODEL_INPUTS];
    simulate_inputs(r, t, u);
    if (r->paper)
        r->model->paper_state(r->p, u, x, shown);
    for (int i = 0; i < r->model->n_states && !r->paper; i++)
        shown[i] = x[i] * scale_of(&r->scale, r->model->state_signal[i].quantity);
    for (int i = 0; i < r->model->n_states; i++)
        fprintf(f, ",%.17g", shown[i]);
    if (f == r->out && r->observable >= 0)
        fprintf(f, ",%.17g", observed(r, t));
    fputc('\n', f);
}

static void write_header(const struct simulation *r, FILE *f, const char *first)
{
    fputs(first, f);
    for (int i = 0; i < r->model->n_states; i++)
        fprintf(f, ",%s", r->paper ? r->model->state_signal[i].paper_name : r->model->state_signal[i].name);
    if (f == r->out && r->observable >= 0)
        fprintf(f, ",%s", r->model->output_signal[r->observable].name);
    fputc('\n', f);
}

static void write_events(struct simulation *r, double start)
{
    struct event e;
    while (plant_take_event(&r->plant, &e)) {
        double t = start + ((double)(e.tick - r->tick) + e.fraction) * r->plant.tick_s;
        if (!r->events)
            continue;
        fprintf(r->events, "%.17g,%s,%d,%d", t, e.touch ? "touchdown" : "liftoff", e.contact,
                r->model->contact_side[e.contact]);
        write_states(r, r->events, t, e.x);
    }
}

/* Most turns of a drive in one step: 1/8 for a sound result, 1/2 for any at all. */
static double turns_per_step(const struct simulation *r, double step)
{
    double most = 0.0;
    for (int i = 0; i < r->model->n_inputs; i++) {
        if (r->drive[i].amplitude < 0.0 || r->drive[i].amplitude > 0.0)
            most = fmax(most, r->drive[i].omega * step / (2.0 * acos(-1.0)));
    }
    return most;
}

/* The step guard: why this step is unsound, or NULL. */
static const char *guard(const struct simulation *r, double step)
{
    if (turns_per_step(r, step) * DRIVE_TICKS_MIN > 1.0 + 1e-9)
        return DRIVE_TICKS_TOO_FEW "a drive";
    return r->method->refuse(r->model, r->p, step / r->scale.time_s, r->tol);
}

/* The guard's word on a step that --force does not override, with a step that would do. */
static const char *refusal(struct simulation *r, double step)
{
    const char *why = guard(r, step);
    double smaller = step;
    if (!why || (options_given(r->o, "force") && turns_per_step(r, step) < 0.5))
        return NULL;
    for (int i = 0; i < HALVINGS && guard(r, smaller); i++)
        smaller *= 0.5;
    if (guard(r, smaller))
        return why; /* no step would do */
    snprintf(r->reason, sizeof r->reason, "%s; --step %.3g would do", why, smaller);
    return r->reason;
}

/* The noise of an input from tick r->tick on, and the input there. */
static void start_noise(struct simulation *r, int i)
{
    struct plant *pl = &r->plant;
    struct noise_setting s = r->noise[i];
    struct excitation e = {.length = 0.0};
    const struct noise_span span = {r->tick, 0.0, 1.0, 1.0, pl->ticks_per_time};
    s.deviation /= scale_of(&r->scale, r->model->input_signal[i].quantity);
    noise_start(&pl->drive[i].noise, &s);
    struct noise ahead = pl->drive[i].noise;
    (void)noise_add(&ahead, &span, &e, i);
    pl->excitation.at[2][i].value += e.at[0][i].value;
    pl->excitation.at[2][i].rate += e.at[0][i].rate;
}

/* Equal steps, none longer than --step, that carry the state over `length`. */
static double steps_over(const struct simulation *r, double length)
{
    double n = ceil(length / r->step - rounding);
    return n < 1.0 ? 1.0 : n;
}

/* The plant at time `start` with steps that divide `length`; a reason when it cannot be. */
static const char *place(struct simulation *r, double start, double length, double *n)
{
    const double turn = 2.0 * acos(-1.0);
    *n = steps_over(r, length);
    if (!(*n <= steps_max))
        return "more than 1e12 steps between two rows; take a longer --step";
    const char *why = refusal(r, length / *n);
    if (why)
        return why;
    const struct plant_config c = {.model = r->model,
                                   .si = r->si,
                                   .method = r->method,
                                   .tick_s = length / *n,
                                   .dilation = 1.0,
                                   .tol = r->tol,
                                   .force = true, /* the guard has spoken */
                                   .work = r->work};
    why = plant_init(&r->plant, &c);
    for (int i = 0; i < r->model->n_inputs && !why; i++) {
        const struct harmonic *d = &r->drive[i];
        double phase = fmod(fmod(d->omega * start, turn) + d->phase, turn);
        if (d->amplitude < 0.0 || d->amplitude > 0.0)
            plant_drive_start(&r->plant, i, d->amplitude, d->omega / turn, phase);
    }
    r->plant.now.tick = r->tick;
    for (int i = 0; i < r->model->n_inputs && !why; i++) {
        if (r->noise[i].deviation > 0.0)
            start_noise(r, i);
    }
    if (!why)
        plant_set_state(&r->plant, r->state);
    return why;
}

/* From one row's time to the next. */
static int carry(struct simulation *r, double start, double length)
{
    double n;
    const char *why = place(r, start, length, &n);
    if (why)
        return simulate_misuse(r, "this run cannot be done", why);
    bool escaped = false;
    double done = 0.0;
    for (; done < n && !escaped && !clock_interrupted(); done += 1.0) {
        escaped = !plant_run(&r->plant, 1);
        write_events(r, start);
    }
    double end = start + (done - escaped) * r->plant.tick_s;
    if (escaped) {
        options_failure(r->o->usage, "the motion escapes at t = %.9g; the rows end before it", end);
        return STATUS_ESCAPED;
    }
    if (done < n)
        return options_failure(r->o->usage, "interrupted at t = %.9g; the rows end before it", end);
    memcpy(r->state, r->plant.x, sizeof r->state);
    r->tick = r->plant.now.tick;
    if (r->plant.counts.budget || r->plant.counts.residual)
        return options_failure(
            r->o->usage, "a contact switch near t = %.9g was not located; take a shorter --step", start);
    return 0;
}

/* A comment above the header: what the step guard said and --force overrode. */
static void mark_forced(const struct simulation *r, FILE *f)
{
    const char *why = guard(r, r->step);
    if (why && options_given(r->o, "force"))
        fprintf(f, "# forced against: %s\n", why);
}

static int run_rows(struct simulation *r)
{
    double now = 0.0;
    int status = 0;
    mark_forced(r, r->out);
    write_header(r, r->out, "t");
    if (r->events)
        mark_forced(r, r->events);
    if (r->events)
        write_header(r, r->events, "t,kind,contact,side");
    for (size_t row = 0; row < r->n_rows && !status; row++) {
        double t = time_of(r, row);
        if (t > now)
            status = carry(r, now, t - now);
        if (status)
            break;
        fprintf(r->out, "%.17g", t);
        write_states(r, r->out, t, r->state);
        now = t;
    }
    return status;
}

/* Opens a file to write; 0, or the exit status after a line. */
static int open_file(const struct simulation *r, const char *option, FILE **f)
{
    const char *path = options_text(r->o, option, 0);
    const char *other = options_text(r->o, strcmp(option, "out") ? "out" : "events", 0);
    if (!path)
        return 0;
    if (scene_load_is(r->origin, r->o->word[0], path))
        return options_misuse(r->o->usage, "--%s %s is the scene itself; choose another", option, path);
    if (other && scene_load_same(path, other))
        return options_misuse(r->o->usage, "--out and --events are both %s; choose two files", path);
    *f = fopen(path, "w");
    return *f ? 0
              : options_failure(r->o->usage, "cannot write %s: %s; choose another --%s", path,
                                strerror(errno), option);
}

static int close_file(const struct simulation *r, const char *option, FILE *f)
{
    bool bad = f && (fflush(f) != 0 || ferror(f));
    int error = errno;
    if (f && f != stdout)
        bad = fclose(f) != 0 || bad;
    return bad ? options_failure(r->o->usage, "--%s is not complete: %s; make room and run again", option,
                                 strerror(error))
               : 0;
}

/* The longest step between two rows. */
static double longest_step(const struct simulation *r)
{
    double now = 0.0, longest = 0.0;
    for (size_t row = 0; row < r->n_rows; row++) {
        double t = time_of(r, row);
        longest = t > now ? fmax(longest, (t - now) / steps_over(r, t - now)) : longest;
        now = t;
    }
    return longest > 0.0 ? longest : r->step;
}

/* What would refuse the run, before a file is touched; leaves the plant at the start. */
static int try_first_rows(struct simulation *r)
{
    for (size_t row = 0; row < r->n_rows && row < 2; row++) {
        double n, t = time_of(r, row);
        const char *why = t > 0.0 ? place(r, 0.0, t, &n) : NULL;
        if (why)
            return simulate_misuse(r, "this run cannot be done", why);
    }
    return 0;
}

static int prepare(struct simulation *r)
{
    int status = simulate_read(r);
    if (status)
        return status;
    if (r->origin != SCENE_OF_MODEL)
        scene_load_warn(r->o->usage->name, r->model, r->si, r->drive);
    r->chosen = r->method == &auto_method;
    if (r->chosen) /* once: what takes the longest step takes the others */
        r->method =
            auto_choice(r->model, r->p, longest_step(r) / r->scale.time_s, r->tol, r->drive, &r->scale);
    r->work = calloc(r->method->n_work(r->model) + 1, sizeof *r->work);
    r->out = stdout;
    status = r->work ? try_first_rows(r) : options_failure(r->o->usage, "out of memory");
    status = status ? status : open_file(r, "out", &r->out);
    return status ? status : open_file(r, "events", &r->events);
}

/* The scene's name is optional: the first model is the default. */
static int find_scene(struct simulation *r)
{
    char why[SCENE_REASON];
    const char *method = options_text(r->o, "method", 0);
    r->origin = scene_load(r->o->n_words ? r->o->word[0] : model_table[0]->name, &r->scene, why);
    if (r->origin == SCENE_OF_NOTHING)
        return options_misuse(r->o->usage, "%s", why);
    bool bare = r->origin == SCENE_OF_MODEL;
    r->model = r->scene.model;
    r->method = method_find(bare || options_given(r->o, "method") ? method : r->scene.method);
    r->observable = bare ? -1 : (int)r->scene.observable;
    r->tol = bare ? 0.0 : r->scene.tolerance;
    /* 1e-12 is asked of methods whose error follows a tolerance; of the others only what the user asks. */
    if (options_given(r->o, "tol") || (bare && r->method && r->method->order == 0))
        r->tol = options_number(r->o, "tol");
    return r->method ? 0 : simulate_misuse(r, method, "no such method; contactplant list shows them");
}

int cmd_simulate(int argc, char **argv)
{
    struct options o;
    int status;
    if (!options_parse(&o, &usage, argc, argv, &status))
        return status;
    struct simulation r = {.o = &o};
    clock_catch_signals();
    status = find_scene(&r);
    status = status ? status : prepare(&r);
    status = status ? status : run_rows(&r);
    int closed = r.out ? close_file(&r, "out", r.out) : 0;
    int closed_events = close_file(&r, "events", r.events);
    free(r.at);
    free(r.work);
    status = status ? status : closed ? closed : closed_events;
    if (!status && r.chosen)
        fprintf(stderr, "contactplant simulate: done by method %s\n", r.method->name);
    return status;
}
