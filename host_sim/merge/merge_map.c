/* merge_map.c - see merge_map.h. */
#include "host_sim/merge/merge_map.h"

#include <string.h>
#include "host_sim/maps/jobs.h"
#include "host_sim/out/plural.h"

struct map {
    struct merge *m;
    struct part *p;
    struct lines l;
    struct jobs_chain chain;
    int next, end; /* the last job that has rows, or the one before the first; behind the last one */
    long rows;     /* in this part */
    long all;
};

static const char *const changed =
    "a row was changed or lost here, or before; remove the file and compute this share again";

/* 0, or the exit status after a line. */
static int take_row(struct map *a)
{
    unsigned run;
    int job;
    if (sscanf(a->l.text, "%8x,%d,", &run, &job) != 2 || run != a->p->share.run || job < a->next ||
        job > a->next + 1 || job >= a->end || job < 0 || strlen(a->l.text) >= JOBS_LINE)
        return merge_refuse(a->m, a->p, &a->l, changed);
    a->next = job;
    a->rows++;
    fputs(a->l.text, a->m->out);
    return jobs_row_fits(&a->chain, a->l.text) ? 0 : merge_refuse(a->m, a->p, &a->l, changed);
}

/* The last line of a complete share, behind which there is nothing. */
static int take_last(struct map *a)
{
    char last[JOBS_LAST];
    jobs_last(a->rows, last);
    bool good = !strcmp(a->l.text, last) && a->next == a->end - 1;
    if (good && !lines_next(&a->l)) {
        a->p->cut = false;
        return 0;
    }
    return merge_refuse(a->m, a->p, &a->l, changed);
}

static int take_line(struct map *a)
{
    bool header = a->l.number == 2 && a->p->share.i == 1;
    if (*a->l.text == '#')
        return take_last(a);
    if (!header)
        return take_row(a);
    fputs(a->l.text, a->m->out);
    return lines_begins(&a->l, "run,job,") ? 0 : merge_refuse(a->m, a->p, &a->l, changed);
}

/* Its first line is read, and known. */
static int add_share(struct map *a)
{
    const struct share s = share_nth(a->p->share.i, a->p->share.n, a->p->share.things);
    int status = 0;
    a->next = s.first - 1;
    a->end = s.end;
    a->rows = 0;
    a->chain = JOBS_CHAIN;
    a->p->cut = true;
    while (!status && a->p->cut && lines_next(&a->l) && lines_ends(&a->l, "\n"))
        status = take_line(a);
    a->all += a->rows;
    return status;
}

int merge_map(struct merge *m)
{
    struct map a = {.m = m};
    int status = 0;
    for (int i = 0; i < m->n && !status; i++) {
        a.p = &m->part[i];
        if (!lines_open(&a.l, a.p->path) || !lines_next(&a.l))
            status = merge_refuse(m, a.p, &a.l, "cannot be read any more");
        status = status ? status : add_share(&a);
        lines_close(&a.l);
    }
    snprintf(m->summary, sizeof m->summary, "%d job%s, %ld row%s", m->part[0].share.things,
             plural(m->part[0].share.things), a.all, plural((double)a.all));
    return status;
}
