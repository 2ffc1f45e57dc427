/* record.c - see record.h. */
#include "host_sim/test/record.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include "host_sim/test/bench/bench.h"

enum {
    FILE_SHOWN = 100, /* bytes of a file name, so that the whole has room in a folder */
    PLACE = 2 * PATH_MAX
};

/* ---- names ---- */

/* The file's name without folder and end, up to a whole character of UTF-8. */
static int stem(const char *file, const char **begin)
{
    const char *slash = strrchr(file, '/');
    *begin = slash ? slash + 1 : file;
    const char *point = strrchr(*begin, '.');
    int n = point ? (int)(point - *begin) : (int)strlen(*begin);
    for (n = n < FILE_SHOWN ? n : FILE_SHOWN; n > 0 && ((*begin)[n] & 0xC0) == 0x80;)
        n--;
    return n;
}

/* No folder and no blank in it. */
static void clean(char *name)
{
    for (char *at = name; *at; at++)
        *at = strchr("/ \t", *at) ? '_' : *at;
}

static void write_name(const struct test_file *t, struct test_case *c, int number)
{
    const char *file;
    char name[TEST_RECORD];
    int n = stem(t->file, &file);
    n = snprintf(name, sizeof name, "%.*s.%s", n, file, c->name);
    clean(name);
    if (number > 1)
        snprintf(name + n, sizeof name - (size_t)n, "-%d", number);
    memcpy(c->record, name, sizeof c->record);
}

/* Whether a run of a, whose name may go on behind a point, can have the name b. */
static bool reaches(const struct test_case *a, const char *b)
{
    size_t n = strlen(a->record);
    bool goes_on = a->names_seed || a->varied >= 0;
    return !strncasecmp(a->record, b, n) && (!b[n] || (goes_on && b[n] == '.'));
}

/* Another case before this one, which is case k of test i, has the name. */
static bool is_taken(struct test_file *const *test, int i, int k)
{
    const struct test_case *own = &test[i]->cases[k];
    for (int t = 0; t <= i; t++)
        for (int other = 0; other < (t < i ? test[t]->n_cases : k); other++) {
            const struct test_case *c = &test[t]->cases[other];
            if (reaches(c, own->record) || reaches(own, c->record))
                return true;
        }
    return false;
}

/* How many of the i test files before this one have its name in another folder. */
static int count_namesakes(struct test_file *const *test, int i)
{
    const char *own, *other;
    int n = stem(test[i]->file, &own), count = 0;
    for (int k = 0; k < i; k++)
        count += stem(test[k]->file, &other) == n && !strncasecmp(own, other, (size_t)n);
    return count;
}

void record_name_cases(struct test_file *const *test, int n)
{
    for (int i = 0; i < n; i++)
        test[i]->namesakes = count_namesakes(test, i);
    for (int i = 0; i < n; i++)
        for (int k = 0; k < test[i]->n_cases; k++) {
            struct test_case *c = &test[i]->cases[k];
            int number = 1;
            do
                write_name(test[i], c, number++);
            while (is_taken(test, i, k));
        }
}

/* ---- a folder ---- */

/* The path that this one leads to; of a file that is not there, its folder's and its name. */
static void resolve(const char *path, char at[PLACE])
{
    char folder[PATH_MAX], real[PATH_MAX];
    const char *slash = strrchr(path, '/');
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash + 1 - path) : 1, slash ? path : ".");
    if (realpath(path, at))
        return;
    if (realpath(folder, real))
        snprintf(at, PLACE, "%s/%s", real, slash ? slash + 1 : path);
    else
        snprintf(at, PLACE, "%s", path);
}

static bool is_same(const char *a, const char *b)
{
    char place_a[PLACE], place_b[PLACE];
    resolve(a, place_a);
    resolve(b, place_b);
    return !strcmp(place_a, place_b);
}

static bool find_golden(const struct test_file *t, int i, char path[BENCH_PATH])
{
    bench_scene_path(t->file, t->cases[i].golden, path);
    return *t->cases[i].golden != 0;
}

const struct test_case *record_of_golden(const struct test_file *t, const char *path)
{
    char golden[BENCH_PATH];
    for (int i = 0; i < t->n_cases; i++)
        if (find_golden(t, i, golden) && is_same(golden, path))
            return &t->cases[i];
    return NULL;
}

static bool has_golden(const struct test_file *t, const char *folder)
{
    char golden[BENCH_PATH], place[PLACE];
    for (int i = 0; i < t->n_cases; i++) {
        resolve(t->cases[i].golden[0] && find_golden(t, i, golden) ? golden : "/", place);
        char *name = strrchr(place, '/');
        if (!name || name == place)
            continue;
        *name = 0;
        if (is_same(place, folder))
            return true;
    }
    return false;
}

/* Something there may be a record of this test, or it is no folder. */
static bool is_used(const struct test_file *t, const char *folder)
{
    const char *file;
    char name[TEST_RECORD];
    struct stat s;
    int n = stem(t->file, &file);
    DIR *d = opendir(folder);
    bool used = !d && !lstat(folder, &s);
    n = snprintf(name, sizeof name, "%.*s.", n, file);
    clean(name);
    for (struct dirent *e; d && !used && (e = readdir(d));)
        used = !strncasecmp(e->d_name, name, (size_t)n);
    if (d)
        closedir(d);
    return used;
}

const char *record_safe_folder(const struct test_file *t, char text[TEST_RECORD])
{
    int number = t->namesakes + 1;
    do {
        int n = snprintf(text, TEST_RECORD, "again");
        if (number > 1)
            snprintf(text + n, (size_t)(TEST_RECORD - n), "-%d", number);
        number++;
    } while (has_golden(t, text) || is_used(t, text));
    return text;
}
