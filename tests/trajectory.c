/* trajectory.c - see trajectory.h. */
#include "tests/trajectory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "models/hertz_rig.h"
#include "models/models.h"
#include "tests/exact.h"
#include "tests/paper.h"
#include "tests/test.h"

#define TWO_PI 6.283185307179586477

enum { LINE = 256 };

static void use_model(struct trajectory *r, const struct model *m)
{
    r->model = m;
    paper_defaults(m, r->paper);
}

static const struct model *model_named(const char *name)
{
    for (int i = 0; i < MODELS; i++) {
        if (strcmp(name, model_table[i]->name) == 0)
            return model_table[i];
    }
    check_string("a model of the reference cases", name, "in the table");
    return &hertz_rig;
}

static void read_numbers(const char *text, int n, double *x)
{
    char *end;
    for (int i = 0; i < n; i++, text = end)
        x[i] = strtod(text, &end);
}

static void read_event(struct trajectory *r, double t, const char *kind, double rate, int contact)
{
    int i = r->n_events[contact];
    if (i == TRAJECTORY_EVENTS)
        return;
    r->event_t[contact][i] = t;
    r->event_touch[contact][i] = strcmp(kind, "touchdown") == 0;
    r->event_rate[contact][i] = rate;
    r->n_events[contact]++;
}

/* One line into the case; 1 at its end. */
static int read_line(struct trajectory *r, const char *line)
{
    char word[64];
    double a, b;
    int contact = 0, n = 0;
    if (sscanf(line, "case %63s", word) == 1) {
        memset(r, 0, sizeof *r);
        use_model(r, &hertz_rig);
        snprintf(r->name, sizeof r->name, "%s", word);
    } else if (sscanf(line, "model %63s", word) == 1) {
        use_model(r, model_named(word));
    } else if (sscanf(line, "parameter %63s %lf", word, &a) == 2) {
        int i = paper_index(r->model, word);
        check_is("a parameter of a reference case is one of its model", i, >=, 0);
        r->paper[i >= 0 ? i : 0] = a;
    } else if (sscanf(line, "growth %lf", &a) == 1) {
        r->growth = a;
    } else if (strncmp(line, "start ", 6) == 0) {
        read_numbers(line + 6, r->model->n_states, r->start);
    } else if (sscanf(line, "sample %lf%n", &a, &n) == 1 && r->n_samples < TRAJECTORY_SAMPLES) {
        r->t[r->n_samples] = a;
        read_numbers(line + n, r->model->n_states, r->state[r->n_samples++]);
    } else if (sscanf(line, "event %lf %63s %lf %d", &a, word, &b, &contact) >= 3 &&
               contact < MODEL_CONTACTS) {
        read_event(r, a, word, b, contact);
    } else if (sscanf(line, "events %lf", &a) == 1) {
        r->n_events_total = (int)a;
    }
    return strncmp(line, "end", 3) == 0;
}

int trajectory_each(const char *path, void (*check)(const struct trajectory *))
{
    static struct trajectory r;
    char line[LINE];
    int cases = 0;
    FILE *f = fopen(path, "r");
    check_true("the file of cases is there (run from the project's top folder)", f != NULL);
    while (f && fgets(line, sizeof line, f)) {
        if (!read_line(&r, line))
            continue;
        check(&r);
        cases++;
    }
    if (f)
        fclose(f);
    return cases;
}

void trajectory_start(struct plant *pl, const struct model *m, const struct method *method, double tol,
                      double *work, const double *paper, double h, const double *state)
{
    double si[MODEL_PARAMETERS], x[MODEL_STATES];
    struct harmonic drive[MODEL_INPUTS];
    m->from_paper(paper, si, drive);
    struct plant_config c = {
        .model = m, .si = si, .method = method, .tick_s = h, .dilation = 1.0, .tol = tol, .work = work};
    const char *why = plant_init(pl, &c);
    if (why)
        check_string("plant_init", why, "no refusal");
    for (int i = 0; i < m->n_inputs; i++) {
        if (drive[i].amplitude != 0.0)
            plant_drive_start(pl, i, drive[i].amplitude, drive[i].omega / TWO_PI, drive[i].phase);
    }
    m->state_from_paper(pl->p, pl->excitation.at[2], state, x);
    plant_set_state(pl, x);
}

static double column_max(const struct trajectory *r, int column)
{
    double max = 0.0;
    for (int i = 0; i < r->n_samples; i++)
        max = fmax(max, fabs(r->state[i][column]));
    return max;
}

/* The events since the last call, each contact's against its own list: two may switch at the same instant. */
static void compare_events(const struct trajectory *r, struct plant *pl, int seen[MODEL_CONTACTS],
                           struct trajectory_errors *worst)
{
    struct event e;
    while (plant_take_event(pl, &e)) {
        if (e.speed * pl->scale.time_s < 1e-6 * pl->scale.length_m)
            continue; /* a touch this slow is there or not by rounding */
        int c = e.contact, i = seen[c]++;
        worst->n_events++;
        if (i >= r->n_events[c])
            continue;
        double t = ((double)e.tick + e.fraction) * pl->tick_s;
        exact_worst(&worst->time, (long double)(fabs(t - r->event_t[c][i]) / pl->scale.time_s));
        exact_worst(&worst->speed, (long double)(fabs(e.speed - fabs(r->event_rate[c][i])) *
                                                 pl->scale.time_s / pl->scale.length_m));
        worst->kinds += e.touch != r->event_touch[c][i];
    }
}

/* The paper's state at time t, a rounding of the file away from now: along the tangent. */
static void state_at(const struct plant *pl, double t, double *state)
{
    double x_dot[MODEL_STATES], dt = (t - plant_time(pl)) / pl->scale.time_s;
    struct plant moved = *pl;
    pl->model->rhs(pl->p, pl->excitation.at[2], pl->x, x_dot);
    for (int k = 0; k < pl->model->n_states; k++)
        moved.x[k] += dt * x_dot[k];
    for (int i = 0; i < pl->model->n_inputs; i++)
        moved.excitation.at[2][i].value += dt * moved.excitation.at[2][i].rate;
    paper_now(&moved, state);
}

struct trajectory_errors trajectory_run(const struct trajectory *r, const struct method *method, double tol,
                                        double *work, double steps)
{
    struct plant pl;
    struct scale scale;
    struct trajectory_errors worst = {0};
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], state[MODEL_STATES];
    int seen[MODEL_CONTACTS] = {0};
    paper_prepare(r->model, r->paper, si, p, &scale);
    double spacing = r->t[r->n_samples - 1] / r->n_samples;
    double period = TWO_PI * scale.time_s / r->model->eigenfrequency(p);
    uint64_t ticks = (uint64_t)ceil(spacing * steps / period);
    trajectory_start(&pl, r->model, method, tol, work, r->paper, spacing / (double)ticks, r->start);
    for (int i = 0; i < r->n_samples; i++) {
        for (uint64_t done = 0; done < ticks; done++) {
            if (!plant_run(&pl, 1))
                check_true("the plant stays finite", 0);
            compare_events(r, &pl, seen, &worst);
        }
        state_at(&pl, r->t[i], state);
        for (int k = 0; k < r->model->n_states; k++)
            exact_worst(&worst.state, (long double)((state[k] - r->state[i][k]) / column_max(r, k)));
    }
    worst.residual = (int)pl.counts.residual;
    worst.budget = (int)(pl.counts.budget + pl.counts.work);
    return worst;
}
