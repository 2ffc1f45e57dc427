/* html_scene.h - the part of a report that says which plant it was. */
#ifndef HOST_SIM_HTML_SCENE_H
#define HOST_SIM_HTML_SCENE_H

#include "host_sim/report/html.h"
#include "models/scenes/scenes.h"

/* The parameters in force, SI, with their meaning; then the text of the scene, which may be NULL. */
void html_scene(struct html *h, const struct scene *s, const struct model *m, const double *si);

#endif
