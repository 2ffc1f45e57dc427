/* chart.h - a small SVG writer: panels stacked over a shared x axis, with ticks, units, bands, spans and
 * markers.
 *
 *   chart_begin(&c, "title", "subtitle");
 *   chart_x_range(&c, 0.0, 10.0);
 *   chart_panel(&c, "displacement (µm)", 120.0, y_min, y_max);
 *   chart_span(&c, 2.0, 4.0, "drive", CHART_GREY);
 *   chart_line(&c, x, y, n, CHART_BLUE, "mean");
 *   chart_x_axis(&c, "time (s)");
 *   error = chart_end(&c, file);
 *
 * The picture grows downwards: title, then panels in order of the calls; chart_x_range may be called again
 * between panels for a part with its own axis. Later parts lie on top. NaN values leave gaps. Text is UTF-8
 * and is escaped. Colours are those of Okabe and Ito, told apart by colour-blind readers; CHART_NONE is
 * invisible. One file, no fonts, no scripts. */
#ifndef HOST_SIM_CHART_H
#define HOST_SIM_CHART_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { CHART_BOX = 4 /* px */, CHART_ROWS = 128, CHART_COLUMNS = 250, CHART_NOTES = 64, CHART_TEXT = 96 };

enum chart_colour {
    CHART_BLUE,
    CHART_RED,
    CHART_GREEN,
    CHART_ORANGE,
    CHART_PURPLE,
    CHART_SKY,
    CHART_GREY,
    CHART_NONE
};

/* A label of the current panel, which goes where there are no curves. */
struct chart_note {
    double x;
    bool centred; /* over x, else beside it */
    char text[CHART_TEXT];
};

struct chart {
    FILE *body; /* memory stream over text, NULL when there was no memory */
    char *text;
    size_t size;
    double next_y; /* where the next panel begins, px */
    double row_y;  /* where the columns of a row begin, px */
    double x_min, x_max;
    double left, right;               /* ends of the current column, px */
    double top, height, y_min, y_max; /* scales of the current panel */
    double legend_x;                  /* where the next legend entry begins, px */
    int n_panels;
    bool marked[CHART_ROWS][CHART_COLUMNS]; /* boxes of the current panel that curves go through */
    struct chart_note note[CHART_NOTES];
    int n_notes;
};

/* Values on an axis: value i is (first + i) * step for 0 <= i < n. */
struct chart_ticks {
    double first, step;
    int n;
    int decimals; /* digits behind the point that tell the values apart */
};

/* The multiples of 1, 2 or 5 times 10^k inside [min, max], as many as possible but at most n_max (2..50). */
struct chart_ticks chart_ticks_of(double min, double max, int n_max);

/* Widens [*min, *max] to the finite values among y[0..n-1]. Begin with *min = INFINITY, *max = -INFINITY. */
void chart_range_add(double *min, double *max, const double *y, size_t n);

/* Makes a range fit for an axis: 6 % of air on both sides; all equal: a unit-free margin around the value;
 * nothing finite: 0..1. */
void chart_range_finish(double *min, double *max);

/* Writes the name with its unit in brackets, with the prefix that suits `largest` where a unit takes one: µm,
 * kN. Returns the factor from SI to that unit. */
double chart_label(char *label, size_t size, const char *name, const char *unit, double largest);

void chart_begin(struct chart *c, const char *title, const char *subtitle);

/* The x axis of the panels that follow; min < max. */
void chart_x_range(struct chart *c, double min, double max);

/* The panels that follow stand in column i of n, side by side; of them, column 0 comes first. Returns the
 * width of the column, px. */
double chart_column(struct chart *c, int i, int n);

/* The next panel: label with unit above it, height of the plot in px, y axis y_min < y_max. */
void chart_panel(struct chart *c, const char *label, double height, double y_min, double y_max);

/* Tick values and label of the x axis below the current panel. */
void chart_x_axis(struct chart *c, const char *label);

/* Shaded from x0 to x1 over the height of the current panel; label at its top, below curves there, or NULL.
 */
void chart_span(struct chart *c, double x0, double x1, const char *label, enum chart_colour colour);

/* A line through n points; name for the legend, or NULL. */
void chart_line(struct chart *c, const double *x, const double *y, size_t n, enum chart_colour colour,
                const char *name);

/* A dot of `width` px at each point; name for the legend, or NULL. */
void chart_points(struct chart *c, const double *x, const double *y, size_t n, enum chart_colour colour,
                  double width, const char *name);

/* Filled between low and high; a point counts when both are numbers. */
void chart_band(struct chart *c, const double *x, const double *low, const double *high, size_t n,
                enum chart_colour colour, const char *name);

/* Cells of a map: rectangle i from from[i] to to[i], half_height above and below y[i]. */
void chart_cells(struct chart *c, const double *from, const double *to, const double *y, size_t n,
                 double half_height, enum chart_colour colour, const char *name);

/* A picture (the n bytes of a PNG) over a rectangle of the panel. */
void chart_image(struct chart *c, double x0, double x1, double y0, double y1, const void *png, size_t n);

/* A dashed vertical line at x with a label beside it, clear of curves (or NULL). */
void chart_marker(struct chart *c, double x, const char *label, enum chart_colour colour);

/* A dashed horizontal line at y; name for the legend, or NULL. */
void chart_level(struct chart *c, double y, enum chart_colour colour, const char *name);

/* An entry of the current panel's legend for something that has none of its own, a kind of span for
 * example. */
void chart_legend(struct chart *c, enum chart_colour colour, const char *name);

/* Writes the picture and frees what chart_begin took. NULL, or that memory was short; the file's errors are
 * told by files_finish. */
const char *chart_end(struct chart *c, FILE *out);

#endif
