/* requirements.c - see requirements.h. */
#include "host_sim/test/report/requirements.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/options_nearest.h"
#include "host_sim/out/utf8.h"
#include "host_sim/test/test_keys.h"

enum { BYTES_MAX = 1 << 22 };

/* The file, with a NUL behind it; NULL with errno. */
static char *read_bytes(const char *path)
{
    FILE *f = fopen(path, "rb");
    char *bytes = f ? malloc(BYTES_MAX + 1) : NULL;
    size_t n = bytes ? fread(bytes, 1, BYTES_MAX + 1, f) : 0;
    bool bad = !f || !bytes || ferror(f) || n > BYTES_MAX;
    errno = f && n > BYTES_MAX ? EFBIG : errno;
    if (f)
        (void)fclose(f);
    if (bad) {
        free(bytes);
        return NULL;
    }
    bytes[n] = 0;
    return bytes;
}

/* Takes a cell off *at, in place: quotes around it go, and two quotes in it are one. */
static char *take_cell(char **at)
{
    char *cell = *at, *to = cell, *from = cell;
    bool quoted = *from == '"';
    from += quoted;
    while (*from && (quoted || *from != ',')) {
        if (quoted && *from == '"' && *++from != '"')
            quoted = false;
        else
            *to++ = *from++;
    }
    *at = *from ? from + 1 : from;
    *to = 0;
    return cell;
}

static char *trimmed(char *text)
{
    size_t n;
    text += strspn(text, " \t");
    for (n = strlen(text); n && strchr(" \t\r", text[n - 1]); n--) {
    }
    text[n] = 0;
    return text;
}

static int find(const struct requirements *l, const char *id)
{
    for (int i = 0; i < l->n; i++)
        if (!strcmp(l->entry[i].id, id))
            return i;
    return -1;
}

/* A line without its end. NULL, or what is wrong with it. */
static const char *take_line(struct requirements *l, char *text, bool first)
{
    char *id = trimmed(take_cell(&text)), *said = trimmed(take_cell(&text));
    if (!*id && !*said)
        return NULL;
    if (first && (!strcmp(id, "id") || !strcmp(id, "ID")))
        return NULL;
    if (!test_keys_is_requirement(id, strlen(id)))
        return "an identifier of letters, digits, - _ . : stands first";
    if (find(l, id) >= 0)
        return "this identifier stands in the list already";
    if (l->n == REQUIREMENTS_MAX)
        return "there are too many requirements";
    l->entry[l->n++] = (struct requirement){id, said};
    return NULL;
}

bool requirements_read(struct requirements *l, const char *path, char why[REQUIREMENTS_REASON])
{
    *l = (struct requirements){.path = path, .bytes = read_bytes(path)};
    l->entry = l->bytes ? malloc(REQUIREMENTS_MAX * sizeof *l->entry) : NULL;
    if (!l->entry) {
        snprintf(why, REQUIREMENTS_REASON, "cannot read %.200s: %s", path, strerror(errno));
        return false;
    }
    char *line = l->bytes + utf8_mark(l->bytes, strlen(l->bytes));
    for (int n = 1; line && *line; n++) {
        char *end = strchr(line, '\n');
        if (end)
            *end = 0;
        const char *wrong = take_line(l, line, n == 1);
        if (wrong) {
            snprintf(why, REQUIREMENTS_REASON, "%.200s:%d: %s", path, n, wrong);
            return false;
        }
        line = end ? end + 1 : NULL;
    }
    if (!l->n)
        snprintf(why, REQUIREMENTS_REASON, "%.200s has no requirement; write lines ID,TEXT", path);
    return l->n > 0;
}

static bool knows(const struct requirements *l, const struct test_file *t, const struct test_case *c,
                  char why[REQUIREMENTS_REASON])
{
    static const char *known[REQUIREMENTS_MAX];
    for (int i = 0; i < c->n_requirements; i++) {
        const char *id = c->requirement[i];
        if (find(l, id) >= 0)
            continue;
        for (int k = 0; k < l->n; k++)
            known[k] = l->entry[k].id;
        snprintf(why, REQUIREMENTS_REASON, "%.120s:%d: requirement: %s is not in %.120s%s", t->file,
                 c->requirement_line, id, l->path,
                 options_advise(id, strlen(id), known, l->n, "see its first column"));
        return false;
    }
    return true;
}

bool requirements_know(const struct requirements *l, const struct test_file *t, char why[REQUIREMENTS_REASON])
{
    for (int i = 0; i < t->n_cases; i++)
        if (!knows(l, t, &t->cases[i], why))
            return false;
    return true;
}

bool requirements_names(const struct test_case *c, const char *id)
{
    for (int i = 0; i < c->n_requirements; i++)
        if (!strcmp(c->requirement[i], id))
            return true;
    return false;
}

const char *requirements_text(const struct requirements *l, const char *id)
{
    int i = find(l, id);
    return i < 0 ? "" : l->entry[i].text;
}

void requirements_free(struct requirements *l)
{
    free(l->entry);
    free(l->bytes);
    *l = (struct requirements){.path = NULL};
}
