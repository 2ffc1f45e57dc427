/* gsf.c - see gsf.h; the format is that of Gwyddion's manual, "Gwyddion Simple Field files". */
#include "host_sim/afm/gsf.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const char blanks[] = " \t\r\f\v";
static const struct {
    const char *unit;
    double metres;
} lengths[] = {{"m", 1.0},          {"cm", 1e-2},           {"mm", 1e-3}, {"um", 1e-6},
               {"\302\265m", 1e-6}, {"\316\274m", 1e-6},    {"nm", 1e-9}, {"pm", 1e-12},
               {"\303\205", 1e-10}, {"\342\204\253", 1e-10}};
static const char gsf_magic[] = "Gwyddion Simple Field 1.0\n";
enum { LINE = 256 };

static void put_float(FILE *f, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (int i = 0; i < 4; i++)
        putc((int)(bits >> (8 * i) & 0xFF), f);
}

void gsf_write(FILE *f, const struct gsf *g)
{
    int n = fprintf(
        f, "%sXRes = %zu\nYRes = %zu\nXReal = %.9g\nYReal = %.9g\nXYUnits = m\nZUnits = %s\nTitle = %s\n",
        gsf_magic, g->nx, g->ny, g->width, g->length, g->unit, g->title);
    for (int i = n % 4; i < 4; i++)
        putc(0, f);
    for (size_t i = 0; i < g->nx * g->ny; i++)
        put_float(f, g->value[i]);
}

/* The first bytes of a line, the rest of which is passed over. False: the file stands at its first NUL, or
 * ends. */
static bool read_line(FILE *f, char line[LINE])
{
    int n = 0, c = getc(f);
    bool more = c != EOF && c != 0;
    for (; c != EOF && c != 0 && c != '\n'; c = getc(f))
        if (n < LINE - 1)
            line[n++] = (char)c;
    if (c == 0)
        ungetc(c, f);
    line[n] = 0;
    return more;
}

/* The text behind NAME and its equal sign, blanks around them being ignored; NULL for another line. */
static const char *text_of(const char *line, const char *name)
{
    line += strspn(line, blanks);
    size_t n = strlen(name);
    if (strncmp(line, name, n) != 0)
        return NULL;
    line += n + strspn(line + n, blanks);
    return *line == '=' ? line + 1 + strspn(line + 1, blanks) : NULL;
}

/* The number that this line gives: false when it is no number. */
static bool take_number(const char *line, const char *name, double *value)
{
    const char *text = text_of(line, name);
    char *end = NULL;
    if (text)
        *value = strtod(text, &end);
    return !text || (end != text && !end[strspn(end, blanks)]);
}

/* The size of the unit that this line gives, in metres: false when it is no length. */
static bool take_unit(const char *line, const char *name, double *metres)
{
    const char *text = text_of(line, name);
    size_t n = text ? strlen(text) : 0;
    while (n && strchr(blanks, text[n - 1]))
        n--;
    for (size_t i = 0; text && i < sizeof lengths / sizeof lengths[0]; i++)
        if (strlen(lengths[i].unit) == n && !memcmp(lengths[i].unit, text, n)) {
            *metres = lengths[i].metres;
            return true;
        }
    return !text;
}

/* The header as it was read, before it is judged. */
struct header {
    double nx, ny, width, length, metres, height_metres;
};

/* Leaves the file at its first NUL. NULL, or the name of the field whose text is wrong. */
static const char *read_header(FILE *f, struct header *h)
{
    const struct {
        const char *name;
        double *value;
        bool (*take)(const char *line, const char *name, double *value);
    } field[] = {{"XRes", &h->nx, take_number},      {"YRes", &h->ny, take_number},
                 {"XReal", &h->width, take_number},  {"YReal", &h->length, take_number},
                 {"XYUnits", &h->metres, take_unit}, {"ZUnits", &h->height_metres, take_unit}};
    char line[LINE];
    while (read_line(f, line))
        for (size_t i = 0; i < sizeof field / sizeof field[0]; i++)
            if (!field[i].take(line, field[i].name, field[i].value))
                return field[i].name;
    return NULL;
}

static size_t read_values(FILE *f, struct gsf *g)
{
    unsigned char byte[4];
    size_t n = 0;
    for (; n < g->nx * g->ny && fread(byte, 1, 4, f) == 4; n++) {
        uint32_t bits = byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
        memcpy(&g->value[n], &bits, sizeof bits);
    }
    return n;
}

static int refuse_file(char *why, const char *text)
{
    snprintf(why, GSF_REASON, "%s", text);
    return 0;
}

static bool is_side(double n)
{
    return n >= 2.0 && n <= GSF_SIDE && !(n > floor(n));
}

/* 1, or 0 with a reason; the file then stands at its values. */
static int take_header(FILE *f, struct gsf *g, double *height_metres, char *why)
{
    struct header h = {.width = 1e-6, .length = 1e-6, .metres = 1.0, .height_metres = 1.0};
    const char *wrong = read_header(f, &h);
    if (wrong) {
        snprintf(why, GSF_REASON, "has %s that is no %s", wrong,
                 strstr(wrong, "Units") ? "unit of length; write m" : "number");
        return 0;
    }
    *g = (struct gsf){.width = h.width * h.metres, .length = h.length * h.metres};
    *height_metres = h.height_metres;
    if (!is_side(h.nx) || !is_side(h.ny) || !(g->width > 0.0 && g->length > 0.0))
        return refuse_file(why, "has no XRes and YRes from 2 to 65535, or no positive XReal and YReal");
    g->nx = (size_t)h.nx;
    g->ny = (size_t)h.ny;
    bool ended = !fseek(f, -1, SEEK_CUR) && getc(f) == '\n';
    for (long i = ftell(f) % 4; i < 4; i++)
        if (!ended || getc(f) != 0)
            return refuse_file(why, "has no NULs between header and values");
    return 1;
}

int gsf_read(FILE *f, struct gsf *g, char *why)
{
    char first[sizeof gsf_magic];
    double metres = 1.0;
    *g = (struct gsf){.value = NULL};
    if (!fgets(first, sizeof first, f) || strcmp(first, gsf_magic))
        return refuse_file(why, "is no file of Gwyddion Simple Field 1.0");
    if (!take_header(f, g, &metres, why))
        return 0;
    g->value = malloc(g->nx * g->ny * sizeof *g->value);
    if (!g->value)
        return refuse_file(why, "does not fit into memory");
    size_t n = read_values(f, g);
    if (n < g->nx * g->ny || getc(f) != EOF) {
        snprintf(why, GSF_REASON, "has the wrong size: its header says %zu x %zu values, and it has %s",
                 g->nx, g->ny, n < g->nx * g->ny ? "fewer" : "more");
        return 0;
    }
    for (size_t i = 0; i < n && metres != 1.0; i++)
        g->value[i] = (float)((double)g->value[i] * metres);
    for (size_t i = 0; i < n; i++)
        if (!isfinite(g->value[i])) {
            snprintf(why, GSF_REASON, "has a value that is no number, in row %zu, column %zu", i / g->nx + 1,
                     i % g->nx + 1);
            return 0;
        }
    return 1;
}
