/* paper.c - see paper.h. */
#include "tests/paper.h"

#include <string.h>
#include "tests/test.h"

#define TWO_PI 6.283185307179586477

void paper_defaults(const struct model *m, double *paper)
{
    for (int i = 0; i < m->n_paper; i++)
        paper[i] = m->paper[i].initial;
}

int paper_index(const struct model *m, const char *name)
{
    for (int i = 0; i < m->n_paper; i++) {
        if (strcmp(name, m->paper[i].name) == 0)
            return i;
    }
    return -1;
}

void paper_prepare(const struct model *m, const double *paper, double *si, double *p, struct scale *scale)
{
    struct harmonic drive[MODEL_INPUTS];
    m->from_paper(paper, si, drive);
    m->prepare(si, p, scale);
}

void paper_start(struct plant *pl, const struct model *m, const double *paper, double h, const double *state)
{
    double si[MODEL_PARAMETERS], x[MODEL_STATES];
    struct harmonic drive[MODEL_INPUTS];
    m->from_paper(paper, si, drive);
    struct plant_config c = {.model = m, .si = si, .method = &rk4, .tick_s = h, .dilation = 1.0};
    const char *why = plant_init(pl, &c);
    if (why)
        check_string("plant_init", why, "no refusal");
    for (int i = 0; i < m->n_inputs; i++) {
        if (drive[i].amplitude != 0.0)
            plant_drive_start(pl, i, drive[i].amplitude, drive[i].omega / TWO_PI, drive[i].phase);
    }
    m->state_from_paper(pl->p, pl->excitation.at[2], state, x);
    plant_set_state(pl, x);
}

void paper_now(const struct plant *pl, double *state)
{
    pl->model->paper_state(pl->p, pl->excitation.at[2], pl->x, state);
}
