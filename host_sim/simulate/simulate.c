/* simulate.c - a plant without a bus, as fast as it goes.
 *
 * One plant goes through all rows in equal steps. So a scene on its own frames makes the run that choose
 * certifies and the bus makes, bit for bit, whatever rows are asked for.
 *
 * Rows are exact, not interpolated. A step that may be chosen divides the rows' distance. For a row
 * between two steps a second plant goes there from the last step, in one step of its own. */
#include "firmware/method/auto.h"
#include "firmware/plant/plant_change.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/ticks.h"
#include "host_sim/commands.h"
#include "host_sim/scene/plant_of_scene.h"
#include "host_sim/scene/scene_app.h"
#include "host_sim/simulate/simulate.h"
#include "host_sim/out/cell.h"
#include "host_sim/simulate/simulate_read.h"
#include "host_sim/simulate/simulate_report.h"
#include "models/math/elementary.h"
#include "models/models.h"

#include <math.h>
#include <stdlib.h>

static const double steps_max = 1e12;     /* between two rows */
enum { HALVINGS = 60 };                   /* most halvings of a step in search of one that the method takes */
static const double run_ticks_max = 9e15; /* most ticks of a run */
static const double shortest_s = 1e-12;   /* bus seconds; a tangent of 10 MHz is off by 2e-9 there */

static const struct option simulate_options[] = {
    {"set", "NAME=VALUE", "a number of the scene, with its unit, or of the model's paper; repeatable",
     OPTION_TEXT, .many = true},
    {"units", "model|si",
     "model: the paper's numbers; si: SI (model if --set names a paper parameter, else si)", OPTION_TEXT,
     .initial = NULL},
    {"drive", "CH=A,HZ,RAD", "SI only: drive input CH with A cos(2 pi HZ t + RAD); repeatable", OPTION_TEXT,
     .many = true},
    {"noise", "CH=SD,STEPS,SEED",
     "noise of deviation SD on input CH, a new value every STEPS steps; repeatable", OPTION_TEXT,
     .many = true},
    {"state", "A,B,...", "initial state (the static equilibrium)", OPTION_TEXT, .initial = NULL},
    {"at", "T1,T2,...", "times of the rows, ascending; the run begins at 0", OPTION_TEXT, .initial = NULL},
    {"until", "T", "last time, with --every (10)", OPTION_NUMBER, 0.0, 1e12, .initial = "10"},
    {"every", "DT", "time from row to row (0.1)", OPTION_NUMBER, 1e-12, 1e12, .initial = "0.1"},
    {"method", "NAME", "integration method (auto: picked by model, step and tolerance)", OPTION_TEXT,
     .initial = "auto"},
    {"step", "H", "longest step (1/4096 of the contact's period)", OPTION_NUMBER, 1e-15, 1e6,
     .initial = NULL},
    {"tol", "E", "tolerance of a method that has one (1e-12)", OPTION_NUMBER, METHOD_TOL_MIN, METHOD_TOL_MAX,
     .initial = "1e-12"},
    {.name = "force", .meaning = "run a step that the method refuses as too long; the output says so"},
    {"out", "FILE", "rows as CSV: time and states, 17 digits (standard output)", OPTION_WRITES,
     .initial = NULL},
    {"events", "FILE", "contact events as CSV: time, kind, contact, side (1 or -1), states", OPTION_WRITES,
     .initial = NULL},
    {"report", "FILE",
     "a page with charts of the rows, its data inside; opens in a browser without a network", OPTION_WRITES,
     .initial = NULL},
    {.name = NULL},
};

static const struct usage simulate_usage = {
    .name = "simulate",
    .words = "[SCENE]",
    .summary = "Runs a plant offline and writes its states at the times given. Exits with 0 only when every "
               "step was\n"
               "valid: finite, and every contact switch located. Exits with 3 when the motion escaped.",
    .words_help = SCENE_WORDS_HELP
    "A preset or file brings its own parameters, drives, start, times, method and tolerance, and its\n"
    "observable as the last column. A model in model units takes parameters, states and time of its paper\n"
    "(hertz_rig: xi sigma omega phi Omega a_force a_base a_stiff; q, q_dot; t in 1/nu).\n",
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
    .table = {simulate_options},
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
    r->model->output(r->p, r->shown ? r->shown->segment.at[2] : u, r->shown ? r->shown->x : r->state, output);
    return output[r->observable] * scale_of(&r->scale, r->model->output_signal[r->observable].quantity);
}

/* The states as they are shown. */
static void show_states(const struct simulation *r, double t, const double *x, double *shown)
{
    struct input u[MODEL_INPUTS];
    simulate_inputs(r, t, u);
    scenes_show_state(&r->scene, r->p, &r->scale, u, x, shown);
}

/* The end of a row: the states, and for rows in time the observable. */
static void write_states(struct simulation *r, FILE *f, double t, const double *x)
{
    double shown[MODEL_STATES + 1];
    int n = r->model->n_states;
    show_states(r, t, x, shown);
    if (f == r->out && r->observable >= 0)
        shown[n++] = observed(r, t);
    for (int i = 0; i < n; i++)
        fputc(',', f), cell_put(f, shown[i], 17);
    for (int i = 0; i < SCENE_STAGES && f == r->out; i++)
        if (r->scene.stage[i][STAGE_AT] > 0.0)
            fputc(',', f), cell_put(f, stages_for_plants.results(r->plant.stages)[i], 17);
    fputc('\n', f);
    if (f == r->out)
        simulate_report_row(r, t, shown);
}

/* The signal on which a stage of the scene acts, or which it reads. */
static const struct signal *stage_signal(const struct simulation *r, int i)
{
    int at = (int)r->scene.stage[i][STAGE_AT] - 1;
    return at < MODEL_INPUTS ? &r->model->input_signal[at] : &r->model->output_signal[at - MODEL_INPUTS];
}

static void write_header(const struct simulation *r, FILE *f, const char *first)
{
    fputs(first, f);
    for (int i = 0; i < r->model->n_states; i++)
        fprintf(f, ",%s", scenes_state_name(&r->scene, i));
    if (f == r->out && r->observable >= 0)
        fprintf(f, ",%s", r->model->output_signal[r->observable].name);
    for (int i = 0; i < SCENE_STAGES && f == r->out; i++)
        if (r->scene.stage[i][STAGE_AT] > 0.0)
            fprintf(f, ",stage_%s", stage_signal(r, i)->name);
    fputc('\n', f);
}

static double real_time(const struct simulation *r, double ticks)
{
    return ticks * r->tick_s / r->dilation;
}

/* Writes the events of r->plant, or those of the plant ahead. The last tick of the latter is only `part`
 * of a tick. */
static void write_events(struct simulation *r, struct plant *pl, double part)
{
    struct event e;
    while (plant_take_event(pl, &e)) {
        double t = real_time(r, (double)e.tick + e.fraction * part);
        simulate_report_event(r, t, &e);
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

/* ---- time ---- */

/* Bus seconds of a time that is shown. */
static double bus_time(const struct simulation *r, double t)
{
    return t * r->dilation;
}

/* Bus seconds from row to row without --at, and the longest step: of a scene's own the very numbers that
 * the bus takes. */
static double bus_every(const struct simulation *r)
{
    bool scene = r->origin != SCENE_OF_MODEL && !options_given(r->o, "every");
    return scene ? r->scene.frame_s : bus_time(r, r->every);
}

static double bus_step(const struct simulation *r)
{
    bool scene = r->origin != SCENE_OF_MODEL && !options_given(r->o, "step");
    return scene ? r->scene.frame_s / r->scene.substeps : bus_time(r, r->step);
}

/* Equal steps, none longer than `step`, in `length`. */
static double steps_over(double length, double step)
{
    return fmax(1.0, ceil(ticks_in(length, step)));
}

/* The ticks until row i: whole ones, or that many and a part of one. */
static double ticks_until(const struct simulation *r, size_t i, double tick_s)
{
    return ticks_in(r->at ? bus_time(r, r->at[i]) : (double)i * bus_every(r), tick_s);
}

/* All rows are at ticks. */
static bool fits(const struct simulation *r, double tick_s)
{
    for (size_t i = 0; r->at && i < r->n_rows; i++)
        if (!ticks_fit(bus_time(r, r->at[i]), tick_s))
            return false;
    return r->at || ticks_fit(bus_every(r), tick_s);
}

/* The first row behind the start and the smallest distance of two, bus seconds; 0: there is none. */
static double first_row(const struct simulation *r, double *nearest)
{
    double first = 0.0;
    *nearest = HUGE_VAL;
    for (size_t i = 0; r->at && i < r->n_rows; i++) {
        double gap = bus_time(r, r->at[i]) - (i ? bus_time(r, r->at[i - 1]) : 0.0);
        *nearest = gap > 0.0 ? fmin(*nearest, gap) : *nearest;
        first = first > 0.0 ? first : bus_time(r, r->at[i]);
    }
    if (!r->at && r->n_rows > 1)
        first = *nearest = bus_every(r);
    return first;
}

/* Chooses the step: NULL, or a refusal. The first of these that applies:
 * - a scene's own step;
 * - the longest step, where the rows are at multiples of it;
 * - a step that divides the way to the first row, if it divides the ways to the others;
 * - the longest step, or the rows' smallest distance. */
static const char *choose_tick(struct simulation *r)
{
    double nearest, first = first_row(r, &nearest), step = bus_step(r);
    double part = first > 0.0 ? first / steps_over(first, step) : step;
    bool asked = r->origin == SCENE_OF_MODEL || options_given(r->o, "step");
    r->tick_s = !asked || fits(r, step) ? step : fits(r, part) ? part : fmin(step, nearest);
    bool noisy = false;
    for (int i = 0; i < r->model->n_inputs; i++)
        noisy |= r->noise[i].deviation > 0.0 && r->model->input_signal[i].quantity == QUANTITY_LENGTH;
    double setting[SETTINGS];
    if (scene_stage_settings(&r->scene, setting) && !fits(r, r->tick_s))
        return "a stage goes from step to step: give times at multiples of a --step";
    if (noisy && !fits(r, r->tick_s))
        return "noise of a length goes from step to step: give times at multiples of a --step";
    double last = r->n_rows > 0 ? ticks_until(r, r->n_rows - 1, r->tick_s) : 0.0;
    return last <= run_ticks_max && (r->at ? last : bus_every(r) / r->tick_s) <= steps_max
               ? NULL
               : "more than 1e12 steps between two rows; take a longer --step";
}

/* ---- the plant ---- */

/* An input from the start of the run or some time in it, when its noise goes on. */
static void begin_input(const struct simulation *r, struct plant *pl, int i, double start)
{
    const double turn = 2.0 * ELEMENTARY_PI;
    const struct harmonic *d = &r->drive[i];
    struct noise_setting s = r->noise[i];
    double phase = start > 0.0 ? fmod(fmod(d->omega * start, turn) + d->phase, turn) : d->phase;
    if (d->amplitude < 0.0 || d->amplitude > 0.0)
        plant_drive_start(pl, i, d->amplitude, d->omega / (turn * r->dilation), phase);
    if (s.deviation > 0.0)
        plant_noise(pl, i, s.deviation, s.hold, s.seed, 0.0);
    s.deviation /= scale_of(&pl->scale, r->model->input_signal[i].quantity);
    if (s.deviation > 0.0 && start > 0.0)
        noise_start(&plant_touch_drive(pl, i)->noise, &s);
}

/* A plant in this state at a tick of the run, with ticks of its own; a reason when it cannot be. */
static const char *place(const struct simulation *r, struct plant *pl, double *scratch, uint64_t tick,
                         double tick_s, const double *x)
{
    static struct stages stages;                       /* one plant may have some: see choose_tick */
    static double event_x[PLANT_EVENTS][MODEL_STATES]; /* events are taken before the next plant runs */
    struct plant_config c = plant_config_of_scene(&r->scene, r->si, scratch);
    c.method = r->method;
    c.tick_s = tick_s;
    c.dilation = r->dilation;
    c.tol = r->tol;
    c.force = true; /* the guard has spoken */
    c.stage_calls = &stages_for_plants;
    c.stages = &stages;
    double setting[SETTINGS];
    bool staged = scene_stage_settings(&r->scene, setting);
    const char *why = staged ? stages_for_plants.refuse(r->model, tick_s / r->dilation, setting) : NULL;
    why = why ? why : plant_init(pl, &c);
    if (why)
        return why;
    pl->event_x = event_x;
    if (staged)
        stages_for_plants.change(&stages, pl, setting);
    pl->now.tick = tick;
    for (int i = 0; i < r->model->n_inputs; i++)
        begin_input(r, pl, i, real_time(r, (double)tick));
    plant_set_state(pl, x);
    return NULL;
}

static int told(const struct simulation *r, const struct plant *pl, bool escaped)
{
    double now = real_time(r, (double)pl->now.tick);
    if (escaped) {
        options_failure(r->o->usage, "the motion escapes at t = %.9g; the rows end before it", now);
        return STATUS_ESCAPED;
    }
    if (pl->counts.budget || pl->counts.residual)
        return options_failure(r->o->usage,
                               "a contact switch near t = %.9g was not located; take a shorter --step", now);
    return 0;
}

/* To a tick, or until there is no going on. */
static int carry_to(struct simulation *r, uint64_t to)
{
    struct plant *pl = &r->plant;
    bool escaped = false;
    while (pl->now.tick < to && !escaped && !clock_interrupted()) {
        escaped = !plant_run(pl, 1);
        write_events(r, pl, 1.0);
    }
    r->shown = pl;
    if (pl->now.tick < to && !escaped)
        return options_failure(r->o->usage, "interrupted at t = %.9g; the rows end before it",
                               real_time(r, (double)pl->now.tick));
    return told(r, pl, escaped);
}

/* From the tick where the plant is, a way too short for a plant, as on a tangent. */
static void lean(struct simulation *r, double way_s)
{
    double x_dot[MODEL_STATES];
    struct plant *pl = &r->ahead;
    *pl = r->plant;
    r->model->rhs(pl->p, pl->segment.at[2], pl->x, x_dot);
    for (int i = 0; i < r->model->n_states; i++)
        pl->x[i] += way_s / pl->scale.time_s * x_dot[i];
    r->shown = pl;
}

/* From the tick where the plant is, part of one ahead by another plant. */
static int look_ahead(struct simulation *r, double part, bool last)
{
    struct plant *pl = &r->ahead;
    const char *why = place(r, pl, r->scratch_ahead, r->plant.now.tick, part * r->tick_s, r->plant.x);
    if (why)
        return simulate_misuse(r, "this run cannot be done", why);
    bool escaped = !plant_run(pl, 1);
    if (last) /* whose ticks the plant will not do */
        write_events(r, pl, part);
    r->shown = pl;
    return told(r, pl, escaped);
}

/* The plant at a row between two ticks. */
static int look(struct simulation *r, double part, bool last)
{
    if (part * r->tick_s >= shortest_s)
        return look_ahead(r, part, last);
    lean(r, part * r->tick_s);
    return 0;
}

/* ---- rows ---- */

/* A comment above the header: what the step guard said and --force overrode. */
static void mark_forced(const struct simulation *r, FILE *f)
{
    const char *why = guard(r, real_time(r, 1.0));
    if (why && options_given(r->o, "force"))
        fprintf(f, "# forced against: %s\n", why);
}

/* No further row can be written, and neither events nor a report are asked for. */
static bool unwanted(const struct simulation *r)
{
    return ferror(r->out) && !r->events && !r->report;
}

static int run_rows(struct simulation *r)
{
    int status = 0;
    mark_forced(r, r->out);
    write_header(r, r->out, "t");
    if (r->events)
        mark_forced(r, r->events);
    if (r->events)
        write_header(r, r->events, "t,kind,contact,side");
    for (size_t row = 0; row < r->n_rows && !status && !unwanted(r); row++) {
        double n = ticks_until(r, row, r->tick_s), t = time_of(r, row);
        if (n > 0.0)
            status = carry_to(r, (uint64_t)n);
        if (!status && n > floor(n))
            status = look(r, n - floor(n), row + 1 == r->n_rows);
        if (status)
            break;
        fprintf(r->out, "%.17g", t);
        write_states(r, r->out, t, r->shown ? r->shown->x : r->state);
    }
    return status;
}

/* Reports whatever would refuse the run, before a file is touched; leaves the plant at the start. */
static int try_plant(struct simulation *r)
{
    if (!(time_of(r, r->n_rows - 1) > 0.0))
        return 0;
    const char *why = refusal(r, real_time(r, 1.0));
    why = why ? why : place(r, &r->plant, r->scratch, 0, r->tick_s, r->state);
    return why ? simulate_misuse(r, "this run cannot be done", why) : 0;
}

static int prepare(struct simulation *r)
{
    int status = simulate_read(r);
    if (status)
        return status;
    if (scene_load_warns(r->origin, r->model))
        scene_load_warn(r->o->usage->name, r->model, r->si, r->drive);
    const char *why = choose_tick(r);
    if (why)
        return simulate_misuse(r, "this run cannot be done", why);
    const struct method *named = r->method;
    r->chosen = r->method == &auto_method;
    if (r->chosen)
        r->method =
            auto_choice(r->model, r->p, real_time(r, 1.0) / r->scale.time_s, r->tol, r->drive, &r->scale);
    r->scratch = calloc(2 * (r->method->n_scratch(r->model) + 1), sizeof *r->scratch);
    r->out = stdout;
    if (!r->scratch)
        return options_failure(r->o->usage, "out of memory");
    r->scratch_ahead = r->scratch + r->method->n_scratch(r->model) + 1;
    status = try_plant(r);
    if (status)
        return status;
    scene_load_tell_tolerance(r->o, r->model, named);
    r->out = options_given(r->o, "out") ? options_create(r->o, "out") : stdout;
    bool events = r->out && options_given(r->o, "events");
    r->events = events ? options_create(r->o, "events") : NULL;
    return r->out && (r->events || !events) ? 0 : STATUS_FAILED;
}

/* The scene's name is optional: the first model is the default. */
static int find_scene(struct simulation *r)
{
    char why[SCENE_REASON];
    const char *method = options_text(r->o, "method", 0);
    bool other = options_given(r->o, "method") || options_given(r->o, "step") || options_given(r->o, "tol");
    r->origin = (other ? scene_load_unstepped
                       : scene_load)(r->o->n_words ? r->o->word[0] : model_table[0]->name, &r->scene, why);
    if (r->origin == SCENE_OF_NOTHING)
        return options_misuse(r->o->usage, "%s", why);
    if (scene_kind(r->scene.model)->without_bus)
        return options_misuse(r->o->usage, "%s", scene_kind(r->scene.model)->without_bus);
    bool bare = r->origin == SCENE_OF_MODEL;
    r->model = r->scene.model;
    r->dilation = bare ? 1.0 : r->scene.dilation;
    r->method = method_find(bare || options_given(r->o, "method") ? method : r->scene.method);
    r->observable = bare ? -1 : r->scene.observable;
    r->tol = bare ? 0.0 : r->scene.tolerance;
    /* 1e-12 is asked of methods whose error follows a tolerance; of the others only what the user asks. */
    if (options_given(r->o, "tol") || (bare && r->method && r->method->order == 0))
        r->tol = options_number(r->o, "tol");
    if (r->method)
        return 0;
    scene_method_refuse(method, why);
    return options_misuse(r->o->usage, "%s", why);
}

int cmd_simulate(int argc, char **argv)
{
    struct options o;
    int status;
    if (!options_parse(&o, &simulate_usage, argc, argv, &status))
        return status;
    struct simulation r = {.o = &o};
    clock_catch_signals();
    status = find_scene(&r);
    status = status ? status : prepare(&r);
    status = status ? status : simulate_report_begin(&r, argc, argv);
    status = status ? status : run_rows(&r);
    bool cut = r.out && ferror(r.out);
    int closed = r.out ? options_close(&o, "out", r.out, NULL) : 0;
    int closed_events = r.events ? options_close(&o, "events", r.events, NULL) : 0;
    status = simulate_report_end(&r, status);
    free(r.at);
    free(r.scratch);
    status = status ? status : closed ? closed : closed_events;
    if (!status && r.chosen && !cut)
        fprintf(stderr, "contactplant simulate: done by method %s\n", r.method->name);
    return status;
}
