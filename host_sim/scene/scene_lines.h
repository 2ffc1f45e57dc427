/* scene_lines.h - the lines of a scene file: words, sections, keys, and where a mistake is. Part of
 * scene_file.c's reading. */
#ifndef HOST_SIM_SCENE_LINES_H
#define HOST_SIM_SCENE_LINES_H

#include "host_sim/scene/scene_keys.h"
#include "host_sim/scene/scene_text.h"

struct line {
    int number;
    enum scene_section section;
    struct word input; /* INPUT of a [drive INPUT], SIGNAL of a [stage SIGNAL] */
    bool header;
    struct word key, value;
    const void *target; /* the member of the scene that it has set */
};

struct reader {
    const char *file;
    char *why;
    struct scene scene;
    struct line line[SCENE_FILE_KEYS];
    int n;
};

/* One line into r->why: file, line where it is not 0, and what is wrong. Always false. */
bool scene_lines_wrong(struct reader *r, int line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The n bytes of text into r->line: every line with a key or section, none before the first section, no
 * section twice. */
bool scene_lines_read(struct reader *r, const char *text, size_t n);

#endif
