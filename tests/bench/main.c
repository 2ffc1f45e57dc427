/* main.c - speed against accuracy of our methods and of what others use, in one run.
 *
 *   bench OUT_DIR [CASE...]             writes OUT_DIR/peers.csv, front.csv, ratios.csv; prints a table
 *   bench --errors OUT_DIR [CASE...]    writes OUT_DIR/tolerance.csv: the error of every entry that has a
 *                                       tolerance; no timing
 *   bench --short OUT_DIR [CASE...]     the first, with one setting in eight, each timed once
 *
 * Every way to compute a case is run once for its error. Those that no other setting of the same solver beats
 * clearly are then timed in interleaved rounds; medians. Numbers, never pass or fail. */
#include "tests/bench/bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#ifndef BENCH_FLAGS
#define BENCH_FLAGS "unknown flags"
#endif

enum { ROUNDS = 7, SLOW_ROUNDS = 3, FIRST_LOOKS = 3, SHORT_SHARE = 8 };
static bool brief;
static const double round_ns = 1e6;   /* an entry repeats until a round has taken this long */
static const double clearly = 1.5;    /* beaten by this in the first look: not timed again */
static const double slow_ns = 1e7;    /* a run longer than this is timed SLOW_ROUNDS times only */
static const double slowest_ns = 2e9; /* longer than this: left out */
static const double errors[] = {1e-3, 1e-6, 1e-9};
enum { ERRORS = sizeof errors / sizeof *errors };

struct files {
    FILE *all, *front, *ratios;
};

double bench_now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

void *bench_alloc(size_t size)
{
    void *p = calloc(1, size);
    if (!p) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return p;
}

double bench_tolerance(int i)
{
    return pow(10.0, -2.0 - 0.5 * i);
}

struct entry *bench_add(struct bench *b, const char *family, const char *setting, double knob)
{
    struct entry *e = &b->entry[b->n++];
    if (b->n > BENCH_ENTRIES) {
        fprintf(stderr, "more than %d entries\n", BENCH_ENTRIES);
        exit(1);
    }
    memset(e, 0, sizeof *e);
    e->family = family;
    e->knob = knob;
    e->trajectories = 1;
    snprintf(e->setting, sizeof e->setting, "%s", setting);
    return e;
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *x, int n)
{
    qsort(x, (size_t)n, sizeof *x, ascending);
    return x[n / 2];
}

static double error_of(const struct problem *p, double (*out)[EQUATION_STATES])
{
    double worst = 0.0;
    for (int k = 0; k < p->n_out; k++) {
        for (int i = 0; i < p->eq.n; i++) {
            double error = fabs(out[k][i] - p->ref[k][i]) / p->column[i];
            if (!(error <= worst))
                worst = isfinite(error) ? error : (double)INFINITY;
        }
    }
    return worst;
}

/* Time of one run, ns a forcing period, over enough repetitions. */
static double time_entry(const struct problem *p, const struct entry *e)
{
    static double out[CASE_OUTPUTS][EQUATION_STATES];
    double begin = bench_now_ns();
    for (int i = 0; i < e->repeats; i++)
        e->run(e->context, out);
    return (bench_now_ns() - begin) / e->repeats / p->c->periods / e->trajectories;
}

/* The entry's error and the shortest time of a run, ns. */
static double run_entry(const struct problem *p, struct entry *e, int times)
{
    static double out[CASE_OUTPUTS][EQUATION_STATES];
    double best = (double)INFINITY;
    for (int i = 0; i < times && !(best < (double)INFINITY && best > slow_ns); i++) {
        double begin = bench_now_ns();
        e->run(e->context, out);
        best = fmin(best, bench_now_ns() - begin);
    }
    if (e->convert)
        e->convert(e->context, out);
    e->error = error_of(p, out);
    return best;
}

static void first_look(const struct problem *p, struct entry *e)
{
    double best = run_entry(p, e, brief ? 1 : FIRST_LOOKS);
    e->repeats = brief || best >= round_ns ? 1 : (int)(round_ns / best) + 1;
    e->ns_median = best / p->c->periods / e->trajectories;
    e->timed = isfinite(e->error) && e->error < 1.0 && best < slowest_ns;
}

/* Another setting of the same solver is as accurate and clearly faster. */
static bool hopeless(const struct bench *b, const struct entry *e)
{
    for (int i = 0; i < b->n; i++) {
        const struct entry *o = &b->entry[i];
        if (o->timed && strcmp(o->family, e->family) == 0 && o->error <= e->error &&
            o->ns_median * clearly < e->ns_median)
            return true;
    }
    return false;
}

static int rounds_of(const struct problem *p, const struct entry *e)
{
    int rounds = e->ns_median * p->c->periods * e->trajectories > slow_ns ? SLOW_ROUNDS : ROUNDS;
    return brief ? 1 : rounds;
}

/* A line that the next one overwrites, for who sits before a terminal; n = 0 clears it. */
static void show_progress(const char *name, const char *what, int k, int n)
{
    if (!isatty(STDERR_FILENO))
        return;
    if (n > 0)
        fprintf(stderr, "\r%-8s %s %d of %d   ", name, what, k, n);
    else
        fprintf(stderr, "\r%50s\r", "");
}

static void measure(struct bench *b)
{
    const struct problem *p = &b->problem;
    static bool skip[BENCH_ENTRIES];
    for (int i = 0; i < b->n; i++) {
        first_look(p, &b->entry[i]);
        show_progress(p->c->name, "first look", i + 1, b->n);
    }
    for (int i = 0; i < b->n; i++)
        skip[i] = hopeless(b, &b->entry[i]);
    for (int r = 0; r < ROUNDS; r++) {
        show_progress(p->c->name, "round     ", r + 1, ROUNDS);
        for (int i = 0; i < b->n; i++) {
            struct entry *e = &b->entry[i];
            e->timed = e->timed && !skip[i];
            if (e->timed && r < rounds_of(p, e))
                e->ns[r] = time_entry(p, e);
        }
    }
    for (int i = 0; i < b->n; i++) {
        if (b->entry[i].timed)
            b->entry[i].ns_median = median(b->entry[i].ns, rounds_of(p, &b->entry[i]));
    }
    show_progress("", "", 0, 0);
}

static int by_error(const void *a, const void *b)
{
    const struct entry *x = *(const struct entry *const *)a, *y = *(const struct entry *const *)b;
    int family = strcmp(x->family, y->family);
    return family ? family : (x->error < y->error) - (x->error > y->error);
}

static void write_entries(const struct bench *b, const struct files *f)
{
    static const char *const side[] = {"peer", "method", "plant", "batch"};
    static const struct entry *sorted[BENCH_ENTRIES];
    for (int i = 0; i < b->n; i++)
        sorted[i] = &b->entry[i];
    qsort(sorted, (size_t)b->n, sizeof *sorted, by_error);
    for (int i = 0; i < b->n; i++) {
        const struct entry *e = sorted[i];
        fprintf(f->all, "%s,%s,%s,\"%s\",%.6g,%.4g,%.5g,%d\n", b->problem.c->name, side[e->side], e->family,
                e->setting, e->knob, e->error, e->ns_median, e->timed);
        if (front_has(b, e))
            fprintf(f->front, "%s,%s,%s,\"%s\",%.6g,%.4g,%.5g\n", b->problem.c->name, side[e->side],
                    e->family, e->setting, e->knob, e->error, e->ns_median);
    }
}

static void print_ns(double ns, double ours)
{
    if (ns > 0.0 && ours > 0.0)
        printf(" %10.0f %7.1f", ns, ns / ours);
    else
        printf(" %10s %7s", ns > 0.0 ? "" : "never", "");
}

static void report_error(const struct bench *b, double error, FILE *ratios)
{
    const char *method = "-", *peer = "-", *plant_name = "-";
    double ours = front_cost(b, NULL, SIDE_METHOD, error, &method);
    double plant = front_cost(b, NULL, SIDE_PLANT, error, &plant_name);
    double batch = front_cost(b, NULL, SIDE_BATCH, error, NULL);
    double best = front_cost(b, NULL, SIDE_PEER, error, &peer);
    double cvode = front_cost(b, "CVODE", SIDE_PEER, error, NULL);
    double naive = front_cost(b, "naive RK4 loop", SIDE_PEER, error, NULL);
    double times = best > 0.0 && plant > 0.0 ? best / plant : 0.0;
    printf("%-8s %6.0e  %6.1f  %-7s %8.0f %8.0f ", b->problem.c->name, error, times, method, ours, plant);
    print_ns(best, ours);
    printf("  %-14s", peer);
    print_ns(cvode, ours);
    print_ns(naive, ours);
    if (batch > 0.0)
        printf("  %10.0f %7.1f", batch, best / batch);
    printf("\n");
    fprintf(ratios, "%s,%.0e,%s,%.5g,%.5g,%s,%.5g,%.5g,%.5g,%.4g,%.4g,%.5g,%.4g,%.*s\n", b->problem.c->name,
            error, method, ours, plant, peer, best, cvode, naive, ours > 0.0 ? best / ours : 0.0,
            ours > 0.0 ? cvode / ours : 0.0, batch, times, (int)strcspn(plant_name, " "), plant_name);
}

/* One setting in SHORT_SHARE stays. */
static void thin(struct bench *b)
{
    int n = 0;
    for (int i = 0; i < b->n; i++) {
        if (i % SHORT_SHARE == 0)
            b->entry[n++] = b->entry[i];
        else
            b->entry[i].release(b->entry[i].context);
    }
    b->n = n;
}

/* Every way to compute the case. */
static void open_case(struct bench *b, const struct bench_case *c)
{
    b->n = 0;
    problem_make(&b->problem, c);
    show_progress(c->name, "reference", 1, 1);
    reference_series(&b->problem);
    ours_add(b);
    batch_add(b);
    naive_add(b);
    gsl_add(b);
    cvode_add(b);
    odeint_add(b);
    if (brief)
        thin(b);
}

static void close_case(struct bench *b)
{
    for (int i = 0; i < b->n; i++)
        b->entry[i].release(b->entry[i].context);
    free(b->problem.held);
}

static void write_tolerances(const struct bench_case *c, FILE *f)
{
    static struct bench b;
    open_case(&b, c);
    for (int i = 0; i < b.n; i++) {
        struct entry *e = &b.entry[i];
        if (e->knob >= 1.0 || e->side == SIDE_PLANT || e->side == SIDE_BATCH)
            continue; /* a number of steps; the same method once more */
        run_entry(&b.problem, e, 1);
        fprintf(f, "%s,%s,\"%s\",%.3g,%.3g\n", c->name, e->family, e->setting, e->knob, e->error);
    }
    close_case(&b);
}

static void run_case(const struct bench_case *c, const struct files *f)
{
    static struct bench b;
    open_case(&b, c);
    double check = reference_check(&b.problem);
    measure(&b);
    printf("%s: %s; %d periods, %d outputs, reference twice: %.1e apart\n", c->name, c->title, c->periods,
           b.problem.n_out, check);
    for (int i = 0; i < ERRORS; i++)
        report_error(&b, errors[i], f->ratios);
    fflush(stdout);
    write_entries(&b, f);
    close_case(&b);
}

static void print_machine(void)
{
    char line[256], *colon;
    FILE *f = fopen("/proc/cpuinfo", "r");
    while (f && fgets(line, sizeof line, f)) {
        if (strncmp(line, "model name", 10) == 0 && (colon = strchr(line, ':')) != NULL) {
            printf("machine   %s", colon + 2);
            break;
        }
    }
    if (f)
        fclose(f);
    printf("compiler  %s, %s\n", __VERSION__, BENCH_FLAGS);
    printf("peers     %s, %s as Debian built them; %s and every right-hand side with the flags above\n",
           gsl_version_text(), cvode_version_text(), odeint_version_text());
    printf("error     largest over outputs and states, relative to the largest value of that state\n");
    printf("ns        a forcing period, one thread, median of %d interleaved rounds, best setting of each "
           "solver\n",
           ROUNDS);
    printf(
        "plant     how many times the best peer takes the time of the whole plant; the ratios behind it are "
        "the method's\n\n");
    printf("%-8s %6s  %6s  %-7s %8s %8s  %10s %7s  %-14s %10s %7s %10s %7s  %10s %7s\n", "case", "error",
           "plant", "method", "ns", "plant ns", "best peer", "ratio", "", "CVODE", "ratio", "naive", "ratio",
           "batch", "best/it");
}

static FILE *open_csv(const char *dir, const char *name, const char *header)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", dir, name);
    FILE *f = fopen(path, "w");
    if (!f) {
        perror(path);
        exit(1);
    }
    fprintf(f, "%s\n", header);
    return f;
}

static bool wanted(const char *name, int argc, char **argv)
{
    for (int i = 2; i < argc; i++) {
        if (strcmp(argv[i], name) == 0)
            return true;
    }
    return argc <= 2;
}

static int errors_only(int argc, char **argv)
{
    FILE *f = open_csv(argv[1], "tolerance.csv", "case,solver,setting,tolerance,error");
    for (int i = 0; i < n_bench_cases; i++) {
        if (wanted(bench_cases[i].name, argc, argv))
            write_tolerances(&bench_cases[i], f);
    }
    return fclose(f) ? 1 : 0;
}

int main(int argc, char **argv)
{
    bool untimed = argc > 1 && strcmp(argv[1], "--errors") == 0;
    brief = argc > 1 && strcmp(argv[1], "--short") == 0;
    if (argc < 2 + untimed + brief) {
        fprintf(stderr, "usage: bench [--errors|--short] OUT_DIR [CASE...]\n");
        return 2;
    }
    argc -= brief;
    argv += brief;
    if (untimed)
        return errors_only(argc - 1, argv + 1);
    struct files f = {
        open_csv(argv[1], "peers.csv", "case,side,solver,setting,knob,error,ns_per_period,timed"),
        open_csv(argv[1], "front.csv", "case,side,solver,setting,knob,error,ns_per_period"),
        open_csv(argv[1], "ratios.csv",
                 "case,error,method,method_ns,plant_ns,best_peer,best_peer_ns,cvode_ns,naive_ns,ratio,cvode_"
                 "ratio,batch_ns,plant_ratio,plant")};
    print_machine();
    for (int i = 0; i < n_bench_cases; i++) {
        if (wanted(bench_cases[i].name, argc, argv))
            run_case(&bench_cases[i], &f);
    }
    return fclose(f.all) | fclose(f.front) | fclose(f.ratios) ? 1 : 0;
}
