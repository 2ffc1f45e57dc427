/* options.c - see options.h. */
#include "host_sim/cli/options.h"
#include "host_sim/cli/files.h"
#include "host_sim/cli/options_help.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/commands.h"
#include "host_sim/out/plain.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { NAMES_MAX = 64, NAME_SHOWN = 24, MESSAGE = 16384 };

/* One line, whatever the names in it hold. */
static void complain(const struct usage *u, const char *format, va_list list)
{
    char text[MESSAGE];
    vsnprintf(text, sizeof text, format, list);
    fprintf(stderr, "contactplant %s: ", u->name);
    plain_put(stderr, text);
}

int options_misuse(const struct usage *u, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    complain(u, format, list);
    fprintf(stderr, "; see contactplant %s --help\n", u->name);
    va_end(list);
    return STATUS_MISUSED;
}

int options_failure(const struct usage *u, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    complain(u, format, list);
    fputc('\n', stderr);
    va_end(list);
    return STATUS_FAILED;
}

bool options_reader_left(void)
{
    struct pollfd out = {STDOUT_FILENO, POLLOUT, 0};
    return poll(&out, 1, 0) > 0 && (out.revents & POLLERR);
}

int options_finish(const char *name, int status)
{
    bool failed = ferror(stdout) != 0, unwritten = fflush(stdout) != 0;
    int error = errno;
    if (!(unwritten || failed) || options_reader_left())
        return status;
    error = unwritten ? error : files_find_cause(stdout);
    fprintf(stderr, "contactplant %s: cannot write the output: %s\n", name, files_unwritten(error));
    return status ? status : STATUS_FAILED;
}

bool options_read_number(const char *text, double *value)
{
    char *end;
    if (!*text || strchr(" \t\n", *text))
        return false;
    errno = 0;
    double x = strtod(text, &end);
    if (*end || !isfinite(x) || (errno == ERANGE && fabs(x) > 1.0))
        return false;
    *value = x;
    return true;
}

static const struct option *find(const struct usage *u, const char *name, size_t length)
{
    for (int t = 0; t < OPTIONS_TABLES && u->table[t]; t++)
        for (const struct option *p = u->table[t]; p->name; p++)
            if (strlen(p->name) == length && !strncmp(p->name, name, length))
                return p;
    return NULL;
}

static int unknown(const struct usage *u, const char *name, int length)
{
    const char *names[NAMES_MAX] = {"help"};
    char text[NAME_SHOWN + 1];
    int n = 1;
    for (int t = 0; t < OPTIONS_TABLES && u->table[t]; t++)
        for (const struct option *p = u->table[t]; p->name && n < NAMES_MAX; p++)
            names[n++] = p->name;
    snprintf(text, sizeof text, "%.*s", length, name);
    const char *nearest = options_nearest(text, names, n);
    if (nearest)
        return options_misuse(u, "unknown option --%.*s; did you mean --%s?", length, name, nearest);
    return options_misuse(u, "unknown option --%.*s", length, name);
}

/* Digits, a comma and digits, as in many countries. */
static bool has_comma(const char *text)
{
    const char *comma = strchr(text, ',');
    return comma && comma > text && isdigit((unsigned char)comma[-1]) && isdigit((unsigned char)comma[1]);
}

/* The value of a number option, checked; 0, or the exit status after a line. */
static int read_value(const struct usage *u, struct given *g)
{
    const struct option *p = g->option;
    if (p->kind != OPTION_NUMBER && p->kind != OPTION_INTEGER)
        return *g->text ? 0 : options_misuse(u, "--%s has an empty value; give %s", p->name, p->argument);
    if (!options_read_number(g->text, &g->number))
        return options_misuse(u, "--%s: \"%s\" is not a finite number; give one from %.10g to %.10g%s",
                              p->name, g->text, p->min, p->max,
                              has_comma(g->text) ? ", with a point for the comma" : "");
    if (!(g->number >= p->min && g->number <= p->max))
        return options_misuse(u, "--%s: %s is out of range; give a number from %.10g to %.10g", p->name,
                              g->text, p->min, p->max);
    if (p->kind == OPTION_INTEGER && g->number != floor(g->number))
        return options_misuse(u, "--%s: %s is not a whole number; give one from %.10g to %.10g", p->name,
                              g->text, p->min, p->max);
    return 0;
}

/* The NAME of this NAME=VALUE stands in an option before already. */
static bool is_repeated(const struct options *o, const struct given *g)
{
    size_t n = strcspn(g->text, "=");
    bool named = g->option->many && strchr(g->option->argument, '=') && g->text[n];
    for (int i = 0; named && i < o->n_given; i++)
        if (o->given[i].option == g->option && !strncmp(o->given[i].text, g->text, n + 1))
            return true;
    return false;
}

/* argv[*i] begins with "--" and is not "--" alone. */
static int read_option(struct options *o, int argc, char **argv, int *i)
{
    const char *name = argv[*i] + 2, *equal = strchr(name, '=');
    size_t length = equal ? (size_t)(equal - name) : strlen(name);
    const struct option *p = find(o->usage, name, length);
    if (!p)
        return unknown(o->usage, name, (int)length);
    if (!p->many && options_given(o, p->name))
        return options_misuse(o->usage, "--%s is given twice; give it once", p->name);
    if (o->n_given == OPTIONS_GIVEN)
        return options_misuse(o->usage, "more than %d options", OPTIONS_GIVEN);
    struct given *g = &o->given[o->n_given];
    *g = (struct given){.option = p, .text = equal ? equal + 1 : NULL};
    o->n_given += p->kind == OPTION_FLAG;
    if (p->kind == OPTION_FLAG)
        return equal ? options_misuse(o->usage, "--%s takes no value", p->name) : 0;
    if (!g->text) {
        if (*i + 1 >= argc)
            return options_misuse(o->usage, "--%s needs a value: --%s %s", p->name, p->name, p->argument);
        g->text = argv[++*i];
    }
    if (is_repeated(o, g))
        return options_misuse(o->usage, "--%s %.*s is given twice; give it once", p->name,
                              (int)strcspn(g->text, "="), g->text);
    o->n_given++;
    return read_value(o->usage, g);
}

static int read_all(struct options *o, int argc, char **argv)
{
    bool only_words = false;
    int status = 0;
    for (int i = 1; i < argc && !status; i++) {
        bool dashed = !only_words && argv[i][0] == '-' && argv[i][1];
        double number;
        if (dashed && !strcmp(argv[i], "--"))
            only_words = true;
        else if (dashed && argv[i][1] == '-')
            status = read_option(o, argc, argv, &i);
        else if (dashed && !options_read_number(argv[i], &number))
            status = options_misuse(o->usage, "unknown option %s; options begin with two dashes", argv[i]);
        else if (o->n_words == OPTIONS_WORDS)
            status = options_misuse(o->usage, "more than %d words", OPTIONS_WORDS);
        else
            o->word[o->n_words++] = argv[i];
    }
    return status;
}

/* Calls take for each file of this kind that the line names, by itself or by default. */
static int each_file(const struct options *o, enum option_kind kind,
                     int (*take)(const struct options *o, const struct option *p, const char *path))
{
    int status = 0;
    for (int t = 0; t < OPTIONS_TABLES && o->usage->table[t]; t++)
        for (const struct option *p = o->usage->table[t]; p->name && !status; p++) {
            const char *path = options_text(o, p->name, 0);
            if (path && p->kind == kind)
                status = take(o, p, path);
        }
    return status;
}

static int take_output(const struct options *o, const struct option *p, const char *path)
{
    char why[FILES_REASON];
    bool taken = files_take(p ? p->name : "", path, p && p->kind == OPTION_FOLDER, why);
    return taken ? 0 : options_misuse(o->usage, "%s", why);
}

static int take_input(const struct options *o, const struct option *p, const char *path)
{
    char why[FILES_REASON];
    (void)p;
    return files_reads(path, "read by this command", why) ? 0 : options_misuse(o->usage, "%s", why);
}

/* Folders come first: a file may lie in one that is not there yet. */
static int take_files(const struct options *o)
{
    files_begin();
    int status = each_file(o, OPTION_FOLDER, take_output);
    status = status ? status : each_file(o, OPTION_WRITES, take_output);
    int written = o->usage->words_written, read = written + o->usage->words_read;
    for (int i = 0; i < o->n_words && i < written && !status; i++)
        status = take_output(o, NULL, o->word[i]);
    status = status ? status : each_file(o, OPTION_READS, take_input);
    for (int i = written; i < o->n_words && i < read && !status; i++)
        status = take_input(o, NULL, o->word[i]);
    return status;
}

bool options_parse(struct options *o, const struct usage *u, int argc, char **argv, int *status)
{
    *o = (struct options){.usage = u, .argc = argc, .argv = argv};
    for (int i = 1; i < argc && strcmp(argv[i], "--"); i++) {
        if (options_help(u, argv[i])) {
            *status = STATUS_DONE;
            return false;
        }
    }
    *status = read_all(o, argc, argv);
    if (!*status && o->n_words < u->min_words)
        *status = options_misuse(u, "something is missing; write contactplant %s %s", u->name, u->words);
    if (!*status && o->n_words > u->max_words)
        *status =
            options_misuse(u, "\"%s\" is one word too many; take it away, see --help", o->word[u->max_words]);
    *status = *status ? *status : take_files(o);
    return !*status;
}

int options_count(const struct options *o, const char *name)
{
    int n = 0;
    for (int i = 0; i < o->n_given; i++)
        n += !strcmp(o->given[i].option->name, name);
    return n;
}

bool options_given(const struct options *o, const char *name)
{
    return options_count(o, name) > 0;
}

static const struct given *nth(const struct options *o, const char *name, int n)
{
    for (int i = 0; i < o->n_given; i++)
        if (!strcmp(o->given[i].option->name, name) && n-- == 0)
            return &o->given[i];
    return NULL;
}

const char *options_text(const struct options *o, const char *name, int i)
{
    const struct given *g = nth(o, name, i);
    const struct option *p = find(o->usage, name, strlen(name));
    if (g)
        return g->text;
    return i == 0 && p ? p->initial : NULL;
}

int options_find(const struct options *o, const char *option, const char *const *name, int n,
                 const char *lacking)
{
    const char *text = options_text(o, option, 0);
    for (int i = 0; i < n; i++)
        if (!strcmp(text, name[i]))
            return i;
    options_misuse(o->usage, "--%s %s: %s%s", option, text, lacking,
                   options_advise(text, strlen(text), name, n, NULL));
    return -1;
}

double options_number(const struct options *o, const char *name)
{
    const struct given *g = nth(o, name, 0);
    const struct option *p = find(o->usage, name, strlen(name));
    if (g)
        return g->number;
    return p && p->initial ? strtod(p->initial, NULL) : (double)NAN;
}

int options_check_folder(const struct options *o, const char *name, const char *const *file)
{
    char why[FILES_REASON];
    for (; *file; file++)
        if (!files_take_in(options_text(o, name, 0), *file, why))
            return options_misuse(o->usage, "%s", why);
    return 0;
}

static FILE *open_output(const struct options *o, const char *name, FILE *(*open)(const char *path))
{
    const char *path = options_text(o, name, 0);
    FILE *f = open(path);
    if (!f)
        options_failure(o->usage, "cannot write --%s %s: %s; choose another", name, path, strerror(errno));
    return f;
}

FILE *options_create(const struct options *o, const char *name)
{
    return open_output(o, name, files_create);
}

FILE *options_compose(const struct options *o, const char *name)
{
    return open_output(o, name, files_compose);
}

int options_close(const struct options *o, const char *name, FILE *f, const char *why)
{
    bool complete = files_finish(f, !why);
    return complete ? 0
                    : options_failure(o->usage, "--%s is not complete: %s", name,
                                      why ? why : files_unwritten(errno));
}

FILE *options_summary(const struct options *o)
{
    return options_given(o, "out") ? stdout : stderr;
}
