/* json.h - JSON text in a buffer of fixed size: what does not fit is left out whole, and that is told. */
#ifndef HOST_SIM_JSON_H
#define HOST_SIM_JSON_H

#include <stdbool.h>
#include <stddef.h>

struct json {
    char *at;
    size_t size, n; /* the buffer has; are in it, always with a NUL behind */
    bool full;      /* something did not fit */
};

void json_begin(struct json *j, char *buffer, size_t size);

/* Adds a pattern, whole or not at all. In it ' stands for ", and these for an argument:
 *   %s text with quotes    %n double, 9 digits     %u uint64_t
 *   %r text as it is       %t double, 15 digits    %b bool (int): true or false
 * A number that is not finite is null. */
void json_put(struct json *j, const char *pattern, ...);

/* As json_put, with a comma before it where one is due: not at the begin of the buffer, nor behind a colon or
 * a bracket that opens. */
void json_item(struct json *j, const char *pattern, ...);

#endif
