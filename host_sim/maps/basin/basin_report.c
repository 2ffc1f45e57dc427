/* basin_report.c - the rows of a basin map as a table of attractors. */
#include "host_sim/maps/basin/basin.h"
#include "host_sim/commands.h"
#include "host_sim/maps/jobs.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { LINE = 4096 };

struct report {
    const struct basin *b;
    const char *path;
    struct basin_clusters clusters;
    struct basin_point *point;
    int n, room;
    unsigned run;
    struct jobs_chain chain;
};

static int refuse(const struct report *r, const char *reason)
{
    return options_misuse(r->b->o->usage, "%s:%d: %s", r->path, r->n + 2, reason);
}

static int take_row(struct report *r, char *line)
{
    bool fits = jobs_row_fits(&r->chain, line);
    struct basin_motion m = {.outcome = BASIN_SETTLED};
    struct basin_point p = {{0.0}, -1};
    unsigned run;
    int start;
    if (!basin_rows_read(r->b, line, &run, &start, p.x, &m))
        return refuse(r, "no row of a basin map of this scene; give its whole file, and the scene it is of");
    if (r->n > 0 && run != r->run)
        return refuse(r, "a row of another map; join shards of one command only");
    if (start != r->n)
        return refuse(r, "not the next start; join all shards in their order");
    if (!fits)
        return refuse(r,
                      "changed since it was written; give the command that wrote the rows its --out again, "
                      "without this line and what follows");
    r->run = run;
    p.attractor = basin_clusters_add(&r->clusters, &m);
    if (p.attractor == -2)
        return refuse(r, "more than 1024 attractors: these motions have not settled; give more --periods");
    if (r->n == r->room) {
        r->room = r->room ? 2 * r->room : 1024;
        struct basin_point *more = realloc(r->point, (size_t)r->room * sizeof *more);
        if (!more)
            return options_failure(r->b->o->usage, "no memory");
        r->point = more;
    }
    r->point[r->n++] = p;
    return 0;
}

static int take_rows(struct report *r, FILE *f)
{
    char line[LINE], header[LINE];
    int status = 0;
    snprintf(header, sizeof header, "run,job,%s,check\n", r->b->columns);
    if (!fgets(line, sizeof line, f) || strcmp(line, header))
        return options_misuse(
            r->b->o->usage,
            "%s:1: not the header of a basin map of %s; give its whole file, and the scene it is of", r->path,
            r->b->plant.model->name);
    while (!status && fgets(line, sizeof line, f))
        status = take_row(r, line);
    if (!status && r->n == 0)
        status = refuse(r, "no rows");
    return status;
}

static void print_images(const struct model *m, const struct basin_attractor *a, int i)
{
    static const char *const name[IMAGES] = {"", "mirrored", "ends exchanged", "both"};
    const char *between = "  ";
    for (int k = IMAGE_MIRROR; k < (m->n_states > 2 ? IMAGES : IMAGE_ENDS); k++) {
        if (a->image[k] == i)
            continue;
        if (a->image[k] < 0)
            printf("%s%s: not seen", between, name[k]);
        else
            printf("%s%s: %d", between, name[k], a->image[k] + 1);
        between = ", ";
    }
    puts(between[0] == ',' ? "" : "  symmetric");
}

static void print_share(const char *name, int count, int total)
{
    double low, high;
    basin_clusters_wilson(count, total, &low, &high);
    printf("%-9s %7d %8.3f %% %8.3f .. %-7.3f", name, count, 100.0 * count / total, 100.0 * low,
           100.0 * high);
}

static void print_attractor(const struct report *r, int i)
{
    const struct basin_attractor *a = &r->clusters.attractor[i];
    char name[16], period[16];
    snprintf(name, sizeof name, "%d", i + 1);
    if (a->motion.period > 0)
        snprintf(period, sizeof period, "%d", a->motion.period);
    else
        snprintf(period, sizeof period, "%s",
                 basin_clusters_kind(&a->motion) == BASIN_CHAOTIC ? "chaos" : "none");
    print_share(name, a->count, r->clusters.total);
    printf(" %6s %8.4f %8.4f  %-12.6g", period, a->growth, a->motion.open,
           a->motion.peak * basin_rows_peak_unit(r->b));
    if (r->b->plant.model->n_contacts > 1) /* one contact has one side */
        print_images(r->b->plant.model, a, i);
    else
        putchar('\n');
}

static void print_table(const struct report *r)
{
    const struct basin_clusters *c = &r->clusters;
    const struct signal *s = &r->b->plant.model->output_signal[r->b->plant.observable];
    printf("%d starts, %d attractors; period: in forcing periods; growth: of a small distance in one, "
           "logarithm;\n"
           "open: share of time without contact; peak: of %s, %s\n"
           "attractor  starts    share    95 %% interval     period   growth     open  peak\n",
           c->total, c->n, s->name, scenes_dimensionless(&r->b->scene) ? "1" : s->unit);
    for (int i = 0; i < c->n; i++)
        print_attractor(r, i);
    if (c->escaped > 0) {
        print_share("escaped", c->escaped, c->total);
        putchar('\n');
    }
    if (c->trouble > 0) {
        print_share("trouble", c->trouble, c->total);
        putchar('\n');
    }
}

static int draw(struct report *r, const char *svg)
{
    FILE *f = fopen(svg, "w");
    if (!f)
        return options_failure(r->b->o->usage,
                               "--svg %s: %s; the rows are whole: give --report %s with another", svg,
                               strerror(errno), r->path);
    const char *why = basin_draw(r->b, &r->clusters, r->point, r->n, f);
    if (fclose(f) && !why)
        why = strerror(errno);
    return why ? options_failure(r->b->o->usage, "--svg %s: %s; make room and give --report %s", svg, why,
                                 r->path)
               : 0;
}

static int conclude(struct report *r, const char *svg)
{
    int *order = malloc(((size_t)r->clusters.n + 1) * sizeof *order);
    if (!order)
        return options_failure(r->b->o->usage, "no memory");
    basin_clusters_finish(&r->clusters, order);
    for (int i = 0; i < r->n; i++)
        r->point[i].attractor = r->point[i].attractor < 0 ? -1 : order[r->point[i].attractor];
    free(order);
    print_table(r);
    return svg ? draw(r, svg) : STATUS_DONE;
}

int basin_report(const struct basin *b, const char *path, const char *svg)
{
    static struct report r;
    r = (struct report){.b = b, .path = path, .chain = JOBS_CHAIN};
    FILE *f = fopen(path, "r");
    if (!f)
        return options_misuse(b->o->usage, "%s: %s; give the rows of a basin map", path, strerror(errno));
    basin_clusters_start(&r.clusters, b->plant.model);
    int status = take_rows(&r, f);
    fclose(f);
    status = status ? status : conclude(&r, svg);
    free(r.point);
    return status;
}
