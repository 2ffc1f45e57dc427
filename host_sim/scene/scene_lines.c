/* scene_lines.c - see scene_lines.h. */
#include "host_sim/scene/scene_lines.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/cli/options.h"
#include "host_sim/cli/options_nearest.h"

bool scene_lines_wrong(struct reader *r, int line, const char *format, ...)
{
    char text[SCENE_FILE_REASON];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    return scene_text_wrong(r->file, line, r->why, "%s", text);
}

static bool read_header(struct reader *r, struct line *l, struct word w)
{
    if (w.at[w.n - 1] != ']')
        return scene_lines_wrong(
            r, l->number, "%.*s: %s; write [plant], [ask], ..", scene_text_shown(w), w.at,
            memchr(w.at, ']', w.n) ? "a section stands alone in its line" : "the bracket ] is missing");
    l->input = (struct word){w.at + 1, w.n - 2};
    struct word name = scene_text_take(&l->input);
    for (l->section = 0; l->section < SECTIONS; l->section++)
        if (scene_text_is(name, scene_section_name[l->section]))
            break;
    if (l->section == SECTIONS)
        return scene_lines_wrong(r, l->number, "[%.*s]: no such section%s", scene_text_shown(name), name.at,
                                 options_advise(name.at, name.n, scene_section_name, SECTIONS, NULL));
    bool named = l->section == SECTION_DRIVE || l->section == SECTION_STAGE;
    if (named != (l->input.n > 0))
        return scene_lines_wrong(r, l->number, "[%s]: %s", scene_section_name[l->section],
                                 l->input.n ? "one word too many"
                                 : l->section == SECTION_DRIVE
                                     ? "which input? write [drive INPUT]"
                                     : "which signal? write [stage INPUT] or [stage OUTPUT]");
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
                                     scene_text_shown(w), w.at);
        l->key = scene_text_trimmed((struct word){w.at, (size_t)(equal - w.at)});
        l->value = scene_text_trimmed((struct word){equal + 1, w.n - (size_t)(equal + 1 - w.at)});
        if (!l->key.n || !l->value.n)
            return scene_lines_wrong(r, number, "\"%.*s\": %s is missing; write KEY = VALUE",
                                     scene_text_shown(w), w.at, l->key.n ? "the value" : "the key");
        if (!r->n)
            return scene_lines_wrong(r, number, "%.*s: stands before the first section; begin with [plant]",
                                     scene_text_shown(l->key), l->key.at);
        l->section = l[-1].section;
        l->input = l[-1].input;
    }
    for (int i = 0; i < r->n && l->header; i++)
        if (r->line[i].header && r->line[i].section == l->section &&
            scene_text_same(r->line[i].input, l->input))
            return scene_lines_wrong(r, number,
                                     "[%s%s%.*s] stands there already, in line %d; put its keys together",
                                     scene_section_name[l->section], l->input.n ? " " : "",
                                     scene_text_shown(l->input), l->input.at, r->line[i].number);
    r->n++;
    return true;
}

bool scene_lines_read(struct reader *r, const char *text, size_t n)
{
    struct scene_text t = {.file = r->file, .what = "scene", .why = r->why, .rest = {text, n}};
    struct word w;
    if (n > SCENE_FILE_BYTES)
        return scene_lines_wrong(r, 0, "larger than %d bytes: not a scene", SCENE_FILE_BYTES);
    *r->why = 0;
    while (scene_text_next(&t, &w))
        if (!read_line(r, t.line, w))
            return false;
    return !*r->why;
}
