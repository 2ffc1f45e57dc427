/* scene_print.c - see scene_print.h. */
#include "host_sim/scene/scene_print.h"

#include <math.h>
#include "firmware/bus/settings.h"
#include "host_sim/scene/scene_keys.h"
#include "host_sim/cli/unit.h"

enum { COLUMN = 42 /* where comments begin */ };

static void print_key(FILE *out, const struct scene *s, const struct scene_key *k)
{
    char text[UNIT_TEXT];
    const char *value = text;
    if (k->kind == KEY_MODEL)
        value = s->model->name;
    else if (k->kind == KEY_METHOD)
        value = s->method;
    else if (k->kind == KEY_OBSERVABLE)
        value = s->model->output_signal[s->observable].name;
    else if (k->kind == KEY_WATCHED)
        value = model_observable(s->model, s->watch.observable)->name;
    else if (k->kind == KEY_PROMOTE)
        value = s->watch.promote->name;
    else
        unit_write(scene_keys_value(s, k), k->unit, text);
    int n = fprintf(out, "%s = %s", k->name, value);
    fprintf(out, "%*s# %s", n < COLUMN ? COLUMN - n : 1, "", k->meaning);
    if (k->max > k->min)
        fprintf(out, ", %g to %g%s%s", k->min, k->max, *k->unit ? " " : "", k->unit);
    fputc('\n', out);
}

/* True for keys that a watch may leave out. */
static bool absent(const struct scene *s, const struct scene_key *k)
{
    if (k->kind == KEY_PROMOTE)
        return !s->watch.promote;
    return k->kind == KEY_NUMBER && fabs(scene_keys_value(s, k)) >= SCENE_UNBOUNDED;
}

/* The sections that only some scenes have. */
static bool has_section(const struct scene *s, int section)
{
    return section == SECTION_PAPER   ? s->paper
           : section == SECTION_START ? s->started
           : section == SECTION_WATCH ? s->watch.on
                                      : true;
}

static void print_keys(FILE *out, const struct scene *s, enum scene_section section, int input)
{
    struct scene_key k;
    for (int i = 0; scene_keys_get(s, section, input, i, &k); i++)
        if (!absent(s, &k))
            print_key(out, s, &k);
}

/* Something is asked of this input. */
static bool sounds(const struct scene *s, int input)
{
    struct scene_key k;
    for (int i = 0; scene_keys_get(s, SECTION_DRIVE, input, i, &k); i++) {
        double value = scene_keys_value(s, &k);
        if (value < 0.0 || value > 0.0)
            return true;
    }
    return false;
}

static void print_drives(FILE *out, const struct scene *s)
{
    const struct model *m = s->model;
    for (int i = 0; i < m->n_inputs; i++) {
        if (sounds(s, i)) {
            fprintf(out, "\n[drive %s]\n", m->input_signal[i].name);
            print_keys(out, s, SECTION_DRIVE, i);
        } else if (!s->paper) {
            fprintf(out, "\n# [drive %s], %s: silent\n", m->input_signal[i].name, m->input_signal[i].unit);
        }
    }
}

/* In the order of their numbers, so that stage_0 stays stage_0. */
static void print_stages(FILE *out, const struct scene *s)
{
    for (int i = 0; i < SCENE_STAGES; i++) {
        int signal = (int)s->stage[i][STAGE_AT] - 1;
        if (signal < 0)
            continue;
        const struct signal *of = signal < MODEL_INPUTS ? &s->model->input_signal[signal]
                                                        : &s->model->output_signal[signal - MODEL_INPUTS];
        fprintf(out, "\n[stage %s]\n", of->name);
        print_keys(out, s, SECTION_STAGE, signal);
    }
}

void scene_print(FILE *out, const char *title, const struct scene *s)
{
    fprintf(out, "# %s\n", title);
    for (int section = 0; section < SECTIONS; section++) {
        if (section == SECTION_DRIVE) {
            print_drives(out, s);
        } else if (section == SECTION_STAGE) {
            print_stages(out, s);
        } else if (has_section(s, section)) {
            fprintf(out, "\n[%s]\n", scene_section_name[section]);
            print_keys(out, s, (enum scene_section)section, 0);
        }
    }
}
