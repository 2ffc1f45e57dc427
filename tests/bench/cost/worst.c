/* worst.c - counts the work in the worst tick of the motions of tests/bench/cost/worst_cases.h.
 *
 * It counts the pieces that switches cut the tick into, switches, and series (taylor) or sums of curves
 * and series (exact) that are begun. It is linked with --wrap, so that the product carries no counter for
 * it. No motion may come near a bound: PLANT_PIECES pieces, and the 32 series of a call of taylor. */
#include <stdio.h>
#include "firmware/method/exact/exact_series.h"
#include "firmware/method/taylor/taylor_load.h"
#include "firmware/method/taylor/taylor_piece.h"
#include "tests/bench/cost/worst_cases.h"

enum { SERIES_MAX = 32 };

static struct rate_run run;
static unsigned series;

bool __real_taylor_begin(struct taylor *t, const struct taylor_load *load, double left, bool changed);
bool __wrap_taylor_begin(struct taylor *t, const struct taylor_load *load, double left, bool changed);
void __real_exact_follow(struct exact *w, const struct exact_regime *r, const struct model *m,
                         const struct segment *e, const double *x, struct exact_path *path);
void __wrap_exact_follow(struct exact *w, const struct exact_regime *r, const struct model *m,
                         const struct segment *e, const double *x, struct exact_path *path);

bool __wrap_taylor_begin(struct taylor *t, const struct taylor_load *load, double left, bool changed)
{
    series++;
    return __real_taylor_begin(t, load, left, changed);
}

void __wrap_exact_follow(struct exact *w, const struct exact_regime *r, const struct model *m,
                         const struct segment *e, const double *x, struct exact_path *path)
{
    series++;
    __real_exact_follow(w, r, m, e, x, path);
}

/* True when the motion stays within half of every bound. */
static bool worst(const struct worst_case *w)
{
    unsigned switches_max = 0, series_max = 0;
    const struct plant_counts *n = &run.plant.counts;
    const char *why = rate_start(&run, &w->motion, &w->setting, false);
    if (why) {
        printf("FAIL  %s: %s\n", w->motion.name, why);
        return false;
    }
    for (int i = 0; i < WORST_PERIODS * w->setting.steps; i++) {
        unsigned switches = n->switches;
        series = 0;
        if (!rate_advance(&run, &w->motion, 1))
            break;
        switches_max = n->switches - switches > switches_max ? n->switches - switches : switches_max;
        series_max = series > series_max ? series : series_max;
    }
    bool good = n->switches > 0 && 2 * n->pieces_max <= PLANT_PIECES && 2 * series_max <= SERIES_MAX &&
                n->budget + n->work + n->residual + n->not_finite == 0;
    printf("%s  worst tick of %s: %u pieces of %d, %u switches, %u series; %u switches in all\n",
           good ? "ok  " : "FAIL", w->motion.name, n->pieces_max, PLANT_PIECES, switches_max, series_max,
           n->switches);
    return good;
}

int main(void)
{
    int passed = 0;
    for (int i = 0; i < WORST_CASES; i++)
        passed += worst(&worst_case[i]);
    printf("%d passed, %d failed\n", passed, WORST_CASES - passed);
    return passed != WORST_CASES;
}
