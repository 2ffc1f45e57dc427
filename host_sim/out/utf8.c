/* utf8.c - see utf8.h. */
#include "host_sim/out/utf8.h"

#include <stdbool.h>
#include <string.h>

/* Bytes of a sequence with this first byte; 0: none begins so. */
static size_t length_of(unsigned char first)
{
    return first < 0x80 ? 1 : first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
}

/* Whether byte i continues the sequence: the second one decides about overlong forms, surrogates and
 * U+10FFFF. */
static bool continues(const unsigned char *c, size_t i)
{
    unsigned char low = 0x80, high = 0xBF;
    if (i == 1) {
        low = c[0] == 0xE0 ? 0xA0 : c[0] == 0xF0 ? 0x90 : low;
        high = c[0] == 0xED ? 0x9F : c[0] == 0xF4 ? 0x8F : high;
    }
    return c[i] >= low && c[i] <= high;
}

struct utf8_character utf8_next(const char **at)
{
    const char *begin = *at;
    const unsigned char *c = (const unsigned char *)begin;
    size_t n = length_of(*c), i = 1;
    uint32_t code = n < 2 ? *c : *c & (0x7Fu >> n);
    for (; i < n && continues(c, i); i++)
        code = code << 6 | (c[i] & 0x3Fu);
    *at += i;
    return i == n ? (struct utf8_character){begin, n, code}
                  : (struct utf8_character){UTF8_REPLACEMENT, sizeof UTF8_REPLACEMENT - 1, 0xFFFD};
}

size_t utf8_mark(const char *text, size_t n)
{
    return n >= 3 && !memcmp(text, "\xEF\xBB\xBF", 3) ? 3 : 0;
}

int utf8_fits(const char *text, int size)
{
    const char *at = text, *end = text;
    while (*at && at - text <= size) {
        end = at;
        (void)utf8_next(&at);
    }
    return (int)((at - text <= size ? at : end) - text);
}

int utf8_field(const char *text, int characters)
{
    for (const char *c = text; *c; c++)
        characters += (*c & 0xC0) == 0x80;
    return characters;
}

void utf8_mend(char *text)
{
    const char *at = text;
    while (*at) {
        char *begin = text + (at - text);
        struct utf8_character c = utf8_next(&at);
        if (c.bytes != begin)
            memset(begin, '?', (size_t)(at - begin));
    }
}
