/* help.h - pages by the words of a command line. */
#ifndef HOST_SIM_HELP_H
#define HOST_SIM_HELP_H

#include <stdbool.h>
#include "host_sim/cli/options.h"

/* There is a page of this name. */
bool help_has_page(const char *word);

/* Prints the page of this name as a manual page. The exit status; a line on stderr where it is not there. */
int help_print_manual(const struct usage *u, const char *word);

#endif
