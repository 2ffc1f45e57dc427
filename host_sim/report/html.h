/* html.h - a report as one HTML file: its data inside as JSON, drawn by the code of the live page, without a
 * network.
 *
 *   if (html_begin(&h, "run.html", "simulate", "rig", argc, argv))
 *       ...
 *   html_words(&h, "It ran %g s.", 2.0);
 *   html_table(&h, "Counters", "name,value");
 *   html_row(&h, false), html_cell(&h, "late"), html_cell(&h, "%d", 2);
 *   html_chart(&h, "displacement", "m", "t", "s");
 *   html_line(&h, HTML_LINE, "rows", n, x, y);
 *   error = html_end(&h);
 *
 * Each call ends the row, table or chart before it where it must. Text is UTF-8 and is escaped; numbers are
 * written with 17 digits, and one that is not finite is null. */
#ifndef HOST_SIM_HTML_H
#define HOST_SIM_HTML_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include "host_sim/out/json.h"

enum html_place { HTML_SECTIONS, HTML_TABLE, HTML_ROW, HTML_CHART };

struct html {
    FILE *f;
    struct json json;
    enum html_place place; /* the part that is open */
    const char *ink;       /* the colour of the next layer, as in CSS or scope.css; NULL: one of its own */
};

/* Opens the file. Its title are the command and what it was of, if name is not NULL. The command line becomes
 * part of it. NULL, or what went wrong. */
const char *html_begin(struct html *h, const char *path, const char *command, const char *name, int argc,
                       char **argv);

/* A paragraph. */
void html_words(struct html *h, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Text as it is, below a title. */
void html_text(struct html *h, const char *title, const char *text);

/* A table: names of its columns with commas between; then rows (bad: shown as a failure) and their cells. */
void html_table(struct html *h, const char *title, const char *columns);
void html_row(struct html *h, bool bad);
void html_cell(struct html *h, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* A chart of values in `unit` over x; then its layers. */
void html_chart(struct html *h, const char *title, const char *unit, const char *x_name, const char *x_unit);

/* A chart with logarithmic axes: all x and y of its layers are above 0. */
void html_chart_log(struct html *h, const char *title, const char *unit, const char *x_name,
                    const char *x_unit);

/* A chart whose x axis is logarithmic: all x are above 0. */
void html_chart_log_x(struct html *h, const char *title, const char *unit, const char *x_name,
                      const char *x_unit);

enum html_layer { HTML_LINE, HTML_STEPS, HTML_POINTS };
void html_line(struct html *h, enum html_layer kind, const char *name, size_t n, const double *x,
               const double *y);

/* Both axes, where the layers do not decide them. */
void html_bounds(struct html *h, const double x[2], const double y[2]);

/* n points, the first of each `every` in x and y. */
void html_points(struct html *h, const char *name, size_t n, size_t every, const double *x, const double *y);

/* Filled from low[i] to high[i] at x[i], with straight lines between. */
void html_area(struct html *h, const char *name, size_t n, const double *x, const double *low,
               const double *high);

/* Rectangles from from[i] to to[i] across, and `half` below and above y[i]. */
void html_cells(struct html *h, const char *name, size_t n, const double *from, const double *to,
                const double *y, double half);

/* Filled from low[i] to high[i] from x[i] until x[i + 1], the last until `end`. A bin is drawn over a
 * `period` of the motion at least: parts of a period would look like beats. */
void html_band(struct html *h, const char *name, size_t n, const double *x, double end, double period,
               const double *low, const double *high);

/* For each of n equal parts of [from, to] the share, 0 to 1, in which contact was open. NaN: not known. */
void html_open(struct html *h, size_t n, double from, double to, const double *share);

/* A dashed line at x with a word beside it. */
void html_marker(struct html *h, double x, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Marked from one x to another over the whole height: there are no numbers, and the name says why. */
void html_span(struct html *h, const char *name, double from, double to);

/* Writes the end and closes the file. NULL, or what went wrong. */
const char *html_end(struct html *h);

#endif
