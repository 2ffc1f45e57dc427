/* merge.c - contactplant merge: joins the parts that several machines have computed, or says what is missing.
 */
#include "host_sim/merge/merge.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/files.h"
#include "host_sim/cli/shell.h"
#include "host_sim/commands.h"
#include "host_sim/maps/jobs.h"
#include "host_sim/merge/merge_json.h"
#include "host_sim/merge/merge_junit.h"
#include "host_sim/merge/merge_map.h"
#include "host_sim/out/json.h"
#include "host_sim/out/plural.h"
#include "host_sim/out/utf8.h"
#include "host_sim/out/xml.h"

static const struct usage merge_usage = {
    .name = "merge",
    .words = "OUT PART..",
    .summary =
        "Joins what several machines have computed: the shares (--shard) of a map, and reports of tests as\n"
        "JUnit or JSON. OUT has the bytes that one run writes, but for the times in JUnit. Where a share is\n"
        "missing or cut, that is told, and the lines that compute it are printed; OUT is not written then.\n"
        "docs/guide/machines.md shows arrays of Slurm and GNU parallel.",
    .words_help =
        "PARTs are of one kind, in any order; a report may also be one of a whole command.\n"
        "Exit status: 0 OUT is written, 1 shares are missing or cut, 2 a part is not what it should be.\n"
        "Verdicts in reports do not count here.\n",
    .examples = "  contactplant merge map.csv part*.csv\n"
                "  contactplant merge all.xml part*.xml          shares of contactplant test --junit\n"
                "  contactplant merge all.json a.json b.json     reports of two test files\n"
                "  contactplant merge map.csv part*.csv | head -1 | sh      sends what is missing to Slurm\n",
    .min_words = 2,
    .max_words = OPTIONS_WORDS,
    .words_written = 1,
    .words_read = OPTIONS_WORDS,
};

/* ---- what a part is ---- */

/* How a kind's file tells a share, and ends that line. */
static const struct kind {
    const char *name, *share, *end;
    void (*read)(char *text); /* takes its escapes back */
} kind_table[PART_KINDS] = {
    [PART_MAP] = {"a map", JOBS_SHARE, "\n", NULL},
    [PART_JUNIT] = {"JUnit", "<?contactplant ", "?>\n", xml_read},
    [PART_JSON] = {"JSON", "{'share': '", "', 'cases': [\n", json_read},
};

/* The share that this line tells. */
static bool read_share(const struct kind *k, struct lines *l, struct share_told *t)
{
    if (!lines_begins(l, k->share) || !lines_ends(l, k->end))
        return false;
    l->text[strlen(l->text) - strlen(k->end)] = 0;
    if (k->read)
        k->read(l->text);
    return share_read(l->text + strlen(k->share), t);
}

static bool is_report(const struct part *p, const struct lines *l)
{
    return p->kind == PART_JUNIT ? lines_begins(l, "<testsuites name='contactplant'")
                                 : lines_begins(l, "{'cases': [\n");
}

/* Its kind and share. 0, or the exit status after a line. */
static int know(const struct merge *m, struct part *p, struct lines *l)
{
    const char *why = "no map of shares, and no report of contactplant test as JUnit or JSON";
    if (!lines_open(l, p->path) || (errno = 0, !lines_next(l)))
        return options_misuse(m->o->usage, "%s: %s", p->path,
                              errno ? strerror(errno)
                                    : "it is empty, as of a share that has not begun; leave it out");
    if (utf8_mark(l->text, strlen(l->text)) || lines_ends(l, "\r\n"))
        return options_misuse(m->o->usage, "%s: an editor has changed it; compute it again", p->path);
    p->kind = lines_begins(l, XML_HEAD) ? PART_JUNIT : lines_begins(l, "{") ? PART_JSON : PART_MAP;
    if (p->kind == PART_JUNIT && !lines_next(l))
        return options_misuse(m->o->usage, "%s: %s", p->path, why);
    bool report = p->kind != PART_MAP && is_report(p, l);
    p->is_share = read_share(&kind_table[p->kind], l, &p->share);
    if (p->is_share || report)
        return 0;
    bool rows = lines_begins(l, "run,job,") ||
                (isxdigit((unsigned char)*l->text) && strspn(l->text, "0123456789abcdef") == 8);
    if (*l->text == '#' && !lines_ends(l, "\n"))
        why = "its first line is cut, as of a share that had just begun; leave it out";
    else if (p->kind == PART_MAP && rows)
        why = "rows that do not tell their share: of a whole run, or of an earlier version; compute the "
              "share again";
    return options_misuse(m->o->usage, "%s: %s", p->path, why);
}

/* ---- whether they belong together ---- */

/* 0, or the exit status after a line. */
static int compare_parts(const struct merge *m, const struct part *a, const struct part *b)
{
    const struct usage *u = m->o->usage;
    const struct share_told *s = &a->share, *t = &b->share;
    if (a->kind != b->kind)
        return options_misuse(u, "%s is %s, and %s is %s; join one kind", a->path, kind_table[a->kind].name,
                              b->path, kind_table[b->kind].name);
    if (a->is_share != b->is_share)
        return options_misuse(u, "%s is a share, and %s is none; join shares of one command",
                              a->is_share ? a->path : b->path, a->is_share ? b->path : a->path);
    if (strcmp(s->version, t->version) != 0)
        return options_misuse(u, "%s is of version %s, and %s of %s; compute them by one", a->path,
                              s->version, b->path, t->version);
    if (s->run != t->run || s->things != t->things)
        return options_misuse(u, "%s and %s are of different commands or scenes; join shares of one command",
                              a->path, b->path);
    if (s->n != t->n)
        return options_misuse(u, "%s is one of %d shares, and %s one of %d; join shares of one number",
                              a->path, s->n, b->path, t->n);
    return 0;
}

static int by_share(const void *a, const void *b)
{
    const struct part *p = a, *q = b;
    return (p->share.i > q->share.i) - (p->share.i < q->share.i);
}

static int check_parts(struct merge *m)
{
    int status = 0;
    for (int i = 1; i < m->n && !status; i++)
        status = compare_parts(m, &m->part[0], &m->part[i]);
    if (status || !m->part[0].is_share)
        return status;
    qsort(m->part, (size_t)m->n, sizeof *m->part, by_share);
    for (int i = 1; i < m->n && !status; i++)
        if (m->part[i].share.i == m->part[i - 1].share.i)
            status =
                options_misuse(m->o->usage, "%s and %s are both share %d/%d; give it once",
                               m->part[i - 1].path, m->part[i].path, m->part[i].share.i, m->part[i].share.n);
    return status;
}

static int read_parts(struct merge *m)
{
    int status = 0;
    for (int i = 0; i < m->n && !status; i++) {
        struct lines l;
        m->part[i].path = m->o->word[i + 1];
        status = know(m, &m->part[i], &l);
        lines_close(&l);
    }
    return status ? status : check_parts(m);
}

/* ---- what is missing ---- */

/* Writes the numbers of the shares that are missing, and with `cut` of those that are cut. */
static void put_lost(const struct merge *m, FILE *f, const char *between, bool cut)
{
    int n = 0, next = 0;
    for (int i = 1; i <= m->part[0].share.n; i++) {
        bool there = next < m->n && m->part[next].share.i == i;
        if (!there || (cut && m->part[next].cut))
            fprintf(f, "%s%d", n++ ? between : "", i);
        next += there;
    }
}

/* Names the cut ones, each with its file. */
static void put_cut(const struct merge *m, FILE *f)
{
    const char *before = "cut: ";
    for (int i = 0; i < m->n; i++) {
        if (m->part[i].cut)
            fprintf(f, "%s%d (%s)", before, m->part[i].share.i, m->part[i].path);
        before = m->part[i].cut ? ", " : before;
    }
}

/* The lines that compute the lost shares: for Slurm, and here. */
static void print_again(const struct merge *m)
{
    const char *command = m->part[0].share.command;
    char script[SHARE_LINE + 32];
    if (!*command)
        return;
    snprintf(script, sizeof script, "i=$SLURM_ARRAY_TASK_ID; %s", command);
    printf("sbatch --array=");
    put_lost(m, stdout, ",", true);
    printf(" --wrap");
    shell_put_word(stdout, script);
    printf("\nfor i in ");
    put_lost(m, stdout, " ", true);
    printf("; do %s; done\n", command);
}

/* Where shares are missing or cut: a line that names them. Returns the exit status. */
static int tell_lost(const struct merge *m)
{
    char *text = NULL;
    size_t size;
    FILE *f = open_memstream(&text, &size);
    int cut = 0;
    for (int i = 0; i < m->n; i++)
        cut += m->part[i].cut;
    bool missing = m->n < m->part[0].share.n;
    if (f && missing) {
        fputs("missing: ", f);
        put_lost(m, f, ", ", false);
        fputs(cut ? "; " : "", f);
    }
    if (f)
        put_cut(m, f);
    int status = f && !fclose(f) ? 0 : options_failure(m->o->usage, "out of memory");
    if (!status && (missing || cut)) {
        status = options_failure(m->o->usage, "of %d shares %s; %s is not written", m->part[0].share.n, text,
                                 m->o->word[0]);
        print_again(m);
    }
    free(text);
    return status;
}

/* A part that is no share must be whole. */
static int check_whole(const struct merge *m)
{
    for (int i = 0; i < m->n; i++)
        if (m->part[i].cut)
            return options_misuse(m->o->usage, "%s: its end is missing; run its command again",
                                  m->part[i].path);
    return 0;
}

static int write_all(struct merge *m)
{
    static int (*const merge[PART_KINDS])(struct merge *) = {
        [PART_MAP] = merge_map, [PART_JUNIT] = merge_junit, [PART_JSON] = merge_json};
    const char *out = m->o->word[0];
    m->out = files_compose(out);
    if (!m->out)
        return options_failure(m->o->usage, "cannot write %s: %s; choose another", out, strerror(errno));
    int status = merge[m->part[0].kind](m);
    if (!status)
        status = m->part[0].is_share ? tell_lost(m) : check_whole(m);
    if (!files_finish(m->out, !status) && !status)
        status = options_failure(m->o->usage, "cannot write %s: %s; choose another", out, strerror(errno));
    if (!status)
        printf("%d part%s: %s\n", m->n, plural(m->n), m->summary);
    return status;
}

int cmd_merge(int argc, char **argv)
{
    static struct options o;
    int status;
    if (!options_parse(&o, &merge_usage, argc, argv, &status))
        return status;
    struct merge m = {.o = &o, .n = o.n_words - 1};
    m.part = calloc((size_t)m.n, sizeof *m.part);
    status = m.part ? read_parts(&m) : options_failure(o.usage, "out of memory");
    status = status ? status : write_all(&m);
    free(m.part);
    return status;
}
