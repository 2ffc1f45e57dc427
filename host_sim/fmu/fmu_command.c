/* fmu_command.c - contactplant fmu SCENE --out FILE: an FMU of a scene. Binary and
 * sources fit every scene; they lie in a folder beside the program, which make and make install fill. */
#include "host_sim/commands.h"
#include "host_sim/cli/beside.h"
#include "host_sim/cli/files.h"
#include "host_sim/cli/options.h"
#include "host_sim/fmu/fmu_describe.h"
#include "host_sim/fmu/zip.h"
#include "host_sim/scene/scene_load.h"
#include "host_sim/scene/scene_print.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

static const struct option fmu_options[] = {
    {"out", "FILE", "the FMU to write, by custom NAME.fmu", OPTION_WRITES, .initial = NULL},
    {.name = NULL},
};

static const struct usage fmu_usage = {
    .name = "fmu",
    .words = "SCENE",
    .summary = "Writes a scene as an FMU: FMI 3.0 for co-simulation, a binary for this machine and the "
               "sources.\n"
               "Inputs, drives and parameters can be set; docs/guide/fmi.md has all variables.",
    .words_help = SCENE_WORDS_HELP,
    .examples = "  contactplant fmu rig --out rig.fmu\n",
    .min_words = 1,
    .max_words = 1,
    .table = {fmu_options}};

/* Where the parts are, seen from the program: installed, and in a build folder. */
static const char *const parts_place[] = {"../lib/contactplant/fmu", "fmu", NULL};

/* The list of the parts: a path in the FMU and in the folder on each line. */
#define PARTS_LIST "files"

/* A block of bytes with an end of text behind it; at is NULL after a failure. */
struct block {
    char *at;
    size_t n;
};

static struct block read_block(const char *folder, const char *name)
{
    char path[PATH_MAX];
    struct block b = {NULL, 0};
    long n = -1;
    FILE *f = snprintf(path, sizeof path, "%s/%s", folder, name) < PATH_MAX ? fopen(path, "rb") : NULL;
    if (f && !fseek(f, 0, SEEK_END) && (n = ftell(f)) >= 0 && !fseek(f, 0, SEEK_SET))
        b.at = malloc((size_t)n + 1);
    if (b.at)
        b.n = fread(b.at, 1, (size_t)n, f);
    if (b.at)
        b.at[b.n] = '\0';
    if (f)
        (void)fclose(f);
    return b;
}

/* The first folder that has a list of parts; its path into `folder`. */
static struct block find_parts(char folder[BESIDE_PATH])
{
    char program[BESIDE_PATH / 2];
    if (beside_find(parts_place, PARTS_LIST, folder))
        return read_block(folder, PARTS_LIST);
    beside_program(program);
    (void)options_failure(&fmu_usage,
                          "the parts of an FMU are not beside this program: neither in %s/%s nor in "
                          "%s/%s; run make install, or make fmu in the source tree",
                          program, parts_place[0], program, parts_place[1]);
    return (struct block){NULL, 0};
}

static int add_part(struct zip *z, const char *folder, const char *name)
{
    struct block b = read_block(folder, name);
    bool good = b.at && zip_add(z, name, b.at, b.n);
    int status = STATUS_DONE;
    if (!b.at)
        status = options_failure(&fmu_usage, "cannot read %s/%s: %s; install again", folder, name,
                                 strerror(errno));
    else if (!good)
        status = options_failure(&fmu_usage, "no memory for %s", name);
    free(b.at);
    return status;
}

static int add_parts(struct zip *z, const char *folder, char *list)
{
    int status = STATUS_DONE;
    for (char *name = strtok(list, "\n"); name && status == STATUS_DONE; name = strtok(NULL, "\n"))
        status = add_part(z, folder, name);
    return status;
}

/* A scene as an FMU has it, and what is said of it. */
struct subject {
    struct block scene, description;
};

static void describe(struct subject *s, struct contactplant *p, const char *word, const char *title)
{
    const char *name = strrchr(word, '/') ? strrchr(word, '/') + 1 : word;
    FILE *f = open_memstream(&s->description.at, &s->description.n);
    if (!f)
        return;
    fmu_describe(f, p, name, title, s->scene.at);
    (void)fclose(f);
}

/* The plant of this scene, NULL after a word on stderr. A bare model is judged by its name: it has no
 * lines to point at. */
static struct contactplant *open_plant(const struct subject *s, const char *model)
{
    static union contactplant_memory memory;
    struct contactplant_error error;
    struct contactplant *p = model ? contactplant_open(&memory, sizeof memory, model, &error) : NULL;
    if (!model || p)
        p = contactplant_open(&memory, sizeof memory, s->scene.at, &error);
    if (!p)
        (void)options_misuse(&fmu_usage, "%s", error.text);
    return p;
}

/* From the name of a scene to both texts. */
static int read_subject(const char *word, struct subject *s)
{
    struct scene scene;
    char why[SCENE_REASON];
    enum scene_origin origin = scene_load(word, &scene, why);
    if (origin == SCENE_OF_NOTHING)
        return options_misuse(&fmu_usage, "%s", why);
    if (origin == SCENE_OF_MODEL && !scene.model->modal_form)
        scene.method = "rk4"; /* as everywhere for a bare model */
    const char *title = origin == SCENE_OF_PRESET ? scenes_find(word)->title : scene.model->title;
    FILE *f = open_memstream(&s->scene.at, &s->scene.n);
    if (!f)
        return options_failure(&fmu_usage, "out of memory");
    scene_print(f, title, &scene);
    (void)fclose(f);
    struct contactplant *p = open_plant(s, origin == SCENE_OF_MODEL ? word : NULL);
    if (!p)
        return STATUS_MISUSED;
    if (scene_load_warns(origin, scene.model))
        scene_load_warn(fmu_usage.name, scene.model, p->scene.si, p->scene.drive);
    describe(s, p, word, title);
    return s->description.at ? STATUS_DONE : options_failure(&fmu_usage, "out of memory");
}

static int write_zip(FILE *f, const struct subject *s, const char *folder, char *list)
{
    static struct zip z;
    zip_begin(&z, f);
    bool good = zip_add(&z, "modelDescription.xml", s->description.at, s->description.n) &&
                zip_add(&z, "resources/" FMU_SCENE_FILE, s->scene.at, s->scene.n);
    int status = good ? add_parts(&z, folder, list) : STATUS_FAILED;
    if (status == STATUS_DONE)
        good = zip_end(&z);
    return good ? status : options_failure(&fmu_usage, "no memory for the FMU");
}

static int write_fmu(const struct options *o, const struct subject *s, const char *folder, char *list)
{
    FILE *f = options_compose(o, "out");
    if (!f)
        return STATUS_FAILED;
    int status = write_zip(f, s, folder, list);
    if (status == STATUS_DONE)
        return options_close(o, "out", f, NULL);
    (void)files_finish(f, false); /* The file of before stays. */
    return status;
}

int cmd_fmu(int argc, char **argv)
{
    struct options o;
    struct subject s = {{NULL, 0}, {NULL, 0}};
    struct block list = {NULL, 0};
    char folder[PATH_MAX];
    int status;
    if (!options_parse(&o, &fmu_usage, argc, argv, &status))
        return status;
    if (!options_given(&o, "out"))
        return options_misuse(&fmu_usage, "say where the FMU goes: --out %s.fmu", o.word[0]);
    status = read_subject(o.word[0], &s);
    if (status == STATUS_DONE) {
        list = find_parts(folder);
        status = list.at ? write_fmu(&o, &s, folder, list.at) : STATUS_FAILED;
    }
    free(list.at);
    free(s.scene.at);
    free(s.description.at);
    return status;
}
