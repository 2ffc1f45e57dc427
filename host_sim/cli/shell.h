/* shell.h - command lines of a POSIX shell: words that are printed for it, and what a line runs. */
#ifndef HOST_SIM_SHELL_H
#define HOST_SIM_SHELL_H

#include <stdbool.h>
#include <stdio.h>
#include "host_sim/cli/quotes.h"

/* Whether the line, without blanks around it, runs one program: no assignment, no list, no command of the
 * shell's own. Then `exec` may stand before it. */
bool shell_is_program(const char *line);

/* Writes a text into a command line at this place, so that a shell reads exactly this text there. Outside of
 * quotes it is one word: as it is where nothing in it is special, else in single quotes, a ' as '\''. */
void shell_put(FILE *f, struct quotes at, const char *text);

/* Writes a blank and the text as a word of a command line. */
void shell_put_word(FILE *f, const char *word);

#endif
