/* assertion.h - does a call end in a failed assertion? It is made in a child process, so that the test goes on. */
#ifndef TESTS_ASSERTION_H
#define TESTS_ASSERTION_H

#include <stdbool.h>

/* True when call(argument) fails an assertion; false when it returns, or ends the process in another way. */
bool assertion_fails(void (*call)(const void *argument), const void *argument);

#endif
