/* plain.h - text of unknown origin in a line for people. */
#ifndef HOST_SIM_PLAIN_H
#define HOST_SIM_PLAIN_H

#include <stdio.h>

/* Writes the text as UTF-8 (utf8.h); controls, line ends among them, are U+FFFD, too. */
void plain_put(FILE *file, const char *text);

#endif
