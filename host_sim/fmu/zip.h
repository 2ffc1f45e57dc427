/* zip.h - writes a zip archive without compression. Equal contents give equal bytes: every file is of
 * 1980. */
#ifndef HOST_SIM_ZIP_H
#define HOST_SIM_ZIP_H

#include <stdbool.h>
#include <stdio.h>

enum { ZIP_FILES = 512, ZIP_NAME = 120 };

struct zip {
    FILE *out;
    unsigned long at; /* bytes written */
    int n;
    struct zip_entry {
        char name[ZIP_NAME];
        unsigned long crc, size, at;
    } entry[ZIP_FILES];
};

void zip_begin(struct zip *z, FILE *out);

/* False when there is no more room in the list, the name is too long, or writing fails. */
bool zip_add(struct zip *z, const char *name, const void *bytes, size_t n);

/* The directory at the end; false when writing fails. */
bool zip_end(struct zip *z);

#endif
