/* scene_file.h - a scene from a small text file. docs/guide/scenes.md is the manual of the format.
 *
 * Reading is pure: a buffer in, a scene or one line out. It takes UTF-8 up to SCENE_FILE_BYTES in
 * lines up to SCENE_FILE_LINE, nothing twice, and every value with its unit and inside its range. A
 * mistake is one line: file, line, key, what is wrong, what is allowed, and the nearest valid name. */
#ifndef HOST_SIM_SCENE_FILE_H
#define HOST_SIM_SCENE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include "models/scenes/scenes.h"

enum { SCENE_FILE_BYTES = 65536, SCENE_FILE_LINE = 255, SCENE_FILE_KEYS = 128, SCENE_FILE_REASON = 512 };

/* The n bytes of text, called `file` in messages. False, with *s as it was: why[SCENE_FILE_REASON] says
 * what is wrong. */
bool scene_file_parse(const char *file, const char *text, size_t n, struct scene *s, char *why);

/* As scene_file_parse without the step guard (scene_check_unstepped). */
bool scene_file_parse_unstepped(const char *file, const char *text, size_t n, struct scene *s, char *why);

#endif
