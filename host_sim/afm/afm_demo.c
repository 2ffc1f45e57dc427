/* afm_demo.c - see afm_demo.h: a force curve, heat, a line
 * over a grating, and images with a dissipative disc. */
#include "host_sim/afm/afm_demo.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/afm/png.h"
#include "host_sim/afm/scan.h"
#include "host_sim/afm/thermal.h"
#include "host_sim/cli/files.h"
#include "host_sim/commands.h"

enum { CURVE = 400, /* points of the force curve in each direction */ LINE_MOST = 512, IMAGES = 3 };

struct afm_demo {
    struct afm_bench bench;
    struct chart chart;
    struct thermal heat;
    struct scan_image image;
    double base[2 * CURVE], deflection[2 * CURVE]; /* nm */
};

/* The bench with this scene and the options of the demo. */
static void begin(struct afm_demo *d, const struct options *o, const char *scene)
{
    struct harmonic unused[MODEL_INPUTS];
    struct afm_bench *b = &d->bench;
    memset(b, 0, sizeof *b);
    b->usage = o->usage;
    b->scene = scenes_find(scene)->scene;
    station_defaults(b->number);
    scenes_resolve(&b->scene, b->si, unused);
    b->tick_s = b->scene.frame_s / b->scene.substeps / b->scene.dilation;
}

/* ---- the force curve of a soft lever, from 25 nm to -12 nm and back in 0.2 s ---- */

static int approach(struct afm_demo *d)
{
    struct afm_bench *b = &d->bench;
    const double top = 25e-9, way = 37e-9;
    uint64_t each = (uint64_t)(0.1 / CURVE / (b->tick_s * 4.0));
    thermal_prepare(b);
    b->si[LEVER_HEIGHT] = top;
    b->number[STATION_TICKS] = 4.0;
    int status = afm_bench_start(b);
    for (int i = 0; i < 2 * CURVE && !status; i++) {
        for (uint64_t k = 1; k <= each && !status; k++) {
            double at = (i + (double)k / (double)each) / CURVE;
            struct microscope_in in = {.z_m = -way * (at < 1.0 ? at : 2.0 - at)};
            if (!station_run(&b->station, &in))
                status = options_failure(b->usage, "the force curve left the finite numbers");
            d->deflection[i] += b->station.out.deflection_m * 1e9 / (double)each;
        }
        d->base[i] = (top + b->station.out.z_m) * 1e9;
    }
    return status;
}

static void draw_approach(struct afm_demo *d)
{
    double min = (double)INFINITY, max = -(double)INFINITY;
    chart_range_add(&min, &max, d->deflection, 2 * CURVE);
    chart_range_finish(&min, &max);
    chart_x_range(&d->chart, -12.0, 25.0);
    chart_panel(&d->chart, "force curve of a soft lever: deflection (nm)", 150.0, min, max);
    chart_line(&d->chart, d->base, d->deflection, CURVE, CHART_BLUE, "approach, snap-in");
    chart_line(&d->chart, d->base + CURVE, d->deflection + CURVE, CURVE, CHART_RED, "retract, pull-off");
    chart_x_axis(&d->chart, "height of the base over the sample (nm)");
}

/* ---- heat ---- */

static int hear(struct afm_demo *d)
{
    thermal_prepare(&d->bench);
    int status = afm_bench_start(&d->bench);
    return status ? status : thermal_listen(&d->bench, 1.0, &d->heat);
}

/* ---- the scan ---- */

/* Lines of 20 nm with a disc that takes energy; a lever with the Q of air, a loop at w0/(4 Q). */
static int scan(struct afm_demo *d)
{
    struct afm_bench *b = &d->bench;
    double *n = b->number;
    b->si[LEVER_Q] = 150.0;
    b->si[LEVER_HEIGHT] = 100e-9;
    n[STATION_SURFACE] = SURFACE_GRATING;
    n[STATION_SURFACE_EDGE] = 20e-9;
    n[STATION_MAP] = MAP_DISC;
    n[STATION_MAP_SIZE] = 600e-9;
    n[STATION_MAP_VISCOSITY] = 300.0;
    n[STATION_DRIVE] = 60e-9;
    n[STATION_SETPOINT] = 53e-9;
    n[STATION_KI] = 700.0;
    int status = afm_bench_start(b);
    if (!status && !scan_alloc(&d->image, n))
        status = options_failure(b->usage, "out of memory");
    status = status ? status : afm_bench_engage(b);
    station_begin_scan(&b->station);
    return status ? status : scan_run(b, &d->image, NULL, NULL);
}

/* The middle line of the trace. */
static void draw_line(struct afm_demo *d)
{
    double x[LINE_MOST] = {0.0}, y[3][LINE_MOST] = {{0.0}}, min = (double)INFINITY, max = -(double)INFINITY;
    size_t n = d->image.pixels, first = d->image.lines / 8 * n;
    float *const *v = d->image.value[0];
    double mean = 0.0, width = d->bench.number[STATION_SCAN_WIDTH] * 1e9;
    for (size_t i = 0; i < n; i++) {
        x[i] = ((double)i + 0.5) * width / (double)n;
        y[0][i] = (double)v[SCAN_SURFACE][first + i] * 1e9;
        y[1][i] = (double)v[SCAN_HEIGHT][first + i] * 1e9;
        y[2][i] = (double)v[SCAN_ERROR][first + i] * 1e9;
        mean += (y[1][i] - y[0][i]) / (double)n;
    }
    for (size_t i = 0; i < n; i++)
        y[1][i] -= mean;
    chart_range_add(&min, &max, y[0], n);
    chart_range_add(&min, &max, y[1], n);
    chart_range_add(&min, &max, y[2], n);
    chart_range_finish(&min, &max);
    chart_x_range(&d->chart, 0.0, width);
    chart_panel(&d->chart, "a line over the grating (nm)", 190.0, min, max);
    for (size_t i = 0; i < n; i++) {
        size_t from = i;
        while (i < n && scan_is_parachute(d->bench.number, (double)v[SCAN_AMPLITUDE][first + i]))
            i++;
        if (i > from)
            chart_span(&d->chart, x[from], x[i - 1] + width / (double)n, NULL, CHART_RED);
    }
    chart_line(&d->chart, x, y[0], n, CHART_GREY, "surface");
    chart_line(&d->chart, x, y[1], n, CHART_BLUE, "z");
    chart_line(&d->chart, x, y[2], n, CHART_ORANGE, "error of the amplitude");
    chart_legend(&d->chart, CHART_RED, "parachuting: off the surface");
    chart_x_axis(&d->chart, "x (nm)");
}

static int compare(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Greys between the 2nd and the 98th percentile, as a PNG in memory; black and white are at range[2]. */
static char *grey_of(const float *value, const struct scan_image *m, size_t *size, double range[2])
{
    size_t n = m->pixels * m->lines;
    char *bytes = NULL;
    float *sorted = malloc(n * sizeof *sorted);
    unsigned char *grey = malloc(n);
    FILE *f = open_memstream(&bytes, size);
    if (f && sorted && grey) {
        memcpy(sorted, value, n * sizeof *sorted);
        qsort(sorted, n, sizeof *sorted, compare);
        float low = sorted[n / 50], high = sorted[n - 1 - n / 50], span = high > low ? high - low : 1.0f;
        range[0] = (double)low, range[1] = (double)high;
        for (size_t i = 0; i < n; i++) {
            float part = (value[i] - low) / span;
            grey[i] = (unsigned char)(part < 0.0f ? 0.0f : part > 1.0f ? 255.0f : 255.0f * part);
        }
        png_write(f, grey, m->pixels, m->lines, NULL);
    }
    if (f)
        fclose(f);
    free(sorted);
    free(grey);
    return bytes;
}

struct shown {
    enum scan_channel channel;
    const char *name, *unit;
    double factor;
};

/* The greys from black to white over their values, below an image. */
static void draw_scale(struct afm_demo *d, const struct shown *w, const double range[2])
{
    unsigned char grey[256];
    char *png = NULL, label[48];
    size_t size = 0;
    FILE *f = open_memstream(&png, &size);
    double low = w->factor * range[0], high = w->factor * range[1];
    for (int i = 0; i < 256; i++)
        grey[i] = (unsigned char)i;
    if (f) {
        png_write(f, grey, 256, 1, NULL);
        fclose(f);
    }
    high = high > low ? high : low + w->factor; /* as grey_of has it for an even image */
    chart_x_range(&d->chart, low, high);
    chart_panel(&d->chart, "", 12.0, 0.0, 1.0);
    if (png)
        chart_image(&d->chart, low, high, 0.0, 1.0, png, size);
    snprintf(label, sizeof label, "%s (%s)", w->name, w->unit);
    chart_x_axis(&d->chart, label);
    free(png);
}

/* Column i: an image whose pixels are square, and its greys. */
static void draw_image(struct afm_demo *d, const struct shown *w, int i)
{
    const double *n = d->bench.number, wide_um = n[STATION_SCAN_WIDTH] * 1e6,
                 long_um = n[STATION_SCAN_LENGTH] * 1e6;
    double px = chart_column(&d->chart, i, IMAGES), range[2] = {0.0, 0.0};
    size_t size = 0;
    char *png = grey_of(d->image.value[0][w->channel], &d->image, &size, range), label[64];
    snprintf(label, sizeof label, "%s of the trace: y (\xC2\xB5m)", w->name);
    chart_x_range(&d->chart, 0.0, wide_um);
    chart_panel(&d->chart, label, px * long_um / wide_um, 0.0, long_um);
    if (png)
        chart_image(&d->chart, 0.0, wide_um, 0.0, long_um, png, size);
    chart_x_axis(&d->chart, "x (\xC2\xB5m)");
    draw_scale(d, w, range);
    free(png);
}

static void draw_images(struct afm_demo *d)
{
    static const struct shown shown[IMAGES] = {{SCAN_HEIGHT, "height", "nm", 1e9},
                                               {SCAN_ERROR, "error", "nm", 1e9},
                                               {SCAN_PHASE, "phase", "rad", 1.0}};
    for (int i = 0; i < IMAGES; i++)
        draw_image(d, &shown[i], i);
}

/* ---- the picture ---- */

static int draw_demo(struct afm_demo *d, const char *directory)
{
    FILE *f = afm_bench_open(&d->bench, directory, "afm.svg");
    if (!f)
        return STATUS_FAILED;
    char verdict[SCAN_VERDICT];
    scan_verdict(&d->bench, &d->image, verdict);
    chart_begin(&d->chart, "contactplant demo afm: a virtual microscope", verdict);
    draw_approach(d);
    bool bad = thermal_panel(&d->chart, &d->heat, 150.0) != 0;
    draw_line(d);
    draw_images(d);
    const char *why = chart_end(&d->chart, f);
    bad = !files_finish(f, !why) || bad;
    return why || bad ? options_failure(d->bench.usage, "afm.svg is not complete: %s",
                                        why ? why : files_unwritten(errno))
                      : 0;
}

static void report_demo(const struct afm_demo *d, const char *directory)
{
    double lowest = 0.0;
    char verdict[SCAN_VERDICT];
    for (int i = CURVE; i < 2 * CURVE; i++)
        lowest = fmin(lowest, d->deflection[i]);
    printf("force curve: pull-off at %.3g nN\n", -lowest * 0.2);
    printf("heat: resonance %.5g kHz, Q %.3g, stiffness %.3g N/m by equipartition\n",
           d->heat.fit.f0_Hz * 1e-3, d->heat.fit.quality, d->heat.stiffness);
    scan_verdict(&d->bench, &d->image, verdict);
    printf("scan: %s\n", verdict);
    printf("picture: %s/afm.svg\n", directory);
}

int afm_demo(const struct options *o, const char *directory)
{
    struct afm_demo *d = calloc(1, sizeof *d);
    if (!d)
        return options_failure(o->usage, "out of memory");
    begin(d, o, "soft");
    int status = approach(d);
    begin(d, o, "tapping");
    status = status ? status : hear(d);
    begin(d, o, "tapping");
    status = status ? status : scan(d);
    status = status ? status : draw_demo(d, directory);
    if (!status)
        report_demo(d, directory);
    spectrum_free(&d->heat.spectrum);
    scan_free(&d->image);
    free(d);
    return status;
}
