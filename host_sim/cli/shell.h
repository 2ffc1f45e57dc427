/* shell.h - the words of a POSIX shell: quoted in a command line that is printed, and the quotes of one that
 * is read. */
#ifndef HOST_SIM_SHELL_H
#define HOST_SIM_SHELL_H

#include <stdbool.h>
#include <stdio.h>

/* Where a character of a command line stands. All zero: before the first one. */
struct shell_place {
    char quote;   /* ' or ", or 0 outside of quotes */
    bool escaped; /* a backslash stands before it */
};

/* Passes over the character c of a command line. */
void shell_pass(struct shell_place *p, char c);

/* Whether quotes or a backslash protect what stands here. */
bool shell_is_protected(const struct shell_place *p);

/* Whether the line, without blanks around it, runs one program: no assignment, no list, no command of the
 * shell's own. Then `exec` may stand before it. */
bool shell_is_program(const char *line);

/* Writes a text into a command line at this place, so that a shell reads exactly this text there. Outside of
 * quotes it is one word: as it is where nothing in it is special, else in single quotes, a ' as '\''. */
void shell_put(FILE *f, struct shell_place at, const char *text);

/* Writes a blank and the text as a word of a command line. */
void shell_put_word(FILE *f, const char *word);

#endif
