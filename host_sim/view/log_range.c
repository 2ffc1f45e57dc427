/* log_range.c - see log_range.h. */
#include "host_sim/view/log_range.h"

#include <math.h>

enum { LATE = 64 }; /* rows: events come a few frames late */

/* ---- columns ---- */

/* The column of a tick, at the edge for one outside. */
static int column_of(const struct log_range *r, double tick)
{
    double k = r->to > r->from ? floor((tick - r->from) / (r->to - r->from) * r->n_columns) : 0.0;
    return (int)fmin(fmax(k, 0.0), r->n_columns - 1.0);
}

/* A bin in each column that it reaches into; what is counted, in the first one alone. */
static void add_bin(struct log_range *r, struct log_cell *c)
{
    if ((double)c->bin.to < r->from || (double)c->bin.from > r->to)
        return;
    int first = column_of(r, (double)c->bin.from), last = column_of(r, (double)c->bin.to);
    log_cell_merge(&r->column[first], c);
    for (int i = 0; i < LOG_MARKS; i++)
        c->bin.n[i] = 0;
    for (int k = first + 1; k <= last; k++)
        log_cell_merge(&r->column[k], c);
}

static void add_bins(struct log_range *r, const struct log_block *b, int level)
{
    struct log_cell c;
    for (int i = 0; i < b->n_bins[level]; i++) {
        log_block_cell(b, level, i, &c);
        add_bin(r, &c);
    }
    r->size = r->size < log_size[level] ? log_size[level] : r->size;
}

/* ---- rows from the file ---- */

/* The walk of an index, from a block on. */
static bool walk_from(const struct log_index *x, const struct log_block *b, struct log_walk *w)
{
    *w = x->walk;
    w->mark = NULL;
    return log_walk_go(w, &b->place);
}

struct reading {
    struct log_range *range;
    double tick_s;
};

static void take_mark(void *context, const struct log_mark *m)
{
    struct reading *g = context;
    struct log_range *r = g->range;
    double tick = m->t_s / g->tick_s;
    if (tick < r->from || tick > r->to)
        return;
    log_cell_mark(&r->column[column_of(r, tick)], m);
    if (r->n_marks < LOG_RANGE_MARKS)
        r->mark[r->n_marks++] = *m;
    else
        r->has_marks = false;
}

static void list_row(struct log_range *r, const struct decode_row *row)
{
    if (r->n_rows < LOG_ROWS)
        r->row[r->n_rows++] = *row;
    else
        r->has_rows = false;
}

static void take_row(struct log_range *r, const struct decode_row *row, const struct log_walk_plant *plant)
{
    bool before = (double)row->tick<r->from, after = (double)row->tick> r->to;
    if (!before && !after)
        log_cell_row(&r->column[column_of(r, (double)row->tick)], row, plant);
    if (before)
        r->n_rows = 0; /* one before is enough: the last one */
    if (!after || !r->has_after)
        list_row(r, row);
    r->has_after = r->has_after || after;
}

/* The rows of a block up to the end of the range. How many were read; 0 where the file cannot be read. */
static uint64_t add_rows(const struct log_index *x, struct log_range *r, const struct log_block *b)
{
    struct reading g = {.range = r, .tick_s = x->tick_s};
    struct log_walk w;
    struct decode_row row;
    uint64_t n = 0;
    if (!walk_from(x, b, &w))
        return 0;
    w.mark = take_mark;
    w.context = &g;
    while (n < b->rows && log_walk_next(&w, &row) > 0) {
        take_row(r, &row, &w.plant);
        n++;
        if ((double)row.tick > r->to + LATE * (double)x->step)
            break;
    }
    return n;
}

/* The greatest size whose bins are no longer than a column; -1: none is. */
static int level_for(const struct log_index *x, const struct log_range *r)
{
    double steps = (r->to - r->from) / r->n_columns / (double)x->step;
    int level = -1;
    while (level + 1 < LOG_LEVELS && steps >= log_size[level + 1])
        level++;
    return level;
}

/* Columns by rows where there are few, by bins where a whole block is shorter than a column. */
static bool add_block(const struct log_index *x, struct log_range *r, const struct log_block *b, int level,
                      uint64_t *budget)
{
    bool is_short = (double)(b->to - b->from) * r->n_columns < r->to - r->from;
    if (is_short)
        level = LOG_LEVELS - 1;
    else if (level < 0 && (*budget < b->rows || !log_index_has_rows(x)))
        level = 0;
    if (level >= 0) {
        r->has_rows = r->has_marks = false;
        add_bins(r, b, level);
        return true;
    }
    uint64_t n = add_rows(x, r, b);
    *budget -= n;
    return n > 0;
}

bool log_range_read(const struct log_index *x, struct log_range *r)
{
    uint64_t budget = LOG_RANGE_BUDGET;
    size_t i, end;
    bool good = log_index_run(x, r->run, &i, &end);
    int level = level_for(x, r);
    for (int k = 0; k < r->n_columns; k++)
        log_cell_begin(&r->column[k]);
    r->size = 1;
    r->has_after = false;
    r->n_rows = r->n_marks = 0;
    r->has_rows = r->has_marks = true;
    for (; good && i < end; i++)
        if ((double)x->block[i]->to >= r->from && (double)x->block[i]->from <= r->to)
            good = add_block(x, r, x->block[i], level, &budget);
    return good;
}

/* ---- one row, one mark ---- */

bool log_range_row(const struct log_index *x, unsigned run, double tick, struct decode_row *row)
{
    struct decode_row next;
    struct log_walk w;
    size_t i, end;
    if (!log_index_has_rows(x) || !log_index_run(x, run, &i, &end))
        return false;
    while (i + 1 < end && (double)x->block[i + 1]->from <= tick)
        i++;
    if (!walk_from(x, x->block[i], &w) || log_walk_next(&w, row) <= 0)
        return false;
    for (uint64_t n = 1; n < x->block[i]->rows && log_walk_next(&w, &next) > 0; n++) {
        if ((double)next.tick > tick)
            break;
        *row = next;
    }
    return true;
}

/* The nearest mark so far. */
struct nearest {
    double t_s;
    bool back, found;
    unsigned kinds;
    struct log_mark mark;
};

static void take_nearer(void *context, const struct log_mark *m)
{
    struct nearest *g = context;
    bool beyond = g->back ? m->t_s < g->t_s : m->t_s > g->t_s;
    bool nearer = !g->found || (g->back ? m->t_s > g->mark.t_s : m->t_s < g->mark.t_s);
    if (!(g->kinds >> m->kind & 1u) || !beyond || !nearer)
        return;
    g->mark = *m;
    g->found = true;
}

static bool has_mark(const struct log_block *b, unsigned kinds)
{
    struct log_cell c;
    for (int i = 0; i < b->n_bins[LOG_LEVELS - 1]; i++) {
        log_block_cell(b, LOG_LEVELS - 1, i, &c);
        for (int k = 0; k < LOG_MARKS; k++)
            if (kinds >> k & 1u && c.bin.n[k])
                return true;
    }
    return false;
}

static void look_in(const struct log_index *x, const struct log_block *b, struct nearest *g)
{
    struct decode_row row;
    struct log_walk w;
    if (!has_mark(b, g->kinds) || !walk_from(x, b, &w))
        return;
    w.mark = take_nearer;
    w.context = g;
    for (uint64_t n = 0; n < b->rows + LATE && log_walk_next(&w, &row) > 0 && row.run == b->run; n++) {
    }
}

bool log_range_mark(const struct log_index *x, unsigned run, double t_s, bool back, unsigned kinds,
                    struct log_mark *m)
{
    struct nearest g = {.t_s = t_s, .back = back, .kinds = kinds};
    size_t first, end;
    if (!log_index_has_rows(x) || !log_index_run(x, run, &first, &end))
        return false;
    for (size_t i = 0; i < end - first && !g.found; i++) {
        const struct log_block *b = x->block[back ? end - 1 - i : first + i];
        double margin = LATE * (double)x->step * x->tick_s;
        bool behind =
            back ? (double)b->from * x->tick_s > t_s + margin : (double)b->to * x->tick_s < t_s - margin;
        if (!behind)
            look_in(x, b, &g);
    }
    *m = g.mark;
    return g.found;
}
