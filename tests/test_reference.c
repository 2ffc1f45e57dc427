/* test_reference.c - every stored trajectory at 4096 steps per contact period.
 *
 * rig_trajectories.txt and model_trajectories.txt in tests/data: multi-precision results made without this code,
 * trusted to 1e-15. At this step rk4 is off by 7e-8 at most where contact is lost (order 2.5 at the Hertz kink) and by
 * 3e-10 elsewhere; 1e-6 catches any error of a model and leaves room for another compiler's rounding times the growth
 * (at most 4e5) of a chaotic case. */
#include "tests/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "models/hertz_rig.h"
#include "models/models.h"
#include "tests/exact.h"
#include "tests/paper.h"

void test_reference_trajectories(void);

enum { SAMPLES = 16, EVENTS = 64, LINE = 256, STEPS = 4096 };

struct reference {
    char name[64];
    const struct model *model;
    double paper[MODEL_PARAMETERS], growth, start[MODEL_STATES];
    double t[SAMPLES], state[SAMPLES][MODEL_STATES];
    double event_t[MODEL_CONTACTS][EVENTS], event_rate[MODEL_CONTACTS][EVENTS];
    int event_touch[MODEL_CONTACTS][EVENTS], n_events[MODEL_CONTACTS];
    int n_samples, n_events_total;
};

/* Worst errors of a case. */
struct errors {
    double state, time, speed;
    int kinds, n_events;
};

static const struct model *model_named(const char *name)
{
    for (int i = 0; i < MODELS; i++) {
        if (strcmp(name, model_table[i]->name) == 0)
            return model_table[i];
    }
    check_string("a model of the reference cases", name, "in the table");
    return &hertz_rig;
}

static void use_model(struct reference *r, const struct model *m)
{
    r->model = m;
    paper_defaults(m, r->paper);
}

static void read_numbers(const char *text, int n, double *x)
{
    char *end;
    for (int i = 0; i < n; i++, text = end)
        x[i] = strtod(text, &end);
}

static void read_event(struct reference *r, double t, const char *kind, double rate, int contact)
{
    int i = r->n_events[contact];
    if (i == EVENTS)
        return;
    r->event_t[contact][i] = t;
    r->event_touch[contact][i] = strcmp(kind, "touchdown") == 0;
    r->event_rate[contact][i] = rate;
    r->n_events[contact]++;
}

/* One line into the case; 1 at its end. */
static int read_line(struct reference *r, const char *line)
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
        if (i < 0)
            check_string("a parameter of a reference case", word, "one of the model's");
        r->paper[i >= 0 ? i : 0] = a;
    } else if (sscanf(line, "growth %lf", &a) == 1) {
        r->growth = a;
    } else if (strncmp(line, "start ", 6) == 0) {
        read_numbers(line + 6, r->model->n_states, r->start);
    } else if (sscanf(line, "sample %lf%n", &a, &n) == 1 && r->n_samples < SAMPLES) {
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

static double column_max(const struct reference *r, int column)
{
    double max = 0.0;
    for (int i = 0; i < r->n_samples; i++)
        max = fmax(max, fabs(r->state[i][column]));
    return max;
}

/* The events since the last call, each contact's against its own list: two may switch at the same instant. */
static void compare_events(const struct reference *r, struct plant *pl, int seen[MODEL_CONTACTS],
                           struct errors *worst)
{
    struct event e;
    while (plant_take_event(pl, &e)) {
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

static struct errors run_case(const struct reference *r)
{
    struct plant pl;
    struct scale scale;
    struct errors worst = {0};
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], state[MODEL_STATES];
    int seen[MODEL_CONTACTS] = {0};
    paper_prepare(r->model, r->paper, si, p, &scale);
    /* the samples are equally spaced to 1e-10; a whole number of steps between them */
    double spacing = r->t[r->n_samples - 1] / r->n_samples;
    double period = 6.283185307179586477 * scale.time_s / r->model->eigenfrequency(p);
    uint64_t steps = (uint64_t)ceil(spacing * STEPS / period);
    paper_start(&pl, r->model, r->paper, spacing / (double)steps, r->start);
    for (int i = 0; i < r->n_samples; i++) {
        /* a few ticks at a time: the plant keeps 32 events */
        for (uint64_t done = 0; done < steps; done += 64) {
            if (!plant_run(&pl, steps - done < 64 ? steps - done : 64))
                check_true("the plant stays finite", 0);
            compare_events(r, &pl, seen, &worst);
        }
        paper_now(&pl, state);
        for (int k = 0; k < r->model->n_states; k++)
            exact_worst(&worst.state, (long double)((state[k] - r->state[i][k]) / column_max(r, k)));
    }
    return worst;
}

static void check_case(const struct reference *r)
{
    struct errors worst = run_case(r);
    char text[128];
    snprintf(text, sizeof text, "%s: worst state error over its column's maximum", r->name);
    check_below(text, worst.state, 1e-6);
    if (r->n_events_total >= 0) {
        snprintf(text, sizeof text, "%s: contact switches", r->name);
        check_int(text, worst.n_events, r->n_events_total);
    }
    if (r->n_events_total > 0) {
        snprintf(text, sizeof text, "%s: worst switch instant error, model time", r->name);
        check_below(text, worst.time, 1e-5);
        snprintf(text, sizeof text, "%s: worst gap speed error at a switch, model units", r->name);
        check_below(text, worst.speed, 1e-5);
        check_int("switches of the wrong kind", worst.kinds, 0);
    }
}

static int check_file(const char *path)
{
    static struct reference r;
    char line[LINE];
    int cases = 0;
    FILE *f = fopen(path, "r");
    check_true("the file of cases is there (run from the project's top folder)", f != NULL);
    while (f && fgets(line, sizeof line, f)) {
        if (!read_line(&r, line))
            continue;
        check_case(&r);
        cases++;
    }
    if (f)
        fclose(f);
    return cases;
}

void test_reference_trajectories(void)
{
    check_int("reference cases of the rig", check_file("tests/data/rig_trajectories.txt"), 10);
    check_int("reference cases of the other models", check_file("tests/data/model_trajectories.txt"), 18);
}
