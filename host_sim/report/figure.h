/* figure.h - panels and their layers, given once for a picture (--svg) and a page (--report).
 *
 *   figure_begin(&g, &o, "rig");
 *   figure_subtitle(&g, "dashed: jumps");
 *   figure_axis(&g, &(struct figure_axis){"frequency of force", "Hz", 100.0, 300.0, false});
 *   figure_panel(&g, "amplitude", "m", 170.0);
 *   figure_put(&g, &(struct figure_layer){.kind = FIGURE_LINE, .name = "up", .legend = "up", .n = n, .x = x,
 * .y = y}); status = figure_end(&g, &o);
 *
 * Numbers are in the units of axis and panel; picture and page pick a prefix. NaN leaves a gap. */
#ifndef HOST_SIM_FIGURE_H
#define HOST_SIM_FIGURE_H

#include <stdbool.h>
#include <stddef.h>
#include "host_sim/cli/chart.h"
#include "host_sim/cli/options.h"
#include "host_sim/report/html.h"

enum { FIGURE_TEXT = 160 };

/* The x axis of the panels that follow. */
struct figure_axis {
    const char *name, *unit;
    double from, to; /* equal: what the layers of each panel need */
    bool logarithmic;
};

enum figure_kind {
    FIGURE_LINE,
    FIGURE_POINTS,
    FIGURE_BAND,   /* from y to z over x */
    FIGURE_CELLS,  /* from x to z, `half` below and above y */
    FIGURE_MARKER, /* dashed, at x[0] */
    FIGURE_SPAN    /* shaded over the whole height, from x[0] to z[0] */
};

struct figure_layer {
    enum figure_kind kind;
    const char *name;   /* on the page; beside a marker. NULL: none */
    const char *legend; /* in the picture; NULL: none */
    enum chart_colour colour;
    bool dots;    /* the page marks the points of this line */
    double width; /* px, the points in the picture */
    double half;
    size_t n;
    const double *x, *y, *z; /* [n]; a marker has x alone, a span x and z */
};

struct figure_kept {
    struct figure_layer layer;
    char name[FIGURE_TEXT], legend[FIGURE_TEXT];
    double *data;
};

struct figure {
    bool draws, writes; /* --svg and --report are given */
    struct chart chart;
    struct html page;
    const char *why;        /* NULL, or what went wrong with the page */
    size_t every;           /* the page has each of so many points; 0: all */
    char name[FIGURE_TEXT]; /* the picture's title */
    struct figure_axis axis;
    char axis_name[FIGURE_TEXT];
    char axis_label[FIGURE_TEXT]; /* below the panels that were drawn; "" for none yet */
    bool open;                    /* a panel is */
    char title[FIGURE_TEXT], unit[FIGURE_TEXT];
    double height, from, to;
    struct figure_kept *kept;
    size_t n, room;
};

/* Begins what the options ask for: --svg, --report, both or nothing. name: what it is of. 0, or the exit
 * status after a line. */
int figure_begin(struct figure *g, const struct options *o, const char *name);

/* Begins the picture of --svg alone, where the page is another one. */
void figure_begin_picture(struct figure *g, const struct options *o, const char *name);

/* The line below the picture's title; it comes first. */
void figure_subtitle(struct figure *g, const char *text);

void figure_axis(struct figure *g, const struct figure_axis *axis);

/* A panel of `height` px in the picture; 0: on the page alone. */
void figure_panel(struct figure *g, const char *title, const char *unit, double height);

/* The y axis of the open panel, where its layers do not decide it. The x axis has its own range then. */
void figure_range(struct figure *g, double from, double to);

/* A layer of the open panel; its numbers and texts are copied. */
void figure_put(struct figure *g, const struct figure_layer *layer);

/* The page, for words and tables that a picture has no room for; NULL: there is none. */
struct html *figure_page(struct figure *g);

/* Writes the files. 0, or the exit status after a line. */
int figure_end(struct figure *g, const struct options *o);

#endif
