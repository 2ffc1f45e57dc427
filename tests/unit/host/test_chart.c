/* test_chart.c - the SVG writer: ticks and ranges against values counted by hand, the file against an
 * independent XML reader. */
#include "host_sim/cli/chart.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void check_ticks(const char *name, double min, double max, int n_max, const double expected[4])
{
    struct chart_ticks t = chart_ticks_of(min, max, n_max);
    check_near(check_name("%s: first tick", name), t.first * t.step, expected[0], 1e-9 * fabs(expected[1]));
    check_near(check_name("%s: step", name), t.step, expected[1], 1e-9 * fabs(expected[1]));
    check_int(check_name("%s: how many", name), t.n, (int)expected[2]);
    check_int(check_name("%s: decimals", name), t.decimals, (int)expected[3]);
}

TEST(chart_ticks)
{
    /* first value, step, number, decimals: multiples of the step inside the range, counted by hand */
    const double ten[] = {0, 1, 11, 0}, ten_few[] = {0, 2, 6, 0}, small[] = {-0.0002, 0.0002, 4, 4};
    const double odd[] = {20, 20, 4, 0}, large[] = {1e6, 500000, 5, 0}, narrow[] = {7.08, 0.005, 3, 3};
    check_ticks("0..10, at most 12", 0.0, 10.0, 12, ten);
    check_ticks("0..10, at most 10", 0.0, 10.0, 10, ten_few);
    check_ticks("-0.0003..0.0005, at most 4", -0.0003, 0.0005, 4, small);
    check_ticks("13..97, at most 5", 13.0, 97.0, 5, odd);
    check_ticks("1e6..3e6, at most 6", 1e6, 3e6, 6, large);
    check_ticks("7.08..7.092, at most 5", 7.08, 7.092, 5, narrow);
    check_int("an empty range has no ticks", chart_ticks_of(3.0, 3.0, 5).n, 0);
    check_int("an endless range has no ticks", chart_ticks_of(0.0, (double)INFINITY, 5).n, 0);
}

TEST(chart_range)
{
    const double same[] = {4.0, 4.0, 4.0}, zero[] = {0.0},
                 mixed[] = {(double)NAN, -1.0, (double)INFINITY, 3.0};
    double min = (double)INFINITY, max = -(double)INFINITY;
    chart_range_add(&min, &max, mixed, 4);
    check_near("smallest finite value", min, -1.0, 0.0);
    check_near("largest finite value", max, 3.0, 0.0);
    chart_range_finish(&min, &max);
    check_near("6 % of air below", min, -1.24, 1e-12);
    check_near("6 % of air above", max, 3.24, 1e-12);
    min = (double)INFINITY, max = -(double)INFINITY;
    chart_range_add(&min, &max, same, 3);
    chart_range_finish(&min, &max);
    check_is("all equal: the value lies inside the range", min, <, 4.0);
    check_is("all equal: the value lies inside the range", max, >, 4.0);
    check_is("all equal: the value lies inside the range", max - min, <, 8.0);
    min = (double)INFINITY, max = -(double)INFINITY;
    chart_range_add(&min, &max, zero, 1);
    chart_range_finish(&min, &max);
    check_is("all zero: zero lies inside the range", min, <, 0.0);
    check_is("all zero: zero lies inside the range", max, >, 0.0);
    min = (double)INFINITY, max = -(double)INFINITY;
    chart_range_add(&min, &max, mixed, 1);
    chart_range_finish(&min, &max);
    check_near("nothing finite: from 0", min, 0.0, 0.0);
    check_near("nothing finite: to 1", max, 1.0, 0.0);
}

/* A picture of everything, two panels with gaps in the data. */
static const char *draw(FILE *f)
{
    const double x[] = {0, 1, 2, 3, 4, 5}, no = (double)NAN;
    const double y[] = {1, 2, no, 4, no, 6}, low[] = {0, no, 1, 2, 3, no};
    struct chart c;
    chart_begin(&c, "a < b & \"c\"", "\xC2\xB5m > 0");
    chart_x_range(&c, 0.0, 5.0);
    chart_panel(&c, "line (N)", 100.0, 0.0, 10.0);
    chart_span(&c, 1.0, 2.0, "span", CHART_GREY);
    chart_span(&c, 7.0, 9.0, "outside", CHART_GREY);
    chart_line(&c, x, y, 6, CHART_BLUE, "y");
    chart_legend(&c, CHART_RED, "kind");
    chart_panel(&c, "band (\xC2\xB5m)", 50.0, 0.0, 10.0);
    chart_band(&c, x, low, y, 6, CHART_GREEN, "band");
    chart_level(&c, 5.0, CHART_GREY, "level");
    chart_marker(&c, 4.0, "marker <1>", CHART_PURPLE);
    chart_x_axis(&c, "time (s)");
    return chart_end(&c, f);
}

/* How often a character stands in the path of the first element of this class. */
static int path_count(const char *svg, const char *element, char letter)
{
    const char *p = strstr(svg, element);
    p = p ? strstr(p, " d=\"") : NULL;
    int n = 0;
    for (p = p ? p + 4 : ""; *p && *p != '"'; p++)
        n += *p == letter;
    return n;
}

/* RFC 4648, section 10: the vectors of base64. */
static void check_image(const char *bytes, const char *base64)
{
    struct chart c;
    char text[20000], wanted[80];
    FILE *f = tmpfile();
    chart_begin(&c, "image", "");
    chart_x_range(&c, 0.0, 1.0);
    chart_panel(&c, "image", 100.0, 0.0, 1.0);
    chart_image(&c, 0.0, 1.0, 0.0, 1.0, bytes, strlen(bytes));
    check_no_error("written", chart_end(&c, f));
    rewind(f);
    text[fread(text, 1, sizeof text - 1, f)] = '\0';
    fclose(f);
    snprintf(wanted, sizeof wanted, "href=\"data:image/png;base64,%s\"", base64);
    check_contains(bytes, text, wanted);
    check_contains("it fills the panel", text, "width=\"902.0\" height=\"100.0\"");
}

TEST(chart_image)
{
    check_image("f", "Zg==");
    check_image("fo", "Zm8=");
    check_image("foo", "Zm9v");
    check_image("foobar", "Zm9vYmFy");
    check_image("\377\376", "//4=");
}

/* Finds the x of the anchor and the y of the base line of a text. */
static bool find_text(const char *svg, const char *text, double at[2])
{
    char wanted[80];
    snprintf(wanted, sizeof wanted, ">%s</text>", text);
    const char *p = strstr(svg, wanted);
    while (p && p > svg && strncmp(p, "<text", 5) != 0)
        p--;
    return p && sscanf(p, "<text x=\"%lf\" y=\"%lf\"", &at[0], &at[1]) == 2;
}

/* The panel is from 84 to 204 px; its lines are at 96 and 192 px, where labels would stand. */
TEST(chart_labels_keep_clear_of_curves)
{
    const double x[] = {0.0, 10.0}, low[] = {1.0, 1.0}, high[] = {9.0, 9.0};
    char text[20000] = "";
    double marker[2] = {0.0, 0.0}, span[2] = {0.0, 0.0}, last[2] = {0.0, 0.0};
    struct chart c;
    FILE *f = tmpfile();
    chart_begin(&c, "labels", "");
    chart_x_range(&c, 0.0, 10.0);
    chart_panel(&c, "y", 120.0, 0.0, 10.0);
    chart_marker(&c, 5.0, "marker", CHART_RED);
    chart_marker(&c, 10.0, "last", CHART_RED);
    chart_span(&c, 2.0, 8.0, "span", CHART_GREY);
    chart_line(&c, x, low, 2, CHART_BLUE, NULL);
    chart_line(&c, x, high, 2, CHART_BLUE, NULL);
    check_no_error("written", chart_end(&c, f));
    rewind(f);
    text[fread(text, 1, sizeof text - 1, f)] = '\0';
    fclose(f);
    check_true("the labels are there", find_text(text, "marker", marker) && find_text(text, "last", last) &&
                                           find_text(text, "span", span));
    check_is("the marker's stands over the lower line", marker[1], <, 192.0 - 1.0);
    check_is("and below the middle", marker[1], >, 144.0);
    check_near("beside its line", marker[0], 525.0 + 5.0, 0.01);
    check_near("the last one on the left", last[0], 976.0 - 5.0, 0.01);
    check_is("the span's stands below the upper line", span[1], >, 96.0 + 9.0);
    check_is("and above the middle", span[1], <, 144.0);
}

TEST(chart_columns)
{
    struct chart c;
    FILE *f = tmpfile();
    chart_begin(&c, "columns", "");
    double width = chart_column(&c, 0, 3);
    chart_panel(&c, "a", 50.0, 0.0, 1.0);
    double top = c.top, left = c.left;
    check_near("three columns and two gaps are a panel wide", 3.0 * width + 2.0 * 48.0, 902.0, 1e-9);
    check_near("columns are equally wide", chart_column(&c, 1, 3), width, 1e-9);
    chart_panel(&c, "b", 50.0, 0.0, 1.0);
    check_near("they stand side by side", c.top, top, 0.0);
    check_near("with the gap between them", c.left - left, width + 48.0, 1e-9);
    (void)chart_column(&c, 0, 1);
    check_near("one column is the whole width", c.right, 976.0, 1e-9);
    check_no_error("written", chart_end(&c, f));
    fclose(f);
}

TEST(chart_gaps)
{
    char *svg = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&svg, &size);
    check_true("drawn without an error", f && draw(f) == NULL);
    if (f)
        fclose(f);
    /* the line's points are 0 1 | 3 | 5, the band's are 0 | 3 (both ends known) */
    check_int("a line with two gaps has three parts", path_count(svg, "<path class=\"line\"", 'M'), 3);
    check_int("and joins two points", path_count(svg, "<path class=\"line\"", 'L'), 1);
    check_int("a band with a gap has two parts", path_count(svg, "<path class=\"band\"", 'M'), 2);
    check_true("no NaN gets into the picture", !strstr(svg, "nan"));
    check_true("a span outside is left out", !strstr(svg, "outside"));
    free(svg);
}

TEST(chart_well_formed)
{
    char path[] = "/tmp/contactplant-chart-XXXXXX", command[512];
    int fd = mkstemp(path);
    FILE *f = fd >= 0 ? fdopen(fd, "w") : NULL;
    check_true("a temporary file", f != NULL);
    if (!f)
        return;
    check_no_error("drawn without an error", draw(f));
    fclose(f);
    snprintf(command, sizeof command,
             "/usr/bin/python3 -c \"import xml.dom.minidom,sys; d=xml.dom.minidom.parse(sys.argv[1]);"
             "t=[''.join(n.data for n in e.childNodes) for e in d.getElementsByTagName('text')];"
             "sys.exit(not('a < b & \\\"c\\\"' in t and 'marker <1>' in t and "
             "d.documentElement.getAttribute('viewBox')))\" %s",
             path);
    check_int("an XML reader gives the texts back (exit status)", system(command), 0);
    unlink(path);
}
