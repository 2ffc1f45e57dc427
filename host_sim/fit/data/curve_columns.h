/* curve_columns.h - the columns of a response curve, and a row of it in SI. */
#ifndef HOST_SIM_FIT_CURVE_COLUMNS_H
#define HOST_SIM_FIT_CURVE_COLUMNS_H

#include "host_sim/fit/data/curve.h"

enum { CURVE_VALUE = 64 };

/* Numbers of columns, -1 where there is none, and factors to SI. */
struct curve_column {
    int frequency, amplitude, phase, sigma, re, im, kind, direction, family;
    double frequency_Hz, amplitude_SI, phase_rad, sigma_SI, ratio_SI;
};

/* All that is known of a file before its rows. */
struct curve_file {
    const struct scene *scene;
    struct curve curve;            /* it holds for all of its curves */
    char amplitude[CURVE_VALUE];   /* as it stands in the file */
    int amplitude_line, direction; /* 1: up, -1: down, 0: not given */
    bool of_sweep, falling;
    struct curve_column column;
};

struct curve_row {
    bool skipped; /* it is no point of a curve */
    bool down;
    double amplitude; /* amplitude of the drive */
    struct curve_point point;
};

/* Finds the columns, and the output by the unit of the amplitude where the file names none. */
int curve_columns_find(struct table *t, struct curve_file *f);

int curve_columns_row(const struct table *t, const struct curve_file *f, struct curve_row *row);

#endif
