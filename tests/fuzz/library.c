/* library.c - a program that uses contactplant.h wildly: a scene's text, then calls with any arguments; or a
 * client on a bus that loses and damages frames. Each is taken or refused with a code and a text; a refusal
 * changes nothing, and nothing that is not a number comes out. */
#include "host_sim/library/contactplant.h"
#include "tests/fuzz/fuzz.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum {
    CALLS = 64,
    TICKS = 256,
    SAMPLES = 6,
    SAVED = 200000,
    TALKS = 250 /* a first byte from here on: a client */
};

struct input {
    const uint8_t *at;
    size_t left;
};

static union contactplant_memory memory;
static unsigned char saved[SAVED];

static uint8_t byte_of(struct input *in)
{
    return in->left ? (in->left--, *in->at++) : 0;
}

static double number_of(struct input *in)
{
    static const double usual[] = {0.0, 1.0, -1.0, 225.0, 1e-3, 1e9, 1e300, 3.5};
    uint8_t kind = byte_of(in), bytes[8];
    double x;
    if (kind < 8)
        return usual[kind];
    if (kind < 128)
        return (kind - 64) * 1e-3;
    for (int i = 0; i < 8; i++)
        bytes[i] = byte_of(in);
    memcpy(&x, bytes, sizeof x);
    return x;
}

/* The text up to a zero byte, opened alone or on a bus. */
static struct contactplant *begin(struct input *in, bool *on_bus)
{
    static char text[4096];
    struct contactplant_error error;
    size_t n = 0;
    *on_bus = byte_of(in) & 1;
    for (uint8_t c; n + 1 < sizeof text && (c = byte_of(in)) != 0; n++)
        text[n] = (char)c;
    text[n] = '\0';
    struct contactplant *p =
        (*on_bus ? contactplant_open_bus : contactplant_open)(&memory, sizeof memory, text, &error);
    MUST(p ? error.code == CONTACTPLANT_OK && !*error.text : error.code == CONTACTPLANT_BAD_SCENE);
    MUST(strlen(error.text) < sizeof error.text && !strchr(error.text, '\n') && (p || *error.text));
    return p;
}

/* Samples told ahead; where they are taken, told one by one they end in the same bits. */
static int run_samples(struct contactplant *p, int i, const double value[SAMPLES], uint64_t ticks)
{
    size_t size = contactplant_save_size(p);
    MUST(size <= sizeof saved && contactplant_save(p, saved, size) == CONTACTPLANT_OK);
    int code = contactplant_advance_samples(p, i, value, SAMPLES, ticks);
    uint64_t hash = contactplant_hash(p);
    if (code != CONTACTPLANT_OK)
        return code;
    MUST(contactplant_restore(p, saved, size) == CONTACTPLANT_OK);
    for (int k = 0; k < SAMPLES; k++)
        MUST(contactplant_set_sample(p, i, value[k], 0) == CONTACTPLANT_OK &&
             contactplant_advance(p, ticks) == CONTACTPLANT_OK);
    MUST(contactplant_hash(p) == hash);
    return code;
}

static int change(struct contactplant *p, struct input *in, uint8_t call)
{
    int i = (int)byte_of(in) - 2;
    double a = number_of(in), b = number_of(in), c = number_of(in);
    const double state[] = {a, b, c, a, b, c};
    struct contactplant_frame frame = {.id = (uint32_t)i * 7u,
                                       .length = byte_of(in),
                                       .extended = byte_of(in) & 3u,
                                       .data = {byte_of(in), byte_of(in)}};
    switch (call % 10) {
    case 0:
        return contactplant_set_drive(p, i, a, b, c, number_of(in));
    case 1:
        return contactplant_set_noise(p, i, a, byte_of(in), byte_of(in), b);
    case 2:
        return contactplant_set_sample(p, i, a, byte_of(in));
    case 3:
        return contactplant_set_parameter(p, i, a);
    case 4:
        return contactplant_set_state(p, state, i);
    case 5:
        return contactplant_silence(p, a);
    case 6:
        return b == 0.0 ? contactplant_advance(p, byte_of(in) % TICKS)
                        : run_samples(p, i, state, byte_of(in));
    case 7:
        a = contactplant_time(p) + fmin(a, 1.0) * TICKS * contactplant_tick_time(p);
        return contactplant_advance_to(p, a);
    case 8:
        return contactplant_bus_put(p, &frame);
    default:
        return contactplant_bus_frame(p);
    }
}

/* A saved plant comes back; with one byte of another value it does not. */
static void keep(struct contactplant *p, struct input *in)
{
    size_t size = contactplant_save_size(p), place = (size_t)byte_of(in) << 8 | byte_of(in);
    uint64_t hash = contactplant_hash(p);
    MUST(size <= sizeof saved && contactplant_save(p, saved, size) == CONTACTPLANT_OK);
    saved[place % size] ^= 1;
    MUST(contactplant_restore(p, saved, size) == CONTACTPLANT_BAD_BYTES && contactplant_hash(p) == hash);
    saved[place % size] ^= 1;
    MUST(contactplant_restore(p, saved, size) == CONTACTPLANT_OK && contactplant_hash(p) == hash);
}

static void look(struct contactplant *p)
{
    struct contactplant_event event;
    struct contactplant_frame frame;
    for (int i = 0; i < contactplant_count(p, CONTACTPLANT_OUTPUT); i++)
        MUST(isfinite(contactplant_output(p, i)));
    for (int i = 0; i < contactplant_count(p, CONTACTPLANT_STATE); i++)
        MUST(isfinite(contactplant_state(p, i)));
    MUST(isfinite(contactplant_time(p)));
    while (contactplant_next_event(p, &event))
        MUST(isfinite(event.time_s) && event.speed >= 0.0);
    while (contactplant_bus_take(p, &frame))
        MUST(frame.length <= 8);
}

/* ---- a client, and a plant at the other end of a bad bus ---- */

struct talk {
    struct input in;
    struct contactplant *plant;
};

static int hear(void *context, struct contactplant_frame *frame)
{
    struct talk *t = context;
    if (!contactplant_bus_take(t->plant, frame))
        return 0;
    uint8_t trouble = byte_of(&t->in);
    if (trouble > 240)
        frame->data[trouble & 7u] ^= byte_of(&t->in);
    if (trouble > 250)
        frame->length = byte_of(&t->in);
    return trouble == 240 ? -1 : 1;
}

static int say(void *context, const struct contactplant_frame *frame)
{
    struct talk *t = context;
    return byte_of(&t->in) < 250 && contactplant_bus_put(t->plant, frame) == CONTACTPLANT_OK;
}

static double rest(void *context, double seconds)
{
    struct talk *t = context;
    uint8_t trouble = byte_of(&t->in);
    MUST(seconds >= 0.0 && contactplant_bus_frame(t->plant) == CONTACTPLANT_OK);
    return trouble == 255 ? -1.0 : trouble == 254 ? (double)NAN : trouble == 253 ? 0.0 : 1e-3;
}

static int ask(struct contactplant_client *c, struct input *in, uint8_t call)
{
    int i = (int)byte_of(in) - 2, index[2] = {i, byte_of(in)};
    double a = number_of(in), value[2] = {a, number_of(in)};
    struct contactplant_latest now;
    switch (call % 11) {
    case 0:
        return contactplant_client_begin(c, 0.05);
    case 1:
        return contactplant_client_end(c, a > 0.05 ? 0.05 : a);
    case 2:
        return contactplant_client_heartbeat(c);
    case 3:
        return contactplant_client_control(c, (enum contactplant_operation)i, byte_of(in));
    case 4:
        return contactplant_client_arm(c, i, a, value[1], 0.0, 0.1);
    case 5:
        return contactplant_client_fire(c, byte_of(in), byte_of(in) * UINT64_C(64), value[1]);
    case 6:
        return contactplant_client_stream(c, i, byte_of(in), a);
    case 7:
        return contactplant_client_set_parameters(c, byte_of(in) % 3, index, value);
    case 8:
        (void)contactplant_client_parameter(c, i, 0.02);
        return CONTACTPLANT_OK;
    case 9:
        return contactplant_client_wait(c, (enum contactplant_wait)i, byte_of(in), a > 0.05 ? 0.05 : a);
    default:
        MUST(contactplant_client_latest(c, &now, sizeof now) == CONTACTPLANT_OK);
        MUST(!isinf(now.force_N) && !isinf(now.displacement_m));
        return contactplant_client_poll(c) < 0;
    }
}

static void talk(struct input in)
{
    static union contactplant_client_memory client_memory;
    struct talk t = {in, contactplant_open_bus(&memory, sizeof memory, "hertz_rig", NULL)};
    struct contactplant_transport way = {&t, hear, say, NULL, rest};
    struct contactplant_client *c =
        contactplant_client_open(&client_memory, sizeof client_memory, "hertz_rig", &way, NULL);
    MUST(t.plant && c);
    for (int i = 0; t.in.left && i < CALLS; i++) {
        int code = ask(c, &t.in, byte_of(&t.in));
        MUST(code >= 0 && code <= CONTACTPLANT_REFUSED);
        MUST(!code || (*contactplant_client_error(c) && !strchr(contactplant_client_error(c), '\n')));
        for (int k = 0; k < contactplant_count(t.plant, CONTACTPLANT_OUTPUT); k++)
            MUST(isfinite(contactplant_output(t.plant, k)));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct input in = {data, size};
    bool on_bus;
    if (size && *data >= TALKS) {
        in.at++, in.left--;
        talk(in);
        return 0;
    }
    struct contactplant *p = begin(&in, &on_bus);
    for (int i = 0; p && in.left && i < CALLS; i++) {
        uint8_t call = byte_of(&in);
        uint64_t hash = contactplant_hash(p);
        int code = change(p, &in, call);
        if (code != CONTACTPLANT_OK)
            MUST(*contactplant_error(p) && !strchr(contactplant_error(p), '\n'));
        if (code != CONTACTPLANT_OK && code != CONTACTPLANT_DIVERGED)
            MUST(contactplant_hash(p) == hash);
        look(p);
        if (call >= 200)
            keep(p, &in);
    }
    return 0;
}
