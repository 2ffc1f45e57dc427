/* help.h - pages by the words of a command line. */
#ifndef HOST_SIM_HELP_H
#define HOST_SIM_HELP_H

#include <stdbool.h>

/* There is a page of this name. */
bool help_has_page(const char *word);

#endif
