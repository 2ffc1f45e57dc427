/* pages.h - the guides, the reference and the reasons as files beside the program: in share/doc/contactplant
 * of an installation, or in the source tree that has the build folder. */
#ifndef HOST_SIM_PAGES_H
#define HOST_SIM_PAGES_H

#include <stdbool.h>
#include "host_sim/cli/beside.h"
#include "host_sim/cli/options_nearest.h"

enum { PAGES_MAX = 128, PAGES_NAME = 64, PAGES_LINE = 4096 };

struct pages {
    char folder[BESIDE_PATH];
    int n;
    char name[PAGES_MAX][PAGES_NAME]; /* "docs/guide/fmi.md": guides first, then reference, other folders of
                                         docs, others */
};

/* Finds them. False: there are none, and why[size] says what to do. */
bool pages_find(struct pages *p, char *why, size_t size);

/* The page of this name: "fmi", "guide/fmi", "docs/guide/fmi.md", whatever its capitals; or -1. */
int pages_named(const struct pages *p, const char *word);

/* The short name of a page, as pages_named takes it, into name[PAGES_NAME]. */
void pages_short(const struct pages *p, int i, char *name);

/* The nearest short name to a word, or NULL. */
const char *pages_nearest(const struct pages *p, const char *word);

/* The text of a page, which the caller frees; NULL, and errno, where it cannot be read. */
char *pages_read(const struct pages *p, int i);

#endif
