/* rig.c - see rig.h. */
#include "tests/rig.h"

#include "models/hertz_rig.h"
#include "tests/paper.h"
#include "tests/test.h"

void rig_paper(double paper[PAPER])
{
    paper_defaults(&hertz_rig, paper);
}

void rig_start(struct plant *pl, const double paper[PAPER], double h, double q, double q_dot)
{
    paper_start(pl, &hertz_rig, paper, h, (double[]){q, q_dot});
}

double rig_q(const struct plant *pl)
{
    return 1.5 * pl->x[0] - 1.5;
}

double rig_q_dot(const struct plant *pl)
{
    return 1.5 * pl->x[1];
}

void rig_run(struct plant *pl, uint64_t ticks)
{
    if (!plant_run(pl, ticks))
        check_true("the plant stays finite", 0);
}
