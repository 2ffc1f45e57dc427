/* beside.h - files that belong to the program, found from where it lies: installed, or in a build folder. */
#ifndef HOST_SIM_BESIDE_H
#define HOST_SIM_BESIDE_H

#include <limits.h>
#include <stdbool.h>

enum { BESIDE_PATH = PATH_MAX };

/* The folder of the running program, its links resolved; "" where the system does not tell. */
void beside_program(char folder[BESIDE_PATH / 2]);

/* The first of these folders, seen from the program's own (NULL behind the last), that has this file; its
 * path. False: none. */
bool beside_find(const char *const *place, const char *file, char folder[BESIDE_PATH]);

#endif
