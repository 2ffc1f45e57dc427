/* library.c - versions, errors, and a plant from a scene in the caller's memory. */
#include "host_sim/library/library.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include "firmware/app/plant_scene.h"
#include "firmware/plant/plant_change.h"
#include "host_sim/out/utf8.h"
#include "host_sim/scene/plant_of_scene.h"
#include "models/models.h"
#include "models/scenes/scenes_table.h"

STATIC_ASSERT(sizeof(struct contactplant) <= CONTACTPLANT_SIZE, plant_fits_its_promised_size);
STATIC_ASSERT(CONTACTPLANT_PROTOCOL == WIRE_VERSION, protocol_of_the_header);
STATIC_ASSERT((int)CONTACTPLANT_SETTING_FIRST == SETTING_FIRST, settings_begin_as_on_the_wire);
STATIC_ASSERT((int)CONTACTPLANT_TEXT >= SCENE_REASON, text_of_a_scene_fits);

enum { CAPTURE_MOST = 65536 * MODEL_OUTPUTS };

static const uint64_t plant_magic = 0x746E616C70746361u;

const char *contactplant_version(void)
{
    return CONTACTPLANT_VERSION;
}

int contactplant_abi(void)
{
    return CONTACTPLANT_ABI;
}

int contactplant_protocol(void)
{
    return CONTACTPLANT_PROTOCOL;
}

size_t contactplant_size(void)
{
    return sizeof(struct contactplant);
}

const char *contactplant_scene_name(int i)
{
    if (i < 0 || i >= MODELS + SCENES)
        return NULL;
    return i < MODELS ? model_table[i]->name : scenes_table[i - MODELS].name;
}

const char *contactplant_scene_title(int i)
{
    if (i < 0 || i >= MODELS + SCENES)
        return NULL;
    return i < MODELS ? model_table[i]->title : scenes_table[i - MODELS].title;
}

/* ---- errors ---- */

/* Numbers in a text have a point, as in a scene, whatever the locale of the process. Quoted words are the
 * user's. */
static void use_points(char *text)
{
    char half[16];
    size_t width = (size_t)snprintf(half, sizeof half, "%.1f", 0.5) - 2;
    bool quoted = false;
    if (width == 1 && half[1] == '.')
        return;
    for (char *at = text; *at; at++) {
        quoted ^= *at == '"';
        char *rest = at + 1 + width;
        if (quoted || !isdigit((unsigned char)*at) || strncmp(at + 1, half + 1, width) ||
            !isdigit((unsigned char)*rest))
            continue;
        at[1] = '.';
        memmove(at + 2, rest, strlen(rest) + 1);
    }
}

int library_fail(struct contactplant_error *e, int code, const char *format, ...)
{
    va_list list;
    if (!e)
        return code;
    e->code = code;
    va_start(list, format);
    vsnprintf(e->text, sizeof e->text, format, list);
    va_end(list);
    use_points(e->text);
    utf8_mend(e->text);
    return code;
}

bool library_is_plant(const struct contactplant *p)
{
    return p && (uintptr_t)p % CONTACTPLANT_ALIGN == 0 && p->magic == plant_magic;
}

const char *contactplant_error(const struct contactplant *p)
{
    return library_is_plant(p) ? p->error.text : "not a plant: give what contactplant_open has returned";
}

bool library_memory_fits(const void *memory, size_t size, size_t needed, struct contactplant_error *e)
{
    if (!memory)
        (void)library_fail(e, CONTACTPLANT_BAD_MEMORY, "the memory is NULL; give %zu bytes", needed);
    else if ((uintptr_t)memory % CONTACTPLANT_ALIGN)
        (void)library_fail(e, CONTACTPLANT_BAD_MEMORY, "the memory is not aligned to %d bytes",
                           CONTACTPLANT_ALIGN);
    else if (size < needed)
        (void)library_fail(e, CONTACTPLANT_BAD_MEMORY, "%zu bytes of memory are too few; give %zu", size,
                           needed);
    else
        return true;
    return false;
}

/* ---- the bus in memory ---- */

bool library_ring_put(struct library_ring *r, uint32_t depth, const struct frame *f)
{
    if (r->n >= depth)
        return false;
    r->frame[(r->first + r->n++) % LIBRARY_RING] = *f;
    return true;
}

bool library_ring_take(struct library_ring *r, struct frame *f)
{
    if (!r->n)
        return false;
    *f = r->frame[r->first];
    r->first = (r->first + 1) % LIBRARY_RING;
    r->n--;
    return true;
}

static int ring_receive(void *context, struct frame *f)
{
    struct contactplant *p = context;
    return library_ring_take(&p->in, f);
}

static int ring_send(void *context, const struct frame *f)
{
    struct contactplant *p = context;
    return library_ring_put(&p->out, LIBRARY_RING, f);
}

static void hal_nothing(void *context)
{
    (void)context;
}

/* A bus in memory has no clock: compute times are 0. */
static uint32_t hal_now_us(void *context)
{
    (void)context;
    return 0;
}

/* ---- opening ---- */

/* A name has neither. */
static bool is_text(const char *scene)
{
    return strchr(scene, '\n') || strchr(scene, '[');
}

bool library_read_scene(const char *scene, struct scene *s, enum scene_origin *origin, char *why)
{
    *origin = is_text(scene) ? SCENE_OF_FILE : scene_name_find(scene, s);
    if (*origin == SCENE_OF_FILE)
        return scene_file_parse("scene", scene, strlen(scene), s, why);
    if (*origin == SCENE_OF_NOTHING)
        scene_name_refuse("model or preset", scene, why);
    return *origin != SCENE_OF_NOTHING;
}

/* The plant of an app without the app. */
static const char *start_alone(struct scene_app *s)
{
    const struct app_config *c = &s->config;
    struct plant_config alone = plant_config_of_scene(&s->scene, s->si, c->scratch);
    double setting[SETTINGS];
    if (scene_kind(c->model)->library)
        return scene_kind(c->model)->library;
    for (int i = 0; i < SCENE_STAGES; i++)
        if (s->scene.stage[i][STAGE_AT] > MODEL_INPUTS)
            return "it has a sensor, whose reading is on the bus alone: leave its [stage] out, or open the "
                   "plant on a bus";
    alone.method = c->method; /* a model's name alone has another one */
    alone.tol = c->tol;
    alone.stage_calls = c->stage_calls;
    alone.stages = c->stages;
    const char *why = plant_init(&s->app.plant, &alone);
    if (!why && scene_stage_settings(&s->scene, setting))
        c->stage_calls->change(c->stages, &s->app.plant, setting);
    if (!why && s->origin != SCENE_OF_MODEL)
        plant_scene_begin(&s->app.plant, &s->scene, s->si, s->drive);
    return why;
}

int library_start(struct contactplant *p, struct contactplant_error *e)
{
    char why[SCENE_REASON];
    if (p->on_bus)
        return scene_app_start(&p->scene, &p->hal, why) ? CONTACTPLANT_OK
                                                        : library_fail(e, CONTACTPLANT_BAD_SCENE, "%s", why);
    const char *reason = start_alone(&p->scene);
    return reason ? library_fail(e, CONTACTPLANT_BAD_SCENE, "this scene cannot run: %s", reason)
                  : CONTACTPLANT_OK;
}

/* The burst capture has what is beyond the plant, at most what it can use. */
static void provide_capture(struct contactplant *p, size_t size)
{
    size_t n = size / sizeof(float);
    p->scene.config.n_capture = n < CAPTURE_MOST ? (uint32_t)n : CAPTURE_MOST;
    p->scene.config.capture = (float *)(void *)(p + 1);
    memset(p->scene.config.capture, 0, p->scene.config.n_capture * sizeof(float));
}

int library_open(struct contactplant *p, const char *scene, bool on_bus, size_t size,
                 struct contactplant_error *e)
{
    char why[SCENE_REASON];
    memset(p, 0, sizeof *p);
    if (!library_read_scene(scene, &p->scene.scene, &p->scene.origin, why))
        return library_fail(e, CONTACTPLANT_BAD_SCENE, "%s", why);
    scene_app_configure(&p->scene);
    p->on_bus = on_bus;
    p->hal = (struct hal){p, ring_receive, ring_send, hal_nothing, hal_now_us, hal_nothing};
    p->scene.config.scratch = p->scratch;
    p->scene.config.stages = scene_stages(scene_kind(p->scene.scene.model), &p->stages, p->scratch);
    p->scene.config.stage_calls = scene_kind(p->scene.scene.model)->stage_calls;
    if (on_bus)
        provide_capture(p, size - sizeof *p);
    int code = library_start(p, e);
    if (code == CONTACTPLANT_OK)
        p->magic = plant_magic;
    return code;
}

static struct contactplant *open_plant(void *memory, size_t size, const char *scene, bool on_bus,
                                       struct contactplant_error *e)
{
    if (e)
        *e = (struct contactplant_error){.code = CONTACTPLANT_OK};
    if (!library_memory_fits(memory, size, sizeof(struct contactplant), e))
        return NULL;
    if (!scene) {
        (void)library_fail(e, CONTACTPLANT_BAD_SCENE,
                           "the scene is NULL; give a model, a preset or the text of a scene file");
        return NULL;
    }
    return library_open(memory, scene, on_bus, size, e) == CONTACTPLANT_OK ? memory : NULL;
}

struct contactplant *contactplant_open(void *memory, size_t size, const char *scene,
                                       struct contactplant_error *error)
{
    return open_plant(memory, size, scene, false, error);
}

struct contactplant *contactplant_open_bus(void *memory, size_t size, const char *scene,
                                           struct contactplant_error *error)
{
    return open_plant(memory, size, scene, true, error);
}
