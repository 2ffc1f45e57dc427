/* html.c - see html.h. */
#include "host_sim/report/html.h"
#include "host_sim/cli/files.h"
#include "host_sim/cli/shell.h"
#include "host_sim/version.h"
#include "host_sim/report/page.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { LINE = 4096 };

/* Nothing from outside is loaded, whatever the text of a scene says. */
static const char policy[] = "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
                             "script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:\">\n";

static void put_file(FILE *f, int which)
{
    const struct page_file *p = &page_file[which];
    (void)fwrite(p->begin, 1, (size_t)(p->end - p->begin), f);
}

/* The first of each `every` numbers, n in all. */
static void put_each(struct html *h, const char *name, size_t n, size_t every, const double *value)
{
    json_item(&h->json, "'%r':[", name);
    for (size_t i = 0; i < n; i++)
        json_item(&h->json, "%e", value[i * every]);
    json_put(&h->json, "]");
}

static void put_numbers(struct html *h, const char *name, size_t n, const double *value)
{
    put_each(h, name, n, 1, value);
}

/* An element of a list, or the value of a member whose name was put. */
static void put_format(struct html *h, const char *format, va_list arguments)
{
    char text[LINE];
    vsnprintf(text, sizeof text, format, arguments);
    json_item(&h->json, "%s", text);
}

/* Ends what is open inside of `place`. */
static void back_to(struct html *h, enum html_place place)
{
    if (h->place == HTML_ROW && place != HTML_ROW) {
        json_put(&h->json, "]}");
        h->place = HTML_TABLE;
    }
    if (place != HTML_SECTIONS || h->place == HTML_SECTIONS)
        return;
    json_put(&h->json, "]}\n");
    h->place = HTML_SECTIONS;
}

static void begin_section(struct html *h, const char *kind)
{
    back_to(h, HTML_SECTIONS);
    json_item(&h->json, "{'kind':%s", kind);
}

static void put_member(struct html *h, const char *name, const char *text)
{
    json_item(&h->json, "'%r':%s", name, text);
}

static void put_command(struct html *h, int argc, char **argv)
{
    char *text = NULL;
    size_t size;
    FILE *f = open_memstream(&text, &size);
    if (f)
        fputs("contactplant", f);
    for (int i = 0; f && i < argc; i++)
        shell_put_word(f, argv[i]);
    if (f && fclose(f) == 0)
        put_member(h, "command", text);
    free(text);
}

const char *html_begin(struct html *h, const char *path, const char *command, const char *name, int argc,
                       char **argv)
{
    char title[LINE];
    snprintf(title, sizeof title, "%s%s%s", command, name ? " " : "", name ? name : "");
    *h = (struct html){.f = files_compose(path)};
    if (!h->f)
        return strerror(errno);
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n",
          h->f);
    fputs(policy, h->f);
    fputs("<title>contactplant report</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>\n", h->f);
    put_file(h->f, PAGE_CSS);
    put_file(h->f, PAGE_REPORT_CSS);
    fputs("</style>\n</head>\n<body class=\"report\">\n<main>\n<noscript>The charts need "
          "JavaScript.</noscript>\n"
          "</main>\n<script type=\"application/json\" id=\"data\">\n",
          h->f);
    json_begin_file(&h->json, h->f);
    h->json.in_page = true;
    json_put(&h->json, "{'kind':'report'");
    put_member(h, "title", title);
    put_member(h, "version", VERSION_TEXT);
    put_command(h, argc, argv);
    json_item(&h->json, "'sections':[\n");
    return NULL;
}

void html_words(struct html *h, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    begin_section(h, "words");
    json_item(&h->json, "'text':");
    put_format(h, format, arguments);
    json_put(&h->json, "}\n");
    va_end(arguments);
}

void html_text(struct html *h, const char *title, const char *text)
{
    begin_section(h, "text");
    put_member(h, "title", title);
    put_member(h, "text", text);
    json_put(&h->json, "}\n");
}

void html_table(struct html *h, const char *title, const char *columns)
{
    begin_section(h, "table");
    put_member(h, "title", title);
    put_member(h, "columns", columns);
    json_item(&h->json, "'rows':[");
    h->place = HTML_TABLE;
}

void html_row(struct html *h, bool bad)
{
    back_to(h, HTML_TABLE);
    json_item(&h->json, "\n{'bad':%b,'cells':[", bad);
    h->place = HTML_ROW;
}

void html_cell(struct html *h, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    put_format(h, format, arguments);
    va_end(arguments);
}

static void begin_chart(struct html *h, const char *title, const char *unit, const char *x_name,
                        const char *x_unit, const char *log)
{
    begin_section(h, "chart");
    put_member(h, "title", title);
    put_member(h, "unit", unit);
    put_member(h, "x_name", x_name);
    put_member(h, "x_unit", x_unit);
    if (log)
        json_item(&h->json, "'log':%s", log);
    json_item(&h->json, "'layers':[");
    h->place = HTML_CHART;
}

void html_chart(struct html *h, const char *title, const char *unit, const char *x_name, const char *x_unit)
{
    begin_chart(h, title, unit, x_name, x_unit, NULL);
}

void html_chart_log(struct html *h, const char *title, const char *unit, const char *x_name,
                    const char *x_unit)
{
    begin_chart(h, title, unit, x_name, x_unit, "both");
}

void html_chart_log_x(struct html *h, const char *title, const char *unit, const char *x_name,
                      const char *x_unit)
{
    begin_chart(h, title, unit, x_name, x_unit, "x");
}

static void begin_layer(struct html *h, const char *kind, const char *name)
{
    json_item(&h->json, "\n{'kind':%s", kind);
    put_member(h, "name", name);
    if (h->ink)
        put_member(h, "ink", h->ink);
}

void html_line(struct html *h, enum html_layer kind, const char *name, size_t n, const double *x,
               const double *y)
{
    static const char *const word[] = {"line", "steps", "points"};
    begin_layer(h, word[kind], name);
    put_numbers(h, "x", n, x);
    put_numbers(h, "y", n, y);
    json_put(&h->json, "}");
}

void html_bounds(struct html *h, const double x[2], const double y[2])
{
    begin_layer(h, "bounds", "");
    put_numbers(h, "x", 2, x);
    put_numbers(h, "y", 2, y);
    json_put(&h->json, "}");
}

void html_points(struct html *h, const char *name, size_t n, size_t every, const double *x, const double *y)
{
    begin_layer(h, "points", name);
    put_each(h, "x", n, every, x);
    put_each(h, "y", n, every, y);
    json_put(&h->json, "}");
}

void html_area(struct html *h, const char *name, size_t n, const double *x, const double *low,
               const double *high)
{
    begin_layer(h, "area", name);
    put_numbers(h, "x", n, x);
    put_numbers(h, "low", n, low);
    put_numbers(h, "high", n, high);
    json_put(&h->json, "}");
}

void html_cells(struct html *h, const char *name, size_t n, const double *from, const double *to,
                const double *y, double half)
{
    begin_layer(h, "cells", name);
    put_numbers(h, "half", 1, &half);
    put_numbers(h, "x", n, from);
    put_numbers(h, "to", n, to);
    put_numbers(h, "y", n, y);
    json_put(&h->json, "}");
}

void html_band(struct html *h, const char *name, size_t n, const double *x, double end, double period,
               const double *low, const double *high)
{
    begin_layer(h, "band", name);
    put_numbers(h, "period", 1, &period);
    put_numbers(h, "x", n, x);
    put_numbers(h, "end", 1, &end);
    put_numbers(h, "low", n, low);
    put_numbers(h, "high", n, high);
    json_put(&h->json, "}");
}

void html_open(struct html *h, size_t n, double from, double to, const double *share)
{
    const double ends[2] = {from, to};
    begin_layer(h, "open", "open");
    put_numbers(h, "ends", 2, ends);
    put_numbers(h, "share", n, share);
    json_put(&h->json, "}");
}

void html_span(struct html *h, const char *name, double from, double to)
{
    const double ends[2] = {from, to};
    begin_layer(h, "span", name);
    put_numbers(h, "ends", 2, ends);
    json_put(&h->json, "}");
}

void html_marker(struct html *h, double x, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    json_item(&h->json, "\n{'kind':'marker'");
    put_numbers(h, "x", 1, &x);
    json_item(&h->json, "'name':");
    put_format(h, format, arguments);
    json_put(&h->json, "}");
    va_end(arguments);
}

const char *html_end(struct html *h)
{
    back_to(h, HTML_SECTIONS);
    json_put(&h->json, "]}\n");
    fputs("</script>\n<script>\n", h->f);
    put_file(h->f, PAGE_DRAW);
    put_file(h->f, PAGE_REPORT);
    fputs("</script>\n</body>\n</html>\n", h->f);
    return files_finish(h->f, true) ? NULL : files_unwritten(errno);
}
