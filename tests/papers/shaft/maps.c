/* maps.c - figures 10, 11, 17, 20, 22, 23 of the shaft-bearing paper; prints docs/papers/maps.csv.
 *
 * Each map shows the largest x1 (22, 23: all three) over frequency and one parameter, the larger of two
 * starts. It is drawn for the shaft and for the model of one mode. The linear frequencies of open and
 * closed gaps are drawn as limits. Two rows of each map are drawn as responses. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "models/reduced/shaft_mode.h"
#include "tests/papers/one_mode.h"
#include "tests/papers/response.h"
#include "tests/papers/rows.h"

enum { ROWS = 17, COLUMNS = 61 };
static const double mm = 1e3;

/* One map: `parameter` and, when both, that of the other
 * bearing run over [low, high], in equal ratios if logarithmic. */
struct map {
    const char *figure;
    int parameter, other;
    double low, high;
    bool logarithmic;
    double gap_stiffness, from, to, seconds;
    int mode[2];       /* that the model of one mode keeps; responses: another one, or 0 */
    int n_coordinates; /* 1: x1, 3: all */
    int shown[2];      /* rows drawn as responses */
};

#define LOW                                                                                                  \
    2.0, 152.0, 3.0,                                                                                         \
    {                                                                                                        \
        1, 0                                                                                                 \
    }
#define BOTH                                                                                                 \
    2.0, 152.0, 3.0,                                                                                         \
    {                                                                                                        \
        1, 2                                                                                                 \
    }
#define HIGH                                                                                                 \
    650.0, 770.0, 3.0,                                                                                       \
    {                                                                                                        \
        3, 0                                                                                                 \
    }
static const struct map maps[] = {
    {"10 low", SHAFT_G1, SHAFT_G3, 2e-5, 2e-2, true, SHAFT_HARD, LOW, 1, {6, 12}},
    {"10 high", SHAFT_G1, SHAFT_G3, 2e-5, 6e-4, true, SHAFT_HARD, HIGH, 1, {4, 12}},
    {"11 low", SHAFT_KG1, SHAFT_KG3, 1e3, 3.502e7, true, SHAFT_HARD, LOW, 1, {5, 10}},
    {"11 high", SHAFT_KG1, SHAFT_KG3, 1e3, 3.502e7, true, SHAFT_HARD, HIGH, 1, {11, 14}},
    {"17 low", SHAFT_C1, SHAFT_C3, 4.0, 184.0, true, SHAFT_HARD, LOW, 1, {8, 16}},
    {"17 high", SHAFT_C1, SHAFT_C3, 4.0, 184.0, true, SHAFT_HARD, HIGH, 1, {0, 3}},
    {"20 soft low", SHAFT_KS3, SHAFT_KS3, 0.0, 8030.0, false, SHAFT_SOFT, BOTH, 1, {0, 8}},
    {"20 soft high", SHAFT_KS3, SHAFT_KS3, 0.0, 8030.0, false, SHAFT_SOFT, HIGH, 1, {0, 8}},
    {"20 hard low", SHAFT_KS3, SHAFT_KS3, 0.0, 8030.0, false, SHAFT_HARD, BOTH, 1, {0, 8}},
    {"20 hard high", SHAFT_KS3, SHAFT_KS3, 0.0, 8030.0, false, SHAFT_HARD, HIGH, 1, {0, 8}},
    {"22 low", SHAFT_G3, SHAFT_G3, 2.54e-4, 2e-2, true, SHAFT_HARD, LOW, 3, {6, 16}},
    {"22 high", SHAFT_G3, SHAFT_G3, 2.54e-4, 2e-2, true, SHAFT_HARD, HIGH, 3, {6, 16}},
    {"23 low", SHAFT_KG3, SHAFT_KG3, 1e3, 3.502e7, true, SHAFT_HARD, LOW, 3, {5, 10}},
    {"23 high", SHAFT_KG3, SHAFT_KG3, 1e3, 3.502e7, true, SHAFT_HARD, HIGH, 3, {5, 10}},
};

static void set(const struct map *map, double value, double *paper)
{
    paper[map->parameter] = paper[map->other] = value;
    if (map->parameter == SHAFT_C1)
        paper[SHAFT_C1 + 1] = value;
}

/* The result of two starts, one of them rest, at a point of a map. */
struct cell {
    double high[3]; /* the larger of each coordinate */
    bool impacts;   /* either */
};

/* The shaft, or its model of one mode. */
static struct cell find(const struct map *map, const struct model *model, const double *paper, uint64_t *seed)
{
    struct cell c = {.impacts = false};
    struct attractor_shaft s;
    double state[MODEL_STATES];
    if (!attractor_open(&s, model, paper))
        return c;
    for (int k = 0; k < 2; k++) {
        struct attractor a;
        (model == &shaft_bearing ? attractor_start : one_mode_start)(seed, paper[SHAFT_G1], state);
        if (!attractor_settle(&s, k ? state : NULL, map->seconds, &a))
            continue;
        c.impacts = c.impacts || a.switches > 0.0;
        for (int i = 0; i < 3; i++)
            c.high[i] = fmax(c.high[i], a.high[i]);
    }
    attractor_close(&s);
    return c;
}

/* The linear shaft with what a contact that lasts adds; of
 * figure 22, where bearing 3 is far from its own, at bearing 1. */
static void close_gaps(const struct map *map, const double *paper, double *closed)
{
    memcpy(closed, paper, MODEL_PARAMETERS * sizeof *closed);
    closed[SHAFT_KS1] += 0.5 * paper[SHAFT_KG1];
    if (map->parameter != SHAFT_G3)
        closed[SHAFT_KS3] += 0.5 * paper[SHAFT_KG3];
}

/* ---- a row as part of a map ---- */

struct row {
    double value;
    struct cell shaft[COLUMNS], one_mode[COLUMNS];
};

static double column(const struct map *map, int i)
{
    return map->from + (map->to - map->from) * i / (COLUMNS - 1);
}

static void paper_at(const struct map *map, double value, int i, int mode, double *paper)
{
    attractor_paper(map->gap_stiffness, column(map, i), paper);
    set(map, value, paper);
    paper[SHAFT_PAPER_MODE] = mode;
}

static void fill_row(const struct map *map, uint64_t *seed, uint64_t *one_mode_seed, struct row *r)
{
    double paper[MODEL_PARAMETERS];
    for (int i = 0; i < COLUMNS; i++) {
        paper_at(map, r->value, i, map->mode[0], paper);
        r->shaft[i] = find(map, &shaft_bearing, paper, seed);
        r->one_mode[i] = find(map, &shaft_bearing_mode, paper, one_mode_seed);
    }
}

static double rounded(double x)
{
    return round(100.0 * log10(x * mm)) / 100.0;
}

static void draw_row(const struct map *map, const struct row *r)
{
    double paper[2][MODEL_PARAMETERS], hz[3], y = map->logarithmic ? log10(r->value) : r->value;
    char name[32];
    for (int i = 0; i < COLUMNS; i++) {
        for (int k = 0; k < map->n_coordinates; k++) {
            snprintf(name, sizeof name, "x%d", k + 1);
            rows_value(map->figure, name, column(map, i), y, rounded(r->shaft[i].high[k]));
        }
        rows_value(map->figure, "mode", column(map, i), y, rounded(r->one_mode[i].high[0]));
    }
    paper_at(map, r->value, 0, map->mode[0], paper[0]);
    close_gaps(map, paper[0], paper[1]);
    for (int closed = 0; closed < 2; closed++) {
        attractor_frequencies(paper[closed], 0.0, hz);
        for (int k = 0; k < 3; k++) {
            snprintf(name, sizeof name, "%s %d", closed ? "closed" : "open", k + 1);
            rows_point(map->figure, name, hz[k], y);
        }
    }
}

struct tally {
    int shaft, one_mode; /* impacts alone */
    int same, cells;     /* largest x1 within 10 %, of all */
};

static void count_row(const struct row *r, struct tally *t)
{
    for (int i = 0; i < COLUMNS; i++) {
        const struct cell *shaft = &r->shaft[i], *one_mode = &r->one_mode[i];
        t->shaft += shaft->impacts && !one_mode->impacts;
        t->one_mode += one_mode->impacts && !shaft->impacts;
        t->same += fabs(one_mode->high[0] - shaft->high[0]) < 0.1 * shaft->high[0];
        t->cells++;
    }
}

static void tell(const struct map *map, const struct tally *t)
{
    char name[96];
    snprintf(name, sizeof name, "fig %s: share where largest x1 of shaft and mode are within 10 %%",
             map->figure);
    rows_number(name, (double)t->same / t->cells);
    rows_number("  where only the shaft impacts", (double)t->shaft / t->cells);
    rows_number("  where only the mode does", (double)t->one_mode / t->cells);
}

/* ---- a row as responses ---- */

/* Where it impacts, and its peak. */
static void tell_row(const struct map *map, const char *who, double value, const struct cell *cell)
{
    char name[96];
    int n = 0, first = 0, last = 0, best = 0, k = map->n_coordinates - 1;
    for (int i = 0; i < COLUMNS; i++) {
        n += cell[i].impacts;
        first = cell[i].impacts && n == 1 ? i : first;
        last = cell[i].impacts ? i : last;
        best = cell[i].high[k] > cell[best].high[k] ? i : best;
    }
    snprintf(name, sizeof name, "fig %s at %.4g, %s: share of frequencies that impact", map->figure, value,
             who);
    rows_number(name, (double)n / COLUMNS);
    if (n > 0) {
        rows_number("  the first, Hz", column(map, first));
        rows_number("  the last", column(map, last));
    }
    rows_number("  peak (22, 23: of x3), Hz", column(map, best));
    rows_number("  x1, mm", cell[best].high[0] * mm);
    rows_number("  x3, mm", cell[best].high[2] * mm);
}

static void draw_cells(const struct map *map, const char *figure, const char *curve, const struct cell *cell)
{
    char name[48];
    for (int k = 0; k < map->n_coordinates; k++) {
        snprintf(name, sizeof name, "%s x%d", figure, k + 1);
        for (int i = 0; i < COLUMNS; i++)
            rows_point(name, curve, column(map, i), cell[i].high[k] * mm);
        rows_break();
    }
}

static void draw_responses(const struct map *map, const char *figure, const struct row *r)
{
    static struct cell other[COLUMNS];
    struct response theory = {
        .figure = figure, .from = map->from, .to = map->to, .n_coordinates = map->n_coordinates};
    double paper[MODEL_PARAMETERS];
    uint64_t seed = 23;
    paper_at(map, r->value, 0, map->mode[0], paper);
    close_gaps(map, paper, theory.paper);
    response_theory(&theory, "closed");
    memcpy(theory.paper, paper, sizeof theory.paper);
    response_theory(&theory, "theory");
    response_balance(&theory, "balance");
    draw_cells(map, figure, "true", r->shaft);
    draw_cells(map, figure, "mode", r->one_mode);
    tell_row(map, "shaft", r->value, r->shaft);
    tell_row(map, "mode", r->value, r->one_mode);
    if (map->mode[1] == 0)
        return;
    for (int i = 0; i < COLUMNS; i++) {
        paper_at(map, r->value, i, map->mode[1], paper);
        other[i] = find(map, &shaft_bearing_mode, paper, &seed);
    }
    draw_cells(map, figure, "other", other);
    tell_row(map, "the other mode", r->value, other);
}

int main(void)
{
    static struct row row, shown[2];
    uint64_t seed = 21, one_mode_seed = 22;
    char figure[32];
    rows_print_header();
    for (size_t j = 0; j < sizeof maps / sizeof *maps; j++) {
        const struct map *map = &maps[j];
        struct tally t = {.cells = 0};
        for (int i = 0; i < ROWS; i++) {
            double share = (double)i / (ROWS - 1);
            row.value = map->logarithmic ? map->low * pow(map->high / map->low, share)
                                         : map->low + (map->high - map->low) * share;
            fill_row(map, &seed, &one_mode_seed, &row);
            draw_row(map, &row);
            count_row(&row, &t);
            for (int k = 0; k < 2; k++)
                shown[k] = i == map->shown[k] ? row : shown[k];
        }
        rows_break();
        tell(map, &t);
        for (int k = 0; k < 2; k++) {
            snprintf(figure, sizeof figure, "%s %d", map->figure, k);
            draw_responses(map, figure, &shown[k]);
        }
    }
    return 0;
}
