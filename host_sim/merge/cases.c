/* cases.c - see cases.h. */
#include "host_sim/merge/cases.h"

#include <search.h>
#include <stdlib.h>
#include <string.h>

struct known {
    char *text;
    const char *path;
};

static int compare_cases(const void *a, const void *b)
{
    return strcmp(((const struct known *)a)->text, ((const struct known *)b)->text);
}

static void forget(void *known)
{
    free(((struct known *)known)->text);
    free(known);
}

void cases_forget(struct cases *c)
{
    tdestroy(c->tree, forget);
}

int cases_take(const struct merge *m, struct cases *c, const struct part *p, const char *text, size_t n)
{
    struct known *k = malloc(sizeof *k), **found;
    if (k)
        *k = (struct known){strndup(text, n), p->path};
    found = k && k->text ? tsearch(k, &c->tree, compare_cases) : NULL;
    if (!found) {
        free(k);
        return options_failure(m->o->usage, "out of memory");
    }
    if (*found == k)
        return 0;
    int status = options_misuse(m->o->usage, "%s and %s have the same case:%s", (*found)->path, p->path,
                                k->text + strcspn(k->text, " \""));
    forget(k);
    return status;
}
