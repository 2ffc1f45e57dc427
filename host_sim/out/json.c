/* json.c - see json.h. */
#include "host_sim/out/json.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>
#include "host_sim/out/utf8.h"

enum { NUMBER_SIZE = 40 };

void json_begin(struct json *j, char *buffer, size_t size)
{
    *j = (struct json){.at = buffer, .size = size};
    buffer[0] = '\0';
}

void json_begin_file(struct json *j, FILE *file)
{
    *j = (struct json){.file = file};
}

static void keep_bytes(struct json *j, const char *bytes, size_t n)
{
    if (j->full || n >= j->size - j->n) {
        j->full = true;
        return;
    }
    memcpy(j->at + j->n, bytes, n);
    j->n += n;
    j->at[j->n] = '\0';
}

static void add_bytes(struct json *j, const char *bytes, size_t n)
{
    if (j->file)
        (void)fwrite(bytes, 1, n, j->file);
    else
        keep_bytes(j, bytes, n);
    for (; n > 0; n--)
        if (!strchr(" \n", bytes[n - 1])) {
            j->last = bytes[n - 1];
            return;
        }
}

static void add_text(struct json *j, const char *text)
{
    const char *escaped = j->in_page ? "\"\\<>&" : "";
    add_bytes(j, "\"", 1);
    while (*text) {
        char escape[8];
        struct utf8_character c = utf8_next(&text);
        if (c.code < ' ' || (c.n == 1 && strchr(escaped, (int)c.code)))
            add_bytes(j, escape, (size_t)snprintf(escape, sizeof escape, "\\u%04x", (unsigned)c.code));
        else {
            if (c.code == '"' || c.code == '\\')
                add_bytes(j, "\\", 1);
            add_bytes(j, c.bytes, c.n);
        }
    }
    add_bytes(j, "\"", 1);
}

void json_read(char *text)
{
    char *to = text;
    for (; *text; text++) {
        text += *text == '\\' && (text[1] == '"' || text[1] == '\\');
        *to++ = *text;
    }
    *to = 0;
}

static void add_number(struct json *j, double value, int digits)
{
    char text[NUMBER_SIZE];
    if (isfinite(value))
        add_bytes(j, text,
                  (size_t)snprintf(text, sizeof text, "%.*g", digits, value + 0.0)); /* there is no -0 */
    else
        add_bytes(j, "null", 4);
}

static void add_integer(struct json *j, char kind, va_list *a)
{
    char text[NUMBER_SIZE];
    int n = kind == 'i'   ? snprintf(text, sizeof text, "%d", va_arg(*a, int))
            : kind == 'h' ? snprintf(text, sizeof text, "\"%016" PRIx64 "\"", va_arg(*a, uint64_t))
                          : snprintf(text, sizeof text, "%" PRIu64, va_arg(*a, uint64_t));
    add_bytes(j, text, (size_t)n);
}

static void add_argument(struct json *j, char kind, va_list *a)
{
    if (kind == 's')
        add_text(j, va_arg(*a, const char *));
    else if (strchr("nte", kind))
        add_number(j, va_arg(*a, double), kind == 'n' ? 9 : kind == 't' ? 15 : 17);
    else if (strchr("uih", kind))
        add_integer(j, kind, a);
    else {
        const char *raw = kind != 'b' ? va_arg(*a, const char *) : va_arg(*a, int) ? "true" : "false";
        add_bytes(j, raw, strlen(raw));
    }
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

void json_take_back(struct json *j, const struct json *before)
{
    j->n = before->n;
    j->last = before->last;
    j->at[j->n] = '\0';
}

void json_put(struct json *j, const char *pattern, ...)
{
    struct json before = *j;
    va_list a;
    va_start(a, pattern);
    put(j, pattern, &a);
    va_end(a);
    if (j->full)
        json_take_back(j, &before);
}

void json_item(struct json *j, const char *pattern, ...)
{
    struct json before = *j;
    va_list a;
    if (j->last && !strchr("[{:", j->last))
        add_bytes(j, ",", 1);
    va_start(a, pattern);
    put(j, pattern, &a);
    va_end(a);
    if (j->full)
        json_take_back(j, &before);
}
