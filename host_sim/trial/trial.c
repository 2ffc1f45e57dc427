/* trial.c - see trial.h. */
#include "host_sim/trial/trial.h"
#include "firmware/afm/afm_plant.h"
#include "host_sim/scene/scene_app.h"

const struct model *trial_model(const struct trial *t)
{
    return t->is_microscope ? &afm_plant : t->scene.model;
}

const struct parameter *trial_parameter(const struct trial *t, int index)
{
    return scene_parameter(trial_model(t), index);
}
