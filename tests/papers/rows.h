/* rows.h - the CSV behind a chart of docs/papers/figures.md, to standard output: figure,curve,x,y[,z]; an
 * empty line ends a piece of a curve. */
#ifndef TESTS_PAPERS_ROWS_H
#define TESTS_PAPERS_ROWS_H

void rows_print_header(void);
/* A NaN is left out. rows_value: with a fifth column. */
void rows_point(const char *figure, const char *curve, double x, double y);
void rows_value(const char *figure, const char *curve, double x, double y, double z);
void rows_break(void);

/* A number for the text: to standard error. */
void rows_number(const char *name, double value);

#endif
