/* choose_grid.c - is what contactplant choose takes the cheapest? Over N random scenes every model, method,
 * number of substeps and series tolerance that costs less than the choice is run against the judge of
 * tests/choose/choose_judge.h. choose_grid N SEED force|motion.
 *
 * Counts what keeps the tolerance with choose's room (CHOOSE_ROOM) and its energy balance, and the bus would
 * take. Prints what was missed and by how much it is cheaper; ends with `N passed, N failed`. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/bus/settings.h"
#include "host_sim/choose/choose_climb.h"
#include "host_sim/choose/choose_ladder.h"
#include "host_sim/choose/choose_run.h"
#include "host_sim/choose/choose_search.h"
#include "host_sim/choose/choose_steps.h"
#include "host_sim/choose/choose_truth.h"
#include "tests/choose/choose_draw.h"
#include "tests/choose/choose_judge.h"

enum { SUBSTEPS = 512 };

/* The cheapest that was found in a scene. */
struct cheapest {
    struct scene scene;
    double cost, error;
    int runs;
};

static struct {
    int scenes, runs, missed;
    double worst, sum; /* the choice's cost over the cheapest one's: the worst, and the sum of logarithms */
} count;

static bool affordable(struct search *o, struct choose_attempt *t, int method, double most)
{
    t->series = (struct choose_series){.time = 0.0};
    choose_price(o, t, method);
    return choose_frame_cost(t, 0) < most;
}

/* One combination; when it is good, the most that others may cost. */
static void one(struct search *o, const struct choose_values *truth, struct choose_attempt *t, int method,
                struct cheapest *best)
{
    struct choose_record r;
    char why[SCENE_CHECK_REASON];
    const struct choose_certificate *c = o->c;
    if (!affordable(o, t, method, best->cost) || scene_check(&t->scene, why))
        return;
    best->runs++;
    if (choose_run(&t->scene, NULL, 0.0, &r)) {
        choose_record_free(&r);
        return;
    }
    t->series = r.series;
    choose_price(o, t, method);
    double cost = choose_frame_cost(t, 0);
    bool good = !r.trouble && r.imbalance <= setting_table[SET_LEDGER_ALARM].initial && cost < best->cost &&
                choose_meets(o, choose_error(o, &r));
    choose_record_free(&r);
    if (!good)
        return;
    double error = choose_judge_error(c, &t->scene, truth);
    if (error * CHOOSE_ROOM <= c->scene.tolerance) {
        best->cost = cost;
        best->scene = t->scene;
        best->error = error;
    }
}

static void candidate(struct search *o, const struct choose_values *truth, const struct choose_candidate *k,
                      struct cheapest *best)
{
    for (int method = 0; method < CHOOSE_METHODS && !k->refused; method++) {
        bool series = choose_method[method] == &taylor;
        for (double tol = series ? 1e-2 : 1.0; tol >= (series ? 1e-9 : 1.0); tol *= 0.5623413251903491) {
            struct choose_attempt t = {.scene = k->scene};
            t.scene.method = choose_method[method]->name;
            t.scene.tolerance = series ? tol : k->scene.tolerance;
            for (int n = 1; n <= SUBSTEPS; n++) {
                t.scene.substeps = n;
                one(o, truth, &t, method, best);
            }
        }
    }
}

static void look(const char *name, const struct scene *s)
{
    static struct choose_certificate c;
    struct choose_candidate candidates[CHOOSE_CANDIDATES];
    bool escaped;
    memset(&c, 0, sizeof c);
    c.title = name;
    c.scene = *s;
    if (choose_search(&c, NULL, &escaped) || !c.met || c.statistics)
        return;
    struct search o = {.c = &c};
    struct scene full = c.scene;
    char why[SCENE_CHECK_REASON];
    if (!choose_tighten(&full, CHOOSE_TIGHT, 1.0, why) || choose_run(&full, NULL, 0.0, &o.truth))
        return;
    const struct choose_attempt *chosen = &c.verdict[c.choice].attempt[c.method];
    double cost = choose_frame_cost(chosen, 0);
    struct cheapest best = {.cost = cost};
    struct choose_values truth = choose_judge(&c.scene, false);
    int n = choose_ladder(&c.scene, candidates);
    for (int i = 0; i < n; i++)
        candidate(&o, &truth, &candidates[i], &best);
    count.scenes++;
    count.runs += best.runs;
    count.missed += best.cost < cost;
    count.worst = fmax(count.worst, cost / best.cost);
    count.sum += log(cost / best.cost);
    printf("      %s: %s %s %u (%.2g), %.0f a frame; %d cheaper ones run", name, chosen->scene.model->name,
           chosen->scene.method, chosen->scene.substeps, c.scene.tolerance, cost, best.runs);
    if (best.scene.model)
        printf("; MISSED %s %s %u (%.2g), error %.2g, %.2f times", best.scene.model->name, best.scene.method,
               best.scene.substeps, best.scene.tolerance, best.error, cost / best.cost);
    printf("\n");
    fflush(stdout);
    free(truth.value);
    choose_record_free(&o.truth);
}

int main(int argc, char **argv)
{
    char name[40];
    struct scene s;
    if (argc < 4 || (strcmp(argv[3], "force") && strcmp(argv[3], "motion"))) {
        fprintf(stderr, "usage: choose_grid N SEED force|motion\n");
        return 2;
    }
    choose_draw_seed(strtoull(argv[2], NULL, 10));
    for (int i = 0; i < atoi(argv[1]); i++) {
        snprintf(name, sizeof name, "random-%d", i);
        choose_draw(strcmp(argv[3], "force") ? DRAW_BY_MOTION : DRAW_BY_FORCE, &s);
        look(name, &s);
    }
    double mean = count.scenes > 0 ? exp(count.sum / count.scenes) : 0.0;
    bool good = count.scenes > 0 && mean <= 1.05 && count.worst <= 1.5;
    printf("      %d certificates, %d cheaper combinations run, %d missed, worst %.3g times, mean %.4g\n",
           count.scenes, count.runs, count.missed, count.worst, mean);
    printf("%s  the choice costs at most 1.05 of the cheapest in the mean, and 1.5 at worst\n",
           good ? "ok  " : "FAIL");
    printf("%d passed, %d failed\n", good, !good);
    return !good;
}
