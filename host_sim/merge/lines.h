/* lines.h - a file that is read line by line, however long a line is. */
#ifndef HOST_SIM_LINES_H
#define HOST_SIM_LINES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct lines {
    FILE *f;
    char *text; /* the line, with its end where it has one */
    size_t room;
    long number; /* counts lines, from 1 */
};

/* False with errno. lines_close in any case. */
bool lines_open(struct lines *l, const char *path);

/* The next line into text. False at the end of the file. */
bool lines_next(struct lines *l);

/* Whether the line begins, or ends, so; and the first place that has a text, or NULL. In all three ' stands
 * for
 * ", as in json_put and xml_put. */
bool lines_begins(const struct lines *l, const char *begin);
bool lines_ends(const struct lines *l, const char *end);
const char *lines_find(const struct lines *l, const char *text);

void lines_close(struct lines *l);

#endif
