/* merge_junit.c - see merge_junit.h. The lines are those of contactplant test: text in them is
 * escaped, so that a quote ends an attribute. */
#include "host_sim/merge/merge_junit.h"

#include <stdlib.h>
#include <string.h>
#include "host_sim/commands.h"
#include "host_sim/merge/cases.h"
#include "host_sim/out/plural.h"
#include "host_sim/out/xml.h"

struct counts {
    int tests, failures, errors;
    double time_s;
};

struct suite {
    char *head; /* its tag up to the counts: name, file, begin and host of its first part */
    struct counts counts;
    char *cases;
    size_t size;
    FILE *f; /* writes into cases, so that a suite stays where it is */
    struct suite *next;
};

struct junit {
    struct merge *m;
    struct part *p;
    struct lines l;
    struct cases known;
    struct suite *first, **end; /* all of them */
    int n;
    struct suite *now; /* inside of it */
    int left;          /* cases of this part's suite that are still to come */
    long cases;        /* that this part has so far */
};

static const char *const foreign = "not as contactplant test --junit writes it";

static int refuse(struct junit *j)
{
    return merge_refuse(j->m, j->p, &j->l, foreign);
}

static void add_counts(struct counts *to, const struct counts *c)
{
    to->tests += c->tests;
    to->failures += c->failures;
    to->errors += c->errors;
    to->time_s += c->time_s;
}

static void put_counts(FILE *f, const struct counts *c)
{
    xml_put(f, " tests='%i' failures='%i' errors='%i' time='%t'>\n", c->tests, c->failures, c->errors,
            c->time_s);
}

/* The suite whose tag begins as this line up to `file`; a new one where there is none. NULL without memory.
 */
static struct suite *find_suite(struct junit *j, size_t same, size_t head)
{
    for (struct suite *s = j->first; s; s = s->next)
        if (!strncmp(s->head, j->l.text, same))
            return s;
    struct suite *s = calloc(1, sizeof *s);
    if (!s)
        return NULL;
    s->head = strndup(j->l.text, head);
    s->f = open_memstream(&s->cases, &s->size);
    *j->end = s;
    j->end = &s->next;
    j->n++;
    return s->head && s->f ? s : NULL;
}

static int begin_suite(struct junit *j)
{
    struct counts c;
    int used = 0;
    const char *began = strstr(j->l.text, " timestamp=\""), *counts = strstr(j->l.text, " tests=\"");
    if (!began || !counts ||
        sscanf(counts, " tests=\"%d\" failures=\"%d\" errors=\"%d\" time=\"%lf\">%n", &c.tests, &c.failures,
               &c.errors, &c.time_s, &used) != 4 ||
        strcmp(counts + used, "\n") != 0)
        return refuse(j);
    j->now = find_suite(j, (size_t)(began - j->l.text), (size_t)(counts - j->l.text));
    if (!j->now)
        return options_failure(j->m->o->usage, "out of memory");
    add_counts(&j->now->counts, &c);
    j->left = c.tests;
    return 0;
}

/* A case is named by its tag up to the file. */
static int begin_case(struct junit *j)
{
    const char *end = strstr(j->l.text, " file=\"");
    if (!end || j->left-- == 0)
        return refuse(j);
    j->cases++;
    return cases_take(j->m, &j->known, j->p, j->l.text, (size_t)(end - j->l.text));
}

static int take_line(struct junit *j)
{
    int status = 0;
    if (lines_begins(&j->l, " <testsuite "))
        return j->now ? refuse(j) : begin_suite(j);
    if (!j->now)
        return j->l.number <= 3 ? 0 : refuse(j); /* the head */
    if (lines_begins(&j->l, " </testsuite>")) {
        j->now = NULL;
        return j->left ? refuse(j) : 0;
    }
    if (lines_begins(&j->l, "  <testcase "))
        status = begin_case(j);
    fputs(j->l.text, j->now->f);
    return status;
}

/* Behind the last suite a complete report says that it is. */
static int end_part(struct junit *j)
{
    char end[SHARE_END], mark[SHARE_END + sizeof XML_MARK];
    j->p->cut = !lines_next(&j->l) || !lines_ends(&j->l, "\n");
    share_end(j->cases, "cases", end);
    snprintf(mark, sizeof mark, XML_MARK, end);
    return j->p->cut || (lines_begins(&j->l, mark) && !lines_next(&j->l)) ? 0 : refuse(j);
}

static int add_part(struct junit *j)
{
    int status = 0;
    bool ended = false;
    j->p->cut = true;
    j->now = NULL;
    j->cases = 0;
    while (!status && !ended && lines_next(&j->l) && lines_ends(&j->l, "\n")) {
        ended = !j->now && lines_begins(&j->l, "</testsuites>\n");
        status = ended ? end_part(j) : take_line(j);
    }
    return status;
}

static void put_all(struct junit *j)
{
    struct counts all = {0, 0, 0, 0.0};
    char end[SHARE_END];
    FILE *out = j->m->out;
    for (struct suite *s = j->first; s; s = s->next)
        add_counts(&all, &s->counts);
    xml_put(out, XML_HEAD "<testsuites name='contactplant'");
    put_counts(out, &all);
    for (struct suite *s = j->first; s; s = s->next) {
        (void)fflush(s->f);
        fputs(s->head, out);
        put_counts(out, &s->counts);
        fputs(s->cases, out);
        fputs(" </testsuite>\n", out);
    }
    fputs("</testsuites>\n", out);
    share_end(all.tests, "cases", end);
    xml_put(out, XML_MARK, end);
    snprintf(j->m->summary, MERGE_SUMMARY, "%d case%s of %d test file%s, %d failed, %d with an error",
             all.tests, plural(all.tests), j->n, plural(j->n), all.failures, all.errors);
}

static void forget(struct junit *j)
{
    for (struct suite *s = j->first, *next; s; s = next) {
        next = s->next;
        if (s->f)
            (void)fclose(s->f);
        free(s->cases);
        free(s->head);
        free(s);
    }
    cases_forget(&j->known);
}

int merge_junit(struct merge *m)
{
    struct junit j = {.m = m};
    int status = 0;
    j.end = &j.first;
    for (int i = 0; i < m->n && !status; i++) {
        j.p = &m->part[i];
        status = lines_open(&j.l, j.p->path) ? add_part(&j) : refuse(&j);
        lines_close(&j.l);
    }
    if (!status)
        put_all(&j);
    forget(&j);
    return status;
}
