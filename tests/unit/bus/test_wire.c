/* test_wire.c - bytes against independent bytes, round
 * trips at the limits, refusals, and the layout table. */
#include "tests/unit/test.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include "firmware/bus/wire.h"
#include "firmware/bus/wire_table.h"

static const struct wire_scene scene = {.base_id = 0x200, .lsb = {1e-9, 1e-5, 2e-9, 0.01}};

static const double infinite = HUGE_VAL, not_a_number = (double)NAN;

static uint64_t next_random(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return *state >> 16;
}

/* CRC-8 SAE J1850 (start 0xFF, final xor 0xFF) on the same kernel. */
static uint8_t crc_j1850(const uint8_t *data, int n)
{
    uint8_t crc = 0xFF;

    for (int i = 0; i < n; i++)
        crc = wire_crc8_byte(crc, data[i]);
    return crc ^ 0xFF;
}

/* The remainder of byte * x^8 by x^8 + x^4 + x^3 + x^2 + 1, one bit after the other. */
static uint8_t divided_by_bits(unsigned byte)
{
    for (int i = 0; i < 8; i++)
        byte = byte & 0x80u ? byte << 1 ^ 0x1Du : byte << 1;
    return (uint8_t)byte;
}

/* Check values: AUTOSAR "Specification of CRC Routines" (SAE J1850 table), the AUTOSAR E2E protocol's profile
 * 1 examples (data ID 0x123, both bytes in the CRC), and the CRC catalogue's "123456789". */
TEST(wire_crc)
{
    static const struct {
        int n;
        uint8_t data[9], crc;
    } j1850[] = {
        {4, {0x00, 0x00, 0x00, 0x00}, 0x59},
        {3, {0xF2, 0x01, 0x83}, 0x37},
        {4, {0x0F, 0xAA, 0x00, 0x55}, 0x79},
        {4, {0x00, 0xFF, 0x55, 0x11}, 0xB8},
        {9, {0x33, 0x22, 0x55, 0xAA, 0xBB, 0xCC, 0xDD, 0xEE, 0xFF}, 0xCB},
        {3, {0x92, 0x6B, 0x55}, 0x8C},
        {4, {0xFF, 0xFF, 0xFF, 0xFF}, 0x74},
        {9, {'1', '2', '3', '4', '5', '6', '7', '8', '9'}, 0x4B},
    };
    static const uint8_t nine[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
    uint8_t frame[8] = {0};
    int same = 0;

    for (unsigned crc = 0; crc < 256; crc++)
        for (unsigned byte = 0; byte < 256; byte++)
            same += wire_crc8_byte((uint8_t)crc, (uint8_t)byte) == divided_by_bits(crc ^ byte);
    check_int("CRCs and bytes whose remainder is that of a division bit by bit", same, 65536);
    for (size_t i = 0; i < sizeof j1850 / sizeof j1850[0]; i++)
        check_hex("CRC-8 SAE J1850", crc_j1850(j1850[i].data, j1850[i].n), j1850[i].crc);
    check_hex("profile 1, data ID 0x123, counter 0", wire_crc8(0x123, frame, 8), 0xCC);
    frame[1] = 1;
    check_hex("profile 1, data ID 0x123, counter 1", wire_crc8(0x123, frame, 8), 0x91);
    frame[0] = 0xA5;
    check_hex("the CRC byte itself does not count", wire_crc8(0x123, frame, 8), 0x91);
    check_hex("CRC-32 of 123456789", wire_crc32(0, nine, 9), 0xCBF43926);
    check_hex("CRC-32 in two pieces", wire_crc32(wire_crc32(0, nine, 4), nine + 4, 5), 0xCBF43926);
}

/* Made by a separate script from the bit positions of docs/reference/message_tables.md. */
static const struct {
    uint8_t kind, counter;
    double value[WIRE_FIELDS];
    uint8_t data[8];
} golden[] = {
    {WIRE_FIRE, 0, {5, 5, 1, 0.5, 2309737967}, {0xEA, 0x50, 0x15, 0x80, 0xEF, 0xCD, 0xAB, 0x89}},
    {WIRE_ENABLE, 3, {5, 1, 1234}, {0xB8, 0x53, 0x01, 0x00, 0xD2, 0x04, 0x00, 0x00}},
    {WIRE_CONTROL, 14, {15, CONTROL_RUN_UNTIL, 250, 64000}, {0x28, 0xFE, 0x05, 0xFA, 0x00, 0xFA, 0x00, 0x00}},
    {WIRE_CAPTURE, 1, {1, CAPTURE_READ, 258, 772}, {0x9D, 0x11, 0x03, 0x00, 0x02, 0x01, 0x04, 0x03}},
    {WIRE_STREAM + 2, 2, {5, 4660, -2.5}, {0x63, 0x52, 0x34, 0x12, 0x00, 0x00, 0x20, 0xC0}},
    {WIRE_ARM + 3, 4, {6, ARM_FREQUENCY, 229.5}, {0x8A, 0x64, 0x01, 0x00, 0x00, 0x80, 0x65, 0x43}},
    {WIRE_PARAM_WRITE, 5, {6, 65, 0.15625}, {0x32, 0x65, 0x41, 0x00, 0x00, 0x00, 0x20, 0x3E}},
    {WIRE_PARAM_COMMIT,
     6,
     {6, 2, COMMIT_WITH_FIRE, 3735928559},
     {0x62, 0x66, 0x02, 0x01, 0xEF, 0xBE, 0xAD, 0xDE}},
    {WIRE_PARAM_READ, 7, {6, 127}, {0x64, 0x67, 0x7F, 0x00, 0x00, 0x00, 0x00, 0x00}},
    {WIRE_DAC, 13, {5, 4660, -32768, 32767}, {0x76, 0x5D, 0x34, 0x12, 0x00, 0x80, 0xFF, 0x7F}},
    {WIRE_STATUS,
     8,
     {6, STATE_FROZEN, REACTION_FREEZE, 0, FAULT_TIMEOUT, 4294967295},
     {0x50, 0x68, 0x35, 0x20, 0xFF, 0xFF, 0xFF, 0xFF}},
    {WIRE_STATUS,
     8,
     {6, STATE_FROZEN, REACTION_FREEZE, 1, FAULT_TIMEOUT, 4294967295},
     {0xF0, 0x68, 0xB5, 0x20, 0xFF, 0xFF, 0xFF, 0xFF}},
    {WIRE_REPLY,
     9,
     {6, WIRE_FIRE, CAUSE_LATE, 13, 255, 300},
     {0x71, 0x69, 0x00, 0x02, 0x0D, 0xFF, 0x2C, 0x01}},
    {WIRE_EVENT_TIME, 10, {1, 3, 0.25, 305419896}, {0x94, 0x7A, 0x00, 0x40, 0x78, 0x56, 0x34, 0x12}},
    {WIRE_EVENT_DATA, 11, {0, 2, 0.5e-3, -3.0}, {0x23, 0x4B, 0x32, 0x00, 0x00, 0xD4, 0xFE, 0xFF}},
    {WIRE_MOTION, 12, {1, -7.0e-9, 83.88607}, {0x4F, 0x1C, 0xF9, 0xFF, 0xFF, 0xFF, 0xFF, 0x7F}},
    {WIRE_CONTACT, 13, {1, 1.5e-6, 64.0}, {0x3E, 0x1D, 0xEE, 0x02, 0x00, 0x00, 0x19, 0x00}},
    {WIRE_SYNC, 14, {43981, 16909060}, {0x37, 0x0E, 0xCD, 0xAB, 0x04, 0x03, 0x02, 0x01}},
    {WIRE_LOCKIN,
     0,
     {3, (double)1.0e-6f, -1.5707963267948966},
     {0x69, 0x30, 0xBD, 0x37, 0x86, 0x35, 0x00, 0xC0}},
    {WIRE_DRIVE_ECHO, 1, {2, ARM_PHASE, 0.75}, {0x0A, 0x21, 0x02, 0x00, 0x00, 0x00, 0x40, 0x3F}},
    {WIRE_LEDGER, 2, {LEDGER_RESIDUAL, -0.0625}, {0xD8, 0x02, 0x02, 0x00, 0x00, 0x00, 0x80, 0xBD}},
    {WIRE_HEALTH, 3, {40, 4294967294}, {0x10, 0x03, 0x28, 0x00, 0xFE, 0xFF, 0xFF, 0xFF}},
    {WIRE_PARAM_ECHO, 4, {0, 6.5}, {0xED, 0x04, 0x00, 0x00, 0x00, 0x00, 0xD0, 0x40}},
    {WIRE_HASH, 5, {187723572702975}, {0xE4, 0x05, 0xFF, 0xEE, 0xDD, 0xCC, 0xBB, 0xAA}},
    {WIRE_CAPTURE_DATA, 6, {4, 999, 1.0}, {0xDF, 0x46, 0xE7, 0x03, 0x00, 0x00, 0x80, 0x3F}},
    {WIRE_EVENT_SUMMARY, 7, {1000, 0.2, 65535}, {0xFA, 0x07, 0xE8, 0x03, 0x33, 0x33, 0xFF, 0xFF}},
    {WIRE_LATENCY, 8, {WIRE_STREAM, 9, 65535, 64}, {0x01, 0x08, 0x04, 0x09, 0xFF, 0xFF, 0x40, 0x00}},
    {WIRE_OVERRUN, 9, {2, 100000}, {0x77, 0x09, 0x02, 0x00, 0xA0, 0x86, 0x01, 0x00}},
    {WIRE_INFO, 10, {INFO_DILATION, 100.0}, {0xDA, 0x0A, 0x04, 0x00, 0x00, 0x00, 0xC8, 0x42}},
    {WIRE_SELF_TEST, 11, {10, SELF_TEST_FAILED, 0.015625}, {0x30, 0x0B, 0x0A, 0x02, 0x00, 0x00, 0x80, 0x3C}},
    {WIRE_WATCH, 12, {2, 4660, -0.5}, {0x2D, 0x2C, 0x34, 0x12, 0x00, 0x00, 0x00, 0xBF}},
    {WIRE_ADC, 14, {65535, -2, 258}, {0x5C, 0x0E, 0xFF, 0xFF, 0xFE, 0xFF, 0x02, 0x01}},
    {WIRE_STREAM_ECHO + 1, 9, {65534, -0.3125}, {0x98, 0x09, 0xFE, 0xFF, 0x00, 0x00, 0xA0, 0xBE}},
};

enum { GOLDEN = sizeof golden / sizeof golden[0] };

static uint64_t word_of(const uint8_t *data)
{
    uint64_t word = 0;

    for (int i = 0; i < 8; i++)
        word = word << 8 | data[i];
    return word;
}

static struct message golden_message(int i)
{
    struct message m = {golden[i].kind, golden[i].counter, {0}};

    memcpy(m.value, golden[i].value, sizeof m.value);
    return m;
}

TEST(wire_golden)
{
    for (int i = 0; i < GOLDEN; i++) {
        const struct message_layout *l = wire_layout(golden[i].kind);
        struct message m = golden_message(i), back = {0};
        struct frame f;
        double worst = 0.0;

        wire_encode(&scene, &m, &f);
        check_hex(l->name, word_of(f.data), word_of(golden[i].data));
        check_int("  identifier", f.id, 0x200 + golden[i].kind);
        check_int("  length", f.length, 8);
        memcpy(f.data, golden[i].data, sizeof f.data);
        check_int("  decodes", wire_decode(&scene, &f, &back), WIRE_OK);
        for (int k = 0; k < l->n_fields; k++)
            worst = fmax(worst, fabs(back.value[k] - m.value[k]) / fmax(fabs(m.value[k]), 1e-30));
        check_below("  values, relative", worst, 4e-16);
        check_is("  kind and counter", back.kind, ==, m.kind);
        check_is("  kind and counter", back.counter, ==, m.counter);
    }
}

/* A value that field d holds exactly: limits in rounds 0 and 1, then at random. */
static double pick(const struct field *d, int round, uint64_t *seed)
{
    double span = ldexp(1.0, d->bits);
    bool angle = d->scale == SCALE_ANGLE;
    double low = d->kind == FIELD_SIGNED ? (angle ? -span / 2.0 : 1.0 - span / 2.0) : 0.0;
    double high = d->kind == FIELD_SIGNED ? span / 2.0 - 1.0 : span - 1.0;
    double random = floor(low + (high - low) * ldexp((double)(next_random(seed) >> 16), -32));

    if (d->kind == FIELD_FLOAT && round < 2)
        return round == 0 ? -(double)FLT_MAX : 0x1p-149;
    if (d->kind == FIELD_FLOAT)
        return (double)(float)ldexp(1.0 + ldexp((double)(next_random(seed) >> 16), -32),
                                    (int)(random / 1e8) - 20);
    return (round == 0 ? low : round == 1 ? high : random) * wire_factor(&scene, d->scale);
}

/* Rounds in which decode(encode(x)) was not x, to the bit. */
static int round_trip_errors(unsigned kind, uint64_t *seed)
{
    const struct message_layout *l = wire_layout(kind);
    int errors = 0;

    for (int round = 0; round < 2000; round++) {
        struct message m = {(uint8_t)kind, (uint8_t)(round % 15), {0}}, back = {0};
        struct frame f;
        for (int i = 0; i < l->n_fields; i++)
            m.value[i] = pick(&l->field[i], round, seed);
        wire_encode(&scene, &m, &f);
        errors += wire_decode(&scene, &f, &back) != WIRE_OK || memcmp(&m, &back, sizeof m) != 0;
    }
    return errors;
}

TEST(wire_round_trip)
{
    uint64_t seed = 1;

    for (unsigned kind = 0; kind < WIRE_KINDS; kind++)
        if (wire_layout(kind))
            check_int(wire_layout(kind)->name, round_trip_errors(kind, &seed), 0);
}

/* One field's value after encoding and decoding. */
static double through(unsigned kind, int field, double value)
{
    struct message m = {(uint8_t)kind, 0, {0}};
    struct frame f;

    m.value[field] = value;
    wire_encode(&scene, &m, &f);
    check_int("  decodes", wire_decode(&scene, &f, &m), WIRE_OK);
    return m.value[field];
}

TEST(wire_limits)
{
    check_near("int24 half a unit rounds away", through(WIRE_MOTION, MOTION_DISPLACEMENT, 0.5e-9), 1e-9, 0.0);
    check_near("int24 minus half a unit too", through(WIRE_MOTION, MOTION_DISPLACEMENT, -0.5e-9), -1e-9, 0.0);
    check_near("int24 just below half", through(WIRE_MOTION, MOTION_DISPLACEMENT, 0.4999999e-9), 0.0, 0.0);
    check_near("int24 largest", through(WIRE_MOTION, MOTION_DISPLACEMENT, 8388607.4e-9), 8388607e-9, 1e-17);
    check_near("int24 smallest", through(WIRE_MOTION, MOTION_DISPLACEMENT, -8388607.4e-9), -8388607e-9,
               1e-17);
    check_nan("int24 too large", through(WIRE_MOTION, MOTION_DISPLACEMENT, 8388607.6e-9));
    check_nan("int24 too small", through(WIRE_MOTION, MOTION_DISPLACEMENT, -8388607.6e-9));
    check_nan("int24 far too large", through(WIRE_MOTION, MOTION_DISPLACEMENT, 1e300));
    check_nan("int24 infinite", through(WIRE_MOTION, MOTION_DISPLACEMENT, -infinite));
    check_nan("int24 not a number", through(WIRE_MOTION, MOTION_DISPLACEMENT, not_a_number));
    const struct wire_scene ones = {.base_id = 0x200, .lsb = {1.0, 1.0, 1.0, 1.0}};
    static const double beyond[] = {8388607.5, -8388607.5, 8388608.4, -8388608.4};
    for (int i = 0; i < 4; i++) {
        struct message m = {.kind = WIRE_MOTION, .value = {0.0, beyond[i]}}, back = {0};
        struct frame f;
        wire_encode(&ones, &m, &f);
        (void)wire_decode(&ones, &f, &back);
        check_nan("int24 that would round to beyond its largest", back.value[MOTION_DISPLACEMENT]);
    }
    check_near("unsigned negative", through(WIRE_SYNC, SYNC_TICK, -3.0), 0.0, 0.0);
    check_near("unsigned too large", through(WIRE_SYNC, SYNC_TICK, 1e300), 4294967295.0, 0.0);
    check_near("unsigned infinite", through(WIRE_SYNC, SYNC_FRAME, infinite), 65535.0, 0.0);
    check_near("unsigned not a number", through(WIRE_SYNC, SYNC_TICK, not_a_number), 0.0, 0.0);
    check_near("fraction 1 of a tick", through(WIRE_EVENT_TIME, EVENT_TIME_FRACTION, 1.0), 65535.0 / 65536.0,
               0.0);
    check_near("loss of all contact", through(WIRE_EVENT_SUMMARY, SUMMARY_LOSS, 1.0), 1.0, 0.0);
    check_near("angle pi wraps", through(WIRE_LOCKIN, LOCKIN_PHASE, M_PI), -M_PI, 1e-15);
    check_near("angle -7 rad wraps", through(WIRE_LOCKIN, LOCKIN_PHASE, -7.0), 2.0 * M_PI - 7.0,
               M_PI / 65536.0);
    check_near("angle not a number", through(WIRE_LOCKIN, LOCKIN_PHASE, not_a_number), 0.0, 0.0);
    struct message unknown = {.kind = WIRE_LOCKIN, .value = {2.0, not_a_number, 1.0}};
    struct frame f;
    wire_encode(&scene, &unknown, &f);
    check_int("LOCKIN without an amplitude", wire_decode(&scene, &f, &unknown), WIRE_OK);
    check_nan("has no phase", unknown.value[LOCKIN_PHASE]);
    check_near("float rounds to nearest", through(WIRE_ARM, ARM_VALUE, 0.1), (double)0.1f, 0.0);
    check_near("float largest", through(WIRE_ARM, ARM_VALUE, (double)FLT_MAX), (double)FLT_MAX, 0.0);
    check_is("float beyond is infinite", through(WIRE_ARM, ARM_VALUE, 1e300), ==, infinite);
    check_is("float below is infinite", through(WIRE_ARM, ARM_VALUE, -1e300), ==, -infinite);
    check_is("float infinite", through(WIRE_STREAM, STREAM_SAMPLE, -infinite), ==, -infinite);
    check_nan("float not a number", through(WIRE_STREAM, STREAM_SAMPLE, not_a_number));
    check_is("float minus zero", signbit(through(WIRE_STREAM, STREAM_SAMPLE, -0.0)), !=, 0);
}

/* Decodes and checks that a refusal leaves the message alone. */
static void check_refused(const char *name, const struct wire_scene *s, const struct frame *f,
                          enum wire_status expected)
{
    struct message m, before;

    memset(&m, 0x5A, sizeof m);
    before = m;
    check_int(name, wire_decode(s, f, &m), expected);
    check_bytes("  message untouched", &m, &before, sizeof m);
}

TEST(wire_refusals)
{
    struct message m = golden_message(1);
    struct wire_scene other = scene,
                      extended = {.base_id = 0x18FF0040, .extended = true, .lsb = {1, 1, 1, 1}};
    struct frame good, f;

    wire_encode(&scene, &m, &good);
    for (int length = 0; length < 8; length++) {
        f = good;
        f.length = (uint8_t)length;
        check_refused("truncated", &scene, &f, WIRE_BAD_LENGTH);
    }
    f = good;
    f.length = 9;
    check_refused("too long", &scene, &f, WIRE_BAD_LENGTH);
    f = good;
    f.flags = FRAME_EXTENDED;
    check_refused("29-bit identifier", &scene, &f, WIRE_NOT_OURS);
    f = good;
    f.id = 0x1FF;
    check_refused("identifier below", &scene, &f, WIRE_NOT_OURS);
    f.id = 0x240;
    check_refused("identifier above", &scene, &f, WIRE_NOT_OURS);
    other.base_id = 0x240;
    check_refused("the neighbour's frame", &other, &good, WIRE_NOT_OURS);
    f = good;
    f.id = 0x200 + WIRE_CONTROL;
    check_refused("another command's identifier", &scene, &f, WIRE_BAD_CRC);
    f.id = 0x200 + 0x29;
    check_refused("unused identifier, CRC not looked at", &scene, &f, WIRE_BAD_KIND);
    f.id = 0x200 + 0x3F;
    check_refused("last unused identifier", &scene, &f, WIRE_BAD_KIND);
    f = good;
    f.data[1] |= 0x0F;
    check_refused("counter 15, wrong CRC", &scene, &f, WIRE_BAD_CRC);
    f.data[0] = wire_crc8(f.id, f.data, 8);
    check_refused("counter 15", &scene, &f, WIRE_BAD_COUNTER);
    wire_encode(&extended, &m, &f);
    check_hex("29-bit identifier kept", f.id, 0x18FF0041);
    check_int("29-bit flag", f.flags, FRAME_EXTENDED);
    check_int("29-bit identifier accepted", wire_decode(&extended, &f, &m), WIRE_OK);
    f.flags = 0;
    check_refused("29-bit identifier without its flag", &extended, &f, WIRE_NOT_OURS);
    f = good;
    f.data[2] |= 0x80; /* an unused bit of ENABLE */
    f.data[0] = wire_crc8(f.id, f.data, 8);
    check_int("unused bits are ignored", wire_decode(&scene, &f, &m), WIRE_OK);
    check_near("  REQUEST", m.value[ENABLE_REQUEST], 1.0, 0.0);
}

TEST(wire_flipped_bits)
{
    for (int i = 0; i < GOLDEN; i++) {
        struct message m = golden_message(i);
        struct frame f;
        int refused = 0;

        wire_encode(&scene, &m, &f);
        for (int bit = 0; bit < 64; bit++) {
            f.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
            refused += wire_decode(&scene, &f, &m) == WIRE_BAD_CRC;
            f.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
        }
        check_int(wire_layout(golden[i].kind)->name, refused, 64);
    }
}

/* As docs/reference/protocol.md states: errors of two bits and
 * bursts of up to 7 bits never pass. Bits in the order sent. */
TEST(wire_bursts)
{
    struct message m = golden_message(0);
    struct frame good, f;
    int pairs = 0, bursts = 0, n_bursts = 0;

    wire_encode(&scene, &m, &good);
    for (int a = 0; a < 64; a++)
        for (int b = 0; b < a; b++) {
            f = good;
            f.data[a / 8] ^= (uint8_t)(1 << a % 8);
            f.data[b / 8] ^= (uint8_t)(1 << b % 8);
            pairs += wire_decode(&scene, &f, &m) == WIRE_BAD_CRC;
        }
    for (int first = 0; first <= 64 - 7; first++)
        for (unsigned pattern = 1; pattern < 128; pattern++) {
            f = good;
            for (int i = 0; i < 7; i++)
                f.data[(first + i) / 8] ^= (uint8_t)((pattern >> i & 1u) << (7 - (first + i) % 8));
            bursts += wire_decode(&scene, &f, &m) == WIRE_BAD_CRC;
            n_bursts++;
        }
    check_int("errors of two bits", pairs, 64 * 63 / 2);
    check_int("bursts", bursts, n_bursts);
}

TEST(wire_layouts)
{
    int n = 0, bad = 0, commands = 0;

    for (unsigned kind = 0; kind < 300; kind++) {
        const struct message_layout *l = wire_layout(kind);
        uint64_t used = 0xFFF; /* CHECKSUM and COUNTER */
        if (!l)
            continue;
        n++;
        commands += l->command;
        bad += l->command != (kind < WIRE_COMMANDS) || l->n_fields > WIRE_FIELDS || l->kind > kind;
        for (int i = 0; i < l->n_fields; i++) {
            uint64_t bits = (((uint64_t)1 << l->field[i].bits) - 1) << l->field[i].start;
            bad += (used & bits) != 0 || l->field[i].start + l->field[i].bits > 64;
            used |= bits;
        }
    }
    check_int("kinds", n, 41);
    check_int("commands", commands, 16);
    check_int("overlapping or misplaced fields", bad, 0);
}

TEST(wire_lsb)
{
    static const struct {
        double typical, lsb;
    } series[] = {{1.0, 1e-5},      {1.9, 1e-5},  {2.0, 2e-5},      {4.99, 2e-5},  {5.0, 5e-5},
                  {9.99, 5e-5},     {10.0, 1e-4}, {7.07e-6, 5e-11}, {1e-6, 1e-11}, {1e-12, 1e-17},
                  {3.3e-15, 2e-20}, {64.0, 5e-4}, {1e5, 1.0},       {2.5e9, 2e4}};
    double worst = 1e300;

    for (size_t i = 0; i < sizeof series / sizeof series[0]; i++)
        check_near("LSB", wire_lsb(series[i].typical), series[i].lsb, 0.0);
    for (double typical = 1e-15; typical < 1e15; typical *= 1.07)
        worst = fmin(worst, wire_lsb(typical) * 8388607.0 / typical);
    check_above("full scale over typical, the least", worst, 33.0);
    check_near("nothing typical", wire_lsb(0.0), 1e-22, 0.0);
}
