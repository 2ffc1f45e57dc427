/* pages.c - see pages.h. */
#include "host_sim/help/pages.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Installed, in a build folder, in one inside of that. */
static const char *const place[] = {"../share/doc/contactplant", "..", "../..", NULL};
enum { ROOMS = 16, ROOM_NAME = 24 };

static int by_name(const void *a, const void *b)
{
    return strcmp(a, b);
}

/* The pages of one folder, in the order of their names. */
static void list_room(struct pages *p, const char *folder)
{
    char path[BESIDE_PATH + PAGES_NAME];
    int first = p->n;
    snprintf(path, sizeof path, "%s/%s", p->folder, folder);
    DIR *d = opendir(path);
    for (struct dirent *e = d ? readdir(d) : NULL; e && p->n < PAGES_MAX; e = readdir(d)) {
        size_t n = strlen(e->d_name);
        if (n > 3 && n < 40 && !strcmp(e->d_name + n - 3, ".md"))
            snprintf(p->name[p->n++], PAGES_NAME, "%s%s%.40s", *folder == '.' ? "" : folder,
                     *folder == '.' ? "" : "/", e->d_name);
    }
    if (d)
        (void)closedir(d);
    qsort(p->name[first], (size_t)(p->n - first), PAGES_NAME, by_name);
}

/* The folders of docs, guides and reference first: the names of few pages stand in two of them. */
static int find_rooms(const struct pages *p, char room[ROOMS][ROOM_NAME])
{
    static const char *const first[] = {"docs/guide", "docs/reference"};
    char path[BESIDE_PATH + PAGES_NAME];
    int n = 2;
    snprintf(room[0], ROOM_NAME, "%s", first[0]);
    snprintf(room[1], ROOM_NAME, "%s", first[1]);
    snprintf(path, sizeof path, "%s/docs", p->folder);
    DIR *d = opendir(path);
    for (struct dirent *e = d ? readdir(d) : NULL; e && n < ROOMS; e = readdir(d)) {
        snprintf(room[n], ROOM_NAME, "docs/%.18s", e->d_name);
        n += !strchr(e->d_name, '.') && strcmp(room[n], first[0]) && strcmp(room[n], first[1]);
    }
    if (d)
        (void)closedir(d);
    qsort(room[2], (size_t)(n - 2), ROOM_NAME, by_name);
    return n;
}

bool pages_find(struct pages *p, char *why, size_t size)
{
    p->n = 0;
    if (beside_find(place, "docs/README.md", p->folder)) {
        char room[ROOMS][ROOM_NAME];
        int n = find_rooms(p, room);
        for (int i = 0; i < n; i++)
            list_room(p, room[i]);
        list_room(p, ".");
        return true;
    }
    char program[BESIDE_PATH / 2];
    beside_program(program);
    snprintf(why, size,
             "the pages are not beside this program: neither in %s/%s nor in %s/%s; run make install in the "
             "source tree, or read them there",
             program, place[0], program, place[1]);
    return false;
}

/* The words are the same but for capitals and an end .md of `name`. */
static bool is_called(const char *name, const char *word)
{
    size_t n = strlen(word);
    return !strncasecmp(name, word, n) && (!name[n] || !strcmp(name + n, ".md"));
}

int pages_named(const struct pages *p, const char *word)
{
    for (int i = 0; i < p->n; i++) {
        const char *part = p->name[i];
        bool found = is_called(part, word);
        for (part = strchr(part, '/'); part && !found; part = strchr(part + 1, '/'))
            found = is_called(part + 1, word);
        if (found)
            return i;
    }
    return -1;
}

void pages_short(const struct pages *p, int i, char *name)
{
    const char *part = strrchr(p->name[i], '/') ? strrchr(p->name[i], '/') + 1 : p->name[i];
    snprintf(name, PAGES_NAME, "%.*s", (int)strcspn(part, "."), part);
    if (pages_named(p, name) != i) /* an earlier page has this name, too */
        snprintf(name, PAGES_NAME, "%.*s", (int)strcspn(p->name[i] + 5, "."), p->name[i] + 5);
}

const char *pages_nearest(const struct pages *p, const char *word)
{
    static char text[PAGES_MAX][PAGES_NAME];
    const char *name[PAGES_MAX];
    for (int i = 0; i < p->n; i++) {
        pages_short(p, i, text[i]);
        name[i] = text[i];
    }
    return options_nearest(word, name, p->n);
}

char *pages_read(const struct pages *p, int i)
{
    char path[BESIDE_PATH + PAGES_NAME], *text = NULL;
    size_t n = 0;
    snprintf(path, sizeof path, "%s/%s", p->folder, p->name[i]);
    FILE *f = fopen(path, "rb");
    if (!f)
        return NULL;
    ssize_t got = getdelim(&text, &n, '\0', f);
    (void)fclose(f);
    if (got >= 0)
        return text;
    free(text);
    return calloc(1, 1);
}
