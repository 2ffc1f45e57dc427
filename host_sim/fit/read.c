/* read.c - the command line of contactplant fit: scene, data, unknowns. */
#include "host_sim/fit/read.h"

#include "host_sim/fit/solve/unknown.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/fit/data/log_record.h"
#include "host_sim/fit/levers.h"
#include "host_sim/fit/motion/linear.h"
#include "host_sim/fit/noise.h"
#include "host_sim/fit/solve/problem.h"
#include "host_sim/scene/scene_load.h"
#include "models/afm_lever.h"
#include "models/math/elementary.h"

enum { FEW = 6 /* parameters that are all free where none is named */ };
static const double tol_most = 1e-9;
static const double size_most = 1e9, size_least = 1e-12; /* data over the scene's own scale */
static const double least_of_start = 1e-9; /* a number that may be 0 stays above this share of its start */

static const struct chain_unknown {
    const char *name, *unit;
    enum fit_kind kind;
    double min, max, start;
} chain[] = {
    {"gain.force", "", FIT_GAIN_FORCE, 1e-3, 1e3, 1.0},
    {"gain.sensor", "", FIT_GAIN_SENSOR, 1e-3, 1e3, 1.0},
    {"delay", "s", FIT_DELAY, -1.0, 1.0, 0.0},
    {"offset", "", FIT_OFFSET, -1e12, 1e12, 0.0},
};
enum { CHAIN = sizeof chain / sizeof chain[0] };

#define misuse(s, ...) options_misuse((s)->o.usage, __VA_ARGS__)

/* ---- scene ---- */

static int read_scene(struct fit_setup *s)
{
    char why[SCENE_REASON];
    s->name = s->o.word[0];
    bool lever = options_given(&s->o, "thermal") || options_given(&s->o, "curve");
    enum scene_origin origin =
        lever ? scene_load(s->name, &s->scene, why) : scene_load_cold(s->name, &s->scene, why);
    if (origin == SCENE_OF_NOTHING)
        return misuse(s, "%s", why);
    if (s->scene.paper)
        return misuse(s, "%s has the numbers of a paper; give a scene with a [plant] in SI", s->name);
    bool is_lever = s->scene.model->modal_form || scene_is_microscope(s->scene.model);
    if (lever && !is_lever)
        return misuse(s,
                      "%s is no AFM lever; --thermal and --curve take soft, tapping, stiff or a scene of one",
                      s->name);
    if (is_lever)
        return lever ? 0 : misuse(s, "%s: of a lever a fit takes --thermal FILE and --curve FILE", s->name);
    if (s->scene.model->n_states > ORBIT_STATES)
        return misuse(s, "%s: a fit does not take the model %s", s->name, s->scene.model->name);
    const struct method *method = method_find(s->scene.method);
    s->task = (struct orbit_task){
        .model = s->scene.model, .method = method, .tol = fmin(s->scene.tolerance, tol_most)};
    s->task.scratch = calloc(method->n_scratch(s->scene.model) + 1, sizeof *s->task.scratch);
    return s->task.scratch ? 0 : options_failure(s->o.usage, "out of memory");
}

/* ---- unknowns ---- */

/* The parameter of this name; its index. */
static int find_parameter(const struct fit_setup *s, const char *name, size_t n, struct scene_range *r,
                          int *index)
{
    struct scene_range_names also = {.n = CHAIN};
    for (int i = 0; i < CHAIN; i++)
        also.name[i] = chain[i].name;
    int status = scene_range_find(s->o.usage, &s->scene, name, n, &also, r);
    if (!status && r->input >= 0)
        return misuse(s, "%.*s belongs to a drive, which the data name; no unknown", (int)n, name);
    *index = (int)((r->key.offset - offsetof(struct scene, value)) / sizeof(double));
    return status;
}

static int add_unknown(struct fit_setup *s, const struct fit_unknown *k)
{
    if (s->n == FIT_UNKNOWNS)
        return misuse(s, "more than %d unknowns; hold some", FIT_UNKNOWNS);
    for (int i = 0; i < s->n; i++)
        if (!strcmp(s->unknown[i].name, k->name))
            return misuse(s, "--free: %s is there twice; give it once", k->name);
    s->unknown[s->n++] = *k;
    return 0;
}

static int add_parameter(struct fit_setup *s, const struct scene_range *r, int index)
{
    double start = s->scene.value[index];
    struct fit_unknown k = {.kind = FIT_PARAMETER,
                            .index = index,
                            .unit = r->key.unit,
                            .min = r->key.min,
                            .max = r->key.max,
                            .start = start};
    if (!(start > 0.0))
        return misuse(
            s, "%s is %g in the scene, and is fitted in logarithms; give it a start above 0, or --hold %s=%g",
            r->key.name, start, r->key.name, start);
    snprintf(k.name, sizeof k.name, "%s", r->key.name);
    k.min = fmax(k.min, least_of_start * start);
    return add_unknown(s, &k);
}

/* A radian of the middle of the smallest curve; an offset in units of the first record's motion. */
static int add_chain(struct fit_setup *s, const struct chain_unknown *c)
{
    struct fit_unknown k = {
        .kind = c->kind, .unit = c->unit, .min = c->min, .max = c->max, .start = c->start, .unit_of_u = 1.0};
    const struct curve *smallest = &s->data.curve[0];
    if (s->levers.n)
        return misuse(s, "%s is no unknown of a lever; contact and baseline are, by themselves", c->name);
    if (c->kind == FIT_DELAY && !s->data.n)
        return misuse(s, "delay is told by response curves alone; give --sweep, or take it out of --free");
    if (c->kind == FIT_OFFSET && !s->records.n)
        return misuse(s, "offset is told by records alone; give --ring, or take it out of --free");
    if (c->kind == FIT_DELAY)
        k.unit_of_u = 1.0 / (2.0 * ELEMENTARY_PI * smallest->point[smallest->n / 2].frequency_Hz);
    if (c->kind == FIT_OFFSET) {
        k.unit_of_u = s->records.record[0].size;
        k.unit = s->scene.model->output_signal[s->records.record[0].output].unit;
    }
    snprintf(k.name, sizeof k.name, "%s", c->name);
    return add_unknown(s, &k);
}

static int add_named(struct fit_setup *s, const char *name, size_t n, const bool *held)
{
    struct scene_range r;
    int index;
    for (int i = 0; i < CHAIN; i++)
        if (strlen(chain[i].name) == n && !strncmp(chain[i].name, name, n))
            return add_chain(s, &chain[i]);
    int status = find_parameter(s, name, n, &r, &index);
    if (!status && held[index])
        return misuse(s, "%s is both in --free and in --hold; give one of the two", r.key.name);
    return status ? status : add_parameter(s, &r, index);
}

/* mass,stiffness,.. */
static int read_free(struct fit_setup *s, const bool *held)
{
    const char *at = options_text(&s->o, "free", 0);
    int status = 0;
    for (bool more = true; more && !status;) {
        size_t n = strcspn(at, ",");
        while (n && *at == ' ')
            at++, n--;
        if (!n)
            return misuse(s, "--free %s: write names with commas between", options_text(&s->o, "free", 0));
        status = add_named(s, at, n, held);
        more = at[n] == ',';
        at += n + more;
    }
    return status;
}

/* All parameters that are not held. */
static int free_all(struct fit_setup *s, const bool *held)
{
    const struct model *m = s->scene.model;
    struct scene_range r;
    int status = 0, index;
    if (m->n_parameters > FEW && !s->levers.n)
        return misuse(s, "%s has %d numbers: name the unknowns, --free NAME,..", m->name, m->n_parameters);
    for (int i = 0; i < m->n_parameters && !status; i++) {
        const char *name = m->parameter[i].name;
        if (held[i] || (s->levers.n && !levers_tell(s, i)))
            continue;
        status = find_parameter(s, name, strlen(name), &r, &index);
        status = status ? status : add_parameter(s, &r, index);
    }
    return status;
}

static int read_held(struct fit_setup *s, bool *held)
{
    int status = 0, index;
    for (int i = 0; i < options_count(&s->o, "hold") && !status; i++) {
        const char *text = options_text(&s->o, "hold", i);
        struct scene_range r;
        if (!strchr(text, '='))
            return misuse(s, "--hold %s: write NAME=VALUE with its unit", text);
        status = find_parameter(s, text, strcspn(text, "="), &r, &index);
        status = status ? status : scene_range_setting(s->o.usage, &s->scene, text, NULL);
        if (!status)
            held[index] = true;
    }
    return status;
}

/* The phase of y at this frequency, in its later half: that of its first harmonic. */
static double phase_seen(const struct record *r)
{
    double re = 0.0, im = 0.0, mean = 0.0;
    int n = 0;
    for (int i = r->n / 2; i < r->n; i++)
        if (!isnan(r->y[i])) {
            mean += r->y[i];
            n++;
        }
    for (int i = r->n / 2; i < r->n; i++) {
        double cosine, sine, turns = r->tone.frequency_Hz * i * r->step_s;
        cos_sin(2.0 * ELEMENTARY_PI * (turns - floor(turns)), &cosine, &sine);
        re += isnan(r->y[i]) ? 0.0 : (r->y[i] - mean / n) * cosine;
        im -= isnan(r->y[i]) ? 0.0 : (r->y[i] - mean / n) * sine;
    }
    return atan2(im, re);
}

/* The phase of a tone that is not known, from what the linear plant of the scene makes of it. */
static int add_phase(struct fit_setup *s, int i)
{
    const struct record *r = &s->records.record[i];
    struct fit_unknown k = {
        .kind = FIT_PHASE, .index = i, .unit = "", .min = -1e12, .max = 1e12, .unit_of_u = 1.0};
    struct orbit_task t = s->task;
    struct harmonic drive[MODEL_INPUTS];
    double re, im;
    if (r->input < 0 || !(r->tone.amplitude > 0.0) || r->tone.phase_known)
        return 0;
    scenes_resolve(&s->scene, t.si, drive);
    t.input = r->input;
    t.output = r->output;
    t.amplitude = r->tone.amplitude;
    if (linear_response(&t, r->tone.frequency_Hz, &re, &im))
        k.start = phase_seen(r) - atan2(im, re);
    snprintf(k.name, sizeof k.name, "phase of record %d", i + 1);
    return add_unknown(s, &k);
}

/* The state in which each record begins: from rest, as large as its motion. */
static int add_starts(struct fit_setup *s)
{
    double p[MODEL_DERIVED];
    struct scale scale;
    if (!s->records.n)
        return 0;
    s->scene.model->prepare(s->scene.value, p, &scale);
    double rate = s->scene.model->eigenfrequency(p) / scale.time_s;
    int status = 0;
    for (int i = 0; i < s->records.n && !status; i++) {
        const struct record *r = &s->records.record[i];
        enum quantity q = s->scene.model->output_signal[r->output].quantity;
        double length = q == QUANTITY_VELOCITY ? r->size / rate
                        : q == QUANTITY_LENGTH ? r->size
                                               : r->size * scale.length_m / scale.force_N;
        for (int v = 0; v < 2 && !status; v++) {
            struct fit_unknown k = {
                .kind = v ? FIT_VELOCITY : FIT_POSITION, .index = i, .unit = "", .min = -1e12, .max = 1e12};
            k.unit_of_u = v ? length * rate : length;
            snprintf(k.name, sizeof k.name, "%s of record %d", v ? "velocity" : "position", i + 1);
            status = add_unknown(s, &k);
        }
        status = status ? status : add_phase(s, i);
    }
    return status;
}

static int read_unknowns(struct fit_setup *s)
{
    bool held[MODEL_PARAMETERS] = {false};
    int status = read_held(s, held);
    if (status)
        return status;
    status = options_given(&s->o, "free") ? read_free(s, held) : free_all(s, held);
    if (!status && !s->n)
        return misuse(s, "nothing is unknown: every number is held");
    status = status ? status : levers_add_chain(s, add_unknown);
    return status ? status : add_starts(s);
}

/* ---- data ---- */

/* The smallest drive first. */
static void sort_curves(struct curves *c)
{
    for (int i = 1; i < c->n; i++)
        for (int k = i; k > 0 && c->curve[k].amplitude < c->curve[k - 1].amplitude; k--) {
            struct curve was = c->curve[k];
            c->curve[k] = c->curve[k - 1];
            c->curve[k - 1] = was;
        }
}

static int read_levers(struct fit_setup *s)
{
    static const char *const option[] = {[LEVER_SPECTRUM] = "thermal", [LEVER_CURVE] = "curve"};
    int status = 0;
    for (int kind = 0; kind < LEVER_DATA && !status; kind++)
        if (options_given(&s->o, option[kind]))
            status = lever_read(s->o.usage, options_text(&s->o, option[kind], 0), (enum lever_kind)kind,
                                &s->crc, &s->levers);
    if (!status && s->levers.n && (s->data.n || s->records.n))
        return misuse(s,
                      "--thermal and --curve are of a lever, the other data of a rig; give one of the two");
    if (!status && options_given(&s->o, "thermal") && !(s->scene.value[LEVER_TEMPERATURE] > 0.0))
        return misuse(s, "%s is at 0 K; give it the temperature of the measurement", s->name);
    return status;
}

static bool are_one_curve(const struct curve *a, const struct curve *b)
{
    bool same = a->n == b->n && a->input == b->input && a->output == b->output &&
                a->derivatives == b->derivatives && a->down == b->down &&
                !memcmp(&a->amplitude, &b->amplitude, sizeof a->amplitude);
    for (int i = 0; same && i < a->n; i++)
        same = !memcmp(&a->point[i], &b->point[i], offsetof(struct curve_point, sigma));
    return same;
}

/* A measurement counts once: given twice, its intervals would be too narrow. */
static int check_twice(const struct fit_setup *s)
{
    const char *twice = NULL, *first = NULL;
    for (int i = 0; i < s->data.n; i++)
        for (int k = 0; k < i; k++)
            if (are_one_curve(&s->data.curve[i], &s->data.curve[k])) {
                twice = s->data.curve[i].path;
                first = s->data.curve[k].path;
            }
    for (int i = 0; i < s->records.n; i++)
        for (int k = 0; k < i; k++) {
            const struct record *a = &s->records.record[i], *b = &s->records.record[k];
            if (a->n != b->n || a->output != b->output || memcmp(a->y, b->y, (size_t)a->n * sizeof *a->y))
                continue;
            twice = a->path;
            first = b->path;
        }
    return twice ? misuse(s, "%s has the data of %s once more; give them once", twice, first) : 0;
}

static int read_data(struct fit_setup *s)
{
    const struct usage *u = s->o.usage;
    int status = 0;
    for (int i = 0; i < options_count(&s->o, "sweep") && !status; i++)
        status = curves_read(u, options_text(&s->o, "sweep", i), &s->scene, &s->crc, &s->data);
    for (int i = 0; i < options_count(&s->o, "ring") && !status; i++)
        status = records_read(u, options_text(&s->o, "ring", i), &s->scene, false, &s->crc, &s->records);
    for (int i = 0; i < options_count(&s->o, "series") && !status; i++)
        status = records_read(u, options_text(&s->o, "series", i), &s->scene, true, &s->crc, &s->records);
    for (int i = 0; i < options_count(&s->o, "log") && !status; i++)
        status = log_record_read(&s->o, options_text(&s->o, "log", i), &s->crc, &s->records);
    status = status ? status : read_levers(s);
    if (status)
        return status;
    bool plan = options_given(&s->o, "plan"), measured = s->data.n || s->records.n || s->levers.n;
    if (plan && measured)
        return misuse(s, "--plan comes before measuring: take the data away");
    if (plan &&
        (options_given(&s->o, "out") || options_given(&s->o, "svg") || options_given(&s->o, "report")))
        return misuse(s, "--plan prints a table alone: take --out, --svg and --report away");
    if (!plan && !measured)
        return misuse(
            s, "no data: give a response curve, --sweep FILE, or a record: --ring, --series or --log FILE");
    if (s->records.n && s->scene.model->n_states != 2)
        return misuse(s, "records are taken of models with one degree of freedom; give response curves");
    sort_curves(&s->data);
    noise_assume(s);
    return check_twice(s);
}

static int make_room(struct fit_setup *s)
{
    int numbers = 0;
    for (int c = 0; c < s->data.n; c++) {
        const struct curve *curve = &s->data.curve[c];
        s->n_residuals += 2 * curve->n;
        numbers += (curve->has_phase ? 2 : 1) * curve->n;
        s->point[c] = calloc((size_t)curve->n, sizeof *s->point[c]);
        if (!s->point[c])
            return options_failure(s->o.usage, "out of memory");
    }
    for (int i = 0; i < s->records.n; i++) {
        s->n_residuals += s->records.record[i].n;
        numbers += record_count(s->records.record[i].y, s->records.record[i].n);
    }
    for (int i = 0; i < s->levers.n; i++) {
        s->n_residuals += s->levers.data[i].n;
        numbers += s->levers.data[i].n;
    }
    if (numbers <= s->n && !options_given(&s->o, "plan"))
        return misuse(s, "%d numbers for %d unknowns: measure more points, or hold some unknowns", numbers,
                      s->n);
    return 0;
}

/* The largest motion or drive of a file, beside the scene's own scale of it. */
static int check_size(const struct fit_setup *s, const char *path, const char *what, const char *unit,
                      double x, double scale)
{
    if (!(x > 0.0) || (x <= size_most * scale && x >= size_least * scale))
        return 0;
    return misuse(s,
                  "%s: %s is %.3g %s at most, and the scene's own scale of it is %.3g %s: is the unit right?",
                  path, what, x, unit, scale, unit);
}

static double largest(const double *x, int n)
{
    double most = 0.0;
    for (int i = 0; i < n; i++)
        most = fmax(most, fabs(x[i])); /* passes over NaN */
    return most;
}

static int check_curve_size(const struct fit_setup *s, const struct curve *c, const struct scale *scale)
{
    const struct model *m = s->scene.model;
    double own = scale_of(scale, m->output_signal[c->output].quantity), most = 0.0;
    own /= c->derivatives ? scale->time_s : 1.0;
    for (int i = 0; i < c->n; i++)
        most = fmax(most, sqrt(c->point[i].re * c->point[i].re + c->point[i].im * c->point[i].im));
    int status = check_size(s, c->path, "amplitude", m->input_signal[c->input].unit, c->amplitude,
                            scale_of(scale, m->input_signal[c->input].quantity));
    return status ? status : check_size(s, c->path, curve_name(c, m), curve_unit(c, m), most, own);
}

static int check_record_size(const struct fit_setup *s, const struct record *r, const struct scale *scale)
{
    const struct model *m = s->scene.model;
    const struct signal *y = &m->output_signal[r->output],
                        *u = r->input < 0 ? NULL : &m->input_signal[r->input];
    int status = check_size(s, r->path, y->name, y->unit, largest(r->y, r->n), scale_of(scale, y->quantity));
    if (!status && u && r->u)
        status = check_size(s, r->path, u->name, u->unit, largest(r->u, r->n), scale_of(scale, u->quantity));
    return status;
}

/* Data whose unit is wrong by many powers of ten are refused before any motion is computed. */
static int check_sizes(const struct fit_setup *s)
{
    double p[MODEL_DERIVED];
    struct scale scale;
    int status = 0;
    if (!s->data.n && !s->records.n)
        return 0;
    s->scene.model->prepare(s->scene.value, p, &scale);
    for (int c = 0; c < s->data.n && !status; c++)
        status = check_curve_size(s, &s->data.curve[c], &scale);
    for (int i = 0; i < s->records.n && !status; i++)
        status = check_record_size(s, &s->records.record[i], &scale);
    return status;
}

/* The plant as it starts must run where the data are. */
static int check_start(struct fit_setup *s)
{
    double u[FIT_UNKNOWNS];
    struct orbit_task t;
    struct harmonic drive[MODEL_INPUTS];
    scenes_resolve(&s->scene, s->task.si, drive);
    for (int k = 0; k < s->n; k++)
        u[k] = unknown_u(&s->unknown[k], s->unknown[k].start);
    for (int c = 0; c < s->data.n; c++) {
        const struct curve *curve = &s->data.curve[c];
        (void)unknown_task(s, c, u, &t);
        for (int i = 0; i < 2; i++) {
            double frequency = curve->point[i ? curve->n - 1 : 0].frequency_Hz;
            const char *why = orbit_refused(&t, frequency);
            if (why)
                return misuse(s, "%s at %.6g Hz: the scene's plant does not run there: %s", curve->path,
                              frequency, why);
        }
    }
    return 0;
}

int fit_read(struct fit_setup *s)
{
    int status = read_scene(s);
    status = status ? status : read_data(s);
    status = status ? status : check_sizes(s);
    status = status ? status : read_unknowns(s);
    status = status ? status : make_room(s);
    return status ? status : check_start(s);
}

void fit_free(struct fit_setup *s)
{
    for (int c = 0; c < s->data.n; c++)
        free(s->point[c]);
    curves_free(&s->data);
    records_free(&s->records);
    lever_free(&s->levers);
    free(s->task.scratch);
}
