/* xml.c - see xml.h. */
#include "host_sim/out/xml.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/out/utf8.h"

enum { NUMBER_SIZE = 40 };

/* Blanks but ' ' are written by number: an attribute would lose them. */
static const char *entity_of(uint32_t code)
{
    switch (code) {
    case '&':
        return "&amp;";
    case '<':
        return "&lt;";
    case '>':
        return "&gt;";
    case '"':
        return "&quot;";
    case '\t':
        return "&#9;";
    case '\n':
        return "&#10;";
    case '\r':
        return "&#13;";
    default:
        return code < ' ' || code == 0xFFFE || code == 0xFFFF ? UTF8_REPLACEMENT : NULL;
    }
}

void xml_read(char *text)
{
    char *to = text;
    while (*text) {
        int code = *text == '&' ? 1 : 0;
        const char *entity = NULL;
        for (; code && code < 128 && !entity; code++) {
            entity = entity_of((uint32_t)code);
            entity = entity && !strncmp(text, entity, strlen(entity)) ? entity : NULL;
        }
        *to++ = (char)(entity ? code - 1 : *text);
        text += entity ? strlen(entity) : 1;
    }
    *to = 0;
}

static void put_text(FILE *file, const char *text)
{
    while (*text) {
        struct utf8_character c = utf8_next(&text);
        const char *entity = entity_of(c.code);
        if (entity)
            fputs(entity, file);
        else
            (void)fwrite(c.bytes, 1, c.n, file);
    }
}

static void put_number(FILE *file, double value)
{
    char text[NUMBER_SIZE];
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        double back = strtod(text, NULL);
        if (!(back < value) && !(back > value))
            break;
    }
    fputs(text, file);
}

static void put_argument(FILE *file, char kind, va_list *a)
{
    if (kind == 's')
        put_text(file, va_arg(*a, const char *));
    else if (kind == 'n')
        put_number(file, va_arg(*a, double));
    else if (kind == 'i')
        fprintf(file, "%d", va_arg(*a, int));
    else if (kind == 'u')
        fprintf(file, "%u", va_arg(*a, unsigned));
    else if (kind == 'r')
        fputs(va_arg(*a, const char *), file);
    else
        fprintf(file, "%.*f", kind == 't' ? 3 : 1, va_arg(*a, double));
}

void xml_put(FILE *file, const char *pattern, ...)
{
    va_list a;
    va_start(a, pattern);
    for (; *pattern; pattern++) {
        if (*pattern == '%')
            put_argument(file, *++pattern, &a);
        else
            fputc(*pattern == '\'' ? '"' : *pattern, file);
    }
    va_end(a);
}
