/* chart.c - see chart.h. Everything is written into a memory stream first: the height is known only at the
 * end. */
#include "host_sim/cli/chart.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/out/xml.h"

enum {
    CHART_WIDTH = 1000,
    LEFT = 74,
    RIGHT = 976,
    LABEL_ROW = 24,
    GAP = 12,
    AXIS_ROW = 42,
    TICKS_MAX = 50,
    COLUMN_GAP = 48, /* px, with the y values of the column on its right */
    TICK_ROOM = 50,  /* px of an axis for a value */
    TICKS_SHOWN = 12,
    STRIP = 20 /* px; a lower panel has no y values */
};

static const char *const colour_of[] = {"#0072b2", "#d55e00", "#009e73", "#e69f00",
                                        "#cc79a7", "#56b4e9", "#7f8790", "none"};

/* attributes: class, anchor, style; the class decides size and colour (see style below). */
static void text_at(struct chart *c, double x, double y, const char *attributes, const char *s)
{
    if (*s)
        xml_put(c->body, "<text x='%p' y='%p' %r>%s</text>\n", x, y, attributes, s);
}

/* Printed width of a string at 12 px, px: a mean of sans-serif fonts; UTF-8 continuation bytes do not
 * print. */
static double text_width(const char *s)
{
    double width = 0.0;
    for (; *s; s++)
        width += (*s & 0xC0) == 0x80 ? 0.0 : 6.4;
    return width;
}

static double to_x(const struct chart *c, double x)
{
    return c->left + (x - c->x_min) / (c->x_max - c->x_min) * (c->right - c->left);
}

static double to_y(const struct chart *c, double y)
{
    return c->top + (c->y_max - y) / (c->y_max - c->y_min) * c->height;
}

struct chart_ticks chart_ticks_of(double min, double max, int n_max)
{
    static const double mantissa[] = {1.0, 2.0, 5.0};
    struct chart_ticks t = {0.0, 1.0, 0, 0};
    if (!(max > min) || !isfinite(max - min))
        return t;
    int k = (int)floor(log10((max - min) / n_max)) - 1;
    for (int i = 0; i < 12; i++) { /* four decades up from below the smallest candidate */
        int power = k + i / 3;
        t.step = mantissa[i % 3] * pow(10.0, power);
        double slack = 1e-9;                        /* a limit that is a multiple up to rounding counts */
        t.first = ceil(min / t.step - slack) + 0.0; /* never -0 */
        t.n = (int)(floor(max / t.step + slack) - t.first) + 1;
        t.decimals = power < 0 ? -power : 0;
        if (t.n <= n_max)
            break;
    }
    return t;
}

void chart_range_add(double *min, double *max, const double *y, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(y[i]))
            continue;
        *min = y[i] < *min ? y[i] : *min;
        *max = y[i] > *max ? y[i] : *max;
    }
}

void chart_range_finish(double *min, double *max)
{
    if (!(*min <= *max)) {
        *min = 0.0;
        *max = 1.0;
        return;
    }
    double air = 0.06 * (*max - *min);
    if (air <= 1e-12 * fabs(*max))
        air = *max != 0.0 ? 0.5 * fabs(*max) : 1.0;
    *min -= air;
    *max += air;
}

double chart_label(char *label, size_t size, const char *name, const char *unit, double largest)
{
    static const char *const prefix[] = {"z", "a", "f", "p", "n", "µ", "m", "", "k", "M", "G"};
    int power = largest > 0.0 && isfinite(largest) ? (int)floor(log10(largest) / 3.0) : 0;
    power = power < -7 ? -7 : power > 3 ? 3 : power;
    bool bare = !*unit || !strcmp(unit, "1"),
         scaled = !bare && strcmp(unit, "rad") != 0 && strncmp(unit, "kg", 2) != 0;
    snprintf(label, size, bare ? "%s" : "%s (%s%s)", name, scaled ? prefix[power + 7] : "", unit);
    return scaled ? pow(10.0, -3.0 * power) : 1.0;
}

void chart_begin(struct chart *c, const char *title, const char *subtitle)
{
    memset(c, 0, sizeof *c);
    c->x_max = 1.0;
    c->left = LEFT;
    c->right = RIGHT;
    c->body = open_memstream(&c->text, &c->size);
    if (!c->body)
        return;
    xml_put(c->body, "<title>%s</title>\n", title);
    text_at(c, LEFT, 30, "class=\"title\"", title);
    text_at(c, LEFT, 49, "class=\"small\"", subtitle);
    c->next_y = 60;
}

void chart_x_range(struct chart *c, double min, double max)
{
    c->x_min = min;
    c->x_max = max;
}

/* ---- labels where a panel has no curves ---- */

static int box_of(double px, double begin, int most)
{
    int i = (int)floor((px - begin) / CHART_BOX);
    return i < 0 ? 0 : i >= most ? most - 1 : i;
}

static void mark(struct chart *c, double x, double y)
{
    if (y >= c->top && y <= c->top + c->height && x >= c->left && x <= c->right)
        c->marked[box_of(y, c->top, CHART_ROWS)][box_of(x, 0.0, CHART_COLUMNS)] = true;
}

static void mark_line(struct chart *c, double x0, double y0, double x1, double y1)
{
    double length = fmin(fmax(fabs(x1 - x0), fabs(y1 - y0)), 8.0 * CHART_WIDTH);
    for (double at = 0.0; at < length; at += 0.5 * CHART_BOX)
        mark(c, x0 + (x1 - x0) * at / length, y0 + (y1 - y0) * at / length);
    mark(c, x1, y1);
}

/* The marked boxes under a text whose middle line stands at y. */
static int count_marks(const struct chart *c, double x, double y, double width)
{
    int n = 0, last = box_of(x + width, 0.0, CHART_COLUMNS), low = box_of(y + 6.0, c->top, CHART_ROWS);
    for (int row = box_of(y - 6.0, c->top, CHART_ROWS); row <= low; row++)
        for (int i = box_of(x, 0.0, CHART_COLUMNS); i <= last; i++)
            n += c->marked[row][i];
    return n;
}

struct place {
    double x, y;   /* the left end and the middle line of the text */
    double anchor; /* where the text's anchor is, px */
    const char *style;
};

/* The place of a label with the fewest marks: over its middle from above, or beside its line from below. */
static struct place find_place(const struct chart *c, const struct chart_note *l)
{
    double width = text_width(l->text);
    const struct place side[] = {
        {l->x + 5.0, 0.0, l->x + 5.0, "class=\"small note\""},
        {l->x - 5.0 - width, 0.0, l->x - 5.0, "class=\"small note\" text-anchor=\"end\""},
        {l->x - 0.5 * width, 0.0, l->x, "class=\"small note\" text-anchor=\"middle\""}};
    struct place best = side[l->centred ? 2 : 0];
    int least = INT_MAX, rows = (int)((c->height - 20.0) / CHART_BOX);
    best.y = c->top + c->height - 11.0;
    for (int i = 0; i < 2 * rows; i++) {
        struct place here = side[l->centred ? 2 : i % 2];
        double down = 10.0 + i / 2 * CHART_BOX;
        here.y = l->centred ? c->top + down : c->top + c->height - down;
        bool fits = l->centred || (here.x >= c->left && here.x + width <= c->right);
        int n = fits ? count_marks(c, here.x, here.y, width) : INT_MAX;
        best = n < least ? here : best;
        least = n < least ? n : least;
    }
    return best;
}

/* The labels wait until all curves of their panel are known. */
static void put_notes(struct chart *c)
{
    for (int i = 0; i < c->n_notes; i++) {
        const char *text = c->note[i].text;
        struct place at = find_place(c, &c->note[i]);
        text_at(c, at.anchor, at.y + 4.0, at.style, text);
        for (double y = at.y - 6.0; y <= at.y + 6.0; y += CHART_BOX)
            mark_line(c, at.x, y, at.x + text_width(text), y);
    }
    c->n_notes = 0;
}

static void keep_note(struct chart *c, double x, bool centred, const char *text)
{
    if (c->n_notes == CHART_NOTES)
        put_notes(c);
    struct chart_note *l = &c->note[c->n_notes++];
    *l = (struct chart_note){.x = x, .centred = centred};
    snprintf(l->text, sizeof l->text, "%s", text);
}

/* ---- panels ---- */

double chart_column(struct chart *c, int i, int n)
{
    if (c->body)
        put_notes(c);
    double pitch = (double)(RIGHT - LEFT + COLUMN_GAP) / n;
    c->left = LEFT + i * pitch;
    c->right = c->left + pitch - COLUMN_GAP;
    c->row_y = i ? c->row_y : c->next_y;
    c->next_y = c->row_y;
    return c->right - c->left;
}

static struct chart_ticks x_ticks(const struct chart *c)
{
    return chart_ticks_of(c->x_min, c->x_max, (int)fmin(TICKS_SHOWN, (c->right - c->left) / TICK_ROOM));
}

static void grid(struct chart *c)
{
    char label[40];
    struct chart_ticks t = x_ticks(c);
    for (int i = 0; i < t.n && i < TICKS_MAX; i++)
        xml_put(c->body, "<path class='grid' d='M%p %pv%p'/>\n", to_x(c, (t.first + i) * t.step), c->top,
                c->height);
    t = chart_ticks_of(c->y_min, c->y_max, c->height < 60.0 ? 3 : (int)(c->height / 20.0));
    for (int i = 0; c->height >= STRIP && i < t.n && i < TICKS_MAX; i++) {
        double y = (t.first + i) * t.step;
        xml_put(c->body, "<path class='grid' d='M%p %pH%p'/>\n", c->left, to_y(c, y), c->right);
        snprintf(label, sizeof label, "%.*f", t.decimals, y + 0.0);
        text_at(c, c->left - 7, to_y(c, y) + 4, "class=\"tick\" text-anchor=\"end\"", label);
    }
}

void chart_panel(struct chart *c, const char *label, double height, double y_min, double y_max)
{
    if (!c->body)
        return;
    put_notes(c);
    memset(c->marked, 0, sizeof c->marked);
    c->top = c->next_y + LABEL_ROW;
    c->height = height;
    c->y_min = y_min;
    c->y_max = y_max;
    c->next_y = c->top + height + GAP;
    c->n_panels++;
    text_at(c, c->left, c->top - 8, "class=\"label\"", label);
    c->legend_x = c->left + 1.1 * text_width(label) + 28;
    xml_put(c->body, "<clipPath id='p%i'><rect x='%p' y='%p' width='%p' height='%p'/></clipPath>\n",
            c->n_panels, c->left, c->top, c->right - c->left, height);
    grid(c);
    xml_put(c->body, "<rect class='frame' x='%p' y='%p' width='%p' height='%p'/>\n", c->left, c->top,
            c->right - c->left, height);
}

void chart_x_axis(struct chart *c, const char *label)
{
    if (!c->body)
        return;
    char text[40];
    double y = c->top + c->height;
    struct chart_ticks t = x_ticks(c);
    for (int i = 0; i < t.n && i < TICKS_MAX; i++) {
        double x = (t.first + i) * t.step;
        snprintf(text, sizeof text, "%.*f", t.decimals, x + 0.0);
        text_at(c, to_x(c, x), y + 17, "class=\"tick\" text-anchor=\"middle\"", text);
    }
    text_at(c, (c->left + c->right) / 2.0, y + 34, "class=\"label\" text-anchor=\"middle\"", label);
    c->next_y = y + AXIS_ROW;
}

static void legend(struct chart *c, const char *swatch, enum chart_colour colour, const char *name)
{
    if (!name)
        return;
    xml_put(c->body, "<path d='M%p %ph18' stroke='%r' %r/>\n", c->legend_x, c->top - 12, colour_of[colour],
            swatch);
    text_at(c, c->legend_x + 23, c->top - 8, "class=\"small\"", name);
    c->legend_x += 23 + text_width(name) + 18;
}

void chart_legend(struct chart *c, enum chart_colour colour, const char *name)
{
    if (c->body)
        legend(c, "stroke-width=\"9\" stroke-opacity=\".2\"", colour, name);
}

void chart_span(struct chart *c, double x0, double x1, const char *label, enum chart_colour colour)
{
    if (!c->body)
        return;
    double left = to_x(c, x0 > c->x_min ? x0 : c->x_min), right = to_x(c, x1 < c->x_max ? x1 : c->x_max);
    if (!(right > left))
        return;
    xml_put(c->body, "<rect x='%p' y='%p' width='%p' height='%p' fill='%r' fill-opacity='.13'/>\n", left,
            c->top, right - left, c->height, colour_of[colour]);
    if (label)
        keep_note(c, (left + right) / 2, true, label);
}

static bool is_point(const double *x, const double *a, const double *b, size_t i)
{
    return isfinite(x[i]) && isfinite(a[i]) && isfinite(b[i]);
}

/* End of the run of points that begins at i: one past its last. */
static size_t run_end(const double *x, const double *a, const double *b, size_t n, size_t i)
{
    while (i < n && is_point(x, a, b, i))
        i++;
    return i;
}

void chart_line(struct chart *c, const double *x, const double *y, size_t n, enum chart_colour colour,
                const char *name)
{
    if (!c->body)
        return;
    xml_put(c->body, "<path class='line' clip-path='url(#p%i)' stroke='%r' d='", c->n_panels,
            colour_of[colour]);
    bool pen_down = false;
    for (size_t i = 0; i < n; i++) {
        bool point = is_point(x, y, y, i);
        if (point) /* h0 makes a lone point visible under a round cap */
            xml_put(c->body, "%r%p %p%r", pen_down ? "L" : "M", to_x(c, x[i]), to_y(c, y[i]),
                    pen_down ? "" : "h0");
        if (point)
            mark_line(c, to_x(c, x[i - pen_down]), to_y(c, y[i - pen_down]), to_x(c, x[i]), to_y(c, y[i]));
        pen_down = point;
    }
    xml_put(c->body, "'/>\n");
    legend(c, "stroke-width=\"2\"", colour, name);
}

void chart_points(struct chart *c, const double *x, const double *y, size_t n, enum chart_colour colour,
                  double width, const char *name)
{
    if (!c->body)
        return;
    xml_put(c->body, "<path class='line' clip-path='url(#p%i)' stroke='%r' style='stroke-width:%p' d='",
            c->n_panels, colour_of[colour], width);
    for (size_t i = 0; i < n; i++)
        if (is_point(x, y, y, i)) { /* h0 makes a lone point visible under a round cap */
            xml_put(c->body, "M%p %ph0", to_x(c, x[i]), to_y(c, y[i]));
            mark(c, to_x(c, x[i]), to_y(c, y[i]));
        }
    xml_put(c->body, "'/>\n");
    legend(c, "stroke-width=\"9\"", colour, name);
}

void chart_band(struct chart *c, const double *x, const double *low, const double *high, size_t n,
                enum chart_colour colour, const char *name)
{
    if (!c->body)
        return;
    xml_put(c->body, "<path class='band' clip-path='url(#p%i)' fill='%r' stroke='%r' d='", c->n_panels,
            colour_of[colour], colour_of[colour]);
    for (size_t i = 0; i < n; i++) {
        size_t end = run_end(x, low, high, n, i);
        for (size_t k = i; k < end; k++) {
            xml_put(c->body, "%r%p %p", k == i ? "M" : "L", to_x(c, x[k]), to_y(c, high[k]));
            mark_line(c, to_x(c, x[k]), to_y(c, low[k]), to_x(c, x[k]), to_y(c, high[k]));
        }
        for (size_t k = end; k > i; k--)
            xml_put(c->body, "L%p %p", to_x(c, x[k - 1]), to_y(c, low[k - 1]));
        if (end > i)
            xml_put(c->body, "Z");
        i = end; /* a gap, or the end */
    }
    xml_put(c->body, "'/>\n");
    legend(c, "stroke-width=\"9\" stroke-opacity=\".45\"", colour, name);
}

void chart_cells(struct chart *c, const double *from, const double *to, const double *y, size_t n,
                 double half_height, enum chart_colour colour, const char *name)
{
    if (!c->body)
        return;
    xml_put(c->body, "<path class='cell' clip-path='url(#p%i)' fill='%r' d='", c->n_panels,
            colour_of[colour]);
    for (size_t i = 0; i < n; i++)
        xml_put(c->body, "M%p %pH%pV%pH%pZ", to_x(c, from[i]), to_y(c, y[i] + half_height), to_x(c, to[i]),
                to_y(c, y[i] - half_height), to_x(c, from[i]));
    xml_put(c->body, "'/>\n");
    legend(c, "stroke-width=\"9\" stroke-opacity=\".7\"", colour, name);
}

/* RFC 4648. */
static void put_base64(FILE *f, const unsigned char *byte, size_t n)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < n; i += 3) {
        unsigned long bits = 0;
        for (size_t k = 0; k < 3; k++)
            bits = bits << 8 | (i + k < n ? byte[i + k] : 0u);
        for (size_t k = 0; k < 4; k++)
            putc(i + k <= n ? digit[bits >> (18 - 6 * k) & 63] : '=', f);
    }
}

void chart_image(struct chart *c, double x0, double x1, double y0, double y1, const void *png, size_t n)
{
    if (!c->body)
        return;
    xml_put(c->body,
            "<image x='%p' y='%p' width='%p' height='%p' preserveAspectRatio='none' "
            "style='image-rendering:pixelated' href='data:image/png;base64,",
            to_x(c, x0), to_y(c, y1), to_x(c, x1) - to_x(c, x0), to_y(c, y0) - to_y(c, y1));
    put_base64(c->body, png, n);
    xml_put(c->body, "'/>\n");
}

void chart_marker(struct chart *c, double x, const char *label, enum chart_colour colour)
{
    if (!c->body || !(x >= c->x_min && x <= c->x_max))
        return;
    xml_put(c->body, "<path class='dash' stroke='%r' d='M%p %pv%p'/>\n", colour_of[colour], to_x(c, x),
            c->top, c->height);
    mark_line(c, to_x(c, x), c->top, to_x(c, x), c->top + c->height);
    if (label)
        keep_note(c, to_x(c, x), false, label);
}

void chart_level(struct chart *c, double y, enum chart_colour colour, const char *name)
{
    if (!c->body)
        return;
    if (y >= c->y_min && y <= c->y_max) {
        mark_line(c, c->left, to_y(c, y), c->right, to_y(c, y));
        xml_put(c->body, "<path class='dash' stroke='%r' d='M%p %pH%p'/>\n", colour_of[colour], c->left,
                to_y(c, y), c->right);
    }
    legend(c, "stroke-width=\"1.5\" stroke-dasharray=\"5 3\"", colour, name);
}

static const char style[] =
    "text{font-family:Helvetica,Arial,\"Liberation Sans\",\"DejaVu "
    "Sans\",sans-serif;fill:#22272e}.title{font-size:18px;font-weight:600}.label{font-size:12px;font-weight:"
    "600}.small{font-size:12px;fill:#444c56}.note{paint-order:stroke;stroke:#fff;stroke-width:3px}.tick{font-"
    "size:11px;fill:#444c56}.grid{stroke:#e4e7eb;fill:none}.frame{stroke:#9aa3ad;fill:none}.line{fill:none;"
    "stroke-width:1.6;stroke-linejoin:round;stroke-linecap:round}.band{fill-opacity:.42;stroke-width:.6;"
    "stroke-opacity:.7}.cell{fill-opacity:.7;shape-rendering:crispEdges}.dash{fill:none;stroke-width:1.3;"
    "stroke-dasharray:5 3}";

const char *chart_end(struct chart *c, FILE *out)
{
    if (!c->body)
        return "no memory for the picture";
    put_notes(c);
    bool bad = fclose(c->body) != 0;
    int height = (int)rint(c->next_y);
    xml_put(out,
            XML_HEAD "<svg xmlns='http://www.w3.org/2000/svg' role='img' width='%i' height='%i' viewBox='0 0 "
                     "%i %i'>\n<style>%r</style>\n<rect width='%r' height='%r' fill='#ffffff'/>\n",
            CHART_WIDTH, height, CHART_WIDTH, height, style, "100%", "100%");
    fwrite(c->text, 1, c->size, out);
    xml_put(out, "</svg>\n");
    free(c->text);
    return bad ? "no memory for the picture" : NULL;
}
