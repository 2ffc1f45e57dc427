/* gsf.h - height fields in files of Gwyddion Simple Field
 * 1.0: a text header, NULs to a multiple of 4, float32. */
#ifndef HOST_SIM_GSF_H
#define HOST_SIM_GSF_H

#include <stddef.h>
#include <stdio.h>

enum { GSF_SIDE = 65535, GSF_REASON = 160 };

struct gsf {
    size_t nx, ny;
    double width, length; /* m */
    const char *unit, *title;
    float *value; /* [ny][nx], the first row on top */
};

/* The file's errors are told by files_finish. */
void gsf_write(FILE *f, const struct gsf *g);

/* Reads a file of heights whose values are finite, into metres; g->value is from malloc. False:
 * why[GSF_REASON] says what is wrong. unit and title stay NULL. */
int gsf_read(FILE *f, struct gsf *g, char *why);

#endif
