/* basin_cells.h - a plane of starts as cells: each belongs to the start nearest to its middle. */
#ifndef HOST_SIM_BASIN_CELLS_H
#define HOST_SIM_BASIN_CELLS_H

enum { BASIN_COLUMNS = 120, BASIN_LINES = 44 };

struct basin_cells {
    double x, y, width, height;            /* the corner of the plane, the size of a cell */
    int start[BASIN_LINES][BASIN_COLUMNS]; /* -1 in all cells: the starts span no plane */
};

/* Cells over the n starts x[], y[], which are finite. */
void basin_cells_make(struct basin_cells *c, const double *x, const double *y, int n);

#endif
