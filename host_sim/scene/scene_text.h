/* scene_text.h - the lexer of scene files and test files: lines of UTF-8, comments, words, and where a
 * mistake is. */
#ifndef HOST_SIM_SCENE_TEXT_H
#define HOST_SIM_SCENE_TEXT_H

#include "host_sim/scene/scene_file.h"

/* A stretch of the text. */
struct word {
    const char *at;
    size_t n;
};

/* How much of a word a message shows, for %.*s. */
enum { SCENE_TEXT_SHOWN = 40 };
int scene_text_shown(struct word w);

bool scene_text_is(struct word w, const char *name);
bool scene_text_same(struct word a, struct word b);

/* Without white space at both ends. */
struct word scene_text_trimmed(struct word w);

/* Takes the first word, up to white space, off *rest; empty when there is none. */
struct word scene_text_take(struct word *rest);

/* As scene_text_take, but what stands between quotes, " or ', is one name, without them. */
struct word scene_text_take_name(struct word *rest);

/* A name that is the whole of it, in quotes or not. */
struct word scene_text_name(struct word w);

/* One line into why[SCENE_FILE_REASON]: file, line where it is not 0, and the message. Always false. */
bool scene_text_wrong(const char *file, int line, char *why, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* A text, and how far it was read. All but `line` is the caller's to set. */
struct scene_text {
    const char *file, *what; /* "scene" */
    const char *shell_key;   /* a key whose quotes protect # and ;, as in a shell; so do quotes around any
                              * name then; or NULL: none */
    char *why;
    struct word rest;
    int line; /* that was taken last */
};

/* The next line that is not empty, without comment and outer blanks. False at the end, and at a mistake,
 * which is in why then; why begins empty. */
bool scene_text_next(struct scene_text *t, struct word *w);

#endif
