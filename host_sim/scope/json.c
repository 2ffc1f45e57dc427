/* json.c - see json.h. */
#include "host_sim/scope/json.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { NUMBER_SIZE = 40 };

void json_begin(struct json *j, char *buffer, size_t size)
{
    *j = (struct json){.at = buffer, .size = size};
    buffer[0] = '\0';
}

static void add_bytes(struct json *j, const char *bytes, size_t n)
{
    if (j->full || n >= j->size - j->n) {
        j->full = true;
        return;
    }
    memcpy(j->at + j->n, bytes, n);
    j->n += n;
    j->at[j->n] = '\0';
}

static void add_text(struct json *j, const char *text)
{
    add_bytes(j, "\"", 1);
    for (; *text; text++) {
        char escape[8];
        unsigned char c = (unsigned char)*text;
        if (c == '"' || c == '\\')
            add_bytes(j, "\\", 1);
        if (c >= ' ')
            add_bytes(j, text, 1);
        else
            add_bytes(j, escape, (size_t)snprintf(escape, sizeof escape, "\\u%04x", c));
    }
    add_bytes(j, "\"", 1);
}

static void add_number(struct json *j, double value, int digits)
{
    char text[NUMBER_SIZE];
    if (isfinite(value))
        add_bytes(j, text, (size_t)snprintf(text, sizeof text, "%.*g", digits, value));
    else
        add_bytes(j, "null", 4);
}

static void add_argument(struct json *j, char kind, va_list *a)
{
    char text[NUMBER_SIZE];
    const char *raw = text;
    if (kind == 's') {
        add_text(j, va_arg(*a, const char *));
        return;
    }
    if (kind == 'n' || kind == 't') {
        add_number(j, va_arg(*a, double), kind == 'n' ? 9 : 15);
        return;
    }
    if (kind == 'u')
        snprintf(text, sizeof text, "%" PRIu64, va_arg(*a, uint64_t));
    else if (kind == 'b')
        raw = va_arg(*a, int) ? "true" : "false";
    else
        raw = va_arg(*a, const char *);
    add_bytes(j, raw, strlen(raw));
}

static void put(struct json *j, const char *pattern, va_list *a)
{
    for (; *pattern; pattern++) {
        if (*pattern == '%')
            add_argument(j, *++pattern, a);
        else
            add_bytes(j, *pattern == '\'' ? "\"" : pattern, 1);
    }
}

/* Takes back what came after `before` where it is not whole. */
static void settle(struct json *j, size_t before)
{
    if (!j->full)
        return;
    j->n = before;
    j->at[before] = '\0';
}

void json_put(struct json *j, const char *pattern, ...)
{
    size_t before = j->n;
    va_list a;
    va_start(a, pattern);
    put(j, pattern, &a);
    va_end(a);
    settle(j, before);
}

void json_item(struct json *j, const char *pattern, ...)
{
    size_t before = j->n;
    va_list a;
    if (before && !strchr("[{:", j->at[before - 1]))
        add_bytes(j, ",", 1);
    va_start(a, pattern);
    put(j, pattern, &a);
    va_end(a);
    settle(j, before);
}
