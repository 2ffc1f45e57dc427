/* rows.c - see rows.h. */
#include "tests/papers/rows.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

static bool piece_open;

void rows_print_header(void)
{
    printf("figure,curve,x,y\n");
}

void rows_point(const char *figure, const char *curve, double x, double y)
{
    if (isnan(x) || isnan(y))
        return;
    printf("%s,%s,%.4g,%.4g\n", figure, curve, x, y);
    piece_open = true;
}

void rows_value(const char *figure, const char *curve, double x, double y, double z)
{
    printf("%s,%s,%.4g,%.4g,%.4g\n", figure, curve, x, y, z);
    piece_open = true;
}

void rows_break(void)
{
    if (piece_open)
        printf("\n");
    piece_open = false;
}

void rows_number(const char *name, double value)
{
    fprintf(stderr, "%-60s %.7g\n", name, value);
}
