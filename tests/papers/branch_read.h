/* branch_read.h - a branch as one line of tests/data writes it:
 *
 *   model swept from to step unit : paper parameters beside the defaults, NAME=VALUE ... : the test's numbers
 */
#ifndef TESTS_PAPERS_BRANCH_READ_H
#define TESTS_PAPERS_BRANCH_READ_H

#include "tests/papers/branch.h"

/* The branch of one line, which is cut up. The rest of the line, or NULL: not a line of the format. */
const char *branch_read(char *line, struct branch *b);

#endif
