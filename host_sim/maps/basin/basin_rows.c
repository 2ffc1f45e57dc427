/* basin_rows.c - see basin_rows.h. */
#include "host_sim/maps/basin/basin_rows.h"

#include <string.h>

#define AT(member)       offsetof(struct basin_row, member)
#define COLUMNS(columns) (sizeof columns / sizeof columns[0])

static const struct rows_column start = {"start", "", "its number", ROWS_COUNT, .offset = AT(start)};
static const struct rows_column place_column = {"", "", "where it starts", ROWS_NUMBER, 17, .offset = AT(x)};
static const struct rows_column motion_columns[] = {
    {"outcome", "", "what became of it", ROWS_WORD, .offset = AT(motion.outcome),
     .words = basin_outcome_name},
    {"period", "", "forcing periods", ROWS_COUNT, .offset = AT(motion.period)},
    {"periods", "", "until it was told", ROWS_COUNT, .offset = AT(motion.periods)},
    {"growth", "", "of a small distance in a forcing period, logarithm", ROWS_NUMBER, 6,
     .offset = AT(motion.growth)},
    {"open", "", "share of time without contact", ROWS_NUMBER, 6, .offset = AT(motion.open)},
};
static const struct rows_column peak = {"peak_",     "", "of the observable",
                                        ROWS_NUMBER, 9,  .offset = AT(motion.peak)};
static const struct rows_column fingerprint[] = {
    {"mean_", "", "of a state of the model", ROWS_NUMBER, 9, .offset = AT(motion.mean)},
    {"rms_", "", "of a state of the model", ROWS_NUMBER, 9, .offset = AT(motion.rms)},
};
static const struct rows_column end = {"end_",      "", "of a state at phase 0",
                                       ROWS_NUMBER, 17, .offset = AT(end)};

const char *basin_unit(const struct basin *b, int i)
{
    return scenes_dimensionless(&b->m.scene) ? "" : b->plant.model->state_signal[i].unit;
}

void basin_show(const struct basin *b, const double *x, double *shown)
{
    scenes_show_state(&b->m.scene, b->plant.p, &b->plant.scale, b->plant.begin, x, shown);
}

void basin_take(const struct basin *b, const double *shown, double *x)
{
    scenes_take_state(&b->m.scene, b->plant.p, &b->plant.scale, b->plant.begin, shown, x);
}

double basin_peak_unit(const struct basin *b)
{
    return scale_of(&b->plant.scale, b->plant.model->output_signal[b->plant.observable].quantity);
}

static void add(struct basin *b, struct rows_column c, const char *unit, int i, const char *item)
{
    c.unit = unit;
    rows_add_item(&b->m.rows, &c, i, item);
}

/* A state as the scene writes it. */
static void add_state(struct basin *b, struct rows_column c, int i)
{
    add(b, c, basin_unit(b, i), i, scenes_state_name(&b->m.scene, i));
}

static void add_peak(struct basin *b, const struct signal *s)
{
    struct rows_column c = peak;
    bool bare = scenes_dimensionless(&b->m.scene) || !strcmp(s->unit, "1");
    c.factor = basin_peak_unit(b);
    add(b, c, bare ? "" : s->unit, 0, s->name);
}

/* A state of the model, whatever the scene calls it: a mean square has no inverse into a paper's symbols. */
static void add_fingerprint(struct basin *b, struct rows_column c, int i)
{
    const struct signal *s = &b->plant.model->state_signal[i];
    c.factor = scale_of(&b->plant.scale, s->quantity);
    add(b, c, basin_unit(b, i), i, s->name);
}

void basin_describe_rows(struct basin *b)
{
    const struct model *m = b->plant.model;
    rows_begin(&b->m.rows, sizeof(struct basin_row));
    rows_add(&b->m.rows, &start);
    for (int i = 0; i < m->n_states; i++)
        add_state(b, place_column, i);
    for (size_t k = 0; k < COLUMNS(motion_columns); k++)
        rows_add(&b->m.rows, &motion_columns[k]);
    add_peak(b, &m->output_signal[b->plant.observable]);
    for (size_t k = 0; k < COLUMNS(fingerprint); k++)
        for (int i = 0; i < m->n_states; i++)
            add_fingerprint(b, fingerprint[k], i);
    for (int i = 0; i < m->n_states; i++)
        add_state(b, end, i);
}
