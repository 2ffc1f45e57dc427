/* scene_lines.c - see scene_lines.h. */
#include "host_sim/scene/scene_lines.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/cli/options.h"

enum { FILE_SHOWN = 120 /* of a file's name in a message */ };

bool scene_lines_wrong(struct reader *r, int line, const char *format, ...)
{
    va_list list;
    int n = line ? snprintf(r->why, SCENE_FILE_REASON, "%.*s:%d: ", FILE_SHOWN, r->file, line)
                 : snprintf(r->why, SCENE_FILE_REASON, "%.*s: ", FILE_SHOWN, r->file);
    va_start(list, format);
    vsnprintf(r->why + n, (size_t)(SCENE_FILE_REASON - n), format, list);
    va_end(list);
    return false;
}

int scene_lines_shown(struct word w)
{
    return w.n < SCENE_LINES_SHOWN ? (int)w.n : SCENE_LINES_SHOWN;
}

bool scene_lines_is(struct word w, const char *name)
{
    return strlen(name) == w.n && !memcmp(w.at, name, w.n);
}

static bool same(struct word a, struct word b)
{
    return a.n == b.n && !memcmp(a.at, b.at, a.n);
}

static struct word trimmed(const char *at, size_t n)
{
    while (n && isspace((unsigned char)*at))
        at++, n--;
    while (n && isspace((unsigned char)at[n - 1]))
        n--;
    return (struct word){at, n};
}

const char *scene_lines_advice(struct word w, const char *const *name, int n,
                               char text[SCENE_FILE_REASON / 2])
{
    char own[SCENE_LINES_SHOWN + 1];
    snprintf(own, sizeof own, "%.*s", scene_lines_shown(w), w.at);
    const char *nearest = options_nearest(own, name, n);
    size_t length =
        (size_t)snprintf(text, SCENE_FILE_REASON / 2, nearest ? "; did you mean %s?" : "; there %s",
                         nearest  ? nearest
                         : n == 1 ? "is"
                                  : "are");
    for (int i = 0; i < n && !nearest && length < SCENE_FILE_REASON / 2; i++)
        length +=
            (size_t)snprintf(text + length, SCENE_FILE_REASON / 2 - length, "%s %s", i ? "," : "", name[i]);
    return text;
}

static bool read_header(struct reader *r, struct line *l, struct word w)
{
    char text[SCENE_FILE_REASON / 2];
    if (w.at[w.n - 1] != ']')
        return scene_lines_wrong(
            r, l->number, "%.*s: %s; write [plant], [ask], ..", scene_lines_shown(w), w.at,
            memchr(w.at, ']', w.n) ? "a section stands alone in its line" : "the bracket ] is missing");
    struct word name = trimmed(w.at + 1, w.n - 2);
    size_t first = 0;
    while (first < name.n && !isspace((unsigned char)name.at[first]))
        first++;
    l->input = trimmed(name.at + first, name.n - first);
    name.n = first;
    for (l->section = 0; l->section < SECTIONS; l->section++)
        if (scene_lines_is(name, scene_section_name[l->section]))
            break;
    if (l->section == SECTIONS)
        return scene_lines_wrong(r, l->number, "[%.*s]: no such section%s", scene_lines_shown(name), name.at,
                                 scene_lines_advice(name, scene_section_name, SECTIONS, text));
    if ((l->section == SECTION_DRIVE) != (l->input.n > 0))
        return scene_lines_wrong(r, l->number, "[%s]: %s", scene_section_name[l->section],
                                 l->input.n ? "one word too many" : "which input? write [drive INPUT]");
    l->header = true;
    return true;
}

/* Not empty, without comment and outer blanks. */
static bool read_line(struct reader *r, int number, struct word w)
{
    if (r->n == SCENE_FILE_KEYS)
        return scene_lines_wrong(r, number, "more than %d lines with a key or section", SCENE_FILE_KEYS);
    struct line *l = &r->line[r->n];
    *l = (struct line){.number = number};
    if (*w.at == '[') {
        if (!read_header(r, l, w))
            return false;
    } else {
        const char *equal = memchr(w.at, '=', w.n);
        if (!equal)
            return scene_lines_wrong(r, number, "\"%.*s\": write KEY = VALUE or [SECTION]",
                                     scene_lines_shown(w), w.at);
        l->key = trimmed(w.at, (size_t)(equal - w.at));
        l->value = trimmed(equal + 1, w.n - (size_t)(equal + 1 - w.at));
        if (!l->key.n || !l->value.n)
            return scene_lines_wrong(r, number, "\"%.*s\": %s is missing; write KEY = VALUE",
                                     scene_lines_shown(w), w.at, l->key.n ? "the value" : "the key");
        if (!r->n)
            return scene_lines_wrong(r, number, "%.*s: stands before the first section; begin with [plant]",
                                     scene_lines_shown(l->key), l->key.at);
        l->section = l[-1].section;
        l->input = l[-1].input;
    }
    for (int i = 0; i < r->n && l->header; i++)
        if (r->line[i].header && r->line[i].section == l->section && same(r->line[i].input, l->input))
            return scene_lines_wrong(r, number,
                                     "[%s%s%.*s] stands there already, in line %d; put its keys together",
                                     scene_section_name[l->section], l->input.n ? " " : "",
                                     scene_lines_shown(l->input), l->input.at, r->line[i].number);
    r->n++;
    return true;
}

/* 0, or the first byte of the line that is no plain text. */
static int odd_byte(const char *at, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        unsigned char c = (unsigned char)at[i];
        if ((c < ' ' && c != '\t' && !(c == '\r' && i + 1 == n)) || c > '~')
            return c ? c : 256;
    }
    return 0;
}

bool scene_lines_read(struct reader *r, const char *text, size_t n)
{
    if (n > SCENE_FILE_BYTES)
        return scene_lines_wrong(r, 0, "larger than %d bytes: not a scene", SCENE_FILE_BYTES);
    for (int number = 1; n; number++) {
        const char *end = memchr(text, '\n', n);
        size_t length = end ? (size_t)(end - text) : n, used = 0;
        int odd = odd_byte(text, length < SCENE_FILE_LINE ? length : SCENE_FILE_LINE);
        if (odd)
            return scene_lines_wrong(
                r, number, "byte 0x%02X: a scene is plain ASCII text (no byte order mark; um for micrometre)",
                odd & 255);
        if (length > SCENE_FILE_LINE)
            return scene_lines_wrong(r, number, "longer than %d characters", SCENE_FILE_LINE);
        while (used < length && text[used] != '#' && text[used] != ';')
            used++;
        struct word w = trimmed(text, used);
        if (w.n && !read_line(r, number, w))
            return false;
        text += length + (end != NULL);
        n -= length + (end != NULL);
    }
    return true;
}
