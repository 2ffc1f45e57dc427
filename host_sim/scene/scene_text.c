/* scene_text.c - see scene_text.h. */
#include "host_sim/scene/scene_text.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/cli/quotes.h"

enum { FILE_SHOWN = 120 /* a file's name in a message is cut to it */ };

int scene_text_shown(struct word w)
{
    return w.n < SCENE_TEXT_SHOWN ? (int)w.n : SCENE_TEXT_SHOWN;
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

/* Whether the line is the value of the key whose quotes protect. */
static bool is_shell_line(const struct scene_text *t, struct word line)
{
    const char *equal = t->shell_key ? memchr(line.at, '=', line.n) : NULL;
    return equal &&
           scene_text_is(scene_text_trimmed((struct word){line.at, (size_t)(equal - line.at)}), t->shell_key);
}

/* Takes the comment off a line. False: a quote of a command does not end, and t->why says so. */
static bool cut_comment(const struct scene_text *t, struct word *line)
{
    struct quotes place = {0, false};
    bool shell = is_shell_line(t, *line);
    size_t used = 0;
    for (; used < line->n; used++) {
        if (!quotes_protect(&place) && (line->at[used] == '#' || line->at[used] == ';'))
            break;
        if (shell)
            quotes_pass(&place, line->at[used]);
    }
    line->n = used;
    if (place.quote)
        return scene_text_wrong(t->file, t->line, t->why, "%s: the quote %c does not end; write it once more",
                                t->shell_key, place.quote);
    return true;
}

bool scene_text_next(struct scene_text *t, struct word *w)
{
    while (t->rest.n) {
        const char *text = t->rest.at, *end = memchr(text, '\n', t->rest.n);
        size_t length = end ? (size_t)(end - text) : t->rest.n;
        int odd = odd_byte(text, length < SCENE_FILE_LINE ? length : SCENE_FILE_LINE);
        t->line++;
        if (odd)
            return scene_text_wrong(
                t->file, t->line, t->why,
                "byte 0x%02X: a %s is plain ASCII text (no byte order mark; um for micrometre)", odd & 255,
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
