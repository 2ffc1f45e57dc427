/* rows.h - the rows of a map: one table of columns, from which header, writing, reading and look-up
 * follow.
 *
 * A command has a struct for its row and describes each value in it once:
 *
 *   const struct rows_column speed = {"speed", "m/s", "at the end", ROWS_NUMBER, 9, offsetof(struct own, v)};
 *   rows_begin(&t, sizeof(struct own));
 *   rows_add(&t, &speed);
 *   rows_write(&t, &own, true, file);
 *
 * Columns stand in the file in the order in which they were added, behind `run` and `job` and before
 * `check` (host_sim/maps/jobs.h). */
#ifndef HOST_SIM_ROWS_H
#define HOST_SIM_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include "host_sim/maps/jobs.h"

enum { ROWS_COLUMNS = 320, ROWS_NAME = 96 };

enum rows_type {
    ROWS_NUMBER, /* double */
    ROWS_COUNT,  /* int */
    ROWS_WORD,   /* enum: index of the words */
    ROWS_TURNS   /* uint64_t[count]: hex digits, with colons in between */
};

struct rows_column {
    const char *name;
    const char *unit;    /* follows the name, "force" and "N" give force_N; "" for none */
    const char *meaning; /* in a chart */
    enum rows_type type;
    int digits;    /* significant ones of a number; 0: the fewest that read back to the same bits */
    size_t offset; /* where the value is in the command's row */
    double factor; /* from the number in the row to that in the file; 0 stands for 1 */
    const char *const *words; /* for ROWS_WORD, NULL behind the last */
    int count;                /* for ROWS_TURNS */
};

struct rows {
    size_t size; /* bytes of the command's row */
    int n;
    int n_given; /* columns that a row without a result has, too; the others are empty there. 0: all */
    struct rows_column column[ROWS_COLUMNS];
    char name[ROWS_COLUMNS][ROWS_NAME]; /* with unit */
    char header[JOBS_LINE - 32];        /* the names, with commas; jobs_header adds some bytes */
};

void rows_begin(struct rows *t, size_t size);

/* Adds a column; or item i of an array of doubles, whose name follows the column's. */
void rows_add(struct rows *t, const struct rows_column *c);
void rows_add_item(struct rows *t, const struct rows_column *c, int i, const char *item);

/* The column of the value at this offset; the value must have one. */
const struct rows_column *rows_find(const struct rows *t, size_t offset);

/* One line. A number that is not finite is an empty cell; so, without a result, is each one behind the
 * n_given first columns. */
void rows_write(const struct rows *t, const void *row, bool result, FILE *f);

/* Reads back a row of rows_write from a line without run, job and check. False when the line does not have
 * these columns. */
bool rows_read(const struct rows *t, const char *line, void *row);

/* A whole file. */
struct rows_table {
    int n;
    size_t size; /* bytes of the command's row */
    int *job;    /* [n] */
    char *row;   /* n times the command's row */
};

static inline const void *rows_row(const struct rows_table *table, int i)
{
    return &table->row[(size_t)i * table->size];
}

/* Every row of a file of this map, each as it was written. 0, or the exit status after a line; rows_free
 * in both cases. */
int rows_load(const struct options *o, const struct rows *t, const char *path, struct rows_table *table);
int rows_load_from(const struct options *o, const struct rows *t, const char *path, FILE *f,
                   struct rows_table *table);
void rows_free(struct rows_table *table);

#endif
