/* merge_json.c - see merge_json.h. The lines are those of contactplant test: text in them is
 * escaped, so that a quote ends it. */
#include "host_sim/merge/merge_json.h"

#include <stdlib.h>
#include <string.h>
#include "host_sim/commands.h"
#include "host_sim/merge/cases.h"
#include "host_sim/out/json.h"
#include "host_sim/out/plural.h"

struct text {
    char *bytes;
    size_t size;
    FILE *f; /* writes into bytes */
};

struct all {
    struct merge *m;
    struct part *p;
    struct lines l;
    struct cases known;
    bool in_case;
    int n, first;        /* cases, and which is this part's first one */
    struct text traced;  /* identifiers with their quotes that a case names */
    struct text missing; /* and those that were told as untraced, each once */
};

static const char *const foreign = "not as contactplant test --json writes it";
static const char end_of_cases[] = "], 'untraced': [", complete[] = "], 'complete': '%s'}\n";

static int refuse(struct all *a)
{
    return merge_refuse(a->m, a->p, &a->l, foreign);
}

/* Whether the identifier, with its quotes, is in the text. */
static bool has(struct text *t, const char *id)
{
    (void)fflush(t->f);
    return strstr(t->bytes, id) != NULL;
}

/* Adds the identifiers from here to the bracket that closes. False where there is none. */
static bool add_identifiers(struct text *t, const char *at)
{
    for (; *at == '"' || *at == ','; at += strspn(at, ",")) {
        const char *end = *at == '"' ? strchr(at + 1, '"') : NULL;
        if (!end)
            return false;
        char *id = strndup(at, (size_t)(end + 1 - at));
        if (id && !has(t, id))
            fputs(id, t->f);
        free(id);
        at = end + 1;
    }
    return *at == ']';
}

static int begin_case(struct all *a)
{
    static const char key[] = ", 'requirements': [";
    const char *end = lines_find(&a->l, ", 'line': "), *requirements = lines_find(&a->l, key);
    if (!end || !requirements || !add_identifiers(&a->traced, requirements + strlen(key)))
        return refuse(a);
    if (a->n++)
        fputc(',', a->m->out);
    a->in_case = true;
    return cases_take(a->m, &a->known, a->p, a->l.text, (size_t)(end - a->l.text));
}

/* Without its end, and without the comma behind a case. */
static void put_line(struct all *a)
{
    bool comma = lines_ends(&a->l, "]},\n");
    a->in_case = !comma && !lines_ends(&a->l, "]}\n");
    fprintf(a->m->out, "\n%.*s", (int)strlen(a->l.text) - 1 - comma, a->l.text);
}

static int take_line(struct all *a)
{
    int status = 0;
    if (a->l.number == 1)
        return lines_ends(&a->l, "'cases': [\n") ? 0 : refuse(a);
    if (lines_begins(&a->l, "  {'file': ") && !a->in_case)
        status = begin_case(a);
    else if (!a->in_case || !lines_begins(&a->l, "    {"))
        return refuse(a);
    put_line(a);
    return status;
}

/* The last line of a part: "], "untraced": ["A","B"]}", where a complete one says that it is. */
static int end_part(struct all *a)
{
    char end[SHARE_END], mark[SHARE_END + sizeof complete];
    share_end(a->n - a->first, "cases", end);
    snprintf(mark, sizeof mark, complete, end);
    bool good = !a->in_case && add_identifiers(&a->missing, a->l.text + strlen(end_of_cases));
    a->p->cut = lines_ends(&a->l, "]}\n");
    return good && (a->p->cut || lines_ends(&a->l, mark)) && !lines_next(&a->l) ? 0 : refuse(a);
}

static int add_part(struct all *a)
{
    int status = 0;
    bool ended = false;
    a->p->cut = true;
    a->in_case = false;
    a->first = a->n;
    while (!status && !ended && lines_next(&a->l) && lines_ends(&a->l, "\n")) {
        ended = lines_begins(&a->l, end_of_cases);
        status = ended ? end_part(a) : take_line(a);
    }
    return status;
}

/* The identifiers that were told as untraced, but for those that a case of any part names. */
static void put_untraced(struct all *a)
{
    int n = 0;
    (void)fflush(a->missing.f);
    char *rest = NULL, id[MERGE_SUMMARY];
    for (char *word = strtok_r(a->missing.bytes, "\"", &rest); word; word = strtok_r(NULL, "\"", &rest)) {
        snprintf(id, sizeof id, "\"%s\"", word);
        if (!has(&a->traced, id))
            fprintf(a->m->out, n++ ? ",%s" : "%s", id);
    }
}

static bool open_text(struct text *t)
{
    t->f = open_memstream(&t->bytes, &t->size);
    return t->f && !fflush(t->f);
}

static void close_text(struct text *t)
{
    if (t->f)
        (void)fclose(t->f);
    free(t->bytes);
}

static int merge_all(struct all *a)
{
    struct merge *m = a->m;
    char end[SHARE_END], mark[SHARE_END + sizeof complete];
    struct json j;
    int status = 0;
    json_begin_file(&j, m->out);
    json_put(&j, "{'cases': [");
    for (int i = 0; i < m->n && !status; i++) {
        a->p = &m->part[i];
        status = lines_open(&a->l, a->p->path) ? add_part(a) : refuse(a);
        lines_close(&a->l);
    }
    json_put(&j, "\n");
    json_put(&j, end_of_cases);
    put_untraced(a);
    share_end(a->n, "cases", end);
    snprintf(mark, sizeof mark, complete, end);
    json_put(&j, mark);
    snprintf(m->summary, sizeof m->summary, "%d case%s", a->n, plural(a->n));
    return status;
}

int merge_json(struct merge *m)
{
    struct all a = {.m = m};
    bool good = open_text(&a.traced) && open_text(&a.missing);
    int status = good ? merge_all(&a) : options_failure(m->o->usage, "out of memory");
    close_text(&a.traced);
    close_text(&a.missing);
    cases_forget(&a.known);
    return status;
}
