/* fault_list.h - the faults of hal/link/faults.h as one word of the command line. */
#ifndef HOST_SIM_FAULT_LIST_H
#define HOST_SIM_FAULT_LIST_H

#include "hal/link/faults.h"

enum { FAULT_LIST_REASON = 256 };

/* What the list looks like, for the help. */
#define FAULT_LIST_HELP                                                                                      \
    "--faults LIST is [in.|out.]KIND[=VALUE][@FROM:UNTIL],.. with FROM and UNTIL in seconds of the bus "     \
    "(all the\n"                                                                                             \
    "time); in. and out. for one direction, as the plant sees it (both). P is the probability for each "     \
    "frame:\n"                                                                                               \
    "  drop=P duplicate=P repeat=P truncate=P flip=P reorder=P refuse=P   refuse: a send finds no room\n"    \
    "  delay=P:FRAMES burst=FRAMES         held back; all together at every FRAMES-th frame\n"               \
    "  freeze@FROM:UNTIL bus-off@FROM:UNTIL   the link stalls and brings everything late; or nothing comes " \
    "or goes\n"

/* Adds the faults of a list, with `frame_s` seconds from frame to frame. False: why[FAULT_LIST_REASON] says which item
 * is wrong and what to give; *f is not to be used then. */
bool fault_list_read(struct faults *f, const char *list, double frame_s, char *why);

#endif
