/* files.c - see files.h. */
#include "host_sim/cli/files.h"
#include "hal/posix/file.h"
#include "models/check.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    OUTPUTS = 32, /* A command line has so many at most. */
    COMPOSED = 8, /* files in memory at a time */
    LINKS = 40,   /* one to the next: as many as the kernel follows */
    PATH_SHOWN = 120,
    NAME = PATH_SHOWN + 40 /* A message names an output so. */
};

struct output {
    const char *option, *path;
    bool folder;
};

struct input {
    dev_t device;
    ino_t node;
};

/* The command line of this process. */
static struct {
    bool begun;
    int n_outputs;
    struct output output[OUTPUTS];
    size_t n_inputs;
    struct input *input;
} line;

static struct composed {
    FILE *f;
    char *text, *path;
    size_t size;
} composed[COMPOSED];

/* ---- what a path is ---- */

/* Where a file is, or will be. name: "" for a file that is there. */
struct place {
    dev_t device;
    ino_t node;
    char name[PATH_MAX];
    bool kept; /* it keeps what is written: a file or a folder, no device and no pipe */
};

/* The folder of a path, with its slash; "." for none. Returns the name behind it. */
static const char *split(const char *path, char folder[PATH_MAX])
{
    const char *slash = strrchr(path, '/');
    int n = slash ? (int)(slash + 1 - path) : 0;
    snprintf(folder, PATH_MAX, "%.*s", slash ? n : 1, slash ? path : ".");
    return path + n;
}

/* The path that a chain of links leads to, though nothing is there. */
static void follow(const char *path, char at[PATH_MAX])
{
    char link[PATH_MAX], folder[PATH_MAX];
    snprintf(at, PATH_MAX, "%s", path);
    for (int i = 0; i < LINKS; i++) {
        ssize_t n = readlink(at, link, sizeof link - 1);
        if (n < 0)
            return;
        link[n] = 0;
        split(at, folder);
        int length =
            *link == '/' ? snprintf(at, PATH_MAX, "%s", link) : snprintf(at, PATH_MAX, "%s/%s", folder, link);
        if (length >= PATH_MAX)
            return;
    }
}

static void find_place(const char *path, struct place *p)
{
    char at[PATH_MAX], folder[PATH_MAX];
    struct stat s;
    memset(p, 0, sizeof *p);
    bool there = !stat(path, &s);
    p->kept = !there || S_ISREG(s.st_mode) || S_ISDIR(s.st_mode);
    if (!there) {
        follow(path, at);
        for (size_t n = strlen(at); n > 1 && at[n - 1] == '/'; n--)
            at[n - 1] = 0;
        const char *name = split(at, folder);
        bool known = !stat(folder, &s);
        snprintf(p->name, sizeof p->name, "%s", known ? name : at);
        if (!known)
            return;
    }
    p->device = s.st_dev;
    p->node = s.st_ino;
}

static bool same(const char *a, const char *b)
{
    struct place x, y;
    find_place(a, &x);
    find_place(b, &y);
    return x.kept && y.kept && x.device == y.device && x.node == y.node && !strcmp(x.name, y.name);
}

/* ---- the command line ---- */

void files_begin(void)
{
    free(line.input);
    memset(&line, 0, sizeof line);
    line.begun = true;
    line.output[line.n_outputs++] = (struct output){NULL, "/dev/fd/1", false};
    line.output[line.n_outputs++] = (struct output){NULL, "/dev/fd/2", false};
}

/* How an output is called in a message. */
static void name_output(const struct output *o, char text[NAME])
{
    if (o->option && !*o->option)
        snprintf(text, NAME, "%.*s", PATH_SHOWN, o->path);
    else if (o->option)
        snprintf(text, NAME, "--%s %.*s", o->option, PATH_SHOWN, o->path);
    else
        snprintf(text, NAME, "standard %s", o->path[strlen(o->path) - 1] == '1' ? "output" : "error");
}

/* The output that this path is, too; NULL: none. */
static const struct output *find_output(const char *path, bool file_only)
{
    for (int i = 0; i < line.n_outputs; i++)
        if (!(file_only && line.output[i].folder) && same(line.output[i].path, path))
            return &line.output[i];
    return NULL;
}

static bool is_input(const char *path)
{
    struct stat s;
    if (stat(path, &s) || !S_ISREG(s.st_mode))
        return false;
    for (size_t i = 0; i < line.n_inputs; i++)
        if (line.input[i].device == s.st_dev && line.input[i].node == s.st_ino)
            return true;
    return false;
}

/* 0, or the errno of why no file can be written there. A folder of the command line need not be there yet. */
static int unwritable(const char *path)
{
    char at[PATH_MAX], folder[PATH_MAX];
    struct stat s;
    bool makes_folder = false;
    for (int i = 0; i < line.n_outputs; i++)
        makes_folder = makes_folder || line.output[i].folder;
    if (!stat(path, &s))
        return S_ISDIR(s.st_mode) ? EISDIR : access(path, W_OK) ? errno : file_is_written(path) ? EBUSY : 0;
    if (errno != ENOENT)
        return errno;
    follow(path, at);
    split(at, folder);
    if (access(folder, W_OK | X_OK) && !(errno == ENOENT && makes_folder))
        return errno;
    return 0;
}

static const char *tell_reason(int error)
{
    return error == EBUSY ? "another process writes it" : strerror(error);
}

bool files_take(const char *option, const char *path, bool folder, char why[FILES_REASON])
{
    char name[NAME], own[NAME];
    const struct output mine = {option, path, folder}, *other = find_output(path, false);
    int reason = folder ? 0 : unwritable(path);
    name_output(&mine, own);
    if (other && other->option)
        snprintf(why, FILES_REASON, "--%s and --%s are both %.*s; choose two files", other->option, option,
                 PATH_SHOWN, path);
    else if (other)
        name_output(other, name), snprintf(why, FILES_REASON, "%s is %s, too; choose another", own, name);
    else if (reason)
        snprintf(why, FILES_REASON, "cannot write %s: %s; choose another", own, tell_reason(reason));
    if (other || reason)
        return false;
    ASSERT(line.n_outputs < OUTPUTS);
    line.output[line.n_outputs++] = mine;
    return true;
}

bool files_reads(const char *path, const char *what, char why[FILES_REASON])
{
    char name[NAME];
    struct stat s;
    const struct output *o = find_output(path, false);
    if (o) {
        name_output(o, name);
        snprintf(why, FILES_REASON, "%s is %.200s; choose another", name, what);
        return false;
    }
    struct input *more = realloc(line.input, (line.n_inputs + 1) * sizeof *more);
    if (more && !stat(path, &s))
        more[line.n_inputs++] = (struct input){s.st_dev, s.st_ino};
    line.input = more ? more : line.input;
    return true;
}

bool files_take_in(const char *folder, const char *name, char why[FILES_REASON])
{
    char path[PATH_MAX], other[NAME];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    const struct output *o = find_output(path, true);
    int reason = unwritable(path);
    if (o)
        name_output(o, other),
            snprintf(why, FILES_REASON, "%.*s, which this command writes, is %s, too; choose another",
                     PATH_SHOWN, path, other);
    else if (is_input(path))
        snprintf(why, FILES_REASON, "%.*s, which this command writes, is read by it; choose another folder",
                 PATH_SHOWN, path);
    else if (reason)
        snprintf(why, FILES_REASON, "cannot write %.*s: %s; choose another folder", PATH_SHOWN, path,
                 tell_reason(reason));
    return !o && !is_input(path) && !reason;
}

/* An option of the command line names this file, or its folder. */
static bool is_taken(const char *path)
{
    char folder[PATH_MAX];
    split(path, folder);
    for (int i = 0; i < line.n_outputs; i++) {
        const struct output *o = &line.output[i];
        if (!strcmp(o->path, path) || same(o->path, o->folder ? folder : path))
            return true;
    }
    return false;
}

bool files_may_write(const char *path)
{
    return !is_input(path);
}

/* ---- writing ---- */

/* False with errno. An output of no option that writes is a mistake of the program. */
static bool approve(const char *path)
{
    ASSERT(!line.begun || is_taken(path));
    if (files_may_write(path))
        return true;
    errno = ETXTBSY;
    return false;
}

FILE *files_create(const char *path)
{
    int file = approve(path) ? file_create(path) : -1;
    return file >= 0 ? fdopen(file, "w") : NULL;
}

FILE *files_resume(const char *path)
{
    FILE *f = approve(path) ? fopen(path, "a+e") : NULL; /* makes a missing file; "r+" writes anywhere */
    return f && !fclose(f) ? fopen(path, "r+e") : NULL;
}

FILE *files_compose(const char *path)
{
    struct composed *c = composed;
    while (c < composed + COMPOSED && c->f)
        c++;
    ASSERT(c < composed + COMPOSED);
    if (!approve(path) || (errno = unwritable(path)) != 0)
        return NULL;
    c->path = strdup(path);
    c->f = c->path ? open_memstream(&c->text, &c->size) : NULL;
    if (!c->f)
        free(c->path);
    return c->f;
}

bool files_make_folder(const char *path)
{
    char part[PATH_MAX];
    struct stat s;
    if ((size_t)snprintf(part, sizeof part, "%s", path) >= sizeof part) {
        errno = ENAMETOOLONG;
        return false;
    }
    for (char *p = part + 1; *p; p++) {
        if (*p != '/')
            continue;
        *p = '\0';
        if (mkdir(part, 0777) && errno != EEXIST)
            return false;
        *p = '/';
    }
    if (!mkdir(part, 0777))
        return true;
    return errno == EEXIST && !stat(part, &s) && S_ISDIR(s.st_mode);
}

int files_make_temporary(char *path, size_t size)
{
    const char *folder = getenv("TMPDIR");
    int n = snprintf(path, size, "%s/contactplant.XXXXXX", folder ? folder : "/tmp");
    int file = n < (int)size ? mkostemp(path, O_CLOEXEC) : -1;
    if (file >= 0 && !unlink(path))
        snprintf(path, size, "/proc/self/fd/%d", file);
    return file;
}

static bool put_bytes(int file, const char *bytes, size_t n)
{
    while (n > 0) {
        ssize_t done = write(file, bytes, n);
        if (done < 0 && errno != EINTR)
            return false;
        bytes += done > 0 ? done : 0;
        n -= done > 0 ? (size_t)done : 0;
    }
    return true;
}

/* Makes room first, so that a full disk leaves the file as it was. Not every file system can say so. */
static bool make_room(int file, off_t size, size_t n)
{
    int error = n ? posix_fallocate(file, 0, (off_t)n) : 0;
    if (error != ENOSPC && error != EFBIG && error != EDQUOT)
        return true;
    (void)!ftruncate(file, size);
    errno = error;
    return false;
}

static bool write_whole(const char *path, const char *bytes, size_t n)
{
    struct stat s;
    bool is_new = access(path, F_OK) != 0;
    int file = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0)
        return false;
    bool plain = !fstat(file, &s) && S_ISREG(s.st_mode);
    bool good = (!plain || make_room(file, s.st_size, n)) && put_bytes(file, bytes, n) &&
                (!plain || !ftruncate(file, (off_t)n));
    int error = errno;
    if (close(file) && good) {
        good = false;
        error = errno;
    }
    if (!good && is_new && plain)
        (void)unlink(path);
    errno = error;
    return good;
}

static bool finish_composed(struct composed *c, bool good)
{
    bool whole = !ferror(c->f);
    whole = !fclose(c->f) && whole;
    errno = whole ? errno : ENOMEM;
    good = good && whole && write_whole(c->path, c->text, c->size);
    int error = errno;
    free(c->text);
    free(c->path);
    *c = (struct composed){.f = NULL};
    errno = error;
    return good;
}

int files_find_cause(FILE *f)
{
    return write(fileno(f), "\n", 1) < 0 ? errno : EIO;
}

const char *files_unwritten(int error)
{
    switch (error) {
    case ENOSPC:
        return "No space left on device; make room and run again";
    case EDQUOT:
        return "Disk quota exceeded; make room and run again";
    case EFBIG:
        return "File too large; raise the limit (ulimit -f), or choose another file system";
    case EBADF:
        return "it is closed; leave out >&- and run again";
    default:
        return strerror(error);
    }
}

bool files_finish(FILE *f, bool good)
{
    if (f == stdout)
        return fflush(f), good; /* options_finish tells of it */
    for (int i = 0; i < COMPOSED; i++)
        if (composed[i].f == f)
            return finish_composed(&composed[i], good);
    bool failed = ferror(f) != 0, unwritten = fflush(f) != 0;
    int error = unwritten ? errno : failed ? files_find_cause(f) : 0;
    if (fclose(f) && !unwritten && !failed) {
        unwritten = true;
        error = errno;
    }
    errno = failed || unwritten ? error : errno;
    return good && !failed && !unwritten;
}
