/* trial.c - see trial.h. */
#include "host_sim/trial/trial.h"
#include "firmware/afm/afm_plant.h"

const struct model *trial_model(const struct trial *t)
{
    return t->lever.model ? &afm_plant : t->scene.model;
}
