/* choose_html.c - see choose_html.h: sentences of the certificate, all candidates, and errors over costs. */
#include "host_sim/choose/choose_html.h"
#include "host_sim/choose/choose_climb.h"
#include "host_sim/choose/choose_print.h"
#include "host_sim/report/html.h"
#include "host_sim/report/html_scene.h"

#include <math.h>
#include <stdlib.h>

enum { TITLE = 160 };

/* True for an attempt that was run: it has an error and a cost. */
static bool was_run(const struct choose_verdict *v, const struct choose_attempt *t)
{
    return !*v->refused && t->error >= 0.0 && isfinite(t->error);
}

static void put_sentences(struct html *h, const struct choose_certificate *c)
{
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    html_words(h, c->met && c->in_time ? "Tolerance and deadline are met."
                                       : "Nothing keeps both tolerance and deadline; the closest is shown.");
    if (!f)
        return;
    choose_print(f, c);
    if (!fclose(f))
        html_text(h, "Certificate", text);
    free(text);
}

static void put_number(struct html *h, bool known, int digits, double value)
{
    if (known)
        html_cell(h, "%.*g", digits, value);
    else
        html_cell(h, " ");
}

static void put_row(struct html *h, const struct choose_certificate *c, int i, int k)
{
    const struct choose_verdict *v = &c->verdict[i];
    const struct choose_attempt *t = &v->attempt[k];
    bool run = was_run(v, t), is_choice = i == c->choice && k == c->method;
    double time_s = run ? choose_time_s(t, k, c->machine) : 0.0;
    html_row(h, false);
    html_cell(h, "%s", v->candidate.name);
    html_cell(h, "%s", choose_method[k]->name);
    html_cell(h, "%s",
              is_choice ? c->met ? "chosen" : "closest"
              : t->met  ? "keeps the tolerance"
                        : "refused");
    put_number(h, run, 6, t->scene.substeps);
    put_number(h, run, 3, t->error);
    put_number(h, run, 9, run ? round(choose_frame_cost(t, c->machine)) : 0.0);
    put_number(h, time_s > 0.0, 4, 1e6 * time_s);
    html_cell(h, t->met ? "no longer step: %s" : "%s", t->why);
}

static void put_table(struct html *h, const struct choose_certificate *c)
{
    char columns[TITLE];
    snprintf(columns, sizeof columns,
             "model,method,verdict,steps a frame,error,instructions a frame,µs a frame on %s,why",
             choose_machine[c->machine].name);
    html_table(h, "Candidates", columns);
    for (int i = 0; i < c->n_candidates; i++) {
        const struct choose_verdict *v = &c->verdict[i];
        for (int k = 0; k < CHOOSE_METHODS && !*v->refused; k++)
            if (choose_takes(v->candidate.scene.model, k))
                put_row(h, c, i, k);
        if (!*v->refused)
            continue;
        html_row(h, false);
        html_cell(h, "%s", v->candidate.name);
        html_cell(h, "any");
        html_cell(h, "refused");
        for (int k = 0; k < 4; k++)
            html_cell(h, " ");
        html_cell(h, "%s", v->refused);
    }
}

/* Each model's attempts as dots, the tolerance as a line from the least cost to the greatest. */
static void put_chart(struct html *h, const struct choose_certificate *c)
{
    double cost[CHOOSE_METHODS], error[CHOOSE_METHODS], ends[2] = {(double)INFINITY, 0.0};
    const double asked[2] = {c->scene.tolerance, c->scene.tolerance};
    html_chart_log(h, "error", "1", "instructions a frame", "");
    for (int i = 0; i < c->n_candidates; i++) {
        const struct choose_verdict *v = &c->verdict[i];
        size_t n = 0;
        for (int k = 0; k < CHOOSE_METHODS; k++) {
            if (!was_run(v, &v->attempt[k]))
                continue;
            cost[n] = choose_frame_cost(&v->attempt[k], c->machine);
            error[n] = v->attempt[k].error;
            ends[0] = fmin(ends[0], cost[n]);
            ends[1] = fmax(ends[1], cost[n++]);
        }
        if (n)
            html_line(h, HTML_POINTS, v->candidate.name, n, cost, error);
    }
    ends[0] /= 1.2; /* a line also where there is one cost */
    ends[1] *= 1.2;
    if (ends[1] > 0.0)
        html_line(h, HTML_LINE, "tolerance", 2, ends, asked);
    if (c->choice >= 0)
        html_marker(h, choose_frame_cost(&c->verdict[c->choice].attempt[c->method], c->machine), "%s",
                    c->met ? "chosen" : "closest");
}

const char *choose_html(const struct choose_certificate *c, const char *path, int argc, char **argv)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    struct html h;
    const char *why = html_begin(&h, path, "choose", c->title, argc, argv);
    if (why)
        return why;
    put_sentences(&h, c);
    put_table(&h, c);
    put_chart(&h, c);
    scenes_resolve(&c->scene, si, drive);
    html_scene(&h, &c->scene, c->scene.model, si);
    return html_end(&h);
}
