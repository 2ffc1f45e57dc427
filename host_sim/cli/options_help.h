/* options_help.h - a table of options as help, as a section of the manual page and as words for a shell. */
#ifndef HOST_SIM_OPTIONS_HELP_H
#define HOST_SIM_OPTIONS_HELP_H

#include "host_sim/cli/options.h"

/* The help that this word asks for, on stdout: --help and -h for people, --help=man a section of the manual
 * page. For a shell --help=words prints the options' names, --help=values the words behind those with a list.
 * False for other words. */
bool options_help(const struct usage *u, const char *word);

/* Text of a manual page, with what troff would take for a request or a hyphen escaped. */
void options_print_roff(const char *text);

#endif
