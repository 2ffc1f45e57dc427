/* html_scene.c - see html_scene.h. */
#include "host_sim/report/html_scene.h"
#include "host_sim/scene/scene_print.h"

#include <stdlib.h>

void html_scene(struct html *h, const struct scene *s, const struct model *m, const double *si)
{
    char *text = NULL;
    size_t size = 0;
    html_table(h, "Parameters", "name,value,unit,meaning");
    for (int i = 0; i < m->n_parameters; i++) {
        html_row(h, false);
        html_cell(h, "%s", m->parameter[i].name);
        html_cell(h, "%.9g", si[i]);
        html_cell(h, "%s", m->parameter[i].unit);
        html_cell(h, "%s", m->parameter[i].meaning);
    }
    FILE *f = s ? open_memstream(&text, &size) : NULL;
    if (!f)
        return;
    scene_print(f, "the scene, as a file", s);
    if (!fclose(f))
        html_text(h, "Scene", text);
    free(text);
}
