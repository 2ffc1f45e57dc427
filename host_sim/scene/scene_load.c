/* scene_load.c - see scene_load.h. */
#include "host_sim/scene/scene_load.h"
#include "host_sim/scene/scene_app.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

enum { PATH_SHOWN = 120 };

static enum scene_origin load_file(const char *path, struct scene *s, char *why, bool stepped)
{
    static char text[SCENE_FILE_BYTES + 1]; /* one more tells a larger file */
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

static bool stat_folder(const char *path, struct stat *s)
{
    char folder[PATH_MAX];
    const char *slash = strrchr(path, '/');
    int n = slash ? snprintf(folder, sizeof folder, "%.*s/", (int)(slash - path), path)
                  : snprintf(folder, sizeof folder, ".");
    return n < (int)sizeof folder && !stat(folder, s);
}

/* Names of files that are not there yet: one name in one folder. */
static bool same_place(const char *a, const char *b)
{
    struct stat x, y;
    const char *slash_a = strrchr(a, '/'), *slash_b = strrchr(b, '/');
    if (strcmp(slash_a ? slash_a + 1 : a, slash_b ? slash_b + 1 : b))
        return false;
    if (!stat_folder(a, &x) || !stat_folder(b, &y))
        return !strcmp(a, b);
    return x.st_dev == y.st_dev && x.st_ino == y.st_ino;
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

bool scene_load_same(const char *a, const char *b)
{
    struct stat x, y;
    bool no_a = stat(a, &x), no_b = stat(b, &y);
    if (no_a || no_b)
        return no_a && no_b && same_place(a, b);
    return S_ISREG(x.st_mode) && x.st_dev == y.st_dev && x.st_ino == y.st_ino;
}

bool scene_load_is(enum scene_origin origin, const char *name, const char *path)
{
    return origin == SCENE_OF_FILE && scene_load_same(name, path);
}

int scene_load_check_files(const struct options *o, enum scene_origin origin, int i_word, const char *read,
                           const char *const *option)
{
    const char *scene = o->n_words > i_word ? o->word[i_word] : "";
    for (; *option; option++) {
        const char *path = options_text(o, *option, 0);
        if (path && scene_load_is(origin, scene, path))
            return options_misuse(o->usage, "--%s %s is the scene itself; choose another", *option, path);
        if (path && read && scene_load_same(path, read))
            return options_misuse(o->usage, "--%s %s is read by this command; choose another", *option, path);
        for (const char *const *next = option + 1; path && *next; next++) {
            const char *other = options_text(o, *next, 0);
            if (other && scene_load_same(path, other))
                return options_misuse(o->usage, "--%s and --%s are both %s; choose two files", *option, *next,
                                      path);
        }
    }
    return 0;
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
