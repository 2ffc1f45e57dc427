/* shaft_linear.c - figures 4 to 7 and 21 of the shaft-bearing paper: linear frequencies and responses, exact.
 * Prints docs/img/papers/shaft_linear.csv. */
#include <math.h>
#include <stdio.h>
#include "tests/papers/response.h"
#include "tests/papers/rows.h"

enum { CURVE = 60 };

/* The modes at one stiffness: frequencies, and shapes as figure `shapes` (NULL: not wanted). */
static void draw_modes(const char *figure, const char *shapes, const double *paper, double closed,
                       double stiffness)
{
    double hz[3], shape[3][3];
    char name[32];
    attractor_modes(paper, closed, hz, shape);
    for (int k = 0; k < 3; k++) {
        snprintf(name, sizeof name, "mode %d", k + 1);
        rows_point(figure, name, stiffness, hz[k]);
        for (int i = 0; shapes && i < 3; i++) {
            snprintf(name, sizeof name, "mode %d x%d", k + 1, i + 1);
            rows_point(shapes, name, stiffness, shape[k][i]);
        }
    }
}

/* Figures 4, 5, 21: gaps closed against the gap springs; gaps open, and closed, against one support. */
static void draw_frequencies(void)
{
    double paper[MODEL_PARAMETERS];
    for (int i = 0; i <= CURVE; i++) {
        double share = (double)i / CURVE, kg = 35.02 * pow(1e9, share);
        attractor_paper(kg, 25.0, paper);
        draw_modes("4", "4b", paper, 1.0, kg);
        paper[SHAFT_KS3] = 8030.0 * share;
        paper[SHAFT_KG1] = paper[SHAFT_KG3] = SHAFT_SOFT;
        draw_modes("5", "5b", paper, 0.0, 8030.0 * share);
        draw_modes("21", NULL, paper, 1.0, 8030.0 * share);
    }
    rows_break();
}

/* Figures 6, 7: one weak support, the force on the middle or on bearing 1. */
static void draw_responses(void)
{
    static const double ks3[] = {8030.0, 4015.0, 803.0, 0.0};
    char name[32];
    for (int high = 0; high < 2; high++) {
        for (int middle = 0; middle < 2; middle++) {
            struct response r = {.figure = middle ? high ? "6 high" : "6 low"
                                           : high ? "7 high"
                                                  : "7 low",
                                 .from = high ? 690.0 : 1.0,
                                 .to = high ? 710.0 : 70.0,
                                 .n_coordinates = 3};
            for (int k = 0; k < 4; k++) {
                attractor_paper(SHAFT_HARD, 25.0, r.paper);
                r.paper[SHAFT_KS3] = ks3[k];
                r.paper[SHAFT_PAPER_P1] = middle ? 0.0 : 25.0;
                r.paper[SHAFT_PAPER_P1 + 1] = middle ? 25.0 : 0.0;
                snprintf(name, sizeof name, "ks3 %d", k);
                response_theory(&r, name);
            }
        }
    }
}

int main(void)
{
    rows_print_header();
    draw_frequencies();
    draw_responses();
    return 0;
}
