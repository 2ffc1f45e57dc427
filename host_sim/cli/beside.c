/* beside.c - see beside.h. */
#include "host_sim/cli/beside.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

void beside_program(char folder[BESIDE_PATH / 2])
{
    ssize_t n = readlink("/proc/self/exe", folder, BESIDE_PATH / 2 - 1);
    folder[n > 0 ? n : 0] = '\0';
    char *slash = strrchr(folder, '/');
    if (slash)
        *slash = '\0';
}

bool beside_find(const char *const *place, const char *file, char folder[BESIDE_PATH])
{
    char program[BESIDE_PATH / 2], path[BESIDE_PATH + BESIDE_PATH];
    beside_program(program);
    for (; *place; place++) {
        snprintf(folder, BESIDE_PATH, "%s/%s", program, *place);
        snprintf(path, sizeof path, "%s/%s", folder, file);
        if (access(path, R_OK) == 0)
            return true;
    }
    return false;
}
