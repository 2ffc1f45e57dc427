/* fitted.c - see fitted.h. */
#include "host_sim/fit/fitted.h"
#include "host_sim/fit/solve/unknown.h"

#include <math.h>
#include <string.h>
#include "host_sim/commands.h"
#include "host_sim/fit/tell.h"
#include "host_sim/cli/unit.h"
#include "host_sim/scene/scene_print.h"
#include "models/afm_lever.h"

enum { COMMENT = 200 /* bytes of a line */ };

static void put_interval(const struct fit_setup *s, const struct fit_result *r, int k, FILE *f)
{
    const struct fit_unknown *x = &s->unknown[k];
    double reach = judge_quantile(s, r, true) * r->sd[k];
    char low[UNIT_TEXT], high[UNIT_TEXT], value[UNIT_TEXT];
    tell_value(x, unknown_value(x, r->u[k]), r->sd[k], value);
    tell_value(x, unknown_value(x, r->u[k] - reach), r->sd[k], low);
    tell_value(x, unknown_value(x, r->u[k] + reach), r->sd[k], high);
    fprintf(f, strcmp(low, high) ? "# %s = %s, 95 %% from %s to %s\n" : "# %s = %s\n", x->name, value, low,
            high);
}

static void put_comments(const struct fit_setup *s, const struct fit_result *r, const struct judged *j,
                         FILE *f)
{
    for (int c = 0; c < s->data.n; c++)
        fprintf(f, "# data: %.100s, drive %.6g %s\n", s->data.curve[c].path, s->data.curve[c].amplitude,
                s->scene.model->input_signal[s->data.curve[c].input].unit);
    for (int i = 0; i < s->levers.n; i++)
        fprintf(f, "# data: %.100s, %d rows\n", s->levers.data[i].path, s->levers.data[i].n);
    for (int i = 0; i < s->records.n; i++)
        fprintf(f, "# data: %.100s, %d rows\n", s->records.record[i].path, s->records.record[i].n);
    fprintf(f, "# CRC-32 of the data files in the order of the command: %08x\n", s->crc);
    for (int k = 0; k < s->n; k++)
        if (!fit_is_hidden(&s->unknown[k]))
            put_interval(s, r, k, f);
    fprintf(f, "# chi^2 per number: %.3g\n", j->chi2_each);
    for (int i = 0; i < j->n; i++)
        fprintf(f, "# NOT TO BE BELIEVED: %.*s\n", COMMENT, j->reason[i]);
    fputc('\n', f);
}

int fitted_write(const struct fit_setup *s, const struct fit_result *r, const struct judged *j)
{
    struct scene scene = s->scene;
    char title[COMMENT];
    FILE *f = options_compose(&s->o, "out");
    if (!f)
        return STATUS_FAILED;
    for (int k = 0; k < s->n; k++)
        if (s->unknown[k].kind == FIT_PARAMETER)
            scene.value[s->unknown[k].index] = unknown_value(&s->unknown[k], r->u[k]);
    if (s->levers.n) /* a lever has no less adhesion on the way out */
        scene.value[LEVER_HAMAKER_OUT] = fmax(scene.value[LEVER_HAMAKER], scene.value[LEVER_HAMAKER_OUT]);
    put_comments(s, r, j, f);
    snprintf(title, sizeof title, "%.100s, fitted by contactplant fit", s->name);
    scene_print(f, title, &scene);
    return options_close(&s->o, "out", f, NULL);
}
