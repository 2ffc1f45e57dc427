/* wire.c - frames to messages and back, driven by the table in wire_table.c. */
#include "firmware/bus/wire.h"

#include <float.h>
#include <string.h>
#include "firmware/bus/wire_table.h"
#include "models/check.h"
#include "models/math/elementary.h"

enum {
    COUNTER_START = 8,
    POWER_OF_TEN_MAX = 22 /* the largest that a double holds exactly */
};

static const uint32_t crc32_polynomial = 0xEDB88320u; /* reflected */
static const uint32_t float_infinity = 0x7F800000u;
static const uint32_t float_nan = 0x7FC00000u; /* one NaN on the wire: targets differ in the one they make */

STATIC_ASSERT(sizeof(float) == 4 && FLT_MANT_DIG == 24, float_is_binary32);

/* CRCs of the low and of the high four bits of a byte, polynomial 0x1D. */
static const uint8_t crc8_of_low[16] = {0x00, 0x1D, 0x3A, 0x27, 0x74, 0x69, 0x4E, 0x53,
                                        0xE8, 0xF5, 0xD2, 0xCF, 0x9C, 0x81, 0xA6, 0xBB};
static const uint8_t crc8_of_high[16] = {0x00, 0xCD, 0x87, 0x4A, 0x13, 0xDE, 0x94, 0x59,
                                         0x26, 0xEB, 0xA1, 0x6C, 0x35, 0xF8, 0xB2, 0x7F};

/* The CRC is linear: that of a byte is that of its high four bits with that of its low ones. */
uint8_t wire_crc8_byte(uint8_t crc, uint8_t byte)
{
    unsigned c = (unsigned)crc ^ byte;

    return (uint8_t)(crc8_of_high[c >> 4] ^ crc8_of_low[c & 0xFu]);
}

uint8_t wire_crc8(uint32_t id, const uint8_t *data, int length)
{
    uint8_t crc = wire_crc8_byte(0, (uint8_t)id);

    crc = wire_crc8_byte(crc, (uint8_t)(id >> 8));
    for (int i = 1; i < length; i++)
        crc = wire_crc8_byte(crc, data[i]);
    return crc;
}

uint32_t wire_crc32(uint32_t crc, const uint8_t *data, int n)
{
    crc = ~crc;
    for (int i = 0; i < n; i++) {
        crc ^= data[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc & 1u ? crc >> 1 ^ crc32_polynomial : crc >> 1;
    }
    return ~crc;
}

uint32_t wire_crc32_entry(uint32_t crc, unsigned index, double value)
{
    float narrow = (float)value;
    uint32_t bits;
    memcpy(&bits, &narrow, sizeof bits);
    const uint8_t entry[5] = {(uint8_t)index, (uint8_t)bits, (uint8_t)(bits >> 8), (uint8_t)(bits >> 16),
                              (uint8_t)(bits >> 24)};
    return wire_crc32(crc, entry, sizeof entry);
}

double wire_factor(const struct wire_scene *s, enum field_scale scale)
{
    switch (scale) {
    case SCALE_FRACTION_8:
        return 1.0 / 256.0;
    case SCALE_FRACTION_16:
        return 1.0 / 65536.0;
    case SCALE_LOSS:
        return 1.0 / 65535.0;
    case SCALE_ANGLE:
        return ELEMENTARY_PI / 32768.0;
    case SCALE_DISPLACEMENT:
    case SCALE_VELOCITY:
    case SCALE_PENETRATION:
    case SCALE_FORCE:
        return s->lsb[scale - SCALE_DISPLACEMENT];
    case SCALE_ONE:
        break;
    }
    return 1.0;
}

/* The integer nearest to x, ties away from zero; |x| < 2^52. */
static int64_t nearest(double x)
{
    int64_t whole = (int64_t)x;
    double rest = x - (double)whole;

    return whole + (rest >= 0.5) - (rest <= -0.5);
}

static uint64_t field_mask(const struct field *d)
{
    return ((uint64_t)1 << d->bits) - 1;
}

static uint64_t encode_float(double x)
{
    uint32_t bits;
    float narrow;

    if (x != x)
        return float_nan;
    if (x > (double)FLT_MAX)
        return float_infinity;
    if (x < -(double)FLT_MAX)
        return float_infinity | (uint32_t)1 << 31;
    narrow = (float)x;
    memcpy(&bits, &narrow, sizeof bits);
    return bits;
}

static double decode_float(uint64_t raw)
{
    uint32_t bits = (uint32_t)raw;
    float narrow;

    memcpy(&narrow, &bits, sizeof narrow);
    return (double)narrow;
}

static uint64_t encode_unsigned(const struct field *d, double units)
{
    uint64_t max = field_mask(d);

    if (!(units > 0.0))
        return 0;
    return units >= (double)max ? max : (uint64_t)nearest(units);
}

/* Angles wrap. In 24 bits the most negative number means "not available"; a converter's 16 bits hold any. */
static uint64_t encode_signed(const struct field *d, double units)
{
    bool angle = d->scale == SCALE_ANGLE;
    double limit = angle ? 1099511627776.0 : (double)(field_mask(d) >> 1) + 0.5;

    if (!(units < limit && units > -limit))
        return angle ? 0 : (uint64_t)1 << (d->bits - 1);
    return (uint64_t)nearest(units) & field_mask(d);
}

static uint64_t encode_field(const struct wire_scene *s, const struct field *d, double value)
{
    double units = value / wire_factor(s, d->scale);

    if (d->kind == FIELD_FLOAT)
        return encode_float(value);
    return d->kind == FIELD_SIGNED ? encode_signed(d, units) : encode_unsigned(d, units);
}

static double decode_field(const struct wire_scene *s, const struct field *d, uint64_t raw)
{
    uint64_t sign = (uint64_t)1 << (d->bits - 1);
    double factor = wire_factor(s, d->scale);

    if (d->kind == FIELD_FLOAT)
        return decode_float(raw);
    if (d->kind == FIELD_UNSIGNED)
        return (double)raw * factor;
    if (raw == sign && d->bits == 24)
        return decode_float(float_nan);
    return (double)((int64_t)(raw ^ sign) - (int64_t)sign) * factor;
}

void wire_encode(const struct wire_scene *s, const struct message *m, struct frame *f)
{
    const struct message_layout *l = wire_layout(m->kind);
    uint64_t word = (uint64_t)(m->counter & 0xFu) << COUNTER_START;

    ASSERT(l != NULL);
    for (int i = 0; i < l->n_fields; i++)
        word |= encode_field(s, &l->field[i], m->value[i]) << l->field[i].start;
    f->id = s->base_id + m->kind;
    f->flags = s->extended ? FRAME_EXTENDED : 0;
    f->length = FRAME_DATA;
    for (int i = 0; i < FRAME_DATA; i++)
        f->data[i] = (uint8_t)(word >> (8 * i));
    f->data[0] = wire_crc8(f->id, f->data, FRAME_DATA);
}

enum wire_status wire_decode(const struct wire_scene *s, const struct frame *f, struct message *m)
{
    uint32_t kind = f->id - s->base_id;
    const struct message_layout *l;
    uint64_t word = 0;

    if (kind >= WIRE_KINDS || ((f->flags & FRAME_EXTENDED) != 0) != s->extended)
        return WIRE_NOT_OURS;
    if (f->length != FRAME_DATA)
        return WIRE_BAD_LENGTH;
    l = wire_layout(kind);
    if (l == NULL)
        return WIRE_BAD_KIND;
    if (wire_crc8(f->id, f->data, FRAME_DATA) != f->data[0])
        return WIRE_BAD_CRC;
    if ((f->data[1] & 0xFu) >= WIRE_COUNTER_STATES)
        return WIRE_BAD_COUNTER;
    for (int i = 0; i < FRAME_DATA; i++)
        word |= (uint64_t)f->data[i] << (8 * i);
    m->kind = (uint8_t)kind;
    m->counter = f->data[1] & 0xFu;
    for (int i = 0; i < l->n_fields; i++)
        m->value[i] = decode_field(s, &l->field[i], word >> l->field[i].start & field_mask(&l->field[i]));
    if (m->kind == WIRE_LOCKIN && m->value[LOCKIN_AMPLITUDE] != m->value[LOCKIN_AMPLITUDE])
        m->value[LOCKIN_PHASE] = decode_float(float_nan); /* no amplitude has no phase either */
    return WIRE_OK;
}

double wire_lsb(double typical)
{
    static const double digit[3] = {5.0, 2.0, 1.0};
    double limit = typical * 1e-5;
    double lsb = 0.0;

    for (int k = POWER_OF_TEN_MAX; k >= -POWER_OF_TEN_MAX; k--) {
        double power = 1.0;
        for (int i = 0; i < (k < 0 ? -k : k); i++)
            power *= 10.0;
        for (int i = 0; i < 3; i++) {
            lsb = k < 0 ? digit[i] / power : digit[i] * power;
            if (lsb <= limit)
                return lsb;
        }
    }
    return lsb;
}
