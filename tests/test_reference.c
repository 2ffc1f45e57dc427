/* test_reference.c - every stored trajectory of the rig at 4096 steps per slow period.
 *
 * tests/data/rig_trajectories.txt: multi-precision results made without this code, trusted to 1e-15. */
#include "tests/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "tests/rig.h"

void test_reference_trajectories(void);

enum { SAMPLES = 16, EVENTS = 64, LINE = 256 };

struct reference {
    char name[64];
    double paper[PAPER], growth, start[2];
    double t[SAMPLES], state[SAMPLES][2];
    double event_t[EVENTS], event_rate[EVENTS];
    int event_touch[EVENTS];
    int n_samples, n_events, n_events_total;
};

static int parameter_index(const char *name)
{
    static const char *const names[PAPER] = {"xi",    "sigma",   "omega",  "phi",
                                             "Omega", "a_force", "a_base", "a_stiff"};
    for (int i = 0; i < PAPER; i++) {
        if (strcmp(name, names[i]) == 0)
            return i;
    }
    return -1;
}

/* One line into the case; 1 at its end. */
static int read_line(struct reference *r, const char *line)
{
    char word[64];
    double a, b, c;
    if (sscanf(line, "case %63s", word) == 1) {
        memset(r, 0, sizeof *r);
        rig_paper(r->paper);
        snprintf(r->name, sizeof r->name, "%s", word);
    } else if (sscanf(line, "parameter %63s %lf", word, &a) == 2 && parameter_index(word) >= 0) {
        r->paper[parameter_index(word)] = a;
    } else if (sscanf(line, "growth %lf", &a) == 1) {
        r->growth = a;
    } else if (sscanf(line, "start %lf %lf", &a, &b) == 2) {
        r->start[0] = a;
        r->start[1] = b;
    } else if (sscanf(line, "sample %lf %lf %lf", &a, &b, &c) == 3 && r->n_samples < SAMPLES) {
        r->t[r->n_samples] = a;
        r->state[r->n_samples][0] = b;
        r->state[r->n_samples++][1] = c;
    } else if (sscanf(line, "event %lf %63s %lf", &a, word, &b) == 3 && r->n_events < EVENTS) {
        r->event_t[r->n_events] = a;
        r->event_touch[r->n_events] = strcmp(word, "touchdown") == 0;
        r->event_rate[r->n_events++] = b;
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

static void check_case(const struct reference *r)
{
    struct plant pl;
    struct event e;
    /* the samples are equally spaced to 1e-10; a whole number of steps between them, at least 4096 a period */
    double spacing = r->t[r->n_samples - 1] / r->n_samples;
    double period = 6.283185307179586477 / r->paper[OMEGA];
    uint64_t steps = (uint64_t)ceil(spacing * 4096.0 / period);
    double error[2] = {0, 0}, event_error = 0.0, speed_error = 0.0;
    int n_events = 0, kinds_wrong = 0;
    char text[128];
    rig_start(&pl, r->paper, spacing / (double)steps, r->start[0], r->start[1]);
    for (int i = 0; i < r->n_samples; i++) {
        rig_run(&pl, steps);
        error[0] = fmax(error[0], fabs(rig_q(&pl) - r->state[i][0]) / column_max(r, 0));
        error[1] = fmax(error[1], fabs(rig_q_dot(&pl) - r->state[i][1]) / column_max(r, 1));
        while (plant_take_event(&pl, &e)) {
            if (n_events < r->n_events) {
                double t = ((double)e.tick + e.fraction) * pl.tick_s;
                event_error = fmax(event_error, fabs(t - r->event_t[n_events]));
                speed_error = fmax(speed_error, fabs(e.speed - fabs(r->event_rate[n_events])));
                kinds_wrong += e.touch != r->event_touch[n_events];
            }
            n_events++;
        }
    }
    snprintf(text, sizeof text, "%s: worst q error over its maximum", r->name);
    check_below(text, error[0], 1e-6);
    snprintf(text, sizeof text, "%s: worst q_dot error over its maximum", r->name);
    check_below(text, error[1], 1e-6);
    snprintf(text, sizeof text, "%s: contact switches", r->name);
    check_int(text, n_events, r->n_events_total);
    if (r->n_events > 0) {
        snprintf(text, sizeof text, "%s: worst switch instant error, model time", r->name);
        check_below(text, event_error, 1e-5);
        snprintf(text, sizeof text, "%s: worst gap speed error at a switch", r->name);
        check_below(text, speed_error, 1e-5);
        check_int("switches of the wrong kind", kinds_wrong, 0);
    }
}

void test_reference_trajectories(void)
{
    static struct reference r;
    char line[LINE];
    int cases = 0;
    FILE *f = fopen("tests/data/rig_trajectories.txt", "r");
    check_true("tests/data/rig_trajectories.txt is there (run from the project's top folder)", f != NULL);
    while (f && fgets(line, sizeof line, f)) {
        if (!read_line(&r, line))
            continue;
        check_case(&r);
        cases++;
    }
    check_int("reference cases", cases, 10);
    if (f)
        fclose(f);
}
