/* main.c - runs the tests, or those whose name contains one of the words given. `unit --help` says how. */
#include "tests/unit/test.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TESTS_MAX = 4096, JOBS_MAX = 256, LISTED_S = 1, EXCEPTIONS = 128 };

/* A test's result, written by the process that ran it. */
struct result {
    struct check_counts checks;
    double seconds; /* processor time, that of its processes too */
    bool ended;
    int status;   /* exit status of its process */
    FILE *output; /* output of its process, until it is printed */
};

static struct test *first;
static struct test *chosen[TESTS_MAX];
static struct result *result;
static int n_chosen;
static int n_jobs;
static bool brief, list;
static const char *except[EXCEPTIONS];
static int n_except;

void test_register(struct test *t)
{
    t->next = first;
    first = t;
}

/* ---- which tests ---- */

static int by_place(const void *a, const void *b)
{
    const struct test *x = *(struct test *const *)a, *y = *(struct test *const *)b;
    int order = strcmp(x->file, y->file);
    return order ? order : x->line - y->line;
}

static bool wanted(const struct test *t, char **word, int n)
{
    for (int i = 0; i < n_except; i++)
        if (!strcmp(t->name, except[i]))
            return false;
    for (int i = 0; i < n; i++)
        if (strstr(t->name, word[i]))
            return true;
    return n == 0;
}

/* One name, one test: otherwise a filter could not tell them apart. */
static void refuse_twins(void)
{
    for (int i = 0; i < n_chosen; i++)
        for (int k = 0; k < i; k++)
            if (!strcmp(chosen[i]->name, chosen[k]->name)) {
                fprintf(stderr, "%s:%d and %s:%d: two tests are called %s; rename one\n", chosen[k]->file,
                        chosen[k]->line, chosen[i]->file, chosen[i]->line, chosen[i]->name);
                exit(2);
            }
}

/* A test that is called otherwise by now would run again, unseen. */
static void refuse_unknown_exceptions(void)
{
    for (int i = 0; i < n_except; i++) {
        const struct test *t = first;
        while (t && strcmp(t->name, except[i]))
            t = t->next;
        if (!t) {
            fprintf(stderr, "--except: no test is called %s; `unit --list` prints the names\n", except[i]);
            exit(2);
        }
    }
}

static void choose_tests(char **word, int n)
{
    refuse_unknown_exceptions();
    for (struct test *t = first; t; t = t->next)
        if (wanted(t, word, n)) {
            if (n_chosen == TESTS_MAX) {
                fprintf(stderr, "more than %d tests: raise TESTS_MAX in tests/unit/main.c\n", TESTS_MAX);
                exit(2);
            }
            chosen[n_chosen++] = t;
        }
    if (n_chosen == 0) {
        fprintf(stderr, "no test has %s in its name; `unit --list` prints the names\n", word[0]);
        exit(2);
    }
    qsort(chosen, (size_t)n_chosen, sizeof chosen[0], by_place);
    refuse_twins();
}

/* ---- one test ---- */

static double seconds_of(int who)
{
    struct rusage r;
    getrusage(who, &r);
    return (double)(r.ru_utime.tv_sec + r.ru_stime.tv_sec) +
           1e-6 * (double)(r.ru_utime.tv_usec + r.ru_stime.tv_usec);
}

/* This process counts, and so do those that it has waited for. */
static double processor_seconds(void)
{
    return seconds_of(RUSAGE_SELF) + seconds_of(RUSAGE_CHILDREN);
}

/* In this process. */
static void run(int i)
{
    check_counts = &result[i].checks;
    double begin = processor_seconds();
    if (!brief)
        printf("--- %s\n", chosen[i]->name);
    fflush(stdout);
    chosen[i]->run();
    result[i].seconds = processor_seconds() - begin;
    result[i].ended = true;
}

/* In a process of its own, so that a crash or a leftover of one test does not reach the next. */
static pid_t start(int i)
{
    result[i].output = tmpfile();
    if (!result[i].output) {
        perror("a temporary file for a test's output");
        exit(2);
    }
    fflush(NULL);
    pid_t child = fork();
    if (child < 0) {
        perror("a process for a test");
        exit(2);
    }
    if (child > 0)
        return child;
    dup2(fileno(result[i].output), STDOUT_FILENO);
    dup2(fileno(result[i].output), STDERR_FILENO);
    run(i);
    exit(0);
}

/* ---- what it printed ---- */

/* In a brief run: only failed checks, with the lines that belong to them. */
static void copy_output(FILE *f)
{
    char line[1 << 12];
    bool begin = true, dropped = false;
    rewind(f);
    while (fgets(line, sizeof line, f)) {
        if (begin)
            dropped = brief && !strncmp(line, "ok  ", 4);
        begin = strchr(line, '\n') != NULL;
        if (!dropped)
            fputs(line, stdout);
    }
    fclose(f);
}

static void print_end(int i)
{
    if (result[i].ended && WIFEXITED(result[i].status) && WEXITSTATUS(result[i].status) == 0)
        return;
    result[i].checks.failed++;
    if (WIFSIGNALED(result[i].status))
        printf("FAIL  the test ended with signal %d, %s\n", WTERMSIG(result[i].status),
               strsignal(WTERMSIG(result[i].status)));
    else
        printf("FAIL  the test ended its process with exit status %d\n", WEXITSTATUS(result[i].status));
    printf("      %s:%d: TEST(%s)\n", chosen[i]->file, chosen[i]->line, chosen[i]->name);
}

static void print_seconds(int i)
{
    if (!brief && result[i].seconds >= LISTED_S)
        printf("      %s: %.1f s\n", chosen[i]->name, result[i].seconds);
}

/* A line when the last test of a file is over. */
static void print_file(int i)
{
    static struct result sum;
    static int n;
    n++;
    sum.checks.passed += result[i].checks.passed;
    sum.checks.failed += result[i].checks.failed;
    sum.seconds += result[i].seconds;
    if (i + 1 < n_chosen && !strcmp(chosen[i]->file, chosen[i + 1]->file))
        return;
    printf("%s  %s: %d tests, %d checks, %d failed, %.1f s\n", sum.checks.failed ? "    " : "ok  ",
           chosen[i]->file, n, sum.checks.passed + sum.checks.failed, sum.checks.failed, sum.seconds);
    sum = (struct result){0};
    n = 0;
}

static void print_test(int i)
{
    if (result[i].output) {
        bool good = result[i].ended && !result[i].checks.failed && result[i].status == 0;
        if (brief && !good)
            printf("--- %s\n", chosen[i]->name);
        if (brief && good)
            fclose(result[i].output);
        else
            copy_output(result[i].output);
        print_end(i);
    }
    print_seconds(i);
    if (brief)
        print_file(i);
    fflush(stdout);
}

/* ---- all of them ---- */

/* Waits for a process and frees its place; ends what happens to no test of ours. */
static int finish(const pid_t *child, int *of)
{
    for (;;) {
        int status;
        pid_t pid = wait(&status);
        if (pid < 0 && errno != EINTR) {
            perror("waiting for a test");
            exit(2);
        }
        for (int k = 0; k < n_jobs; k++)
            if (of[k] >= 0 && child[k] == pid) {
                result[of[k]].status = status;
                return k;
            }
    }
}

/* As many tests at a time as there are jobs, their output in order. */
static void run_jobs(void)
{
    pid_t child[JOBS_MAX];
    int of[JOBS_MAX]; /* the test of this job, -1 without one */
    bool over[TESTS_MAX] = {false};
    int next = 0, printed = 0;
    for (int k = 0; k < n_jobs; k++)
        of[k] = -1;
    for (int k = 0; k < n_jobs && next < n_chosen; k++, next++)
        child[k] = start(of[k] = next);
    while (printed < n_chosen) {
        int k = finish(child, of);
        over[of[k]] = true;
        of[k] = -1;
        if (next < n_chosen) {
            child[k] = start(next);
            of[k] = next++;
        }
        for (; printed < n_chosen && over[printed]; printed++)
            print_test(printed);
    }
}

static void run_here(void)
{
    for (int i = 0; i < n_chosen; i++) {
        run(i);
        print_test(i);
    }
}

static int slower(const void *a, const void *b)
{
    double x = result[*(const int *)a].seconds, y = result[*(const int *)b].seconds;
    return (x < y) - (x > y);
}

static void print_slow(void)
{
    int order[TESTS_MAX];
    for (int i = 0; i < n_chosen; i++)
        order[i] = i;
    qsort(order, (size_t)n_chosen, sizeof order[0], slower);
    for (int i = 0; i < n_chosen && result[order[i]].seconds >= LISTED_S; i++)
        printf("%s%s %.1f s", i ? ", " : "      slow: ", chosen[order[i]]->name, result[order[i]].seconds);
    if (result[order[0]].seconds >= LISTED_S)
        printf("\n");
}

static void print_failed(void)
{
    bool any = false;
    for (int i = 0; i < n_chosen; i++)
        if (result[i].checks.failed) {
            printf("%s%s", any ? ", " : "      failed: ", chosen[i]->name);
            any = true;
        }
    if (any)
        printf("\n");
}

static int summary(void)
{
    int passed = 0, failed = 0;
    for (int i = 0; i < n_chosen; i++) {
        passed += result[i].checks.passed;
        failed += result[i].checks.failed;
    }
    if (n_chosen > 1) {
        print_slow();
        print_failed();
    }
    printf("%d passed, %d failed\n", passed, failed);
    return failed != 0;
}

/* ---- the command line ---- */

static void help(void)
{
    puts("usage: unit [--jobs N] [--brief] [--list] [--except NAME]... [WORD...]\n\n"
         "Runs the tests whose name contains one of the words; without words all.\n"
         "  --jobs N  N tests at a time, each in a process of its own; without it in this process, for a "
         "debugger\n"
         "  --brief   prints failed checks and a line for each file; needs --jobs\n"
         "  --list    prints the names, with file and line\n"
         "  --except NAME  leaves out the test of this name");
    exit(0);
}

static void usage(const char *text)
{
    fprintf(stderr, "unit: %s; see unit --help\n", text);
    exit(2);
}

static void read_exception(const char *name)
{
    if (!name || n_except == EXCEPTIONS)
        usage("--except needs the name of a test, at most 128 times");
    except[n_except++] = name;
}

static void read_jobs(const char *text)
{
    char *end;
    long n = text ? strtol(text, &end, 10) : 0;
    if (n < 1 || n > JOBS_MAX || *end)
        usage("--jobs needs a number from 1 to 256");
    n_jobs = (int)n;
}

/* Takes the options; how many words stand before argv now. */
static int read_options(int argc, char **argv)
{
    int words = 0;
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "--help"))
            help();
        else if (!strcmp(argv[i], "--list"))
            list = true;
        else if (!strcmp(argv[i], "--brief"))
            brief = true;
        else if (!strcmp(argv[i], "--except"))
            read_exception(argv[++i]);
        else if (!strcmp(argv[i], "--jobs"))
            read_jobs(argv[++i]);
        else if (argv[i][0] == '-')
            usage("no such option");
        else
            argv[words++] = argv[i];
    if (brief && !n_jobs)
        usage("--brief needs --jobs");
    return words;
}

int main(int argc, char **argv)
{
    choose_tests(argv, read_options(argc, argv));
    for (int i = 0; list && i < n_chosen; i++)
        printf("%-32s %s:%d\n", chosen[i]->name, chosen[i]->file, chosen[i]->line);
    if (list)
        return 0;
    result = mmap(NULL, sizeof *result * (size_t)n_chosen, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS,
                  -1, 0);
    if (result == MAP_FAILED) {
        perror("memory for the results");
        return 2;
    }
    if (n_jobs)
        run_jobs();
    else
        run_here();
    return summary();
}
