/* file.h - a file that one process at a time writes. */
#ifndef HAL_FILE_H
#define HAL_FILE_H

#include <stdbool.h>

/* Creates or empties a file. Until it is closed, no other process does so by this function. -1 with errno;
 * EBUSY: another process writes it. Devices, pipes and file systems without locks let both in. */
int file_create(const char *path);

/* Another process, or this one, has it by file_create. */
bool file_is_written(const char *path);

#endif
