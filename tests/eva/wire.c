/* wire.c - any frame decodes, any message encodes, with the lowest and with the highest identifiers. */
#include "firmware/bus/wire.h"
#include "firmware/bus/wire_table.h"
#include "tests/eva/eva.h"

static void any_scene(struct wire_scene *s, uint32_t base)
{
    *s = (struct wire_scene){.base_id = base, .extended = eva_bool()};
    for (int i = 0; i < 4; i++)
        s->lsb[i] = eva_between(1e-22, 5e22); /* the range of wire_lsb: see below */
}

/* Each field by itself is any number; the others are 0, for no field's code depends on another's. */
static void any_field(const struct wire_scene *s, uint32_t kind, int i, double value)
{
    struct frame f;
    struct message m = {.kind = (uint8_t)kind, .counter = (uint8_t)eva_uint(0, 255)};
    m.value[i] = value;
    wire_encode(s, &m, &f);
}

static void any_message(const struct wire_scene *s, uint32_t kind, const double *value)
{
    const struct message_layout *l = wire_layout(kind);
    for (int i = 0; l && i < l->n_fields; i++)
        any_field(s, kind, i, value[i]);
}

/* Any length, flags and bytes; identifier base + kind, of which the last stands for every identifier that
 * is not ours. A frame that decodes is encoded again: no value from the wire is one that encoding cannot
 * take. */
static void any_frame(const struct wire_scene *s, uint32_t kind)
{
    struct frame f;
    struct message m;
    eva_any(&f, sizeof f);
    f.id = s->base_id + kind;
    if (wire_decode(s, &f, &m) == WIRE_OK)
        any_message(s, kind, m.value);
}

static void any_lsb(void)
{
    double typical;
    eva_any(&typical, sizeof typical);
    double lsb = wire_lsb(typical);
    /*@ assert lsb_is_sound: 0.99e-22 <= lsb <= 5.01e22; */
    (void)lsb;
}

int main(void)
{
    static const uint32_t base[2] = {0, 0x1FFFFFC0};
    uint8_t bytes[16];
    eva_any(bytes, sizeof bytes);
    (void)wire_crc32((uint32_t)eva_word(), bytes, (int)eva_uint(0, sizeof bytes));
    any_lsb();
    for (int i = 0; i < 2; i++) {
        struct wire_scene s;
        any_scene(&s, base[i]);
        double value[WIRE_FIELDS];
        eva_any(value, sizeof value);
        for (uint32_t kind = 0; kind <= WIRE_KINDS; kind++) {
            any_frame(&s, kind);
            any_message(&s, kind, value);
        }
    }
    return 0;
}
