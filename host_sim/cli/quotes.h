/* quotes.h - the quotes and backslashes of a POSIX shell in a command line that is read. */
#ifndef HOST_SIM_QUOTES_H
#define HOST_SIM_QUOTES_H

#include <stdbool.h>

/* Where a character of a command line stands. All zero: before the first one. */
struct quotes {
    char quote;   /* ' or ", or 0 outside of quotes */
    bool escaped; /* a backslash stands before it */
};

/* Passes over the character c of a command line. */
void quotes_pass(struct quotes *p, char c);

/* Whether quotes or a backslash protect what stands here. */
bool quotes_protect(const struct quotes *p);

#endif
