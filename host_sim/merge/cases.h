/* cases.h - the cases of tests in all parts so far: no two are the same. */
#ifndef HOST_SIM_CASES_H
#define HOST_SIM_CASES_H

#include "host_sim/merge/merge.h"

struct cases {
    void *tree;
};

/* Takes a case of this part by the text that names it. 0, or the exit status after a line. */
int cases_take(const struct merge *m, struct cases *c, const struct part *p, const char *text, size_t n);
void cases_forget(struct cases *c);

#endif
