/* requirements.h - the requirements that cases name (requirement = ID, ID), and a list of all that there are.
 */
#ifndef HOST_SIM_REQUIREMENTS_H
#define HOST_SIM_REQUIREMENTS_H

#include "host_sim/test/test_file.h"

enum { REQUIREMENTS_MAX = 10000, REQUIREMENTS_REASON = 512 };

struct requirement {
    const char *id, *text;
};

/* A list of ID,TEXT lines, in its order. All zero: none was given. */
struct requirements {
    const char *path;
    char *bytes; /* the entries point into it */
    int n;
    struct requirement *entry;
};

/* Reads a CSV with an identifier in the first column and its text in the second one; a first line whose
 * identifier is `id` is the header. False: why says which line is wrong, and how. requirements_free in any
 * case. */
bool requirements_read(struct requirements *l, const char *path, char why[REQUIREMENTS_REASON]);

/* Whether all that the cases of a test file name are in the list. False: why names line and nearest one. */
bool requirements_know(const struct requirements *l, const struct test_file *t,
                       char why[REQUIREMENTS_REASON]);

/* Whether this case names it. */
bool requirements_names(const struct test_case *c, const char *id);

/* The text of an identifier, "" where it is not in the list. */
const char *requirements_text(const struct requirements *l, const char *id);

void requirements_free(struct requirements *l);

#endif
