/* basin_cells.c - see basin_cells.h. */
#include "host_sim/maps/basin/basin_cells.h"

#include <math.h>
#include <stddef.h>
#include "host_sim/cli/chart.h"

static void place_plane(struct basin_cells *c, const double *x, const double *y, size_t n)
{
    double low[2] = {(double)INFINITY, (double)INFINITY}, high[2] = {-(double)INFINITY, -(double)INFINITY};
    chart_range_add(&low[0], &high[0], x, n);
    chart_range_add(&low[1], &high[1], y, n);
    c->x = low[0];
    c->y = low[1];
    c->width = (high[0] - low[0]) / BASIN_COLUMNS;
    c->height = (high[1] - low[1]) / BASIN_LINES;
}

/* Gives a line the start where it is nearer than all before; distances are squares, in cells. */
static void offer(struct basin_cells *c, int line, double x, double y, int start, double *nearest)
{
    for (int k = 0; k < BASIN_COLUMNS; k++) {
        double dx = x - k - 0.5, dy = y - line - 0.5, distance = dx * dx + dy * dy;
        if (distance >= nearest[k])
            continue;
        nearest[k] = distance;
        c->start[line][k] = start;
    }
}

void basin_cells_make(struct basin_cells *c, const double *x, const double *y, int n)
{
    double nearest[BASIN_COLUMNS];
    place_plane(c, x, y, (size_t)n);
    for (int line = 0; line < BASIN_LINES; line++) {
        for (int k = 0; k < BASIN_COLUMNS; k++) {
            nearest[k] = (double)INFINITY;
            c->start[line][k] = -1;
        }
        for (int i = 0; i < n && c->width > 0.0 && c->height > 0.0; i++)
            offer(c, line, (x[i] - c->x) / c->width, (y[i] - c->y) / c->height, i, nearest);
    }
}
