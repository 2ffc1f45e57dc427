/* fault_list.h - the faults of hal/link/faults.h as one word of the command line. */
#ifndef HOST_SIM_FAULT_LIST_H
#define HOST_SIM_FAULT_LIST_H

#include "hal/link/faults.h"

enum { FAULT_LIST_REASON = 512 };

/* The syntax of the list, for the help. */
#define FAULT_LIST_HELP                                                                                      \
    "--faults LIST has items [in.|out.]KIND[=VALUE][@FROM:UNTIL], separated by commas. FROM and UNTIL are\n" \
    "seconds of the bus; without them the item holds all the time. in. and out. pick one direction, as "     \
    "the\n"                                                                                                  \
    "plant sees it; without them it holds for both. P is the probability for each frame:\n"                  \
    "  drop=P duplicate=P repeat=P truncate=P flip=P reorder=P\n"                                            \
    "  refuse=P                 a send finds no room\n"                                                      \
    "  delay=P:FRAMES           the frame is held back\n"                                                    \
    "  burst=FRAMES             frames arrive all together at every FRAMES-th frame\n"                       \
    "  freeze@FROM:UNTIL        the link stalls, then brings everything late\n"                              \
    "  bus-off@FROM:UNTIL       nothing comes or goes\n"

/* Adds the faults of a list, with `frame_s` seconds from frame to frame. False: why[FAULT_LIST_REASON] says
 * which item is wrong and what to give; *f is not to be used then. */
bool fault_list_read(struct faults *f, const char *list, double frame_s, char *why);

#endif
