/* json.h - the one writer of JSON (RFC 8259), into a file or into a buffer of fixed size. Every text is UTF-8
 * when it is written (host_sim/out/utf8.h), and a number that is not finite is null. */
#ifndef HOST_SIM_JSON_H
#define HOST_SIM_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct json {
    FILE *file;     /* NULL: a buffer */
    char *at;       /* the buffer */
    size_t size, n; /* the buffer has; are in it, always with a NUL behind */
    bool full;      /* something did not fit */
    bool in_page;   /* inside a script of HTML: < > & are escaped, too */
    char last;      /* the last byte that is no blank, or 0 */
};

/* Into a buffer: what does not fit is left out whole, and that is told. */
void json_begin(struct json *j, char *buffer, size_t size);

/* Into a file; its errors are told by ferror. */
void json_begin_file(struct json *j, FILE *file);

/* Adds a pattern, in a buffer whole or not at all. In it ' stands for ", and these for an argument:
 *   %s text with quotes    %n double, 9 digits     %u uint64_t
 *   %r text as it is       %t double, 15 digits    %i int
 *   %h uint64_t, as a      %e double, 17 digits:   %b bool (int): true or false
 *      text of hex digits     reads back the same */
void json_put(struct json *j, const char *pattern, ...);

/* As json_put, with a comma before it where one is due: not at the begin, nor behind a colon or a bracket
 * that opens. */
void json_item(struct json *j, const char *pattern, ...);

/* Takes the escapes of %s back, in place, but for controls. */
void json_read(char *text);

/* Takes back what came into a buffer since `before` was a copy of it. */
void json_take_back(struct json *j, const struct json *before);

#endif
