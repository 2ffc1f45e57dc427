/* record.h - the files that `contactplant test --log` records into: each run has files of its own. */
#ifndef HOST_SIM_RECORD_H
#define HOST_SIM_RECORD_H

#include "host_sim/test/test_file.h"

/* Names the records of every case of these n test files, in their order: keep.shaken of keep.test. A name
 * that another run has, with capitals or without, goes on with a number: keep.shaken-2. */
void record_name_cases(struct test_file *const *test, int n);

/* The case whose golden log is the file at this path, or will be; NULL: none. */
const struct test_case *record_of_golden(const struct test_file *t, const char *path);

/* A folder for --log in which nothing is written over. It has none of the golden logs of this test and no
 * record of a test of this name. Another file of this name that fails beside it gets another folder. */
const char *record_safe_folder(const struct test_file *t, char text[TEST_RECORD]);

#endif
