/* stability_tell.c - see stability_tell.h. */
#include "host_sim/cli/unit.h"
#include "host_sim/maps/stability/stability_tell.h"

#include <math.h>

enum { TONGUES_TOLD = 8 };

int stability_floquet_kind(const double *c)
{
    bool plant = !(c[FLOQUET_PLANT] <= STABILITY_UNIT), method = !(c[FLOQUET_METHOD] <= STABILITY_UNIT);
    return plant ? !method : method ? 2 : STABILITY_NO_KIND;
}

int stability_energy_kind(const double *c)
{
    double ratio = c[CONTACT_ENERGY];
    if (ratio < 1.0 - STABILITY_ENERGY)
        return 0;
    return !isfinite(ratio) ? 3 : ratio > 2.0 ? 2 : ratio > 1.0 + STABILITY_ENERGY ? 1 : STABILITY_NO_KIND;
}

int stability_switches_kind(const double *c)
{
    double more = c[CONTACT_OF_METHOD] - c[CONTACT_SWITCHES];
    return more < 0.0 ? 0 : more > 0.0 ? 1 : STABILITY_NO_KIND;
}

static int count(const struct rows_table *t, int (*kind_of)(const double *), int kind)
{
    int n = 0;
    for (int i = 0; i < t->n; i++)
        n += kind_of(rows_row(t, i)) == kind;
    return n;
}

static void tell_count(FILE *f, const char *what, int n, int all)
{
    fprintf(f, "%s: %d of %d cells, %.3g %%\n", what, n, all, 100.0 * n / all);
}

static bool plant_is_unstable(const double *cell)
{
    int kind = stability_floquet_kind(cell);
    return kind == 0 || kind == 1;
}

/* The tongues of the plant where they are widest, in the last row. */
static void tell_tongues(const struct stability *s, const struct rows_table *t, FILE *f)
{
    char a[UNIT_TEXT], b[UNIT_TEXT];
    int told = 0, first = t->n - s->x.values.n;
    for (int i = first; i < t->n; i++) {
        const double *cell = rows_row(t, i), *before = i > first ? rows_row(t, i - 1) : NULL;
        int end = i;
        if (!plant_is_unstable(cell) || (before && plant_is_unstable(before)))
            continue;
        while (end + 1 < t->n && plant_is_unstable(rows_row(t, end + 1)))
            end++;
        if (told++ < TONGUES_TOLD)
            fprintf(f, "  tongue at the upper edge: %s from %s to %s\n", s->x.words,
                    maps_in_words(cell[1], s->x.unit, a),
                    maps_in_words(((const double *)rows_row(t, end))[1], s->x.unit, b));
    }
    if (told > TONGUES_TOLD)
        fprintf(f, "  and %d more\n", told - TONGUES_TOLD);
}

void stability_tell(void *context, const struct rows_table *t, FILE *f)
{
    const struct stability *s = context;
    char a[UNIT_TEXT], b[UNIT_TEXT];
    fprintf(f, "%s by %s\n", s->m.name, s->m.method->name);
    fprintf(f, "across: %s from %s to %s\n", s->x.words, maps_in_words(s->x.values.from, s->x.unit, a),
            maps_in_words(s->x.values.to, s->x.unit, b));
    fprintf(f, "upwards: %s from %s to %s\n", s->y.words, maps_in_words(s->y.values.from, s->y.unit, a),
            maps_in_words(s->y.values.to, s->y.unit, b));
    if (s->map == STABILITY_CONTACT) {
        tell_count(f, "energy lost, 5 % and more", count(t, stability_energy_kind, 0), t->n);
        tell_count(f, "energy made, 5 % and more",
                   count(t, stability_energy_kind, 1) + count(t, stability_energy_kind, 2), t->n);
        tell_count(f, "motion not finite", count(t, stability_energy_kind, 3), t->n);
        tell_count(f, "contact switches missed", count(t, stability_switches_kind, 0), t->n);
        tell_count(f, "contact switches that are none", count(t, stability_switches_kind, 1), t->n);
        return;
    }
    tell_count(f, "unstable in plant and method", count(t, stability_floquet_kind, 0), t->n);
    tell_count(f, "unstable in the plant only", count(t, stability_floquet_kind, 1), t->n);
    tell_count(f, "unstable in the method only", count(t, stability_floquet_kind, 2), t->n);
    tell_tongues(s, t, f);
}
