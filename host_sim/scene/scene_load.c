/* scene_load.c - see scene_load.h. */
#include "host_sim/scene/scene_load.h"
#include "host_sim/cli/files.h"
#include "host_sim/scene/scene_app.h"
#include "models/scenes/scenes_range.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

enum { PATH_SHOWN = 120 };

static enum scene_origin load_file(const char *path, struct scene *s, char *why, bool stepped)
{
    static char text[SCENE_FILE_BYTES + 1]; /* one more tells a larger file */
    char written[FILES_REASON];
    if (!files_reads(path, "the scene itself", written)) {
        snprintf(why, SCENE_REASON, "%s", written);
        return SCENE_OF_NOTHING;
    }
    errno = 0;
    FILE *f = fopen(path, "rb");
    size_t n = f ? fread(text, 1, sizeof text, f) : 0;
    bool bad = !f || ferror(f);
    int error = errno;
    if (f)
        (void)fclose(f);
    if (bad && error == ENOENT)
        scene_name_refuse("model, preset or file", path, why);
    else if (bad)
        snprintf(why, SCENE_REASON, "cannot read %.*s: %s", PATH_SHOWN, path, strerror(error));
    bool good = !bad && (stepped ? scene_file_parse : scene_file_parse_unstepped)(path, text, n, s, why);
    return good ? SCENE_OF_FILE : SCENE_OF_NOTHING;
}

enum scene_origin scene_load(const char *name, struct scene *s, char *why)
{
    enum scene_origin origin = scene_name_find(name, s);
    return origin == SCENE_OF_NOTHING ? load_file(name, s, why, true) : origin;
}

enum scene_origin scene_load_unstepped(const char *name, struct scene *s, char *why)
{
    enum scene_origin origin = scene_name_find(name, s);
    return origin == SCENE_OF_NOTHING ? load_file(name, s, why, false) : origin;
}

enum scene_origin scene_load_cold(const char *name, struct scene *s, char *why)
{
    struct scene found;
    enum scene_origin origin = scene_load(name, &found, why);
    const char *refused = origin == SCENE_OF_NOTHING ? NULL : scene_refuses_stages(&found);
    if (refused)
        snprintf(why, SCENE_REASON, "%.200s: %s", name, refused);
    if (refused || origin == SCENE_OF_NOTHING)
        return SCENE_OF_NOTHING;
    *s = found;
    if (s->paper)
        return origin;
    for (int i = 0; i < s->model->n_parameters; i++)
        if (!strcmp(s->model->parameter[i].name, "temperature_K"))
            s->value[i] = 0.0;
    return origin;
}

bool scene_load_warns(enum scene_origin origin, const struct model *m)
{
    bool averaged = m->full && !m->climb;
    return origin != SCENE_OF_MODEL || averaged;
}

void scene_load_warn(const char *command, const struct model *m, const double *si,
                     const struct harmonic *drive)
{
    const char *text;
    for (int i = 0; (text = scenes_warning(m, si, drive, i)) != NULL; i++)
        fprintf(stderr, "contactplant %s: warning: %s\n", command, text);
}

void scene_load_tell_tolerance(const struct options *o, const struct model *m, const struct method *method)
{
    if (options_given(o, "tol") && (m->modal_form || method->order > 0))
        fprintf(stderr,
                "contactplant %s: method %s has no tolerance, so --tol does nothing; its error falls with "
                "the step\n",
                o->usage->name, m->modal_form ? "modal" : method->name);
}
