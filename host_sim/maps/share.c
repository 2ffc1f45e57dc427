/* share.c - see share.h. */
#include "host_sim/maps/share.h"

#include "host_sim/cli/shell.h"
#include "host_sim/commands.h"
#include "host_sim/version.h"

#include <ctype.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* ---- which one ---- */

/* A whole number of an environment variable; 0: there is none. */
static long told(const char *name)
{
    const char *text = getenv(name);
    char *end;
    long value = text ? strtol(text, &end, 10) : 0;
    return text && end != text && !*end && value > 0 && value < INT_MAX ? value : 0;
}

/* The I of N that the scheduler tells this task: Slurm's array 1..N, or any of it where N is given. GNU
 * parallel tells I alone. False: it tells none. */
static bool scheduled(long *i, long *n)
{
    long task = told("SLURM_ARRAY_TASK_ID"), count = told("SLURM_ARRAY_TASK_COUNT");
    bool whole = told("SLURM_ARRAY_TASK_MIN") == 1 && told("SLURM_ARRAY_TASK_MAX") == count;
    *i = task ? task : told("PARALLEL_SEQ");
    *n = *n ? *n : task && whole ? count : 0;
    return *i && *n;
}

/* I/N, auto/N or auto. False after a line. */
static bool read_option(const struct options *o, long *i, long *n)
{
    const char *text = options_text(o, "shard", 0);
    bool automatic = !strncmp(text, "auto", 4);
    size_t head = automatic ? 4 : strspn(text, "0123456789");
    const char *of = text + head;
    char *last;
    *i = automatic ? 0 : strtol(text, NULL, 10);
    *n = *of == '/' ? strtol(of + 1, &last, 10) : 0;
    bool good = *of == '/' ? last != of + 1 && !*last && *n >= 1 && *n <= INT_MAX : automatic && !*of;
    if (good && automatic && !scheduled(i, n)) {
        options_misuse(o->usage,
                       "--shard %s: SLURM_ARRAY_TASK_ID of an array 1-N tells the share, or with auto/N it "
                       "and PARALLEL_SEQ of GNU parallel; neither does here",
                       text);
        return false;
    }
    good = good && *i >= 1 && *i <= *n;
    if (!good)
        options_misuse(o->usage, "--shard %s: give I/N with 1 <= I <= N, or auto", text);
    return good;
}

struct share share_nth(int i, int n, int things)
{
    return (struct share){i, n, (int)((int64_t)things * (i - 1) / n), (int)((int64_t)things * i / n)};
}

int share_take(const struct options *o, int n, struct share *s)
{
    long i, of;
    if (!read_option(o, &i, &of))
        return STATUS_MISUSED;
    *s = share_nth((int)i, (int)of, n);
    return STATUS_DONE;
}

/* ---- its line ---- */

/* The last digits in a name that are this number, with zeros before it or without. NULL: there are none. */
static const char *find_number(const char *name, int number, int *width)
{
    for (const char *end = name + strlen(name); end > name; end--) {
        const char *at = end;
        while (at > name && isdigit((unsigned char)at[-1]))
            at--;
        *width = (int)(end - at);
        if (*width > 0 && *width < 10 && atoi(at) == number)
            return at;
        end = *width > 0 ? at + 1 : end;
    }
    return NULL;
}

/* The name of an output of share i as a word for a shell, whose variable i stands for the number in it. */
static void put_output(FILE *f, const char *name, int i)
{
    const struct quotes bare = {0, false};
    int width;
    const char *at = find_number(name, i, &width);
    char *before = at ? strndup(name, (size_t)(at - name)) : NULL;
    fputc(' ', f);
    if (!before) {
        shell_put(f, bare, name);
        return;
    }
    if (*before)
        shell_put(f, bare, before);
    bool joins = isalnum((unsigned char)at[width]) || at[width] == '_'; /* to the variable's name */
    if (*at == '0')
        fprintf(f, "$(printf %%0%dd $i)", width);
    else
        fputs(joins ? "${i}" : "$i", f);
    if (at[width])
        shell_put(f, bare, at + width);
    free(before);
}

static void put_option(FILE *f, const struct given *g, const struct share *s)
{
    if (!strcmp(g->option->name, "shard"))
        return;
    fprintf(f, " --%s", g->option->name);
    if (g->option->kind == OPTION_WRITES || g->option->kind == OPTION_FOLDER)
        put_output(f, g->text, s->i);
    else if (g->option->kind != OPTION_FLAG)
        shell_put_word(f, g->text);
}

static void put_words(FILE *f, const struct options *o)
{
    for (int k = 0; k < o->n_words; k++)
        shell_put_word(f, o->word[k]);
}

/* The command of this share, for any i. */
static void put_command(FILE *f, const struct options *o, const struct share *s)
{
    bool dashed = false, writes = false;
    for (int k = 0; k < o->n_words; k++)
        dashed = dashed || *o->word[k] == '-';
    fprintf(f, "contactplant %s", o->usage->name);
    if (!dashed)
        put_words(f, o);
    for (int k = 0; k < o->n_given; k++) {
        put_option(f, &o->given[k], s);
        writes = writes || o->given[k].option->kind == OPTION_WRITES;
    }
    fprintf(f, " --shard $i/%d%s", s->n, writes ? "" : " --out share$i.csv");
    if (dashed) {
        fputs(" --", f);
        put_words(f, o);
    }
}

void share_tell(const struct options *o, const struct share *s, int things, const char *called, uint32_t run,
                char line[SHARE_LINE])
{
    char *command = NULL;
    size_t size;
    FILE *f = open_memstream(&command, &size);
    if (f)
        put_command(f, o, s);
    bool good = f && !fclose(f);
    int n = snprintf(line, SHARE_LINE, "share %d/%d of %d %s, run %08x, contactplant %s: ", s->i, s->n,
                     things, called, (unsigned)run, VERSION_TEXT);
    if (good && !strpbrk(command, "\r\n") && n + (int)size < SHARE_LINE)
        strcpy(line + n, command);
    free(command);
}

void share_end(long n, const char *called, char text[SHARE_END])
{
    snprintf(text, SHARE_END, "complete: %ld %s", n, called);
}

bool share_read(const char *line, struct share_told *t)
{
    int used = 0;
    memset(t, 0, sizeof *t);
    bool good = sscanf(line, "share %d/%d of %d %*[a-z], run %8x, contactplant %23[^:]: %n", &t->i, &t->n,
                       &t->things, &t->run, t->version, &used) == 5 &&
                used && t->n > 0 && t->i > 0 && t->i <= t->n && t->things >= 0;
    if (good)
        snprintf(t->command, sizeof t->command, "%s", line + used);
    return good;
}

bool share_is_same(const char *line, const char *other)
{
    const char *end = strchr(other, ':');
    return end && !strncmp(line, other, (size_t)(end - other) + 1);
}
