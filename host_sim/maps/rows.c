/* rows.c - writes and reads the rows of a map by its table of columns. */
#include "host_sim/maps/rows.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/unit.h"
#include "host_sim/out/cell.h"
#include "host_sim/scene/scene_range.h"

void rows_begin(struct rows *t, size_t size)
{
    t->size = size;
    t->n = t->n_given = 0;
    *t->header = '\0';
}

void rows_add_item(struct rows *t, const struct rows_column *c, int i, const char *item)
{
    char bare[ROWS_NAME];
    size_t length = strlen(t->header);
    snprintf(bare, sizeof bare, "%s%s", c->name, item);
    scene_range_spell(t->name[t->n], ROWS_NAME, bare, c->unit);
    snprintf(t->header + length, sizeof t->header - length, "%s%s", t->n ? "," : "", t->name[t->n]);
    t->column[t->n] = *c;
    t->column[t->n].offset += (size_t)i * sizeof(double);
    if (!(c->factor > 0.0))
        t->column[t->n].factor = 1.0;
    t->n++;
}

void rows_add(struct rows *t, const struct rows_column *c)
{
    rows_add_item(t, c, 0, "");
}

const struct rows_column *rows_find(const struct rows *t, size_t offset)
{
    int i = 0;
    while (t->column[i].offset != offset)
        i++;
    return &t->column[i];
}

/* ---- writing ---- */

static void write_number(double value, int digits, FILE *f)
{
    char text[UNIT_TEXT] = "";
    if (digits)
        cell_put(f, value, digits);
    else if (isfinite(value))
        unit_write(value, "", text);
    fputs(text, f);
}

static void write_turns(const char *at, int n, FILE *f)
{
    for (int i = 0; i < n; i++) {
        uint64_t turns;
        memcpy(&turns, at + (size_t)i * sizeof turns, sizeof turns);
        fprintf(f, i ? ":%016" PRIx64 : "%016" PRIx64, turns);
    }
}

static void write_cell(const struct rows_column *c, const char *at, FILE *f)
{
    double value;
    int count;
    if (c->type == ROWS_NUMBER) {
        memcpy(&value, at, sizeof value);
        write_number(value * c->factor, c->digits, f);
    } else if (c->type == ROWS_TURNS) {
        write_turns(at, c->count, f);
    } else {
        memcpy(&count, at, sizeof count);
        if (c->type == ROWS_WORD)
            fputs(c->words[count], f);
        else
            fprintf(f, "%d", count);
    }
}

void rows_write(const struct rows *t, const void *row, bool result, FILE *f)
{
    for (int i = 0; i < t->n; i++) {
        if (i)
            fputc(',', f);
        if (result || i < t->n_given)
            write_cell(&t->column[i], (const char *)row + t->column[i].offset, f);
    }
    fputc('\n', f);
}

/* ---- reading: each function returns where the value ends, or `text` where there is no value ---- */

/* An empty cell; `nan` in rows of versions before. */
static const char *read_nothing(const struct rows_column *c, const char *text, char *at)
{
    const double nothing = (double)NAN;
    if (c->type == ROWS_NUMBER)
        memcpy(at, &nothing, sizeof nothing);
    return !strncmp(text, "nan", 3) ? text + 3 : text;
}

static const char *read_number(const struct rows_column *c, const char *text, char *at)
{
    char *end;
    double value = strtod(text, &end) / c->factor;
    memcpy(at, &value, sizeof value);
    return end;
}

static const char *read_count(const char *text, char *at)
{
    char *end;
    int value = (int)strtol(text, &end, 10);
    memcpy(at, &value, sizeof value);
    return end;
}

static const char *read_word(const struct rows_column *c, const char *text, char *at)
{
    size_t n = strcspn(text, ",\n");
    for (int i = 0; c->words[i]; i++) {
        if (strlen(c->words[i]) == n && !strncmp(text, c->words[i], n)) {
            memcpy(at, &i, sizeof i);
            return text + n;
        }
    }
    return text;
}

static const char *read_turns(const struct rows_column *c, const char *text, char *at)
{
    const char *next = text;
    for (int i = 0; i < c->count; i++) {
        char *end;
        uint64_t turns = strtoull(next, &end, 16);
        bool last = i + 1 == c->count;
        if (end == next || (!last && *end != ':'))
            return text;
        memcpy(at + (size_t)i * sizeof turns, &turns, sizeof turns);
        next = end + !last;
    }
    return next;
}

static const char *read_cell(const struct rows_column *c, const char *text, char *at)
{
    return c->type == ROWS_NUMBER  ? read_number(c, text, at)
           : c->type == ROWS_COUNT ? read_count(text, at)
           : c->type == ROWS_WORD  ? read_word(c, text, at)
                                   : read_turns(c, text, at);
}

bool rows_read(const struct rows *t, const char *line, void *row)
{
    memset(row, 0, t->size);
    for (int i = 0; i < t->n; i++) {
        const struct rows_column *c = &t->column[i];
        bool nothing = (c->type == ROWS_NUMBER || c->type == ROWS_TURNS) &&
                       (*line == ',' || *line == '\n' || !strncmp(line, "nan", 3));
        char *at = (char *)row + c->offset;
        const char *end = nothing ? read_nothing(c, line, at) : read_cell(c, line, at);
        if (!nothing && (end == line || isspace((unsigned char)*line)))
            return false;
        if (*end != (i + 1 < t->n ? ',' : '\n'))
            return false;
        line = end + 1;
    }
    return true;
}

/* ---- a whole file ---- */

struct load {
    const struct rows *t;
    struct rows_table *table;
    int room;
    unsigned run;
    struct jobs_chain chain;
};

static bool make_room(struct load *l)
{
    if (l->table->n < l->room)
        return true;
    l->room = l->room ? 2 * l->room : 1024;
    int *job = realloc(l->table->job, (size_t)l->room * sizeof *job);
    l->table->job = job ? job : l->table->job;
    char *row = realloc(l->table->row, (size_t)l->room * l->t->size);
    l->table->row = row ? row : l->table->row;
    return job && row;
}

/* NULL, or what is wrong with this line. */
static const char *take_line(struct load *l, char *line)
{
    struct rows_table *table = l->table;
    int i = table->n, own = 0;
    unsigned run;
    bool fits = jobs_row_fits(&l->chain, line);
    if (!make_room(l))
        return "no memory for this row, nor those behind it";
    if (sscanf(line, "%8x,%d,%n", &run, &table->job[i], &own) != 2 || !own ||
        !rows_read(l->t, line + own, table->row + (size_t)i * l->t->size))
        return "no row of this map; give its whole file, and the scene it is of";
    if (i > 0 && run != l->run)
        return "a row of another map; join shares of one command by contactplant merge";
    if (!fits)
        return "changed since it was written; give the command that wrote the rows its --out again, without "
               "this line and what follows";
    l->run = run;
    table->n++;
    return NULL;
}

int rows_load_from(const struct options *o, const struct rows *t, const char *path, FILE *f,
                   struct rows_table *table)
{
    char line[JOBS_LINE], header[JOBS_LINE];
    struct load l = {.t = t, .table = table, .chain = JOBS_CHAIN};
    const char *wrong = NULL;
    int number = 1;
    *table = (struct rows_table){.size = t->size};
    jobs_header(t->header, header);
    if (!fgets(line, sizeof line, f) || strcmp(line, header))
        wrong = *line == '#' ? "a share of a map; join all of them by contactplant merge"
                             : "not the header of this map; give its whole file, and the scene it is of";
    for (; !wrong && fgets(line, sizeof line, f); number++)
        wrong = take_line(&l, line);
    if (!wrong && table->n == 0)
        wrong = "no rows";
    return wrong ? options_misuse(o->usage, "%s:%d: %s", path, number, wrong) : 0;
}

int rows_load(const struct options *o, const struct rows *t, const char *path, struct rows_table *table)
{
    FILE *f = fopen(path, "r");
    *table = (struct rows_table){.size = t->size};
    if (!f)
        return options_misuse(o->usage, "%s: %s; give the rows of a map", path, strerror(errno));
    int status = rows_load_from(o, t, path, f, table);
    (void)fclose(f);
    return status;
}

void rows_free(struct rows_table *table)
{
    free(table->job);
    free(table->row);
}
