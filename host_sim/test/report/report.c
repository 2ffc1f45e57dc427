/* report.c - see report.h. */
#include "host_sim/test/report/report.h"
#include "host_sim/cli/files.h"

#include <math.h>
#include <unistd.h>
#include "host_sim/cli/shell.h"
#include "host_sim/maps/share.h"
#include "host_sim/out/json.h"
#include "host_sim/out/xml.h"
#include "host_sim/test/record.h"
#include "host_sim/version.h"

enum { HOST_NAME = 256 };

const char *const report_verdict[] = {"ok", "untested", "FAIL", "error"};

/* ---- for people ---- */

/* Which of several runs. */
static void print_which(FILE *out, const struct report_case *r)
{
    const struct bench_result *w = r->worst;
    if (r->n_runs == 1)
        return;
    fprintf(out, "      %d of %d runs; %s", r->n_bad, r->n_runs,
            w->verdict == VERDICT_OK ? "the first" : "this one");
    if (r->c->names_seed)
        fprintf(out, " seed %u", w->seed);
    if (w->varied)
        fprintf(out, " at %.6g", w->varied_value);
    fprintf(out, "\n");
}

/* A command for a shell, which runs the case alone and records it. */
static void print_again(FILE *out, const struct report_case *r, const char *options)
{
    const struct quotes bare = {0, false};
    char folder[TEST_RECORD];
    fprintf(out, "      again: contactplant test %s", *r->test->file == '-' ? "./" : ""); /* no option */
    shell_put(out, bare, r->test->file);
    fputs(*r->c->name == '-' ? " --case=" : " --case ", out);
    shell_put(out, bare, r->c->name);
    if (r->c->names_seed)
        fprintf(out, " --seed %u", r->worst->seed);
    fprintf(out, "%s --log %s\n", options, record_safe_folder(r->test, folder));
}

void report_print(FILE *out, const struct report_case *r, const char *options)
{
    const struct bench_result *w = r->worst;
    fprintf(out, "%-8s  %-24s %8.6g s of plant in %.2f s", report_verdict[w->verdict], r->c->name, r->plant_s,
            r->took_s);
    if (w->hash)
        fprintf(out, "   hash %016llx", (unsigned long long)w->hash);
    fprintf(out, "\n");
    if (w->verdict == VERDICT_OK)
        return;
    print_which(out, r);
    if (*w->error)
        fprintf(out, "      %s:%d: %s\n", r->test->file, r->c->line, w->error);
    for (int i = 0; i < w->n; i++) {
        const struct outcome *o = &w->outcome[i];
        if (o->verdict != VERDICT_OK)
            fprintf(out, "      %s:%d: expect %s: %s\n", r->test->file, o->line ? o->line : r->c->line,
                    o->text, o->found);
    }
    print_again(out, r, options);
}

/* ---- for programs ---- */

static void junit_property(FILE *f, const char *name, const char *value)
{
    xml_put(f, "\n     <property name='%r' value='%s'/>", name, value);
}

/* For tools that trace requirements, and for people who repeat a run. */
static void junit_properties(FILE *f, const struct report_case *r)
{
    const struct bench_result *w = r->worst;
    char number[24];
    xml_put(f, "\n    <properties>");
    for (int i = 0; i < r->c->n_requirements; i++)
        junit_property(f, "requirement", r->c->requirement[i]);
    junit_property(f, "scene", r->test->scene_name);
    junit_property(f, "version", VERSION_TEXT);
    snprintf(number, sizeof number, "%u", (unsigned)w->seed);
    junit_property(f, "seed", number);
    snprintf(number, sizeof number, "%016llx", (unsigned long long)w->hash);
    if (w->hash)
        junit_property(f, "hash", number);
    if (*w->log)
        junit_property(f, "log", w->log);
    xml_put(f, "</properties>");
}

static void junit_case(FILE *f, const struct report_case *r)
{
    const struct bench_result *w = r->worst;
    xml_put(f, "  <testcase classname='%s' name='%s' file='%s' line='%i' time='%t'>", r->test->file,
            r->c->name, r->test->file, r->c->line, r->took_s);
    junit_properties(f, r);
    if (*w->error)
        xml_put(f, "\n    <%r message='%s'/>", w->verdict == VERDICT_ERROR ? "error" : "failure", w->error);
    for (int i = 0; i < w->n; i++) {
        const struct outcome *o = &w->outcome[i];
        if (o->verdict != VERDICT_OK)
            xml_put(f, "\n    <%r type='%s' message='%s:%i: expect %s: %s'/>",
                    o->verdict == VERDICT_ERROR ? "error" : "failure", report_verdict[o->verdict],
                    r->test->file, o->line ? o->line : r->c->line, o->text, o->found);
    }
    xml_put(f, "</testcase>\n");
}

/* Attributes of n cases together, and the end of the tag. */
static void junit_counts(FILE *f, const struct report_case *r, int n)
{
    int failures = 0, errors = 0;
    double took_s = 0.0;
    for (int i = 0; i < n; i++) {
        errors += r[i].worst->verdict == VERDICT_ERROR;
        failures += r[i].worst->verdict == VERDICT_FAIL || r[i].worst->verdict == VERDICT_UNTESTED;
        took_s += r[i].took_s;
    }
    xml_put(f, " tests='%i' failures='%i' errors='%i' time='%t'>\n", n, failures, errors, took_s);
}

/* The n cases of a test file. */
static void junit_suite(FILE *f, const struct report_case *r, int n)
{
    char host[HOST_NAME] = "", began[sizeof "2000-01-01T00:00:00"] = "";
    struct tm utc;
    (void)gethostname(host, sizeof host - 1);
    if (gmtime_r(&r->began, &utc))
        (void)strftime(began, sizeof began, "%Y-%m-%dT%H:%M:%S", &utc);
    xml_put(f, " <testsuite name='%s' file='%s' timestamp='%s' hostname='%s'", r->test->file, r->test->file,
            began, host);
    junit_counts(f, r, n);
    for (int i = 0; i < n; i++)
        junit_case(f, &r[i]);
    xml_put(f, " </testsuite>\n");
}

bool report_junit(const char *path, const struct report *r)
{
    char end[SHARE_END];
    FILE *f = files_compose(path);
    if (!f)
        return false;
    xml_put(f, XML_HEAD);
    if (*r->share)
        xml_put(f, XML_MARK, r->share);
    xml_put(f, "<testsuites name='contactplant'");
    junit_counts(f, r->of, r->n);
    for (int i = 0, k; i < r->n; i = k) {
        for (k = i + 1; k < r->n && r->of[k].test == r->of[i].test;)
            k++;
        junit_suite(f, &r->of[i], k - i);
    }
    xml_put(f, "</testsuites>\n");
    share_end(r->n, "cases", end);
    if (r->whole)
        xml_put(f, XML_MARK, end);
    return files_finish(f, true);
}

static void json_outcome(struct json *j, const struct outcome *o)
{
    double unknown = (double)NAN;
    json_item(j, "\n    {'verdict': %s, 'line': %i, 'metric': %s, 'expect': %s, 'found': %s, 'value': ",
              report_verdict[o->verdict], o->line, o->kind < METRICS ? metric_table[o->kind].name : "golden",
              o->text, o->found);
    if (o->kind == METRIC_HASH)
        json_put(j, "%h", o->value.hash);
    else
        json_put(j, "%e", o->value.known ? o->value.value : unknown);
    json_put(j, ", 'unit': %s, 'at_s': %e}", o->unit, o->value.known ? o->value.when_s : unknown);
}

static void json_case(struct json *j, const struct report_case *r)
{
    const struct bench_result *w = r->worst;
    json_item(j, "\n  {'file': %s, 'case': %s, 'line': %i, 'verdict': %s, 'runs': %i, 'bad_runs': %i",
              r->test->file, r->c->name, r->c->line, report_verdict[w->verdict], r->n_runs, r->n_bad);
    json_put(j, ", 'seed': %u, 'varied': %e, 'plant_s': %e, 'hash': %h, 'error': %s, 'log': %s",
             (uint64_t)w->seed, w->varied ? w->varied_value : (double)NAN, r->plant_s, w->hash, w->error,
             w->log);
    json_put(j, ", 'scene': %s, 'requirements': [", r->test->scene_name);
    for (int i = 0; i < r->c->n_requirements; i++)
        json_item(j, "%s", r->c->requirement[i]);
    json_put(j, "], 'expects': [");
    for (int i = 0; i < w->n; i++)
        json_outcome(j, &w->outcome[i]);
    json_put(j, "]}");
}

bool report_json(const char *path, const struct report *r)
{
    char end[SHARE_END];
    struct json j;
    FILE *f = files_compose(path);
    if (!f)
        return false;
    json_begin_file(&j, f);
    json_put(&j, "{");
    if (*r->share)
        json_put(&j, "'share': %s, ", r->share);
    json_put(&j, "'cases': [");
    for (int i = 0; i < r->n; i++)
        json_case(&j, &r->of[i]);
    json_put(&j, "\n], 'untraced': [");
    for (int i = 0; i < r->untraced->n; i++)
        json_item(&j, "%s", r->untraced->entry[i].id);
    share_end(r->n, "cases", end);
    json_put(&j, r->whole ? "], 'complete': %s}\n" : "]}\n", end);
    return files_finish(f, true);
}
