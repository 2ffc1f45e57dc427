/* file.c - see file.h. */
#include "hal/posix/file.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static bool is_plain(int file)
{
    struct stat s;
    return !fstat(file, &s) && S_ISREG(s.st_mode);
}

static bool is_taken(int file)
{
    return is_plain(file) && flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

int file_create(const char *path)
{
    int file = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0)
        return -1;
    bool taken = is_taken(file);
    if (!taken && (!is_plain(file) || ftruncate(file, 0) == 0))
        return file;
    int error = taken ? EBUSY : errno;
    close(file);
    errno = error;
    return -1;
}

bool file_is_written(const char *path)
{
    struct stat s;
    int file = !stat(path, &s) && S_ISREG(s.st_mode) ? open(path, O_WRONLY | O_CLOEXEC) : -1;
    bool taken = file >= 0 && is_taken(file);
    if (file >= 0)
        close(file);
    return taken;
}
