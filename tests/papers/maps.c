/* maps.c - figures 10, 11, 17, 20, 22, 23 of the shaft-bearing paper: largest x1 (22, 23: all three) against frequency and
 * one parameter, the larger of two starts, with the linear frequencies of open and closed gaps as limits. Prints
 * docs/papers/maps.csv. */
#include <math.h>
#include <stdio.h>
#include "tests/papers/attractor.h"
#include "tests/papers/rows.h"

enum { ROWS = 17, COLUMNS = 61 };
static const double mm = 1e3;

/* One map: `parameter` and, when both, that of the other bearing run over [low, high], in equal ratios if logarithmic. */
struct map {
    const char *figure;
    int parameter, other;
    double low, high;
    bool logarithmic;
    double gap_stiffness, from, to, seconds;
    int n_coordinates; /* 1: x1, 3: all */
};

#define LOW  2.0, 152.0, 3.0
#define HIGH 650.0, 770.0, 3.0
static const struct map maps[] = {
    {"10 low", SHAFT_G1, SHAFT_G3, 2e-5, 2e-2, true, SHAFT_HARD, LOW, 1},
    {"10 high", SHAFT_G1, SHAFT_G3, 2e-5, 6e-4, true, SHAFT_HARD, HIGH, 1},
    {"11 low", SHAFT_KG1, SHAFT_KG3, 1e3, 3.502e7, true, SHAFT_HARD, LOW, 1},
    {"11 high", SHAFT_KG1, SHAFT_KG3, 1e3, 3.502e7, true, SHAFT_HARD, HIGH, 1},
    {"17 low", SHAFT_C1, SHAFT_C3, 4.0, 184.0, true, SHAFT_HARD, LOW, 1},
    {"17 high", SHAFT_C1, SHAFT_C3, 4.0, 184.0, true, SHAFT_HARD, HIGH, 1},
    {"20 soft low", SHAFT_KS3, SHAFT_KS3, 0.0, 8030.0, false, SHAFT_SOFT, LOW, 1},
    {"20 soft high", SHAFT_KS3, SHAFT_KS3, 0.0, 8030.0, false, SHAFT_SOFT, HIGH, 1},
    {"20 hard low", SHAFT_KS3, SHAFT_KS3, 0.0, 8030.0, false, SHAFT_HARD, LOW, 1},
    {"20 hard high", SHAFT_KS3, SHAFT_KS3, 0.0, 8030.0, false, SHAFT_HARD, HIGH, 1},
    {"22 low", SHAFT_G3, SHAFT_G3, 2.54e-4, 2e-2, true, SHAFT_HARD, LOW, 3},
    {"22 high", SHAFT_G3, SHAFT_G3, 2.54e-4, 2e-2, true, SHAFT_HARD, HIGH, 3},
    {"23 low", SHAFT_KG3, SHAFT_KG3, 1e3, 3.502e7, true, SHAFT_HARD, LOW, 3},
    {"23 high", SHAFT_KG3, SHAFT_KG3, 1e3, 3.502e7, true, SHAFT_HARD, HIGH, 3},
};

static void set(const struct map *map, double value, double *paper)
{
    paper[map->parameter] = paper[map->other] = value;
    if (map->parameter == SHAFT_C1)
        paper[SHAFT_C1 + 1] = value;
}

/* The largest values of two starts, one of them rest. */
static void find(const struct map *map, const double *paper, uint64_t *seed, double *high)
{
    struct attractor_shaft s;
    double state[MODEL_STATES];
    high[0] = high[1] = high[2] = 0.0;
    if (!attractor_open(&s, &shaft_bearing, paper))
        return;
    for (int k = 0; k < 2; k++) {
        struct attractor a;
        attractor_start(seed, paper[SHAFT_G1], state);
        if (!attractor_settle(&s, k ? state : NULL, map->seconds, &a))
            continue;
        for (int i = 0; i < 3; i++)
            high[i] = fmax(high[i], a.high[i]);
    }
    attractor_close(&s);
}

static void draw_row(const struct map *map, double value, double y, uint64_t *seed)
{
    double paper[MODEL_PARAMETERS], high[3], hz[3];
    char name[32];
    for (int i = 0; i < COLUMNS; i++) {
        double f = map->from + (map->to - map->from) * i / (COLUMNS - 1);
        attractor_paper(map->gap_stiffness, f, paper);
        set(map, value, paper);
        find(map, paper, seed, high);
        for (int k = 0; k < map->n_coordinates; k++) {
            snprintf(name, sizeof name, "x%d", k + 1);
            rows_value(map->figure, name, f, y, round(100.0 * log10(high[k] * mm)) / 100.0);
        }
    }
    for (int closed = 0; closed < 2; closed++) {
        attractor_frequencies(paper, closed, hz);
        for (int k = 0; k < 3; k++) {
            snprintf(name, sizeof name, "%s %d", closed ? "closed" : "open", k + 1);
            rows_point(map->figure, name, hz[k], y);
        }
    }
}

int main(void)
{
    uint64_t seed = 21;
    rows_begin();
    for (size_t j = 0; j < sizeof maps / sizeof *maps; j++) {
        const struct map *map = &maps[j];
        for (int i = 0; i < ROWS; i++) {
            double share = (double)i / (ROWS - 1);
            double value = map->logarithmic ? map->low * pow(map->high / map->low, share)
                                            : map->low + (map->high - map->low) * share;
            draw_row(map, value, map->logarithmic ? log10(value) : value, &seed);
        }
        rows_break();
    }
    return 0;
}
