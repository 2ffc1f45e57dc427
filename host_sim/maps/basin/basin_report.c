/* basin_report.c - see basin_report.h. */
#include "host_sim/maps/basin/basin_report.h"
#include "host_sim/maps/basin/basin_figure.h"
#include "host_sim/maps/basin/basin_rows.h"

struct report {
    const struct basin *b;
    const char *path; /* the rows are there */
    struct basin_clusters clusters;
    struct basin_row *row;
    int n;
};

/* Sorts each start to its attractor; every start must be there once, and in order. */
static int sort_rows(struct report *r)
{
    const struct usage *u = r->b->m.o.usage;
    for (int i = 0; i < r->n; i++) {
        if (r->row[i].start != i)
            return options_misuse(u, "%s:%d: not the next start; join all shares by contactplant merge",
                                  r->path, i + 2);
        r->row[i].attractor = basin_clusters_add(&r->clusters, &r->row[i].motion);
        if (r->row[i].attractor == -2)
            return options_misuse(
                u, "%s:%d: more than 1024 attractors: these motions have not settled; give more --periods",
                r->path, i + 2);
    }
    return 0;
}

static void print_images(FILE *f, const struct model *m, const struct basin_attractor *a, int i)
{
    static const char *const name[IMAGES] = {"", "mirrored", "ends exchanged", "both"};
    const char *between = "  ";
    for (int k = IMAGE_MIRROR; k < (m->n_states > 2 ? IMAGES : IMAGE_ENDS); k++) {
        if (a->image[k] == i)
            continue;
        if (a->image[k] < 0)
            fprintf(f, "%s%s: not seen", between, name[k]);
        else
            fprintf(f, "%s%s: %d", between, name[k], a->image[k] + 1);
        between = ", ";
    }
    fputs(between[0] == ',' ? "\n" : "  symmetric\n", f);
}

static void print_share(FILE *f, const char *name, int count, int total)
{
    double low, high;
    basin_clusters_wilson(count, total, &low, &high);
    fprintf(f, "%-9s %7d %8.3f %% %8.3f .. %-7.3f", name, count, 100.0 * count / total, 100.0 * low,
            100.0 * high);
}

static void print_attractor(FILE *f, const struct report *r, int i)
{
    const struct basin_attractor *a = &r->clusters.attractor[i];
    char name[16], period[16];
    snprintf(name, sizeof name, "%d", i + 1);
    basin_period_text(&a->motion, period, sizeof period);
    print_share(f, name, a->count, r->clusters.total);
    fprintf(f, " %6s %8.4f %8.4f  %-12.6g", period, a->growth, a->motion.open,
            a->motion.peak * basin_peak_unit(r->b));
    if (r->b->plant.model->n_contacts > 1) /* one contact has one side */
        print_images(f, r->b->plant.model, a, i);
    else
        fputc('\n', f);
}

static void print_table(FILE *f, const struct report *r)
{
    const struct basin_clusters *c = &r->clusters;
    const struct signal *s = &r->b->plant.model->output_signal[r->b->plant.observable];
    fprintf(f,
            "%d starts, %d attractors; period: in forcing periods; growth: of a small distance in one, "
            "logarithm;\n"
            "open: share of time without contact; peak: of %s, %s\n"
            "attractor  starts    share    95 %% interval     period   growth     open  peak\n",
            c->total, c->n, s->name, scenes_dimensionless(&r->b->m.scene) ? "1" : s->unit);
    for (int i = 0; i < c->n; i++)
        print_attractor(f, r, i);
    if (c->escaped > 0) {
        print_share(f, "escaped", c->escaped, c->total);
        fputc('\n', f);
    }
    if (c->trouble > 0) {
        print_share(f, "trouble", c->trouble, c->total);
        fputc('\n', f);
    }
}

static void tell(void *context, const struct rows_table *t, FILE *f)
{
    (void)t;
    print_table(f, context);
}

static const char *draw(void *context, const struct rows_table *t, struct figure *g)
{
    const struct report *r = context;
    (void)t;
    return basin_draw(r->b, &r->clusters, r->row, r->n, g);
}

/* The attractors in the order of their frequency. */
static int sum_up(void *context, const struct rows_table *t)
{
    static int order[BASIN_ATTRACTORS];
    struct report *r = context;
    r->row = (struct basin_row *)(void *)t->row;
    r->n = t->n;
    int status = sort_rows(r);
    if (status)
        return status;
    basin_clusters_finish(&r->clusters, order);
    for (int i = 0; i < r->n; i++)
        r->row[i].attractor = r->row[i].attractor < 0 ? -1 : order[r->row[i].attractor];
    return 0;
}

int basin_report(const struct basin *b, const char *path)
{
    static const struct maps_finding found = {.read = sum_up, .tell = tell, .draw = draw, .is_table = true};
    static struct report r;
    const char *out = options_text(&b->m.o, "out", 0);
    r = (struct report){.b = b, .path = path ? path : out ? out : "standard output"};
    basin_clusters_start(&r.clusters, b->plant.model);
    return maps_conclude(&b->m, path, &found, &r);
}
