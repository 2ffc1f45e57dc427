/* log_index.c - see log_index.h. */
#include "host_sim/view/log_index.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const unsigned log_size[LOG_LEVELS] = {64, 512, LOG_BLOCK_TICKS};

/* ---- cells ---- */

void log_cell_begin(struct log_cell *c)
{
    memset(&c->bin, 0, sizeof c->bin);
    c->bin.state = LOG_NO_STATE;
    for (int i = 0; i < LOG_SIGNALS; i++)
        c->band[i].low = c->band[i].high = (double)NAN;
}

static void widen(struct log_band *b, double low, double high)
{
    if (low < b->low || isnan(b->low))
        b->low = low;
    if (high > b->high || isnan(b->high))
        b->high = high;
}

void log_cell_row(struct log_cell *c, const struct decode_row *row, const struct log_walk_plant *plant)
{
    struct log_bin *b = &c->bin;
    b->ticks += !b->rows || row->tick != b->to;
    b->from = b->rows ? b->from : row->tick;
    b->to = row->tick;
    b->rows++;
    b->known += row->contact_known;
    b->closed += row->contact_known && row->closed;
    b->state = row->state >= 0 ? (uint8_t)row->state : LOG_NO_STATE;
    b->session = (uint8_t)plant->session;
    b->faults |= (uint8_t)plant->faults;
    b->beyond |= (uint8_t)row->beyond;
    for (int i = 0; i < DECODE_SIGNALS; i++)
        widen(&c->band[i], row->value[i], row->value[i]);
}

void log_cell_mark(struct log_cell *c, const struct log_mark *m)
{
    c->bin.n[m->kind] += (uint32_t)fmin(m->n, 1e9);
    if (m->kind == LOG_MARK_TOUCHDOWN)
        widen(&c->band[LOG_SPEED], m->speed, m->speed);
}

void log_cell_merge(struct log_cell *c, const struct log_cell *more)
{
    struct log_bin *b = &c->bin;
    const struct log_bin *m = &more->bin;
    if (m->rows) {
        b->from = b->rows ? b->from : m->from;
        b->to = m->to;
        b->state = m->state;
        b->session = m->session;
    }
    b->rows += m->rows;
    b->ticks += m->ticks;
    b->known += m->known;
    b->closed += m->closed;
    b->faults |= m->faults;
    b->beyond |= m->beyond;
    for (int i = 0; i < LOG_MARKS; i++)
        b->n[i] += m->n[i];
    for (int i = 0; i < LOG_SIGNALS; i++)
        widen(&c->band[i], more->band[i].low, more->band[i].high);
}

/* ---- blocks ---- */

static bool is_hole(const struct log_index *x, uint64_t from, uint64_t to, unsigned size)
{
    return x->step != UINT64_MAX && to > from && (to - from) / size >= x->step;
}

/* Bins of one size more, of those before it in cell[0 .. n). Returns how many. */
static int coarsen(const struct log_index *x, unsigned size, const struct log_cell *cell, int n,
                   struct log_cell *to)
{
    int made = 0;
    for (int i = 0; i < n; i++) {
        bool more = made && to[made - 1].bin.ticks + cell[i].bin.ticks <= size &&
                    !is_hole(x, to[made - 1].bin.to, cell[i].bin.from, size);
        if (!more)
            log_cell_begin(&to[made++]);
        log_cell_merge(&to[made - 1], &cell[i]);
    }
    return made;
}

static unsigned present_in(const struct log_cell *cell, int n)
{
    unsigned present = 0;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < LOG_SIGNALS; k++)
            present |= isnan(cell[i].band[k].low) ? 0u : 1u << k;
    return present;
}

/* The bins of one cell after the other, and of their bands those that are present. */
static void pack(struct log_block *b, const struct log_cell *cell, int n, int *at, int width)
{
    for (int i = 0; i < n; i++, ++*at) {
        struct log_band *band = b->band + (size_t)*at * (size_t)width;
        b->bin[*at] = cell[i].bin;
        for (int k = 0; k < LOG_SIGNALS; k++)
            if (b->present >> k & 1u)
                *band++ = cell[i].band[k];
    }
}

static int count_bits(unsigned bits)
{
    int n = 0;
    for (; bits; bits &= bits - 1)
        n++;
    return n;
}

/* Memory for its bins and bands; false without. */
static bool make_room(struct log_index *x, struct log_block *b, int n)
{
    size_t width = (size_t)count_bits(b->present);
    size_t size = (size_t)n * (sizeof *b->bin + width * sizeof *b->band);
    b->bin = malloc(size);
    b->band = b->bin ? (struct log_band *)(void *)(b->bin + n) : NULL;
    x->bytes += size + sizeof *b;
    return b->bin != NULL;
}

static bool keep_block(struct log_index *x)
{
    if (x->n_blocks == x->room) {
        size_t room = x->room ? 2 * x->room : 64;
        struct log_block **more = realloc(x->block, room * sizeof *more);
        if (!more)
            return false;
        x->block = more;
        x->room = room;
    }
    x->block[x->n_blocks++] = x->open;
    x->open = NULL;
    return true;
}

/* The open block is whole. False: out of memory. */
static bool end_block(struct log_index *x)
{
    static struct log_cell coarse[LOG_LEVELS - 1][LOG_BLOCK_BINS];
    const struct log_cell *level[LOG_LEVELS] = {x->cell, coarse[0], coarse[1]};
    struct log_block *b = x->open;
    int at = 0, n = x->n_cells;
    b->n_bins[0] = x->n_cells;
    for (int i = 1; i < LOG_LEVELS; i++) {
        b->n_bins[i] = coarsen(x, log_size[i], level[i - 1], b->n_bins[i - 1], coarse[i - 1]);
        n += b->n_bins[i];
    }
    b->present = present_in(x->cell, x->n_cells);
    b->from = x->cell[0].bin.from;
    b->to = x->cell[x->n_cells - 1].bin.to;
    if (!make_room(x, b, n))
        return false;
    for (int i = 0; i < LOG_LEVELS; i++)
        pack(b, level[i], b->n_bins[i], &at, count_bits(b->present));
    return keep_block(x);
}

bool log_index_has_rows(const struct log_index *x)
{
    return x->walk.log.log.reader.file != NULL;
}

static bool begin_block(struct log_index *x)
{
    x->open = calloc(1, sizeof *x->open);
    x->n_cells = 0;
    x->open_ticks = 0;
    if (!x->open)
        return false;
    if (log_index_has_rows(x))
        log_walk_tell(&x->walk, &x->open->place);
    x->open->run = x->walk.log.rows.row.run;
    return true;
}

void log_block_cell(const struct log_block *b, int level, int i, struct log_cell *c)
{
    for (int k = 0; k < level; k++)
        i += b->n_bins[k];
    const struct log_band *band = b->band + (size_t)i * (size_t)count_bits(b->present);
    log_cell_begin(c);
    c->bin = b->bin[i];
    for (int k = 0; k < LOG_SIGNALS; k++)
        if (b->present >> k & 1u)
            c->band[k] = *band++;
}

/* ---- all of it ---- */

static void take_mark(void *context, const struct log_mark *m)
{
    struct log_index *x = context;
    log_cell_mark(&x->next, m);
}

/* A row, and what came with it, which is in `next`. */
static void add_row(struct log_index *x, const struct decode_row *row)
{
    struct log_cell *c = x->n_cells ? &x->cell[x->n_cells - 1] : NULL;
    uint64_t before = x->open->rows ? x->last : row->tick;
    if (row->tick > before && row->tick - before < x->step)
        x->step = row->tick - before;
    if (!c || c->bin.ticks >= log_size[0] || is_hole(x, before, row->tick, log_size[0])) {
        c = &x->cell[x->n_cells++];
        log_cell_begin(c);
    }
    log_cell_row(&x->next, row, &x->walk.plant);
    log_cell_merge(c, &x->next);
    log_cell_begin(&x->next);
    x->open_ticks += row->tick != before || !x->open->rows;
    x->open->rows++;
    x->rows++;
    x->last = row->tick;
}

/* The next row, which the walk has begun, is another block's. */
static bool is_whole(const struct log_index *x)
{
    return x->open_ticks >= LOG_BLOCK_TICKS || x->open->rows >= LOG_BLOCK_ROWS ||
           x->n_cells == LOG_BLOCK_BINS || x->walk.log.rows.row.run != x->open->run;
}

/* All rows that are there: 0, -1 for a file that cannot be read, -2 without memory. */
static int read_rows(struct log_index *x)
{
    struct decode_row row;
    int got;
    x->walk.mark = take_mark;
    x->walk.context = x;
    while ((got = log_walk_next(&x->walk, &row)) > 0) {
        add_row(x, &row);
        if (is_whole(x) && !(end_block(x) && begin_block(x)))
            return -2;
    }
    if (x->open && x->open->rows && !end_block(x))
        return -2;
    return got;
}

static void free_block(struct log_block *b)
{
    if (b)
        free(b->bin);
    free(b);
}

/* The reason why read_rows has ended so. */
static const char *reason_of(struct log_index *x, int got)
{
    const char *why = got == -1 ? x->walk.log.log.reader.reason : "out of memory";
    snprintf(x->why, sizeof x->why, "%s", why);
    return got == 0 ? NULL : x->why;
}

const char *log_index_more(struct log_index *x)
{
    struct log_walk_place place;
    struct log_block *b = x->n_blocks ? x->block[x->n_blocks - 1] : NULL;
    if (!b)
        return NULL;
    place = b->place;
    x->rows -= b->rows;
    x->n_blocks--;
    free_block(b);
    free_block(x->open);
    log_cell_begin(&x->next);
    int got = !log_walk_go(&x->walk, &place) ? -1 : begin_block(x) ? read_rows(x) : -2;
    return reason_of(x, got);
}

const char *log_index_open(struct log_index *x, const char *path, const char *interface,
                           const struct wire_scene *scene, double tick_s)
{
    const char *why = log_walk_open(&x->walk, path, interface, scene, tick_s);
    if (why)
        return why;
    log_index_begin(x, tick_s);
    int got = begin_block(x) ? read_rows(x) : -2;
    why = reason_of(x, got);
    if (why)
        log_index_close(x);
    return why;
}

/* ---- rows from elsewhere ---- */

static const char *const no_memory = "out of memory";

void log_index_begin(struct log_index *x, double tick_s)
{
    x->tick_s = tick_s;
    x->step = UINT64_MAX;
    log_cell_begin(&x->next);
}

const char *log_index_add(struct log_index *x, const struct decode_row *row)
{
    x->walk.log.rows.row.run = row->run;
    if (x->open && is_whole(x) && !end_block(x))
        return no_memory;
    if (!x->open && !begin_block(x))
        return no_memory;
    add_row(x, row);
    return NULL;
}

const char *log_index_end(struct log_index *x)
{
    return !x->open || end_block(x) ? NULL : no_memory;
}

bool log_index_run(const struct log_index *x, unsigned run, size_t *first, size_t *end)
{
    size_t i = 0, n = x->n_blocks;
    while (n > 0) { /* bounded: halves */
        size_t half = n / 2;
        bool before = x->block[i + half]->run < run;
        i = before ? i + half + 1 : i;
        n = before ? n - half - 1 : half;
    }
    *first = *end = i;
    while (*end < x->n_blocks && x->block[*end]->run == run)
        ++*end;
    return *end > *first;
}

void log_index_close(struct log_index *x)
{
    for (size_t i = 0; i < x->n_blocks; i++)
        free_block(x->block[i]);
    free_block(x->open);
    free(x->block);
    x->block = NULL;
    x->open = NULL;
    x->n_blocks = 0;
    if (log_index_has_rows(x))
        decode_log_close(&x->walk.log);
}
