/* scene_text.c - see scene_text.h. */
#include "host_sim/scene/scene_text.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/cli/quotes.h"
#include "host_sim/out/utf8.h"

enum { FILE_SHOWN = 120 /* a file's name in a message is cut to it */ };

int scene_text_shown(struct word w)
{
    size_t n = w.n < SCENE_TEXT_SHOWN ? w.n : SCENE_TEXT_SHOWN;
    while (n && n < w.n && (w.at[n] & 0xC0) == 0x80) /* no character of UTF-8 is cut */
        n--;
    return (int)n;
}

bool scene_text_is(struct word w, const char *name)
{
    return strlen(name) == w.n && !memcmp(w.at, name, w.n);
}

bool scene_text_same(struct word a, struct word b)
{
    return a.n == b.n && !memcmp(a.at, b.at, a.n);
}

struct word scene_text_trimmed(struct word w)
{
    while (w.n && isspace((unsigned char)*w.at))
        w.at++, w.n--;
    while (w.n && isspace((unsigned char)w.at[w.n - 1]))
        w.n--;
    return w;
}

struct word scene_text_take(struct word *rest)
{
    struct word w = scene_text_trimmed(*rest);
    size_t n = 0;
    while (n < w.n && !isspace((unsigned char)w.at[n]))
        n++;
    *rest = scene_text_trimmed((struct word){w.at + n, w.n - n});
    return (struct word){w.at, n};
}

struct word scene_text_take_name(struct word *rest)
{
    struct word w = scene_text_trimmed(*rest);
    const char *end = w.n && (*w.at == '"' || *w.at == '\'') ? memchr(w.at + 1, *w.at, w.n - 1) : NULL;
    if (!end)
        return scene_text_take(rest);
    size_t n = (size_t)(end - w.at) + 1;
    *rest = scene_text_trimmed((struct word){w.at + n, w.n - n});
    return (struct word){w.at + 1, n - 2};
}

struct word scene_text_name(struct word w)
{
    struct word rest = w, name = scene_text_take_name(&rest);
    return rest.n ? w : name;
}

bool scene_text_wrong(const char *file, int line, char *why, const char *format, ...)
{
    va_list list;
    int n = line ? snprintf(why, SCENE_FILE_REASON, "%.*s:%d: ", FILE_SHOWN, file, line)
                 : snprintf(why, SCENE_FILE_REASON, "%.*s: ", FILE_SHOWN, file);
    va_start(list, format);
    vsnprintf(why + n, (size_t)(SCENE_FILE_REASON - n), format, list);
    va_end(list);
    return false;
}

/* 0, or the first byte of the line that is a control, or no UTF-8. */
static int odd_byte(const char *text, size_t n)
{
    char line[SCENE_FILE_LINE + UTF8_MAX] = "";
    const char *at = line, *end = line + (n < SCENE_FILE_LINE ? n : SCENE_FILE_LINE);
    memcpy(line, text, n < sizeof line ? n : sizeof line - 1);
    while (at < end) {
        const char *begin = at;
        unsigned char first = (unsigned char)*at;
        bool blank = first == '\t' || (first == '\r' && (size_t)(at + 1 - line) == n);
        struct utf8_character c = first ? utf8_next(&at) : (struct utf8_character){.code = 0};
        if (!blank && (c.code < ' ' || (c.code > '~' && c.code < 0xA0) || c.bytes != begin))
            return first ? first : 256;
    }
    return 0;
}

/* The key of a line in which quotes protect: that of a command, or of a name that begins with a quote. */
static struct word find_protected(const struct scene_text *t, struct word line)
{
    const char *equal = t->shell_key ? memchr(line.at, '=', line.n) : NULL, *end = line.at + line.n;
    struct word key = scene_text_trimmed((struct word){line.at, equal ? (size_t)(equal - line.at) : 0});
    const char *from = equal ? equal + 1 : end;
    struct word value = scene_text_trimmed((struct word){from, (size_t)(end - from)});
    bool quoted = value.n && (*value.at == '"' || *value.at == '\'');
    return equal && (quoted || scene_text_is(key, t->shell_key)) ? key : (struct word){NULL, 0};
}

/* Takes the comment off a line. False: a quote of a command does not end, and t->why says so. */
static bool cut_comment(const struct scene_text *t, struct word *line)
{
    struct quotes place = {0, false};
    struct word key = find_protected(t, *line);
    size_t used = 0;
    for (; used < line->n; used++) {
        if (!quotes_protect(&place) && (line->at[used] == '#' || line->at[used] == ';'))
            break;
        if (key.n)
            quotes_pass(&place, line->at[used]);
    }
    line->n = used;
    if (place.quote)
        return scene_text_wrong(t->file, t->line, t->why,
                                "%.*s: the quote %c does not end; write it once more", scene_text_shown(key),
                                key.at, place.quote);
    return true;
}

bool scene_text_next(struct scene_text *t, struct word *w)
{
    size_t mark = t->line ? 0 : utf8_mark(t->rest.at, t->rest.n);
    t->rest = (struct word){t->rest.at + mark, t->rest.n - mark};
    while (t->rest.n) {
        const char *text = t->rest.at, *end = memchr(text, '\n', t->rest.n);
        size_t length = end ? (size_t)(end - text) : t->rest.n;
        int odd = odd_byte(text, length);
        t->line++;
        if (odd)
            return scene_text_wrong(
                t->file, t->line, t->why,
                "byte 0x%02X: a %s is text in UTF-8 without control characters; save it so", odd & 255,
                t->what);
        if (length > SCENE_FILE_LINE)
            return scene_text_wrong(t->file, t->line, t->why, "longer than %d characters", SCENE_FILE_LINE);
        struct word line = {text, length};
        if (!cut_comment(t, &line))
            return false;
        *w = scene_text_trimmed(line);
        t->rest.at += length + (end != NULL);
        t->rest.n -= length + (end != NULL);
        if (w->n)
            return true;
    }
    return false;
}
