/* table.c - see table.h. */
#include "host_sim/fit/data/table.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/bus/wire.h"
#include "host_sim/cli/unit.h"
#include "host_sim/out/utf8.h"

enum { MESSAGE = 512, SHOWN = 40, NUMBER_ROOM = 64 };

int table_wrong(const struct table *t, int i, const char *format, ...)
{
    char text[MESSAGE];
    va_list list;
    va_start(list, format);
    (void)vsnprintf(text, sizeof text, format, list);
    va_end(list);
    if (i < 0)
        return options_misuse(t->usage, "%s:%d: %s", t->path, t->line, text);
    return options_misuse(t->usage, "%s:%d:%d: %s", t->path, t->line, t->column[i], text);
}

/* ---- lines ---- */

/* Cuts blanks off both ends. */
static char *trim(char *text)
{
    while (isspace((unsigned char)*text))
        text++;
    for (size_t n = strlen(text); n && isspace((unsigned char)text[n - 1]); n--)
        text[n - 1] = '\0';
    return text;
}

/* The next line into t->text without its end. *more is false at the end of the file. */
static int read_line(struct table *t, bool *more)
{
    size_t n = 0;
    int c = fgetc(t->f);
    *more = c != EOF;
    t->line += *more || !t->line;
    for (; c != EOF && c != '\n'; c = fgetc(t->f)) {
        if (n + 1 == TABLE_LINE)
            return table_wrong(t, -1, "a line of more than %d bytes; this is no data file", TABLE_LINE - 2);
        if (!c)
            return table_wrong(t, -1, "a byte 0; this is no text");
        t->text[n++] = (char)c;
    }
    if (ferror(t->f))
        return options_misuse(t->usage, "cannot read %s: %s", t->path, strerror(errno));
    t->text[n] = '\0';
    t->crc = wire_crc32(t->crc, (const uint8_t *)t->text, (int)n);
    t->crc = wire_crc32(t->crc, (const uint8_t *)"\n", c == '\n');
    if (n && t->text[n - 1] == '\r')
        t->text[n - 1] = '\0';
    return 0;
}

/* `# key = value`; another comment says nothing. */
static int take_key(struct table *t)
{
    char *equal = strchr(t->text, '='), *key = trim(t->text + 1);
    if (!equal)
        return 0;
    *equal = '\0';
    trim(key);
    return strpbrk(key, " \t") ? 0 : t->key(t, t->context, key, trim(equal + 1));
}

static int split(struct table *t)
{
    char *at = t->text;
    t->n = 0;
    for (bool more = true; more; t->n++) {
        char *comma = strchr(at, t->tabs ? '\t' : ',');
        more = comma;
        if (t->n == TABLE_CELLS)
            return table_wrong(t, -1, "more than %d cells", TABLE_CELLS);
        if (comma)
            *comma = '\0';
        t->cell[t->n] = trim(at);
        t->column[t->n] = (int)(t->cell[t->n] - t->text) + 1;
        at = comma ? comma + 1 : at;
    }
    return 0;
}

/* A comment of three cells at least. */
static bool names_columns(const char *text)
{
    const char *tab = *text == '#' ? strchr(text, '\t') : NULL;
    return tab && strchr(tab + 1, '\t');
}

/* The next line with cells; comments before the header have keys. */
static int next_line(struct table *t, bool header, bool *more)
{
    int status;
    while (!(status = read_line(t, more)) && *more) {
        char *text = t->text + (t->line == 1 ? utf8_mark(t->text, strlen(t->text)) : 0);
        memmove(t->text, text, strlen(text) + 1);
        t->tabs = header ? names_columns(t->text) : t->tabs;
        if (header && t->tabs) {
            *t->text = ' ';
            return split(t);
        }
        if (*t->text == '#' && header && (status = take_key(t)))
            return status;
        if (*t->text != '#' && t->text[strspn(t->text, " \t")])
            return split(t);
    }
    return status;
}

/* ---- the table ---- */

static int read_header(struct table *t)
{
    bool more;
    int status = next_line(t, true, &more);
    if (status)
        return status;
    if (!more)
        return table_wrong(t, -1, "no header, and no data; give rows below a header with units");
    if (t->n == 1 && strpbrk(t->cell[0], ";\t"))
        return table_wrong(t, -1, "write commas between the cells");
    double number;
    if (options_read_number(t->cell[0], &number))
        return table_wrong(t, 0,
                           "a row, and no header before it; name the columns above it, with their units");
    char *at = t->header;
    for (int i = 0; i < t->n; i++) {
        size_t n = strlen(t->cell[i]) + 1;
        for (int k = 0; k < i; k++)
            if (!strcmp(t->name[k], t->cell[i]))
                return table_wrong(t, i, "column \"%.40s\" is there twice; take one away", t->cell[i]);
        memcpy(at, t->cell[i], n);
        t->name[i] = at;
        at += n;
    }
    t->n_name = t->n;
    return 0;
}

int table_open(struct table *t)
{
    t->line = t->n = t->n_name = 0;
    t->tabs = false;
    t->f = NULL;
    t->f = fopen(t->path, "rb");
    if (!t->f)
        return options_misuse(t->usage, "cannot read %s: %s", t->path, strerror(errno));
    return read_header(t);
}

int table_row(struct table *t, bool *more)
{
    int status = next_line(t, false, more);
    if (status || !*more || t->n == t->n_name)
        return status;
    return table_wrong(t, t->n < t->n_name ? t->n - 1 : t->n_name, "%d cells; the header has %d", t->n,
                       t->n_name);
}

void table_close(struct table *t)
{
    if (t->f)
        (void)fclose(t->f);
}

int table_key_once(struct table *t, const char *key)
{
    for (int i = 0; i < t->n_given; i++)
        if (!strcmp(t->given[i], key))
            return table_wrong(t, -1, "%s is there twice; take one away", key);
    if (t->n_given < TABLE_KEYS)
        snprintf(t->given[t->n_given++], TABLE_KEY, "%s", key);
    return 0;
}

int table_number(const struct table *t, int i, double *value)
{
    if (!*t->cell[i])
        return table_wrong(t, i, "an empty cell for %.40s; take this row away", t->name[i]);
    if (!options_read_number(t->cell[i], value))
        return table_wrong(t, i, "\"%.*s\" is not a finite number, for %.40s", SHOWN, t->cell[i], t->name[i]);
    return 0;
}

int table_find(const struct table *t, const char *name, const char **unit)
{
    size_t n = strlen(name);
    for (int i = 0; i < t->n_name; i++)
        if (!strncmp(t->name[i], name, n) && (t->name[i][n] == '_' || !t->name[i][n])) {
            *unit = t->name[i] + n + (t->name[i][n] == '_');
            return i;
        }
    return -1;
}

/* m_per_s is m/s, N_s is N s. */
bool table_unit(const char *column, const char *unit, double *factor, char *why)
{
    char text[NUMBER_ROOM] = "1 ";
    size_t n = 2;
    for (const char *c = column; *c && n + 1 < sizeof text; n++) {
        bool per = !strncmp(c, "_per_", 5);
        text[n] = per ? '/' : *c == '_' ? ' ' : *c;
        c += per ? 5 : 1;
    }
    text[n] = '\0';
    return unit_read(text, n, unit, factor, why);
}
