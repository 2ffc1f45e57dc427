/* basin_rows.c - the columns of a basin map: the start, what became of it, its fingerprint, a state of the
 * attractor. */
#include "host_sim/maps/basin/basin.h"

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
    {"mean_", "", "of a state", ROWS_NUMBER, 9, .offset = AT(motion.mean)},
    {"rms_", "", "of a state", ROWS_NUMBER, 9, .offset = AT(motion.rms)},
    {"end_", "", "of a state at phase 0", ROWS_NUMBER, 17, .offset = AT(motion.end)},
};

double basin_unit(const struct basin *b, int i, const char **unit)
{
    const struct signal *s = &b->plant.model->state_signal[i];
    if (unit)
        *unit = scenes_dimensionless(&b->m.scene) ? "1" : s->unit;
    return scale_of(&b->plant.scale, s->quantity);
}

double basin_peak_unit(const struct basin *b)
{
    return scale_of(&b->plant.scale, b->plant.model->output_signal[b->plant.observable].quantity);
}

static void add(struct basin *b, struct rows_column c, double factor, int i, const char *item)
{
    c.factor = factor;
    rows_add_item(&b->m.rows, &c, i, item);
}

void basin_describe_rows(struct basin *b)
{
    const struct model *m = b->plant.model;
    rows_begin(&b->m.rows, sizeof(struct basin_row));
    rows_add(&b->m.rows, &start);
    for (int i = 0; i < m->n_states; i++)
        add(b, place_column, 1.0, i, m->state_signal[i].name);
    for (size_t k = 0; k < COLUMNS(motion_columns); k++)
        rows_add(&b->m.rows, &motion_columns[k]);
    add(b, peak, basin_peak_unit(b), 0, m->output_signal[b->plant.observable].name);
    for (size_t k = 0; k < COLUMNS(fingerprint); k++)
        for (int i = 0; i < m->n_states; i++)
            add(b, fingerprint[k], basin_unit(b, i, NULL), i, m->state_signal[i].name);
}
