/* lines.c - see lines.h. */
#include "host_sim/merge/lines.h"

#include <stdlib.h>
#include <string.h>

bool lines_open(struct lines *l, const char *path)
{
    *l = (struct lines){.f = fopen(path, "re")};
    return l->f != NULL;
}

bool lines_next(struct lines *l)
{
    bool read = getline(&l->text, &l->room, l->f) > 0;
    l->number += read;
    return read;
}

static bool is_at(const char *at, const char *text)
{
    while (*text && *at == (*text == '\'' ? '"' : *text))
        at++, text++;
    return !*text;
}

bool lines_begins(const struct lines *l, const char *begin)
{
    return is_at(l->text, begin);
}

bool lines_ends(const struct lines *l, const char *end)
{
    size_t n = strlen(l->text), m = strlen(end);
    return n >= m && is_at(l->text + n - m, end);
}

const char *lines_find(const struct lines *l, const char *text)
{
    const char *at = l->text;
    while (*at && !is_at(at, text))
        at++;
    return *at ? at : NULL;
}

void lines_close(struct lines *l)
{
    if (l->f)
        (void)fclose(l->f);
    free(l->text);
}
