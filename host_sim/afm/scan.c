/* scan.c - the subcommand `scan`: images of a virtual microscope, as Gwyddion Simple Fields and PNG. */
#include "host_sim/afm/scan.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "host_sim/afm/gsf.h"
#include "host_sim/afm/png.h"
#include "host_sim/afm/scan_part.h"
#include "host_sim/afm/volume.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/files.h"
#include "host_sim/commands.h"

enum { NAME = 64, DOTS_MOST = 4096, MEMORY_MAX = 1 << 28 /* values */ };

static const struct option scan_options[] = {
    {"set", "NAME=VALUE", "a number of microscope or lever, with its unit; repeatable", OPTION_TEXT,
     .many = true},
    {"surface", "FILE", "heights from a Gwyddion Simple Field (.gsf)", OPTION_READS, .initial = NULL},
    {"out", "DIR", "directory of the images (build/scan)", OPTION_FOLDER, .initial = "build/scan"},
    {"volume", "DIR", "with peak force: curves of pixels (.tab), and their list", OPTION_FOLDER,
     .initial = NULL},
    {"every", "N", "pixels and lines from one curve to the next (8)", OPTION_INTEGER, 1, 65536,
     .initial = "8"},
    {.name = NULL},
};

static const struct usage scan_usage = {
    .name = "scan",
    .words = "[SCENE]",
    .summary =
        "Scans a surface with a virtual AFM. Its z loop engages first; then trace and retrace of height, "
        "error,\n"
        "amplitude, phase and peak force, with a PLL or DART also frequency, go into DIR as .gsf and .png.\n"
        "With a peak force to hold it writes that, adhesion, modulus, deformation and dissipation instead.\n"
        "contactplant list microscope prints all numbers of --set. A scan that was cut off is kept in DIR,\n"
        "and the same command goes on from there.",
    .words_help =
        "SCENE is tapping, soft, stiff or a scene file of afm_lever; without SCENE it is tapping.\n",
    .examples =
        "  contactplant scan --set surface=2 --set pixel=\"4 ms\"\n"
        "  contactplant scan --set surface=2 --set ki=3000     # too fast: z swings, tip and lines crash\n"
        "  contactplant scan --set peak_force=\"5 nN\" --set ticks=2 --set map=2 --set map_modulus=\"200 "
        "MPa\"\n"
        "  contactplant scan --set peak_force=\"5 nN\" --set ticks=2 --volume build/volume --every 16\n"
        "  contactplant scan soft --set z_loop=2 --set drive=0 --set setpoint=\"2 nm\" --set surface=4\n",
    .min_words = 0,
    .max_words = 1,
    .table = {scan_options},
};

/* Which scans have a channel. */
enum { WITH_TONE = 1, WITH_SWING = 2, ALWAYS = 3, WITH_TRACKING = 4 };

static const struct channel {
    const char *name, *unit, *title;
    int when;
} channel[SCAN_CHANNELS] = {
    [SCAN_HEIGHT] = {"height", "m", "Height", ALWAYS},
    [SCAN_ERROR] = {"error", "m", "Error", WITH_TONE},
    [SCAN_AMPLITUDE] = {"amplitude", "m", "Amplitude", WITH_TONE},
    [SCAN_PHASE] = {"phase", "rad", "Phase", WITH_TONE},
    [SCAN_PEAK] = {"peak_force", "N", "Peak force", ALWAYS},
    [SCAN_FREQUENCY] = {"frequency", "Hz", "Frequency", WITH_TRACKING},
    [SCAN_FORCE_ERROR] = {"peak_force_error", "N", "Peak force error", WITH_SWING},
    [SCAN_ADHESION] = {"adhesion", "N", "Adhesion", WITH_SWING},
    [SCAN_MODULUS] = {"modulus", "Pa", "DMT modulus", WITH_SWING},
    [SCAN_DEFORMATION] = {"deformation", "m", "Deformation", WITH_SWING},
    [SCAN_DISSIPATION] = {"dissipation", "J", "Dissipation", WITH_SWING},
    [SCAN_SURFACE] = {NULL, "m", "Surface", ALWAYS},
};

/* ---- the image ---- */

bool scan_alloc(struct scan_image *m, const double *number)
{
    bool good = true;
    *m =
        (struct scan_image){.pixels = (size_t)number[STATION_PIXELS], .lines = (size_t)number[STATION_LINES]};
    for (int i = 0; i < 2 * SCAN_CHANNELS; i++) {
        float **value = &m->value[i / SCAN_CHANNELS][i % SCAN_CHANNELS];
        *value = m->pixels * m->lines <= MEMORY_MAX ? calloc(m->pixels * m->lines, sizeof **value) : NULL;
        good = good && *value;
    }
    return good;
}

void scan_free(struct scan_image *m)
{
    for (int i = 0; i < 2 * SCAN_CHANNELS; i++)
        free(m->value[i / SCAN_CHANNELS][i % SCAN_CHANNELS]);
}

static double known(bool is, double value)
{
    return is ? value : (double)NAN;
}

static void keep_pixel(struct scan_image *m, const struct pixel *p, double setpoint_N)
{
    const double value[SCAN_CHANNELS] = {
        [SCAN_HEIGHT] = p->height_m,
        [SCAN_ERROR] = p->error_m,
        [SCAN_AMPLITUDE] = p->amplitude_m,
        [SCAN_PHASE] = p->phase_rad,
        [SCAN_PEAK] = p->peak_N,
        [SCAN_FREQUENCY] = p->frequency_Hz,
        [SCAN_FORCE_ERROR] = known(p->force.n > 0, p->force.peak_N - setpoint_N),
        [SCAN_ADHESION] = known(p->force.touched, p->force.adhesion_N),
        [SCAN_MODULUS] = known(p->force.fitted, p->force.modulus_Pa),
        [SCAN_DEFORMATION] = known(p->force.touched, p->force.deformation_m),
        [SCAN_DISSIPATION] = known(p->force.touched, p->force.work_J),
        [SCAN_SURFACE] = p->surface_m,
    };
    for (int i = 0; i < SCAN_CHANNELS; i++)
        m->value[p->back][i][p->line * m->pixels + p->column] = (float)value[i];
}

static void tell_progress(const struct afm_bench *b, double begin_s, double *told_s)
{
    double now = clock_now_s(), each = isatty(STDERR_FILENO) ? 1.0 : 10.0;
    double part = (double)b->station.scanned / (double)raster_samples(&b->station.raster);
    if (now - *told_s < each)
        return;
    fprintf(stderr, "contactplant %s: line %u of %u, %.0f s left%s", b->usage->name,
            b->station.pixel.line + 1, b->station.raster.lines, (now - begin_s) * (1.0 - part) / part,
            isatty(STDERR_FILENO) ? "   \r" : "\n");
    *told_s = now;
}

#define KEEP_S 0.5 /* from one time that a scan is kept to the next */

/* After a pixel: progress, a copy on disk, an end. */
static int after_pixel(struct afm_bench *b, const struct scan_image *m, struct scan_part *part)
{
    bool stop = clock_interrupted();
    if (part && (stop || clock_now_s() - part->kept_s > KEEP_S)) {
        int status = scan_part_write(part, b, m);
        if (status)
            return status;
    }
    return stop ? options_failure(b->usage, "interrupted in line %u; the same command goes on from there",
                                  b->station.pixel.line + 1)
                : 0;
}

int scan_run(struct afm_bench *b, struct scan_image *m, struct scan_part *part, struct volume *volume)
{
    struct station *s = &b->station;
    double begin_s = clock_now_s(), told_s = begin_s;
    uint64_t all = raster_samples(&s->raster);
    int status = 0;
    clock_catch_signals();
    while (s->scanned < all && !status) {
        status = afm_bench_run(b, 1);
        if (!status && volume)
            status = volume_take(volume);
        if (status || !s->pixel_ready)
            continue;
        keep_pixel(m, &s->pixel, b->number[STATION_PEAK_FORCE]);
        status = after_pixel(b, m, part);
        tell_progress(b, begin_s, &told_s);
    }
    return status;
}

bool scan_is_parachute(const double *number, double amplitude_m)
{
    double free = number[STATION_DRIVE];
    return number[STATION_Z_LOOP] == Z_AMPLITUDE &&
           amplitude_m > free - 0.1 * (free - number[STATION_SETPOINT]);
}

void scan_verdict(const struct afm_bench *b, const struct scan_image *m, char text[SCAN_VERDICT])
{
    bool swings = station_swings(b->number);
    size_t n = m->pixels * m->lines, off = 0, unknown = 0;
    double peak = 0.0, square = 0.0, limited = b->station.n_limited * b->station.sample_s;
    for (size_t i = 0; i < 2 * n; i++) {
        float *const *v = m->value[i >= n];
        peak = fmax(peak, (double)v[SCAN_PEAK][i % n]);
        double error = (double)v[swings ? SCAN_FORCE_ERROR : SCAN_ERROR][i % n];
        square += isnan(error) ? 0.0 : error * error;
        off += swings ? error < -0.9 * b->number[STATION_PEAK_FORCE]
                      : scan_is_parachute(b->number, (double)v[SCAN_AMPLITUDE][i % n]);
        unknown += isnan(v[SCAN_MODULUS][i % n]);
    }
    int length = snprintf(
        text, SCAN_VERDICT,
        "largest force %.3g nN, %u crashes above %.3g nN; off the surface in %.1f %% of the pixels; "
        "error %.3g %s rms",
        peak * 1e9, b->station.microscope.n_crashes, b->number[STATION_CRASH] * 1e9,
        50.0 * (double)off / (double)n, sqrt(square / (2.0 * (double)n)) * 1e9, swings ? "nN" : "nm");
    if (swings && unknown)
        length += snprintf(text + length, SCAN_VERDICT - (size_t)length, "; no modulus in %.1f %% of them",
                           50.0 * (double)unknown / (double)n);
    const struct crash *c = &b->station.microscope.crash;
    if (b->station.microscope.n_crashes)
        length += snprintf(text + length, SCAN_VERDICT - (size_t)length,
                           "; the last crash had %.3g nN, at x %.3g nm, y %.3g nm", c->peak_N * 1e9,
                           c->x_m * 1e9, c->y_m * 1e9);
    if (limited > 0.0)
        snprintf(text + length, SCAN_VERDICT - (size_t)length,
                 "; z stood at the piezo's limit for %.3g s: widen z_min or z_max", limited);
}

/* ---- files ---- */

static int finish(struct afm_bench *b, FILE *f, const char *name)
{
    return files_finish(f, true) ? 0
                                 : options_failure(b->usage, "image %s: %s", name, files_unwritten(errno));
}

/* The name of a file of this channel, without what tells its kind. */
static void stem_of(int which, int back, char stem[NAME])
{
    snprintf(stem, NAME, "%.40s%s", channel[which].name, back ? "_back" : "");
}

static int write_gsf(struct afm_bench *b, const struct scan_image *m, int back, int i, const char *stem)
{
    char name[NAME + 8], title[NAME];
    snprintf(name, sizeof name, "%s.gsf", stem);
    snprintf(title, sizeof title, "%s%s", channel[i].title, back ? " (retrace)" : "");
    struct gsf g = {.nx = m->pixels,
                    .ny = m->lines,
                    .width = b->number[STATION_SCAN_WIDTH],
                    .length = b->number[STATION_SCAN_LENGTH],
                    .unit = channel[i].unit,
                    .title = title,
                    .value = m->value[back][i]};
    FILE *f = afm_bench_open(b, options_text(&b->o, "out", 0), name);
    if (f)
        gsf_write(f, &g);
    return f ? finish(b, f, name) : STATUS_FAILED;
}

/* The size of a picture with square dots: the finer of the two steps is a dot. A picture that would be too
 * large has a dot for each value. */
static void find_dots(const struct afm_bench *b, const struct scan_image *m, size_t *wide, size_t *high)
{
    double step_x = b->number[STATION_SCAN_WIDTH] / (double)m->pixels,
           step_y = b->number[STATION_SCAN_LENGTH] / (double)m->lines, dot = fmin(step_x, step_y);
    *wide = m->pixels;
    *high = m->lines;
    if (!(fmax(step_x * (double)m->pixels, step_y * (double)m->lines) <= DOTS_MOST * dot))
        return;
    *wide = (size_t)fmax(1.0, round(step_x * (double)m->pixels / dot));
    *high = (size_t)fmax(1.0, round(step_y * (double)m->lines / dot));
}

/* Black is the least value, white the largest. Unknown values are black. The file and standard output tell
 * which those are. */
static int write_png(struct afm_bench *b, const struct scan_image *m, const float *value, int which,
                     const char *stem)
{
    char name[NAME + 8], about[2 * NAME];
    const char *unit = channel[which].unit;
    size_t n = m->pixels * m->lines, wide, high_dots;
    float low = value[0], high = value[0];
    find_dots(b, m, &wide, &high_dots);
    unsigned char *grey = malloc(wide * high_dots);
    if (!grey)
        return options_failure(b->usage, "out of memory");
    for (size_t i = 0; i < n; i++) {
        low = fminf(value[i], low);
        high = fmaxf(value[i], high);
    }
    for (size_t i = 0; i < wide * high_dots; i++) {
        float v = value[i / wide * m->lines / high_dots * m->pixels + i % wide * m->pixels / wide];
        grey[i] = (unsigned char)(high > low && !isnan(v) ? 255.0f * (v - low) / (high - low) : 0.0f);
    }
    snprintf(name, sizeof name, "%s.png", stem);
    snprintf(about, sizeof about, "black is %.4g %s, white is %.4g %s", (double)low, unit, (double)high,
             unit);
    if (isnan(low))
        snprintf(about, sizeof about, "no value is known");
    printf("%s: %s\n", name, about);
    FILE *f = afm_bench_open(b, options_text(&b->o, "out", 0), name);
    if (f)
        png_write(f, grey, wide, high_dots, about);
    free(grey);
    return f ? finish(b, f, name) : STATUS_FAILED;
}

static int write_images(struct afm_bench *b, const struct scan_image *m)
{
    bool tracks = b->number[STATION_PLL] + b->number[STATION_DART] > 0.0;
    int status = 0,
        here = (station_swings(b->number) ? WITH_SWING : WITH_TONE) | (tracks ? WITH_TRACKING : 0);
    for (int i = 0; i < 2 * SCAN_SURFACE && !status; i++) {
        int which = i / 2, back = i % 2;
        char stem[NAME];
        if (!(channel[which].when & here))
            continue;
        stem_of(which, back, stem);
        status = write_gsf(b, m, back, which, stem);
        status = status ? status : write_png(b, m, m->value[back][which], which, stem);
    }
    return status;
}

/* Before the work: none of the images takes the place of what this command reads. */
static int check_images(struct afm_bench *b)
{
    char name[NAME];
    const char *const one[] = {name, NULL};
    int status = 0;
    for (int i = 0; i < 4 * SCAN_SURFACE && !status; i++) {
        stem_of(i / 4, i % 2, name);
        strcat(name, i / 2 % 2 ? ".png" : ".gsf");
        status = options_check_folder(&b->o, "out", one);
    }
    return status;
}

/* From the beginning, or from where it was cut off. */
static int run_scan(struct afm_bench *b, struct scan_image *m, struct scan_part *part, struct volume *volume)
{
    bool found = false;
    int status = scan_part_open(part, b, options_text(&b->o, "out", 0));
    status = status ? status : scan_part_read(part, b, m, &found);
    if (status)
        return status;
    afm_bench_warn(b);
    if (found)
        fprintf(stderr, "contactplant scan: goes on in line %u of %u\n", b->station.pixel.line + 1,
                b->station.raster.lines);
    else if (b->number[STATION_Z_LOOP] != Z_OFF)
        status = afm_bench_engage(b);
    if (!found)
        station_begin_scan(&b->station);
    status = status ? status : scan_run(b, m, part, volume);
    status = status ? status : write_images(b, m);
    return status ? status : volume_end(volume, m);
}

int cmd_scan(int argc, char **argv)
{
    static struct afm_bench b;
    static struct scan_image image;
    static struct scan_part part;
    static struct volume volume;
    char verdict[SCAN_VERDICT];
    int status;
    part.lock = -1;
    memset(&b, 0, sizeof b);
    memset(&image, 0, sizeof image);
    if (!options_parse(&b.o, &scan_usage, argc, argv, &status))
        return status;
    status = afm_bench_read(&b);
    status = status ? status : afm_bench_read_surface(&b);
    status = status ? status : afm_bench_start(&b);
    status = status ? status : check_images(&b);
    const char *out = options_text(&b.o, "out", 0);
    if (!status && !files_make_folder(out))
        status = options_failure(&scan_usage, "cannot make the directory --out %s: %s", out, strerror(errno));
    if (!status && !scan_alloc(&image, b.number))
        status = options_failure(&scan_usage, "no memory for %.0f pixels in %.0f lines; give fewer",
                                 b.number[STATION_PIXELS], b.number[STATION_LINES]);
    status = status ? status : volume_open(&volume, &b);
    status = status ? status : run_scan(&b, &image, &part, &volume);
    if (!status) {
        scan_verdict(&b, &image, verdict);
        puts(verdict);
        scan_part_end(&part);
    }
    volume_free(&volume);
    scan_free(&image);
    afm_bench_free(&b);
    return status;
}
