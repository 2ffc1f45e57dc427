/* record.c - see record.h. */
#include "tests/bench/ledger/record.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/method/taylor/taylor_piece.h"
#include "firmware/plant/plant_change.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/shaft_bearing.h"

#define TURN 6.283185307179586476925L

enum { SERIES_MAX = 2048 };

/* The rig and the tip keep contact. The shaft is the benchmark's C1, with 46 switches in four periods. */
static const struct scene {
    const char *name;
    const struct model *model;
    const struct method *method;
    double tol;
    int ticks;
    struct {
        const char *name;
        double value;
    } paper[6]; /* others as their tables have them */
    double state[2];
} scenes[RECORD_SCENES] = {
    {"rig_rk4", &hertz_rig, &rk4, 0.0, 128, {{"xi", 0.01}, {"sigma", 0.04}, {"omega", 0.9}}, {0.3, 0.0}},
    {"rig_taylor",
     &hertz_rig,
     &taylor,
     1e-9,
     128,
     {{"xi", 0.01}, {"sigma", 0.04}, {"omega", 0.9}},
     {0.3, 0.0}},
    {"tip",
     &afm_tip,
     &taylor,
     1e-9,
     128,
     {{"beta", 0.8}, {"c", 0.02}, {"f", 0.01}, {"omega", 1.3}, {"sign", -1.0}},
     {0.2, 0.0}},
    {"shaft",
     &shaft_bearing,
     &exact,
     0.0,
     512,
     {{"c1", 139.0}, {"c2", 139.0}, {"c3", 139.0}, {"p2", 25.0}, {"freq_hz", 25.0}},
     {0.9 * 2.54e-4, 0.0}},
};

static struct plant plant;
static struct record now;
static struct piece pieces[RECORD_PERIODS * 2 * RECORD_TICKS_MAX];
static struct series all_series[SERIES_MAX];
static double scratch[METHOD_SCRATCH];
static struct taylor_tally seen; /* in the tick before */

int record_ticks(int scene)
{
    return scenes[scene].ticks;
}

/* In place of the ledger's own rule, which single steps call by ledger_piece: `at` is a segment's at[1]. */
static double note(struct ledger *l, const double *p, const struct input (*at)[MODEL_INPUTS],
                   const double *x0, const double *x1)
{
    const struct segment *e =
        (const void *)((const char *)(const void *)at - offsetof(struct segment, at[1]));
    struct piece *to = &pieces[now.n_pieces++];
    size_t size = (size_t)now.model->n_states * sizeof *x0;
    (void)l, (void)p;
    to->e = *e;
    memcpy(to->x0, x0, size);
    memcpy(to->x1, x1, size);
    to->regime = plant.regime;
    to->whole = e->length == plant.h;
    return 0.0;
}

static void stop(const char *why)
{
    fprintf(stderr, "ledger_rules: %s\n", why);
    exit(1);
}

/* After a tick: the series that began in it, if any. Where one ended or a short one served the whole tick,
 * the series before holds no longer. */
static void note_series(const struct plant *pl)
{
    const struct taylor *t = (const struct taylor *)(const void *)scratch;
    double time = (double)pl->now.tick * pl->h, begin = time - t->now;
    if (pl->method != &taylor)
        return;
    bool new = t->count.time != seen.time, brief = t->count.brief != seen.brief;
    double over = new ? begin : time - pl->h;
    if ((new || brief) && now.n_series > 0 && all_series[now.n_series - 1].end > over)
        all_series[now.n_series - 1].end = over;
    seen = t->count;
    if (!new)
        return;
    if (now.n_series == SERIES_MAX)
        stop("more series than expected");
    struct series *s = &all_series[now.n_series++];
    memcpy(s->a, t->a, sizeof s->a);
    s->begin = begin;
    s->end = begin + t->end;
    s->cosine = cos(now.omega * begin);
    s->sine = sin(now.omega * begin);
}

static void take_paper(const struct scene *s, double *paper)
{
    for (int i = 0; i < s->model->n_paper; i++) {
        paper[i] = s->model->paper[i].initial;
        for (int k = 0; k < 6 && s->paper[k].name; k++)
            paper[i] = strcmp(s->paper[k].name, s->model->paper[i].name) == 0 ? s->paper[k].value : paper[i];
    }
}

static void begin_plant(const struct scene *s, int ticks, double tol)
{
    double si[MODEL_PARAMETERS], paper[MODEL_PARAMETERS], x[MODEL_STATES] = {0.0},
                                                          start[MODEL_STATES] = {s->state[0], s->state[1]};
    struct harmonic drive[MODEL_INPUTS];
    take_paper(s, paper);
    s->model->from_paper(paper, si, drive);
    for (now.input = 0; drive[now.input].amplitude == 0.0;)
        now.input++;
    const struct harmonic *d = &drive[now.input];
    static struct method bookless; /* the ledger's rules are wanted, not those of `exact` */
    bookless = *s->method;
    bookless.books = NULL;
    struct plant_config c = {.model = s->model,
                             .si = si,
                             .method = s->method->books ? &bookless : s->method,
                             .tick_s = (double)(TURN / (long double)d->omega) / ticks,
                             .dilation = 1.0,
                             .tol = tol,
                             .scratch = scratch};
    const char *why = plant_init(&plant, &c);
    if (why)
        stop(why);
    plant_drive_start(&plant, now.input, d->amplitude, (double)((long double)d->omega / TURN), d->phase);
    s->model->state_from_paper(plant.p, plant.segment.at[2], start, x);
    plant_set_state(&plant, x);
    now.amplitude = plant.segment.at[2][now.input].value;
    now.omega = d->omega * plant.scale.time_s;
}

const struct record *record_run(int scene, int ticks, bool exactly)
{
    const struct scene *s = &scenes[scene];
    now = (struct record){.name = s->name, .model = s->model, .ticks = ticks};
    seen = (struct taylor_tally){0, 0, 0, 0};
    begin_plant(s, ticks, exactly && s->tol > 0.0 ? METHOD_TOL_MIN : s->tol);
    plant.ledger.piece = note;
    plant.bind_run = NULL;
    now.p = plant.p;
    now.h = plant.h;
    now.piece = pieces;
    now.series = all_series;
    for (int i = 0; i < RECORD_PERIODS; i++) {
        for (int k = 0; k < ticks; k++) { /* tick by tick: each piece by itself */
            if (!plant_run(&plant, 1))
                stop("the motion has escaped");
            note_series(&plant);
        }
        now.period[i + 1] = now.n_pieces;
    }
    if ((plant.counts.switches > 0) != (s->method == &exact))
        stop("a contact that is kept has switched, or none has");
    return &now;
}
