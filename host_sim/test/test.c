/* test.c - contactplant test: reads test files, runs their cases side by side, and reports. */
#include "host_sim/cli/options_nearest.h"
#include "host_sim/commands.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/files.h"
#include "host_sim/cli/options.h"
#include "host_sim/cli/shell.h"
#include "host_sim/test/bench/controller.h"
#include "host_sim/test/bench/device.h"
#include "host_sim/maps/jobs.h"
#include "host_sim/maps/jobs_workers.h"
#include "host_sim/live/bus.h"
#include "host_sim/scene/scene_load.h"
#include "host_sim/test/bench/loops.h"
#include "host_sim/test/bench/child.h"
#include "host_sim/test/bench/controller.h"
#include "host_sim/test/record.h"
#include "host_sim/test/report/report.h"
#include "host_sim/test/report/test_html.h"
#include "host_sim/test/test_read.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TEST_FILES_MAX = 80, RUNS_MAX = 100000, REPORTS_MAX = 2000, STATUS_BENCH = 3 };

static const struct option test_options[] = {
    {"case", "NAME", "run this case only; repeatable", OPTION_TEXT, .many = true},
    {"seed", "N", "run each case with this seed only", OPTION_INTEGER, 0.0, 4294967295.0, .initial = NULL},
    {"log", "DIR", "record each run and what its controller prints into this folder", OPTION_FOLDER,
     .initial = NULL},
    {"junit", "FILE", "also report as JUnit XML", OPTION_WRITES, .initial = NULL},
    {"json", "FILE", "also report as JSON, with the value of every expectation", OPTION_WRITES,
     .initial = NULL},
    {"report", "FILE", "a page with verdicts and, with --log, charts around what failed; opens in a browser",
     OPTION_WRITES, .initial = NULL},
    {"requirements", "FILE",
     "a CSV of ID,TEXT lines: all that there are. A case that names another one is refused, and those that "
     "no "
     "case names are told",
     OPTION_READS, .initial = NULL},
    {"fail-on", "WHAT", "exit with 1 on this, too: untraced, a requirement that no case names", OPTION_TEXT,
     .initial = NULL},
    {"cores", "N", "cases that run side by side (all cores)", OPTION_INTEGER, 1.0, JOBS_CORES,
     .initial = NULL},
    {"shard", "I/N", "only the I-th of N shares of the cases, or auto; contactplant merge joins them (1/1)",
     OPTION_TEXT, .initial = "1/1"},
    {"patience", "S", "seconds that a controller may be silent (10; 0: for ever)", OPTION_NUMBER, 0.0, 1e9,
     .initial = "10"},
    {.name = "realtime",
     .meaning = "test on a plant that runs elsewhere, in real time: contactplant run, or a board"},
    {"bus", "BUS",
     "with --realtime: this program's udp:HOST:PORT or can:IFACE (udp:20003); with attach: the plant's "
     "(udp:127.0.0.1:20000)",
     OPTION_TEXT, .initial = NULL},
    {"plant", "HOST:PORT", "with --realtime: where the plant is (127.0.0.1:20000)", OPTION_TEXT,
     .initial = "127.0.0.1:20000"},
    {"controller", "HOST:PORT",
     "with --realtime or attach: where the controller is, a peer of the plant (127.0.0.1:20001)", OPTION_TEXT,
     .initial = "127.0.0.1:20001"},
    {.name = NULL},
};

static const struct usage test_usage = {
    .name = "test",
    .words = "FILE...",
    .summary =
        "Tests a controller: runs the cases of test files against a plant in lockstep, without a clock, and\n"
        "judges by what the plant did. Each case starts the controller anew. With --realtime the plant runs\n"
        "elsewhere, and what its bus tells is judged. The format, the metrics and a recipe for CI are in\n"
        "docs/guide/controller-tests.md; contactplant list metrics prints the metrics.",
    .words_help =
        "Exit status: 0 every case is ok, 1 a case failed or judged nothing, 2 a mistake in a file,\n"
        "3 the bench had an error: a controller that ended or was silent, a fault of the plant.\n",
    .examples = "  contactplant test keep.test\n"
                "  contactplant test keep.test --case shaken --log logs\n"
                "  contactplant test tests/*.test --junit out.xml\n"
                "  contactplant test keep.test --realtime                  beside contactplant run\n"
                "  contactplant test keep.test --realtime --bus can:can0   a board, say\n",
    .min_words = 1,
    .max_words = TEST_FILES_MAX,
    .words_read = TEST_FILES_MAX,
    .table = {test_options},
};

struct tests {
    const struct options *o;
    struct test_file *test[TEST_FILES_MAX];
    struct report_case report[REPORTS_MAX];
    int n_reports, n_runs, n_done, printed;
    int first_run[REPORTS_MAX]; /* each report's */
    bool is_done[RUNS_MAX];
    char program[PATH_MAX];
    struct requirements requirements, untraced;
    uint32_t identity;      /* a hash of the files' texts */
    char share[SHARE_LINE]; /* tells the share, for its reports; "" for all cases */
    char *again;            /* options that a command for one case must have */
    double begin_s;
    bool whole; /* every run came to its end */
};

/* ---- reading ---- */

static bool load_scene(const char *file, const char *name, struct scene *s, char *why)
{
    char path[BENCH_PATH];
    bench_scene_path(file, name, path);
    bool bare = access(path, F_OK) != 0 && access(name, F_OK) != 0; /* then its name tells the nearest */
    return scene_load(bare ? name : path, s, why) != SCENE_OF_NOTHING;
}

/* A word of the test file that names a file is an input, too. 0, or the exit status after a line. */
static int take_input(const struct tests *t, const struct test_file *test, const char *name, const char *what)
{
    char path[BENCH_PATH], why[FILES_REASON];
    bench_scene_path(test->file, name, path);
    return !access(path, F_OK) && !files_reads(path, what, why) ? options_misuse(t->o->usage, "%s", why) : 0;
}

/* Golden logs, and the files that the controller's command names. */
static int take_inputs(const struct tests *t, const struct test_file *test)
{
    static const char between[] = " \t'\"`$(){};&|<>=";
    char command[TEST_VALUE], *rest = NULL;
    int status = 0;
    for (int k = 0; k < test->n_cases && !status; k++)
        if (*test->cases[k].golden)
            status = take_input(t, test, test->cases[k].golden, "a golden log of this test");
    snprintf(command, sizeof command, "%s", test->command);
    for (char *word = strtok_r(command, between, &rest); word && !status;
         word = strtok_r(NULL, between, &rest))
        status = take_input(t, test, word, "part of the controller's command");
    return status;
}

static int read_file(struct tests *t, int i)
{
    const char *path = t->o->word[i];
    char why[TEST_REASON], *text = malloc(TEST_BYTES + 1);
    t->test[i] = malloc(sizeof *t->test[i]);
    if (!text || !t->test[i]) {
        free(text);
        return options_failure(t->o->usage, "out of memory");
    }
    errno = 0;
    FILE *f = fopen(path, "rb");
    size_t n = f ? fread(text, 1, TEST_BYTES + 1, f) : 0;
    bool bad = !f || ferror(f);
    int error = errno;
    if (f)
        (void)fclose(f);
    int status = 0;
    t->identity = jobs_run_on(t->identity, text, bad ? 0 : n);
    if (bad)
        status = options_misuse(t->o->usage, "cannot read %s: %s", path, strerror(error));
    else if (!test_parse(path, text, n, load_scene, t->test[i], why))
        status = options_misuse(t->o->usage, "%s", why);
    free(text);
    for (int k = 0; !status && k < t->test[i]->n_cases; k++)
        if (!(t->test[i]->loops ? loops_approve : bench_approve)(t->test[i], &t->test[i]->cases[k], why))
            status = options_misuse(t->o->usage, "%s", why);
    return status ? status : take_inputs(t, t->test[i]);
}

/* Names what the shares have in common: files, requirements, and the options that decide the cases. */
static uint32_t identify_all(const struct tests *t)
{
    uint32_t id = t->identity;
    for (int i = 0; i < t->o->n_words; i++)
        id = jobs_run_on(id, t->o->word[i], strlen(t->o->word[i]) + 1);
    for (int i = 0; i < t->requirements.n; i++)
        id = jobs_run_on(id, t->requirements.entry[i].id, strlen(t->requirements.entry[i].id) + 1);
    for (int i = 0; i < t->o->n_given; i++) {
        const struct given *g = &t->o->given[i];
        bool decides = g->option->kind != OPTION_WRITES && g->option->kind != OPTION_READS &&
                       g->option->kind != OPTION_FOLDER && strcmp(g->option->name, "shard") != 0 &&
                       strcmp(g->option->name, "cores") != 0;
        if (!decides)
            continue;
        id = jobs_run_on(id, g->option->name, strlen(g->option->name) + 1);
        id = jobs_run_on(id, g->text ? g->text : "", g->text ? strlen(g->text) + 1 : 0);
    }
    return id;
}

/* The cases of --shard stay, and their runs get their numbers. */
static int take_share(struct tests *t)
{
    struct share s = {.end = 0};
    int status = share_take(t->o, t->n_reports, &s);
    if (!status && s.n > 1)
        share_tell(t->o, &s, t->n_reports, "cases", identify_all(t), t->share);
    t->n_reports = s.end - s.first;
    memmove(t->report, t->report + s.first, (size_t)t->n_reports * sizeof t->report[0]);
    t->n_runs = 0;
    for (int i = 0; i < t->n_reports; i++) {
        t->first_run[i] = t->n_runs;
        t->n_runs += t->report[i].n_runs;
    }
    return status;
}

static bool is_picked(const struct options *o, const char *name)
{
    for (int i = 0; i < options_count(o, "case"); i++)
        if (!strcmp(options_text(o, "case", i), name))
            return true;
    return !options_given(o, "case");
}

static int no_case(const struct tests *t, const char *name)
{
    const char *known[TEST_CASES];
    int n = t->test[0]->n_cases;
    for (int i = 0; i < n; i++)
        known[i] = t->test[0]->cases[i].name;
    return options_misuse(t->o->usage, "--case %s: no such case%s", name,
                          options_advise(name, strlen(name), known, n, NULL));
}

static int add_case(struct tests *t, const struct test_file *test, struct test_case *c)
{
    if (options_given(t->o, "seed")) {
        c->first_seed = (uint32_t)options_number(t->o, "seed");
        c->n_seeds = 1;
    }
    int runs = (int)c->n_seeds * c->vary.n;
    if (t->n_reports == REPORTS_MAX || t->n_runs + runs > RUNS_MAX)
        return options_misuse(t->o->usage, "more than %d cases or %d runs; test fewer at once", REPORTS_MAX,
                              RUNS_MAX);
    t->report[t->n_reports++] =
        (struct report_case){.test = test, .c = c, .n_runs = runs, .began = time(NULL)};
    t->n_runs += runs;
    return 0;
}

/* Before any is picked, so that a case has the same name with --case and in each shard. */
static void name_cases(struct tests *t)
{
    for (int i = 0; i < t->o->n_words; i++)
        for (int k = 0; k < t->test[i]->n_cases; k++)
            t->test[i]->cases[k].names_seed = t->test[i]->cases[k].n_seeds > 1 || options_given(t->o, "seed");
    record_name_cases(t->test, t->o->n_words);
}

static int pick_cases(struct tests *t)
{
    int status = 0;
    name_cases(t);
    for (int i = 0; i < t->o->n_words; i++)
        for (int k = 0; k < t->test[i]->n_cases && !status; k++)
            if (is_picked(t->o, t->test[i]->cases[k].name))
                status = add_case(t, t->test[i], &t->test[i]->cases[k]);
    for (int i = 0; i < options_count(t->o, "case") && !status; i++) {
        bool found = false;
        for (int k = 0; k < t->n_reports; k++)
            found = found || !strcmp(t->report[k].c->name, options_text(t->o, "case", i));
        status = found ? 0 : no_case(t, options_text(t->o, "case", i));
    }
    return status ? status : take_share(t);
}

/* Options that decide what a case does, for the command that runs it again. False: out of memory. */
static bool write_again(struct tests *t)
{
    static const char *const kept[] = {"realtime", "bus", "plant", "controller", "patience"};
    size_t size;
    FILE *f = open_memstream(&t->again, &size);
    for (int i = 0; f && i < (int)(sizeof kept / sizeof kept[0]); i++) {
        if (!options_given(t->o, kept[i]))
            continue;
        fprintf(f, " --%s", kept[i]);
        if (i > 0)
            shell_put_word(f, options_text(t->o, kept[i], 0));
    }
    return f && fclose(f) == 0;
}

/* ---- running ---- */

static int report_of(const struct tests *t, int run)
{
    int i = t->n_reports - 1;
    while (t->first_run[i] > run)
        i--;
    return i;
}

/* Which run this is, into a result that has nothing else. */
static void identify(const struct tests *t, int run, struct bench_result *r)
{
    const struct report_case *report = &t->report[report_of(t, run)];
    const struct test_case *c = report->c;
    int k = run - t->first_run[report_of(t, run)];
    memset(r, 0, sizeof *r);
    r->i_case = (int)(c - report->test->cases);
    r->seed = c->first_seed + (uint32_t)(k % (int)c->n_seeds);
    r->varied = c->varied >= 0;
    r->i_varied = k / (int)c->n_seeds;
    if (r->varied)
        r->varied_value = range_value(&c->vary, r->i_varied);
}

/* In a process of its own: the result as it is in memory. */
static bool compute(void *context, int run, FILE *rows)
{
    const struct tests *t = context;
    static struct bench_result r;
    const struct test_file *test = t->report[report_of(t, run)].test;
    const struct bench_setting s = {.test = test,
                                    .program = t->program,
                                    .log = options_text(t->o, "log", 0),
                                    .bus = options_text(t->o, "bus", 0),
                                    .plant = options_text(t->o, "plant", 0),
                                    .controller = options_text(t->o, "controller", 0),
                                    .realtime = options_given(t->o, "realtime"),
                                    .patience_s = options_number(t->o, "patience")};
    identify(t, run, &r);
    (test->loops ? loops_run : s.realtime ? device_run : bench_run)(&s, &r);
    return fwrite(&r, sizeof r, 1, rows) == 1;
}

static void show_progress(const struct tests *t)
{
    double passed_s = clock_now_s() - t->begin_s;
    if (!isatty(2))
        return;
    fprintf(stderr, "\r%d of %d runs, %.0f s left \r", t->n_done, t->n_runs,
            passed_s / t->n_done * (t->n_runs - t->n_done));
}

/* The result of a run goes to its case, which keeps the first of the worst. */
static void book(struct tests *t, int run, struct bench_result *found)
{
    struct report_case *r = &t->report[report_of(t, run)];
    t->is_done[run] = true;
    r->n_done++;
    t->n_done++;
    r->plant_s += found->plant_s;
    r->took_s += found->took_s;
    r->n_bad += found->verdict != VERDICT_OK;
    bool worse = !r->worst || found->verdict > r->worst->verdict ||
                 (found->verdict == r->worst->verdict && run < r->i_worst);
    if (worse)
        r->i_worst = run;
    free(worse ? r->worst : found);
    r->worst = worse ? found : r->worst;
    show_progress(t);
    while (t->printed < t->n_reports && t->report[t->printed].n_done == t->report[t->printed].n_runs)
        report_print(stdout, &t->report[t->printed++], t->again);
    (void)fflush(stdout); /* where nobody reads on, the other reports are still written */
}

static bool take(void *taker, int run, char *text, bool last)
{
    (void)last;
    book(taker, run, (struct bench_result *)(void *)text);
    return true;
}

/* The log of a run that did not come to its end, where it was begun. */
static void name_log(const struct tests *t, int run, struct bench_result *r)
{
    const struct bench_setting s = {.test = t->report[report_of(t, run)].test,
                                    .log = options_text(t->o, "log", 0)};
    if (!s.log || s.test->loops)
        return;
    controller_log_path(&s, r, ".log", r->log);
    if (access(r->log, F_OK))
        *r->log = 0;
}

/* An error in the place of a run's result. False: out of memory. */
static bool book_error(struct tests *t, int run, const char *why)
{
    struct bench_result *r = malloc(sizeof *r);
    if (!r)
        return false;
    identify(t, run, r);
    r->verdict = VERDICT_ERROR;
    snprintf(r->error, sizeof r->error, "%s", why);
    name_log(t, run, r);
    book(t, run, r);
    return true;
}

/* Runs that did not end are errors, so that every report names them. */
static void book_rest(struct tests *t, const char *reason)
{
    char why[TEST_REASON];
    snprintf(why, sizeof why, "it did not run to its end: %.400s", reason);
    for (int run = 0; run < t->n_runs; run++)
        if (!t->is_done[run])
            (void)book_error(t, run, why);
}

/* The process of a run is no more, and its controller may be. */
static bool lose(void *taker, int run, int status)
{
    char why[TEST_REASON];
    bool killed = WIFSIGNALED(status);
    (void)child_end_left(true);
    snprintf(why, sizeof why, "the bench's process of this case ended by %s %d (%s)%s",
             killed ? "signal" : "status", killed ? WTERMSIG(status) : WEXITSTATUS(status),
             killed ? strsignal(WTERMSIG(status)) : "no signal",
             killed ? "; a controller must not signal its parent" : "");
    return book_error(taker, run, why);
}

/* The file of this option, if it was given. */
static bool write_report(const struct tests *t, const char *option,
                         bool (*write)(const char *path, const struct report *r))
{
    const char *path = options_text(t->o, option, 0);
    const struct report r = {t->report, t->n_reports, &t->untraced, t->share, t->whole};
    bool written = !path || write(path, &r);
    if (!written)
        options_failure(t->o->usage, "--%s %s cannot be written: %s", option, path, files_unwritten(errno));
    return written;
}

/* One line for requirements that no case names. */
static void print_untraced(const struct tests *t)
{
    for (int i = 0; i < t->untraced.n; i++)
        printf("%s%s", i ? ", " : "untraced: ", t->untraced.entry[i].id);
    if (t->untraced.n)
        printf("; no case names %s\n", t->untraced.n == 1 ? "it" : "them");
}

static int conclude(const struct tests *t)
{
    int n[4] = {0};
    double plant_s = 0.0, took_s = clock_now_s() - t->begin_s;
    for (int i = 0; i < t->n_reports; i++) {
        n[t->report[i].worst->verdict]++;
        plant_s += t->report[i].plant_s;
    }
    printf("%d ok, %d failed, %d untested, %d with an error; %.6g s of plant time in %.2f s\n", n[VERDICT_OK],
           n[VERDICT_FAIL], n[VERDICT_UNTESTED], n[VERDICT_ERROR], plant_s, took_s);
    print_untraced(t);
    bool written = write_report(t, "junit", report_junit);
    written = write_report(t, "json", report_json) && written;
    if (!written || fflush(stdout))
        return STATUS_FAILED;
    bool is_short = t->untraced.n && options_given(t->o, "fail-on");
    return n[VERDICT_ERROR]                                    ? STATUS_BENCH
           : n[VERDICT_FAIL] + n[VERDICT_UNTESTED] || is_short ? STATUS_FAILED
                                                               : STATUS_DONE;
}

static bool has_microscope(const struct tests *t)
{
    bool has = false;
    for (int i = 0; i < t->o->n_words; i++)
        has = has || t->test[i]->lever.model;
    return has;
}

static bool has_attached(const struct tests *t)
{
    bool has = false;
    for (int i = 0; i < t->o->n_words; i++)
        has = has || t->test[i]->attached;
    return has;
}

static int run_all(struct tests *t)
{
    char why[JOBS_REASON];
    if (!write_again(t))
        return options_failure(t->o->usage, "out of memory");
    int cores = options_given(t->o, "cores") ? (int)options_number(t->o, "cores") : workers_cores();
    cores = has_attached(t) || options_given(t->o, "realtime") ? 1 : cores; /* there is one address */
    const struct workers w = {compute, t, take, lose, t, 0, t->n_runs, cores};
    t->begin_s = clock_now_s();
    child_adopt();
    t->whole = workers_run(&w, why);
    (void)child_end_left(false);
    if (!t->whole) {
        options_failure(t->o->usage, "%s", why);
        book_rest(t, why);
    }
    return conclude(t);
}

/* Addresses are for what is started elsewhere. */
static int check_addresses(const struct tests *t)
{
    static const char *const needs_it[] = {"bus", "controller", "plant"};
    const char *bus = options_text(t->o, "bus", 0);
    bool realtime = options_given(t->o, "realtime"), udp = bus && !strncmp(bus, "udp:", 4);
    for (int i = 0; i < 3 && !realtime; i++)
        if (options_given(t->o, needs_it[i]) && (i == 2 || !has_attached(t)))
            return options_misuse(t->o->usage, "--%s goes with --realtime%s", needs_it[i],
                                  i == 2 ? "" : ", or with attach in [controller]");
    if (realtime && has_microscope(t))
        return options_misuse(t->o->usage, "--realtime: a microscope is tested in lockstep; leave it out");
    if (bus && !realtime && !udp)
        return options_misuse(t->o->usage, "--bus %s: lockstep needs udp:HOST:PORT", bus);
    const char *wrong = bus ? bus_misspelt(bus, NULL, 0, BUS_CONTROLLER) : NULL;
    return wrong ? options_misuse(t->o->usage, "--bus %s: %s", bus, wrong) : 0;
}

/* A record is no golden log of any case, though that be missing: a run would be compared with itself. */
static int check_record(const struct tests *t, const char *path)
{
    char why[FILES_REASON];
    const char *log = options_text(t->o, "log", 0);
    const struct test_case *of = NULL;
    for (int i = 0; i < t->o->n_words && !of; i++)
        of = record_of_golden(t->test[i], path);
    if (of)
        return options_misuse(t->o->usage, "--log: %s is the golden log of [case %s]; choose another folder",
                              path, of->name);
    return files_take_in(log, path + strlen(log) + 1, why) ? 0
                                                           : options_misuse(t->o->usage, "--log: %s", why);
}

/* Before anything runs: no run records over an input or another output. 0, or the exit status after a line.
 */
static int check_records(const struct tests *t)
{
    static const char *const ends[] = {".log", ".csv", ".controller.txt"};
    static struct bench_result r; /* large: not on the stack */
    struct bench_setting s = {.log = options_text(t->o, "log", 0)};
    char path[BENCH_PATH];
    int status = 0;
    for (int run = 0; s.log && run < t->n_runs && !status; run++) {
        s.test = t->report[report_of(t, run)].test;
        identify(t, run, &r);
        for (size_t i = 0; i < sizeof ends / sizeof *ends && !status; i++) {
            controller_log_path(&s, &r, ends[i], path);
            status = check_record(t, path);
        }
    }
    return status;
}

static int make_folder(const struct tests *t)
{
    const char *log = options_text(t->o, "log", 0);
    struct stat s;
    if (log && (stat(log, &s) || !S_ISDIR(s.st_mode)) && mkdir(log, 0777))
        return options_misuse(t->o->usage, "--log %s: no such folder, and it cannot be made: %s", log,
                              strerror(errno));
    return 0;
}

static bool is_traced(const struct tests *t, const char *id)
{
    for (int i = 0; i < t->o->n_words; i++)
        for (int k = 0; k < t->test[i]->n_cases; k++)
            if (requirements_names(&t->test[i]->cases[k], id))
                return true;
    return false;
}

/* Holds the cases of all files, picked or not, against --requirements. 0, or the exit status after a line. */
static int read_requirements(struct tests *t)
{
    struct requirements *l = &t->requirements;
    const char *path = options_text(t->o, "requirements", 0), *fail_on = options_text(t->o, "fail-on", 0);
    char why[REQUIREMENTS_REASON];
    if (fail_on && (!path || strcmp(fail_on, "untraced") != 0))
        return options_misuse(t->o->usage, "--fail-on %s: it is untraced, and goes with --requirements",
                              fail_on);
    if (!path)
        return 0;
    if (!requirements_read(l, path, why))
        return options_misuse(t->o->usage, "--requirements: %s", why);
    for (int i = 0; i < t->o->n_words; i++)
        if (!requirements_know(l, t->test[i], why))
            return options_misuse(t->o->usage, "%s", why);
    t->untraced.entry = malloc((size_t)l->n * sizeof *l->entry);
    if (!t->untraced.entry)
        return options_failure(t->o->usage, "out of memory");
    for (int i = 0; i < l->n; i++)
        if (!is_traced(t, l->entry[i].id))
            t->untraced.entry[t->untraced.n++] = l->entry[i];
    return 0;
}

static int prepare(struct tests *t)
{
    int status = 0;
    ssize_t n = readlink("/proc/self/exe", t->program, sizeof t->program - 1);
    t->program[n > 0 ? n : 0] = 0;
    for (int i = 0; i < t->o->n_words && !status; i++)
        status = read_file(t, i);
    status = status ? status : read_requirements(t);
    status = status ? status : check_addresses(t);
    status = status ? status : pick_cases(t);
    status = status ? status : check_records(t);
    return status ? status : make_folder(t);
}

int cmd_test(int argc, char **argv)
{
    static struct tests t; /* large: not on the stack */
    static struct options o;
    int status;
    if (!options_parse(&o, &test_usage, argc, argv, &status))
        return status;
    t.o = &o;
    status = prepare(&t);
    status = status ? status : run_all(&t);
    if (t.n_reports && t.printed == t.n_reports &&
        test_html(&o, argc, argv, t.report, t.n_reports, &t.requirements, &t.untraced))
        status = STATUS_FAILED;
    for (int i = 0; i < t.n_reports; i++)
        free(t.report[i].worst);
    for (int i = 0; i < o.n_words; i++)
        free(t.test[i]);
    free(t.again);
    requirements_free(&t.requirements);
    requirements_free(&t.untraced);
    return status;
}
