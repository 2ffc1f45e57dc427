/* sweep_tell.c - see sweep_tell.h. */
#include "host_sim/maps/sweep/sweep_tell.h"
#include "host_sim/cli/unit.h"
#include "host_sim/maps/sweep/sweep_chain.h"

#include <math.h>

enum { JUMPS_TOLD = 12 };

bool sweep_is_jump(const struct sweep_result *row, int i)
{
    return row[i].kind == SWEEP_TO && i > 0 && row[i - 1].kind == SWEEP_FROM;
}

const char *sweep_chain_name(const struct sweep *s, int chain, char text[SWEEP_LABEL])
{
    const struct scene_range *f = &s->family;
    const char *way = chain % 2 ? "down" : "up";
    char value[UNIT_TEXT];
    if (!f->values.n)
        return way;
    maps_in_words(range_value(&f->values, chain / 2), f->unit, value);
    snprintf(text, SWEEP_LABEL, "%s %s, %s", f->words, value, way);
    return text;
}

void sweep_name_harmonic(const struct sweep *s, int i, char name[SWEEP_LABEL])
{
    const struct sweep_harmonic *h = &s->harmonic[i];
    snprintf(name, SWEEP_LABEL, h->m > 1 ? "amplitude of %s, harmonic %u/%u" : "amplitude of %s, harmonic %u",
             s->m.scene.model->output_signal[(int)s->m.scene.observable].name, (unsigned)h->n,
             (unsigned)h->m);
}

void sweep_say_settled(const struct sweep *s, char text[SWEEP_LABEL])
{
    if (s->settle < 0)
        snprintf(text, SWEEP_LABEL, "until the damping leaves 1e-4");
    else
        snprintf(text, SWEEP_LABEL, "over %d periods", s->settle);
}

int sweep_unsettled(const struct rows_table *t, const struct sweep_result *row)
{
    int n = 0;
    for (int i = 0; i < t->n; i++)
        n += row[i].kind == SWEEP_UNSETTLED;
    return n;
}

static void tell_jump(const struct sweep *s, const struct rows_table *t, const struct sweep_result *row,
                      int i, FILE *f)
{
    const char *unit = s->m.scene.model->output_signal[s->m.scene.observable].unit;
    char chain[SWEEP_LABEL], at[UNIT_TEXT], before[UNIT_TEXT], behind[UNIT_TEXT];
    unit = scenes_dimensionless(&s->m.scene) ? "" : unit;
    fprintf(f, "  %s at %s: amplitude from %s to %s\n", sweep_chain_name(s, sweep_chain_of(t, row, i), chain),
            maps_in_words(row[i].value, s->range.unit, at),
            maps_in_words(row[i - 1].measured.amplitude[0], unit, before),
            maps_in_words(row[i].measured.amplitude[0], unit, behind));
}

/* The row with the largest amplitude of the first harmonic, or -1. */
static int find_largest(const struct rows_table *t, const struct sweep_result *row)
{
    int largest = -1;
    for (int i = 0; i < t->n; i++) {
        double a = row[i].measured.amplitude[0];
        if (isfinite(a) && (largest < 0 || a > row[largest].measured.amplitude[0]))
            largest = i;
    }
    return largest;
}

void sweep_tell(void *context, const struct rows_table *t, FILE *f)
{
    const struct sweep *s = context;
    const struct sweep_result *row = rows_row(t, 0);
    const struct signal *y = &s->m.scene.model->output_signal[s->m.scene.observable];
    const char *unit = scenes_dimensionless(&s->m.scene) ? "" : y->unit;
    int jumps = 0, unsettled = sweep_unsettled(t, row), escaped = 0, largest = find_largest(t, row);
    char a[UNIT_TEXT], b[UNIT_TEXT], name[SWEEP_LABEL];
    sweep_name_harmonic(s, 0, name);
    for (int i = 0; i < t->n; i++) {
        jumps += sweep_is_jump(row, i);
        escaped += row[i].kind == SWEEP_ESCAPED;
    }
    fprintf(f, "%s, %s from %s to %s in %d points, up and down\n", s->m.name, s->range.words,
            maps_in_words(s->range.values.from, s->range.unit, a),
            maps_in_words(s->range.values.to, s->range.unit, b), s->range.values.n);
    if (largest >= 0)
        fprintf(f, "largest %s: %s at %s%s\n", name,
                maps_in_words(row[largest].measured.amplitude[0], unit, a),
                maps_in_words(row[largest].value, s->range.unit, b),
                row[largest].kind == SWEEP_UNSETTLED ? ", which did not settle" : "");
    if (jumps)
        fprintf(f, "%d %s located by bisection:\n", jumps, jumps == 1 ? "jump" : "jumps");
    else
        fputs(unsettled ? "no jump was found where points settled\n" : "no jump was found\n", f);
    for (int i = 0, n = 0; i < t->n && n < JUMPS_TOLD; i++)
        if (sweep_is_jump(row, i)) {
            tell_jump(s, t, row, i, f);
            n++;
        }
    if (jumps > JUMPS_TOLD)
        fprintf(f, "  and %d more, in the rows jump_from and jump_to\n", jumps - JUMPS_TOLD);
    if (unsettled)
        fprintf(f,
                "%d %s did not settle: give more --settle, or the motion is chaotic or beats; see "
                "contactplant basin and random\n",
                unsettled, unsettled == 1 ? "point" : "points");
    if (escaped)
        fprintf(f, "the motion escaped at %d points\n", escaped);
}
