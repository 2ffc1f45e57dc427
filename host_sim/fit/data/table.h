/* table.h - a data file as a table: lines `# key = value unit`, a header with units, rows of numbers with
 * commas between them. Or tabs, and the header is a comment with tabs, as in a .tab of afmformats. Each
 * mistake is one line with file, line and column. Functions that return a status have printed it when it is
 * not 0. */
#ifndef HOST_SIM_FIT_TABLE_H
#define HOST_SIM_FIT_TABLE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include "host_sim/cli/options.h"

enum { TABLE_CELLS = 320, TABLE_LINE = 8192, TABLE_KEYS = 8, TABLE_KEY = 16 };

struct table {
    const struct usage *usage;
    const char *path;
    FILE *f;
    uint32_t crc; /* CRC-32 of the bytes so far; begins as the caller says */
    int line;
    char text[TABLE_LINE], header[TABLE_LINE];
    bool tabs;                     /* between the cells, instead of commas */
    int n;                         /* cells of the line */
    const char *cell[TABLE_CELLS]; /* without blanks around */
    int column[TABLE_CELLS];       /* where it begins, from 1 */
    int n_name;
    const char *name[TABLE_CELLS]; /* cells of the header */
    /* For each `# key = value` before the header. */
    int (*key)(struct table *t, void *context, const char *key, const char *value);
    void *context;
    int n_given;
    char given[TABLE_KEYS][TABLE_KEY]; /* keys so far, of table_key_once */
};

/* Opens the file and reads up to its header. All but usage, path, crc, key and context is set here. */
int table_open(struct table *t);

/* The next row, with as many cells as the header. *more is false at the end. */
int table_row(struct table *t, bool *more);

void table_close(struct table *t);

/* One line: file, line and column of cell i (-1: no column), and what is wrong. Returns the status. */
int table_wrong(const struct table *t, int i, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* This key, one of TABLE_KEYS shorter than TABLE_KEY, stands once. */
int table_key_once(struct table *t, const char *key);

/* The cell as a finite number. */
int table_number(const struct table *t, int i, double *value);

/* The number of the column whose name is `name` or begins with `name_`; -1: there is none. *unit is what
 * stands behind, or "". */
int table_find(const struct table *t, const char *name, const char **unit);

/* The factor from a column's unit (m, um, m_per_s) to `unit` of the tables. False: why[UNIT_REASON]. */
bool table_unit(const char *column, const char *unit, double *factor, char *why);

#endif
