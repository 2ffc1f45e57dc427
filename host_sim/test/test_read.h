/* test_read.h - reads a test file: a buffer in, a test or one line out, with file, line, what is wrong,
 * what is allowed, and the nearest name. It is pure but for `load`. */
#ifndef HOST_SIM_TEST_READ_H
#define HOST_SIM_TEST_READ_H

#include "host_sim/test/test_file.h"

/* The n bytes of text, called `file` in messages. `load` finds a scene by its name: false with
 * why[SCENE_FILE_REASON]. False: why[TEST_REASON] is one line, and *t is not to be used. */
bool test_parse(const char *file, const char *text, size_t n,
                bool (*load)(const char *file, const char *name, struct scene *s, char *why),
                struct test_file *t, char *why);

#endif
