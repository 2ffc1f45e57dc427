/* report.c - see report.h. */
#include "host_sim/trial/report.h"

#include <math.h>
#include <string.h>

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
    if (r->c->n_seeds > 1)
        fprintf(out, " seed %u", w->seed);
    if (w->varied)
        fprintf(out, " at %.6g", w->varied_value);
    fprintf(out, "\n");
}

void report_print(FILE *out, const struct report_case *r)
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
        fprintf(out, "      %s:%d: %s\n", r->trial->file, r->c->line, w->error);
    for (int i = 0; i < w->n; i++) {
        const struct outcome *o = &w->outcome[i];
        if (o->verdict != VERDICT_OK)
            fprintf(out, "      %s:%d: expect %s: %s\n", r->trial->file, o->line ? o->line : r->c->line,
                    o->text, o->found);
    }
    fprintf(out, "      again: contactplant test %s --case '%s'", r->trial->file, r->c->name);
    if (r->c->n_seeds > 1)
        fprintf(out, " --seed %u", w->seed);
    fprintf(out, " --log .\n");
}

/* ---- for programs ---- */

static void put_xml(FILE *f, const char *text)
{
    for (; *text; text++) {
        const char *as = *text == '&'   ? "&amp;"
                         : *text == '<' ? "&lt;"
                         : *text == '>' ? "&gt;"
                         : *text == '"' ? "&quot;"
                                        : NULL;
        if (as)
            fputs(as, f);
        else
            fputc(*text >= ' ' && *text <= '~' ? *text : ' ', f);
    }
}

static void put_json(FILE *f, const char *text)
{
    fputc('"', f);
    for (; *text; text++) {
        if (*text == '"' || *text == '\\')
            fputc('\\', f);
        fputc(*text >= ' ' && *text <= '~' ? *text : ' ', f);
    }
    fputc('"', f);
}

static void put_number(FILE *f, double x)
{
    if (isfinite(x))
        fprintf(f, "%.17g", x);
    else
        fputs("null", f);
}

static bool finish(FILE *f)
{
    bool good = !ferror(f);
    return fclose(f) == 0 && good;
}

static void junit_case(FILE *f, const struct report_case *r)
{
    const struct bench_result *w = r->worst;
    fputs("  <testcase classname=\"", f), put_xml(f, r->trial->file);
    fputs("\" name=\"", f), put_xml(f, r->c->name);
    fprintf(f, "\" time=\"%.3f\">", r->took_s);
    if (*w->error) {
        fprintf(f, "\n    <%s message=\"", w->verdict == VERDICT_ERROR ? "error" : "failure");
        put_xml(f, w->error);
        fputs("\"/>", f);
    }
    for (int i = 0; i < w->n; i++) {
        const struct outcome *o = &w->outcome[i];
        if (o->verdict == VERDICT_OK)
            continue;
        fprintf(f, "\n    <%s type=\"%s\" message=\"", o->verdict == VERDICT_ERROR ? "error" : "failure",
                report_verdict[o->verdict]);
        put_xml(f, r->trial->file), fprintf(f, ":%d: expect ", o->line ? o->line : r->c->line);
        put_xml(f, o->text), fputs(": ", f), put_xml(f, o->found);
        fputs("\"/>", f);
    }
    fputs("</testcase>\n", f);
}

bool report_junit(const char *path, const struct report_case *r, int n)
{
    FILE *f = fopen(path, "w");
    int failures = 0, errors = 0;
    double took_s = 0.0;
    if (!f)
        return false;
    for (int i = 0; i < n; i++) {
        errors += r[i].worst->verdict == VERDICT_ERROR;
        failures += r[i].worst->verdict == VERDICT_FAIL || r[i].worst->verdict == VERDICT_UNTESTED;
        took_s += r[i].took_s;
    }
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n", f);
    fprintf(f,
            "<testsuites>\n <testsuite name=\"contactplant\" tests=\"%d\" failures=\"%d\" errors=\"%d\" "
            "time=\"%.3f\">\n",
            n, failures, errors, took_s);
    for (int i = 0; i < n; i++)
        junit_case(f, &r[i]);
    fputs(" </testsuite>\n</testsuites>\n", f);
    return finish(f);
}

static void json_outcome(FILE *f, const struct outcome *o)
{
    fprintf(f, "{\"verdict\": \"%s\", \"line\": %d, \"metric\": ", report_verdict[o->verdict], o->line);
    put_json(f, o->kind < METRICS ? metric_table[o->kind].name : "golden");
    fputs(", \"expect\": ", f), put_json(f, o->text);
    fputs(", \"found\": ", f), put_json(f, o->found);
    fputs(", \"value\": ", f);
    if (o->kind == METRIC_HASH)
        fprintf(f, "\"%016llx\"", (unsigned long long)o->value.hash);
    else
        put_number(f, o->value.known ? o->value.value : (double)NAN);
    fputs(", \"at_s\": ", f), put_number(f, o->value.known ? o->value.when_s : (double)NAN);
    fputs("}", f);
}

static void json_case(FILE *f, const struct report_case *r)
{
    const struct bench_result *w = r->worst;
    fputs("  {\"file\": ", f), put_json(f, r->trial->file);
    fputs(", \"case\": ", f), put_json(f, r->c->name);
    fprintf(f,
            ", \"line\": %d, \"verdict\": \"%s\", \"runs\": %d, \"bad_runs\": %d, \"seed\": %u, \"varied\": ",
            r->c->line, report_verdict[w->verdict], r->n_runs, r->n_bad, w->seed);
    put_number(f, w->varied ? w->varied_value : (double)NAN);
    fputs(", \"plant_s\": ", f), put_number(f, r->plant_s);
    fprintf(f, ", \"hash\": \"%016llx\", \"error\": ", (unsigned long long)w->hash);
    put_json(f, w->error);
    fputs(", \"log\": ", f), put_json(f, w->log);
    fputs(", \"expects\": [", f);
    for (int i = 0; i < w->n; i++) {
        fputs(i ? ",\n    " : "\n    ", f);
        json_outcome(f, &w->outcome[i]);
    }
    fputs("]}", f);
}

bool report_json(const char *path, const struct report_case *r, int n)
{
    FILE *f = fopen(path, "w");
    if (!f)
        return false;
    fputs("{\"cases\": [\n", f);
    for (int i = 0; i < n; i++) {
        json_case(f, &r[i]);
        fputs(i + 1 < n ? ",\n" : "\n", f);
    }
    fputs("]}\n", f);
    return finish(f);
}
