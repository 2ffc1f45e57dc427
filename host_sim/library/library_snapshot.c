/* library_snapshot.c - a plant or a microscope as bytes, and back.
 *
 * The bytes are a header, the app, the method's scratch memory, the stages, the frames on the bus and the
 * burst capture, as they lie in memory. Pointers are left out: those of the plant that takes the bytes stay.
 * They fit a plant of the same scene only, and the header says so. */
#include "host_sim/library/library.h"

#include <stddef.h>
#include <string.h>
#include "host_sim/library/library_afm.h"

struct header {
    uint64_t magic;
    uint64_t check; /* over everything behind it */
    uint64_t size;  /* number of all bytes */
    char version[16];
    uint32_t abi, layout; /* sizes that differ between machines */
    uint32_t on_bus, n_capture;
    uint64_t scene; /* a check of what does not change while a plant runs */
};

static const uint64_t magic = 0x31746C7063706E73u; /* another order of bytes is another number */

uint64_t library_hash(uint64_t hash, const void *bytes, size_t n)
{
    const unsigned char *b = bytes;
    for (size_t i = 0; i < n; i++)
        hash = (hash ^ b[i]) * 0x100000001B3u;
    return hash;
}

static uint64_t hash_text(uint64_t hash, const char *text)
{
    return library_hash(hash, text, strlen(text) + 1);
}

/* Model, method, tick and identity on the bus. */
static uint64_t scene_check_of(const struct contactplant *p)
{
    const struct app_config *c = &p->scene.config;
    uint64_t hash = hash_text(hash_text(LIBRARY_HASH, c->model->name), c->method->name);
    const double number[] = {c->frame_s,         c->dilation,        c->tol,
                             c->substeps,        c->base_id,         p->scene.watch.observable,
                             p->scene.watch.low, p->scene.watch.high};
    return library_hash(hash, number, sizeof number);
}

static size_t capture_bytes(const struct contactplant *p)
{
    return p->scene.config.n_capture * sizeof(float);
}

static size_t bytes_of(const struct contactplant *p)
{
    return sizeof(struct header) + sizeof p->scene.app + sizeof p->scratch + sizeof p->stages + sizeof p->in +
           sizeof p->out + sizeof p->scene.setting + sizeof p->scene.si + capture_bytes(p);
}

static struct header header_of(const struct contactplant *p)
{
    struct header h = {.magic = magic,
                       .size = bytes_of(p),
                       .version = CONTACTPLANT_VERSION,
                       .abi = CONTACTPLANT_ABI,
                       .layout = (uint32_t)(sizeof(void *) << 24 | sizeof(struct contactplant)),
                       .on_bus = p->on_bus,
                       .n_capture = p->scene.config.n_capture,
                       .scene = scene_check_of(p)};
    return h;
}

/* The parts behind the header, in their order; a NULL ends them. The app is the first. */
struct part {
    void *at;
    size_t n;
};
enum { PARTS = 9 };

static void list_parts(struct contactplant *p, struct part part[PARTS])
{
    const struct part all[PARTS] = {{&p->scene.app, sizeof p->scene.app},
                                    {p->scratch, sizeof p->scratch},
                                    {&p->stages, sizeof p->stages},
                                    {&p->in, sizeof p->in},
                                    {&p->out, sizeof p->out},
                                    {p->scene.setting, sizeof p->scene.setting},
                                    {p->scene.si, sizeof p->scene.si},
                                    {p->scene.config.capture, capture_bytes(p)},
                                    {NULL, 0}};
    memcpy(part, all, sizeof all);
}

#define MEMBER(name)                                                                                         \
    {                                                                                                        \
        offsetof(struct app, name), sizeof(((struct app *)NULL)->name)                                       \
    }

/* Where the app has pointers. */
static const struct {
    size_t offset, size;
} pointers[] = {MEMBER(hal),
                MEMBER(config),
                MEMBER(plant.model),
                MEMBER(plant.method),
                MEMBER(plant.step),
                MEMBER(plant.scratch),
                MEMBER(plant.stage_calls),
                MEMBER(plant.stages),
                MEMBER(plant.ledger.model),
                MEMBER(plant.ledger.piece)};
enum { POINTERS = sizeof pointers / sizeof pointers[0] };

size_t contactplant_save_size(struct contactplant *p)
{
    return library_is_plant(p) ? bytes_of(p) : 0;
}

static uint64_t check_of(const unsigned char *at, size_t size)
{
    return library_hash(0, at + offsetof(struct header, size), size - offsetof(struct header, size));
}

int contactplant_save(struct contactplant *p, void *bytes, size_t size)
{
    struct part part[PARTS];
    unsigned char *at = bytes;
    if (!library_is_plant(p))
        return CONTACTPLANT_BAD_HANDLE;
    if (!bytes || size < bytes_of(p))
        return library_fail(&p->error, CONTACTPLANT_BAD_MEMORY,
                            "give contactplant_save_size: %zu bytes, not %zu", bytes_of(p), bytes ? size : 0);
    struct header h = header_of(p);
    list_parts(p, part);
    if (scene_kind(p->scene.config.model)->keep)
        scene_kind(p->scene.config.model)->keep(p->scratch);
    at += sizeof h;
    for (int i = 0; part[i].at; at += part[i++].n)
        memcpy(at, part[i].at, part[i].n);
    at = bytes;
    for (int i = 0; i < POINTERS; i++)
        memset(at + sizeof h + pointers[i].offset, 0, pointers[i].size);
    memcpy(at, &h, sizeof h);
    h.check = check_of(at, (size_t)h.size);
    memcpy(at, &h, sizeof h);
    return CONTACTPLANT_OK;
}

/* NULL, or why these bytes are not of the plant with this header. */
static const char *refuse(const struct header *own, const unsigned char *at, size_t size)
{
    struct header h;
    if (!at)
        return "they are NULL";
    if (size < sizeof h)
        return "they are too few";
    memcpy(&h, at, sizeof h);
    if (h.magic != own->magic)
        return "they were not saved by this library on this kind of machine";
    if (h.abi != own->abi || memcmp(h.version, own->version, sizeof h.version) || h.layout != own->layout)
        return "another version of the library has saved them; run the plant again";
    if (h.on_bus != own->on_bus || h.scene != own->scene)
        return "they are of another scene; open the plant with the scene that was saved";
    if (h.n_capture != own->n_capture)
        return "the plant that was saved had memory of another size";
    if (h.size != own->size || size < h.size)
        return "they are too few";
    return h.check == check_of(at, (size_t)h.size) ? NULL : "they are damaged";
}

int contactplant_restore(struct contactplant *p, const void *bytes, size_t size)
{
    struct part part[PARTS];
    const unsigned char *at = bytes;
    unsigned char kept[POINTERS][sizeof(struct app_config)];
    if (!library_is_plant(p))
        return CONTACTPLANT_BAD_HANDLE;
    const struct header own = header_of(p);
    const char *why = refuse(&own, bytes, size);
    if (why)
        return library_fail(&p->error, CONTACTPLANT_BAD_BYTES, "these bytes cannot be restored: %s", why);
    for (int i = 0; i < POINTERS; i++)
        memcpy(kept[i], (const char *)&p->scene.app + pointers[i].offset, pointers[i].size);
    list_parts(p, part);
    at += sizeof(struct header);
    for (int i = 0; part[i].at; at += part[i++].n)
        memcpy(part[i].at, at, part[i].n);
    for (int i = 0; i < POINTERS; i++)
        memcpy((char *)&p->scene.app + pointers[i].offset, kept[i], pointers[i].size);
    return CONTACTPLANT_OK;
}

/* ---- a microscope ---- */

static const uint64_t afm_snapshot_magic = 0x316D6661706E6173u;
enum { AFM_SAVED = sizeof(struct contactplant_afm) - offsetof(struct contactplant_afm, runs) };

/* Its pointers: a grid and stages, which a microscope of the library has not. */
static void forget_pointers(struct station *s)
{
    memset(&s->microscope.surface.grid, 0, sizeof s->microscope.surface.grid);
    memset(&s->microscope.piezo, 0, sizeof s->microscope.piezo);
    memset(&s->microscope.sensor, 0, sizeof s->microscope.sensor);
}

static struct header afm_header_of(const struct contactplant_afm *a)
{
    struct header h = {.magic = afm_snapshot_magic,
                       .size = sizeof h + AFM_SAVED,
                       .version = CONTACTPLANT_VERSION,
                       .abi = CONTACTPLANT_ABI,
                       .layout = (uint32_t)(sizeof(void *) << 24 | sizeof(struct contactplant_afm)),
                       .scene =
                           library_hash(library_hash(0, a->si, sizeof a->si), &a->tick_s, sizeof a->tick_s)};
    return h;
}

size_t contactplant_afm_save_size(struct contactplant_afm *a)
{
    return library_is_afm(a) ? sizeof(struct header) + AFM_SAVED : 0;
}

int contactplant_afm_save(struct contactplant_afm *a, void *bytes, size_t size)
{
    struct contactplant_afm copy;
    unsigned char *at = bytes;
    if (!library_is_afm(a))
        return CONTACTPLANT_BAD_HANDLE;
    struct header h = afm_header_of(a);
    if (!bytes || size < h.size)
        return library_fail(&a->error, CONTACTPLANT_BAD_MEMORY,
                            "give contactplant_afm_save_size: %zu bytes, not %zu", (size_t)h.size,
                            bytes ? size : 0);
    memcpy(&copy, a, sizeof copy);
    forget_pointers(&copy.station);
    memcpy(at, &h, sizeof h);
    memcpy(at + sizeof h, &copy.runs, AFM_SAVED);
    h.check = check_of(at, (size_t)h.size);
    memcpy(at, &h, sizeof h);
    return CONTACTPLANT_OK;
}

/* With numbers with which none could begin the bytes are refused. */
int contactplant_afm_restore(struct contactplant_afm *a, const void *bytes, size_t size)
{
    struct contactplant_afm saved;
    if (!library_is_afm(a))
        return CONTACTPLANT_BAD_HANDLE;
    const struct header own = afm_header_of(a);
    const char *why = refuse(&own, bytes, size);
    if (why)
        return library_fail(&a->error, CONTACTPLANT_BAD_BYTES, "these bytes cannot be restored: %s", why);
    memcpy(&saved, a, sizeof saved);
    memcpy(&saved.runs, (const unsigned char *)bytes + sizeof(struct header), AFM_SAVED);
    if (saved.runs) {
        struct contactplant_afm fresh = saved;
        fresh.runs = false;
        if (library_start_afm(&fresh) != CONTACTPLANT_OK)
            return library_fail(&a->error, CONTACTPLANT_BAD_BYTES, "these bytes cannot be restored: %s",
                                fresh.error.text);
    }
    *a = saved;
    return CONTACTPLANT_OK;
}
