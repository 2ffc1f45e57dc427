/* test_figure.c - a picture and a page of the same facts: each number stands in both. */
#include "host_sim/report/figure.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ROOM = 400000 };

static const struct option rows[] = {{"svg", "FILE", "", OPTION_WRITES, .initial = NULL},
                                     {"report", "FILE", "", OPTION_WRITES, .initial = NULL},
                                     {.name = NULL}};
static const struct usage usage = {.name = "sweep", .words = "", .table = {rows}};

static char picture[ROOM], page[ROOM];

static void read_file(const char *path, char *text)
{
    FILE *f = fopen(path, "r");
    size_t n = f ? fread(text, 1, ROOM - 1, f) : 0;
    text[n] = '\0';
    if (f)
        (void)fclose(f);
    unlink(path);
}

/* Amplitudes of micrometres over 1 to 100 kHz, in powers of ten where `logarithmic`; a map of two cells. */
static void put_all(struct figure *g, bool logarithmic)
{
    const double x[] = {1e3, 1e4, 1e5}, y[] = {0.0, 5e-6, (double)NAN}, high[] = {1e-6, 7e-6, 2e-6};
    const double from[] = {1e3, 1e4}, to[] = {1e4, 1e5}, at[] = {1.0, 2.0};
    figure_subtitle(g, "three points");
    figure_axis(g, &(struct figure_axis){"frequency", "Hz", 1e3, 1e5, logarithmic});
    figure_panel(g, "amplitude", "m", 100.0);
    figure_range(g, -10e-6, 10e-6);
    figure_put(g, &(struct figure_layer){
                      .kind = FIGURE_LINE, .name = "up", .legend = "upwards", .n = 3, .x = x, .y = y});
    figure_put(
        g, &(struct figure_layer){.kind = FIGURE_BAND, .name = "band", .n = 3, .x = x, .y = y, .z = high});
    figure_put(g, &(struct figure_layer){.kind = FIGURE_MARKER, .name = "here", .n = 1, .x = &x[1]});
    figure_panel(g, "page alone", "m", 0.0);
    figure_put(g, &(struct figure_layer){.kind = FIGURE_POINTS, .name = "few", .n = 3, .x = x, .y = high});
    figure_panel(g, "map", "", 100.0);
    figure_range(g, 0.5, 2.5);
    figure_put(g,
               &(struct figure_layer){
                   .kind = FIGURE_CELLS, .name = "cell", .half = 0.5, .n = 2, .x = from, .y = at, .z = to});
}

static void write_figure(bool logarithmic)
{
    char svg[] = "/tmp/contactplant_figure_XXXXXX", html[] = "/tmp/contactplant_figure_XXXXXX";
    char command[] = "contactplant", of_svg[] = "--svg", of_page[] = "--report";
    char *argv[] = {command, of_svg, svg, of_page, html};
    struct options o;
    struct figure g;
    int status;
    (void)close(mkstemp(svg));
    (void)close(mkstemp(html));
    check_true("options", options_parse(&o, &usage, 5, argv, &status));
    check_int("begun", figure_begin(&g, &o, "rig"), 0);
    put_all(&g, logarithmic);
    check_int("written", figure_end(&g, &o), 0);
    read_file(svg, picture);
    read_file(html, page);
}

TEST(figure_picture_and_page_have_the_same_facts)
{
    write_figure(false);
    check_contains(
        "page: unscaled numbers, NaN as null", page,
        "\"name\":\"up\",\"ink\":\"blue\",\"x\":[1000,10000,100000],\"y\":[0,5.0000000000000004e-06,null]");
    check_contains("page: the band", page, "\"kind\":\"area\",\"name\":\"band\"");
    check_contains("page: the cells", page,
                   "\"half\":[0.5],\"x\":[1000,10000],\"to\":[10000,100000],\"y\":[1,2]");
    check_contains("page: the axes of the map", page, "\"kind\":\"bounds\"");
    check_contains("page: its own panel", page, "\"title\":\"page alone\"");
    check_true("which the picture has not", !strstr(picture, "page alone"));
    check_contains("picture: title", picture, ">contactplant sweep rig<");
    check_contains("picture: label with its prefix", picture, ">amplitude (\xC2\xB5m)<");
    check_contains("picture: legend", picture, ">upwards<");
    check_contains("picture: one axis below both panels", picture, ">frequency (kHz)<");
    /* 74 to 976 px are 1 to 100 kHz; 10 to -10 um are 84 px to 184 px */
    check_contains("picture: the line", picture, "M74.0 134.0h0L156.0 109.0");
    check_contains("picture: a cell from 1 to 10 kHz, 0.5 to 1.5", picture, "M74.0 270.0H156.0V320.0H74.0Z");
}

TEST(figure_with_a_logarithmic_axis)
{
    write_figure(true);
    check_contains("page: numbers as they are", page, "\"log\":\"x\"");
    check_contains("page: numbers as they are", page, "\"x\":[1000,10000,100000]");
    check_contains("picture: axis", picture, ">log10 of frequency (Hz)<");
    check_contains("picture: 10 kHz is the middle", picture, "M74.0 134.0h0L525.0 109.0");
}
