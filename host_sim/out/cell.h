/* cell.h - a number in a table for programs: CSV cells are empty where nothing is known. */
#ifndef HOST_SIM_CELL_H
#define HOST_SIM_CELL_H

#include <stdio.h>

/* The number in so many digits (17: it reads back to the last bit); nothing where it is not finite. There is
 * no -0. */
void cell_put(FILE *f, double value, int digits);

#endif
