/* volume.c - see volume.h. */
#include "host_sim/afm/volume.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/afm/force_curve.h"
#include "host_sim/cli/files.h"
#include "host_sim/commands.h"

enum { NAME = 64 };

static void name_of(uint32_t line, uint32_t pixel, char name[NAME])
{
    snprintf(name, NAME, "curve_%05u_%05u.tab", line, pixel);
}

static bool wanted(const struct volume *v, uint32_t line, uint32_t pixel)
{
    return line % v->every == 0 && pixel % v->every == 0;
}

/* None of its files takes the place of an input or of another output. */
static int check_files(const struct volume *v)
{
    const double *n = v->bench->number;
    char name[NAME];
    const char *const one[] = {name, NULL};
    strcpy(name, "volume.csv");
    int status = options_check_folder(&v->bench->o, "volume", one);
    for (uint32_t line = 0; line < n[STATION_LINES] && !status; line += v->every)
        for (uint32_t pixel = 0; pixel < n[STATION_PIXELS] && !status; pixel += v->every) {
            name_of(line, pixel, name);
            status = options_check_folder(&v->bench->o, "volume", one);
        }
    return status;
}

static int check(const struct volume *v)
{
    const struct afm_bench *b = v->bench;
    const double *n = b->number;
    double curves = ceil(n[STATION_LINES] / v->every) * ceil(n[STATION_PIXELS] / v->every);
    if (!station_swings(n))
        return options_misuse(b->usage, "--volume needs cycles of force: give --set peak_force=\"5 nN\"");
    if (n[STATION_PIXEL] < (2.0 - 1e-9) * (double)v->samples * b->station.sample_s)
        return options_misuse(b->usage,
                              "--volume needs two cycles in a pixel of %.3g ms: give a longer pixel, or a "
                              "higher frequency",
                              n[STATION_PIXEL] * 1e3);
    if (curves > VOLUME_CURVES)
        return options_misuse(b->usage, "--volume would write %.0f curves, %d at most: give a larger --every",
                              curves, VOLUME_CURVES);
    return check_files(v);
}

int volume_open(struct volume *v, struct afm_bench *b)
{
    *v = (struct volume){.bench = b, .directory = options_text(&b->o, "volume", 0)};
    if (!v->directory)
        return options_given(&b->o, "every") ? options_misuse(b->usage, "--every belongs to --volume") : 0;
    v->every = (uint32_t)options_number(&b->o, "every");
    v->samples = b->station.swing.samples;
    int status = check(v);
    if (status)
        return status;
    if (!files_make_folder(v->directory))
        return options_failure(b->usage, "cannot make the directory --volume %s: %s", v->directory,
                               strerror(errno));
    v->base = malloc(v->samples * sizeof *v->base);
    v->deflection = malloc(v->samples * sizeof *v->deflection);
    return v->base && v->deflection ? 0 : options_failure(b->usage, "no memory for a curve");
}

static int finish(const struct volume *v, FILE *f)
{
    return files_finish(f, true) ? 0
                                 : options_failure(v->bench->usage, "a curve: %s", files_unwritten(errno));
}

static int write_curve(const struct volume *v)
{
    const struct afm_bench *b = v->bench;
    const struct station *s = &b->station;
    double swing = b->number[STATION_DRIVE];
    char name[NAME];
    name_of(v->line, v->pixel, name);
    FILE *f = afm_bench_open(v->bench, v->directory, name);
    if (!f)
        return STATUS_FAILED;
    force_curve_write(f,
                      &(struct force_curve){.n = v->samples,
                                            .base = v->base,
                                            .deflection = v->deflection,
                                            .step_s = s->sample_s,
                                            .begin_s = s->sample_s,
                                            .speed = swing * 2.0 * 3.14159265358979323846 * s->frequency_Hz,
                                            .z_range = 2.0 * swing,
                                            .stiffness = b->si[LEVER_K]});
    return finish(v, f);
}

/* A row in a cycle that was seen from its top on; at the next top the curve is whole. */
static int take_row(struct volume *v)
{
    const struct station *s = &v->bench->station;
    if (v->begun && v->n < v->samples) {
        v->base[v->n] = v->bench->si[LEVER_HEIGHT] + s->out.z_m;
        v->deflection[v->n++] = s->out.deflection_m;
    }
    if (s->swing.i != 0)
        return 0;
    v->done = v->begun && v->n == v->samples;
    v->begun = true;
    v->n = 0;
    return v->done ? write_curve(v) : 0;
}

int volume_take(struct volume *v)
{
    const struct station *s = &v->bench->station;
    struct raster_place at;
    if (!v->directory || !raster_at(&s->raster, s->scanned - 1, &at))
        return 0;
    if (at.back || !wanted(v, at.line, at.pixel) || at.line != v->line || at.pixel != v->pixel)
        v->begun = v->done = false;
    v->line = at.line;
    v->pixel = at.pixel;
    return at.back || v->done || !wanted(v, at.line, at.pixel) ? 0 : take_row(v);
}

/* A cell: a number, or nothing where it is not known. */
static void put_value(FILE *f, float value)
{
    fprintf(f, isnan(value) ? "," : ",%.7g", (double)value);
}

int volume_end(struct volume *v, const struct scan_image *m)
{
    static const enum scan_channel told[] = {SCAN_HEIGHT,  SCAN_PEAK,        SCAN_ADHESION,
                                             SCAN_MODULUS, SCAN_DEFORMATION, SCAN_DISSIPATION};
    const double *n = v->bench->number;
    char name[NAME];
    FILE *f = v->directory ? afm_bench_open(v->bench, v->directory, "volume.csv") : NULL;
    if (!f)
        return v->directory ? STATUS_FAILED : 0;
    fprintf(f, "file,x_m,y_m,height_m,peak_force_N,adhesion_N,modulus_Pa,deformation_m,dissipation_J\n");
    for (uint32_t line = 0; line < m->lines; line += v->every)
        for (uint32_t pixel = 0; pixel < m->pixels; pixel += v->every) {
            name_of(line, pixel, name);
            fprintf(f, "%s,%.9g,%.9g", name, n[STATION_SCAN_WIDTH] * (pixel + 0.5) / n[STATION_PIXELS],
                    n[STATION_SCAN_LENGTH] * (line + 0.25) / n[STATION_LINES]);
            for (size_t i = 0; i < sizeof told / sizeof told[0]; i++)
                put_value(f, m->value[0][told[i]][line * m->pixels + pixel]);
            fputc('\n', f);
        }
    return finish(v, f);
}

void volume_free(struct volume *v)
{
    free(v->base);
    free(v->deflection);
}
