/* library.h - the inside of the library's objects. Nothing of it is public: contactplant.h is. */
#ifndef HOST_SIM_LIBRARY_H
#define HOST_SIM_LIBRARY_H

#include <stdbool.h>
#include "host_sim/library/contactplant.h"
#include "host_sim/live/client.h"
#include "host_sim/scene/scene_app.h"

enum { LIBRARY_RING = 512 };

/* Frames that wait, oldest first. */
struct library_ring {
    uint32_t first, n;
    struct frame frame[LIBRARY_RING];
};

/* A plant alone uses app.plant and nothing else of the app. */
struct contactplant {
    uint64_t magic;
    bool on_bus;
    struct contactplant_error error; /* the last call that failed */
    struct scene_app scene;
    struct hal hal;
    struct library_ring in, out;
    double scratch[METHOD_SCRATCH];
    struct stages stages;
};

struct contactplant_client {
    uint64_t magic;
    struct contactplant_error error;
    struct client client;
    struct hal hal;
    struct client_waiter waiter;
    struct contactplant_transport transport;
    double waited_s;           /* the client's clock: what its waits have taken */
    bool is_ended;             /* the transport ended a wait */
    bool is_unsent;            /* something was sent since the last flush */
    struct contactplant plant; /* alone, of the same scene */
};

/* The scene of this name or text. False: why[SCENE_REASON] says what to do. */
bool library_read_scene(const char *scene, struct scene *s, enum scene_origin *origin, char *why);

/* True for an object that was opened. */
bool library_is_plant(const struct contactplant *p);

/* Notes code and text, which is UTF-8 then; returns the code. Without an error to note it in, just that. */
int library_fail(struct contactplant_error *e, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Opens without looking at the memory, which is large enough. */
int library_open(struct contactplant *p, const char *scene, bool on_bus, size_t size,
                 struct contactplant_error *e);

/* NULL or not aligned or smaller than `needed` is refused. */
bool library_memory_fits(const void *memory, size_t size, size_t needed, struct contactplant_error *e);

/* The app of a plant on a bus starts anew, by its configuration. */
int library_start(struct contactplant *p, struct contactplant_error *e);

/* FNV-1a over n bytes, after `hash` of those before. */
#define LIBRARY_HASH 0xCBF29CE484222325u
uint64_t library_hash(uint64_t hash, const void *bytes, size_t n);

bool library_ring_put(struct library_ring *r, uint32_t depth, const struct frame *f);
bool library_ring_take(struct library_ring *r, struct frame *f);

#endif
