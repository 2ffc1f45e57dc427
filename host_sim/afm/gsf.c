/* gsf.c - see gsf.h; the format is that of Gwyddion's manual, "Gwyddion Simple Field files". */
#include "host_sim/afm/gsf.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const char gsf_magic[] = "Gwyddion Simple Field 1.0\n";
enum { LINE = 256, LINES = 100 };

static void put_float(FILE *f, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (int i = 0; i < 4; i++)
        putc((int)(bits >> (8 * i) & 0xFF), f);
}

const char *gsf_write(FILE *f, const struct gsf *g)
{
    int n = fprintf(
        f, "%sXRes = %zu\nYRes = %zu\nXReal = %.9g\nYReal = %.9g\nXYUnits = m\nZUnits = %s\nTitle = %s\n",
        gsf_magic, g->nx, g->ny, g->width, g->length, g->unit, g->title);
    for (int i = n % 4; i < 4; i++)
        putc(0, f);
    for (size_t i = 0; i < g->nx * g->ny; i++)
        put_float(f, g->value[i]);
    return fflush(f) || ferror(f) ? "it could not be written completely (disk full?)" : NULL;
}

/* The header's numbers; the file then stands at its first NUL. */
static void read_header(FILE *f, struct gsf *g)
{
    char line[LINE];
    for (int i = 0, c; i < LINES && (c = getc(f)) != EOF; i++) {
        ungetc(c, f);
        if (c == 0 || !fgets(line, sizeof line, f))
            return;
        (void)(sscanf(line, "XRes = %zu", &g->nx) || sscanf(line, "YRes = %zu", &g->ny) ||
               sscanf(line, "XReal = %lf", &g->width) || sscanf(line, "YReal = %lf", &g->length));
    }
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

int gsf_read(FILE *f, struct gsf *g, char *why)
{
    char first[sizeof gsf_magic];
    *g = (struct gsf){.width = 1e-6, .length = 1e-6};
    if (!fgets(first, sizeof first, f) || strcmp(first, gsf_magic))
        return refuse_file(why, "is no file of Gwyddion Simple Field 1.0");
    read_header(f, g);
    if (g->nx < 2 || g->ny < 2 || g->nx > GSF_SIDE || g->ny > GSF_SIDE ||
        !(g->width > 0.0 && g->length > 0.0))
        return refuse_file(why, "has no XRes and YRes from 2 to 65535, or no positive XReal and YReal");
    for (long i = ftell(f) % 4; i < 4; i++)
        if (getc(f) != 0)
            return refuse_file(why, "has no NULs between header and values");
    g->value = malloc(g->nx * g->ny * sizeof *g->value);
    if (!g->value)
        return refuse_file(why, "does not fit into memory");
    size_t n = read_values(f, g);
    if (n < g->nx * g->ny || getc(f) != EOF) {
        snprintf(why, GSF_REASON, "has the wrong size: its header says %zu x %zu values, and it has %s",
                 g->nx, g->ny, n < g->nx * g->ny ? "fewer" : "more");
        return 0;
    }
    for (size_t i = 0; i < n; i++)
        if (!isfinite(g->value[i])) {
            snprintf(why, GSF_REASON, "has a value that is no number, in row %zu, column %zu", i / g->nx + 1,
                     i % g->nx + 1);
            return 0;
        }
    return 1;
}
