/* pcapng.c - see pcapng.h. */
#include "hal/posix/pcapng.h"

#include <string.h>
#include "hal/hal.h"

enum {
    BLOCK_SECTION = 0x0A0D0D0A,
    BLOCK_INTERFACE = 1,
    BLOCK_PACKET = 6,
    BYTE_ORDER_MARK = 0x1A2B3C4D,
    LINK_CAN = 227,
    OPTION_COMMENT = 1, /* may stand in every block */
    OPTION_NAME = 2,    /* in the block of an interface */
    OPTION_PROGRAM = 4, /* in the block of a section */
    OPTION_RESOLUTION = 9,
    OPTION_FLAGS = 2, /* in the block of a packet */
    FLAGS_IN = 1,
    FLAGS_OUT = 2,
    NANOSECONDS = 9,
    MICROSECONDS = 6, /* where an interface does not say */
    BLOCK_FRAME = 12, /* type, length, and the length again behind the body */
    BODY = 1 << 10,   /* bytes of a body that are looked at; a frame has 72 */
    OPTIONS = 512,
    CAN_HEADER = 8,
    CAN_FD_FRAME = 72,
    CAN_FDF = 0x04
};

#define CAN_EXTENDED 0x80000000u
#define CAN_REMOTE   0x40000000u
#define CAN_ERROR    0x20000000u

/* ---- writing ---- */

static void put_low(uint8_t *to, uint32_t value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        to[i] = (uint8_t)(value >> 8 * i);
}

static uint32_t padded(uint32_t n)
{
    return (n + 3u) & ~3u;
}

/* The options of a block, as they are put together. */
struct some {
    uint8_t bytes[OPTIONS];
    uint32_t n;
};

static void add(struct some *o, unsigned code, const void *value, size_t length)
{
    uint32_t n = length < OPTIONS - 64u ? (uint32_t)length : OPTIONS - 64u;
    if (o->n + 8 + padded(n) > OPTIONS)
        return;
    put_low(o->bytes + o->n, code, 2);
    put_low(o->bytes + o->n + 2, n, 2);
    memset(o->bytes + o->n + 4, 0, padded(n));
    memcpy(o->bytes + o->n + 4, value, n);
    o->n += 4 + padded(n);
}

static void put_block(FILE *f, uint32_t type, const uint8_t *body, uint32_t n, struct some *o)
{
    static const uint8_t nothing[4] = {0};
    uint8_t head[8], tail[4];
    uint32_t end = o->n ? 4 : 0, length = BLOCK_FRAME + padded(n) + o->n + end;
    put_low(head, type, 4);
    put_low(head + 4, length, 4);
    put_low(tail, length, 4);
    (void)fwrite(head, 1, sizeof head, f);
    (void)fwrite(body, 1, n, f);
    (void)fwrite(nothing, 1, padded(n) - n, f);
    (void)fwrite(o->bytes, 1, o->n, f);
    (void)fwrite(nothing, 1, end, f);
    (void)fwrite(tail, 1, sizeof tail, f);
}

void pcapng_begin(FILE *f, const char *program, const char *const *interface, int n)
{
    uint8_t section[16], of_can[8] = {LINK_CAN};
    const uint8_t resolution = NANOSECONDS;
    struct some o = {.n = 0};
    put_low(section, BYTE_ORDER_MARK, 4);
    put_low(section + 4, 1, 4); /* version 1.0 */
    memset(section + 8, 0xFF, 8);
    add(&o, OPTION_PROGRAM, program, strlen(program));
    put_block(f, BLOCK_SECTION, section, sizeof section, &o);
    for (int i = 0; i < n; i++) {
        o.n = 0;
        add(&o, OPTION_NAME, interface[i], strlen(interface[i]));
        add(&o, OPTION_RESOLUTION, &resolution, 1);
        put_block(f, BLOCK_INTERFACE, of_can, sizeof of_can, &o);
    }
}

/* The frame as it stands behind the header of a packet; its length. */
static uint32_t can_of(const struct log_raw *raw, uint8_t *to)
{
    uint32_t id = raw->id | (raw->extended && !(raw->id & CAN_ERROR) ? CAN_EXTENDED : 0u) |
                  (raw->remote ? CAN_REMOTE : 0u);
    memset(to, 0, CAN_FD_FRAME);
    for (int i = 0; i < 4; i++)
        to[i] = (uint8_t)(id >> 8 * (3 - i));
    to[4] = raw->length;
    to[5] = raw->fd ? (uint8_t)(raw->flags | CAN_FDF) : 0;
    memcpy(to + CAN_HEADER, raw->data, raw->fd ? LOG_FD_DATA : FRAME_DATA);
    return raw->fd ? CAN_FD_FRAME : CAN_HEADER + FRAME_DATA;
}

void pcapng_put(FILE *f, int i, uint64_t time_us, enum log_way way, const struct log_raw *raw,
                const char *comment)
{
    uint8_t body[20 + CAN_FD_FRAME], flags[4] = {0};
    uint64_t ns = time_us * 1000u;
    uint32_t length = can_of(raw, body + 20);
    struct some o = {.n = 0};
    put_low(body, (uint32_t)i, 4);
    put_low(body + 4, (uint32_t)(ns >> 32), 4);
    put_low(body + 8, (uint32_t)ns, 4);
    put_low(body + 12, length, 4);
    put_low(body + 16, length, 4);
    if (*comment)
        add(&o, OPTION_COMMENT, comment, strlen(comment));
    flags[0] = way == LOG_RECEIVED ? FLAGS_IN : way == LOG_SENT ? FLAGS_OUT : 0;
    if (flags[0])
        add(&o, OPTION_FLAGS, flags, sizeof flags);
    put_block(f, BLOCK_PACKET, body, 20 + length, &o);
}

/* ---- reading ---- */

static uint32_t number(const struct pcapng *p, const uint8_t *at, int bytes)
{
    uint32_t value = 0;
    for (int i = 0; i < bytes; i++)
        value |= (uint32_t)at[i] << 8 * (p->swapped ? bytes - 1 - i : i);
    return value;
}

/* The value of an option in options[0..n), and its length; NULL where it is none of them. */
static const uint8_t *find(const struct pcapng *p, const uint8_t *at, uint32_t n, unsigned code,
                           uint32_t *length)
{
    for (uint32_t i = 0; i + 4 <= n;) {
        unsigned this = number(p, at + i, 2);
        *length = number(p, at + i + 2, 2);
        if (!this || i + 4 + padded(*length) > n)
            return NULL;
        if (this == code)
            return at + i + 4;
        i += 4 + padded(*length);
    }
    return NULL;
}

static void begin_section(struct pcapng *p, const uint8_t *body)
{
    memset(p, 0, sizeof *p);
    p->swapped = body[0] == (BYTE_ORDER_MARK >> 24);
}

/* A name that a line of candump may have. */
static void name_interface(struct pcapng_interface *on, uint32_t i, const uint8_t *name, uint32_t n)
{
    bool fits = name && n > 0 && n < LOG_INTERFACE;
    for (uint32_t k = 0; fits && k < n; k++)
        fits = name[k] > ' ' && name[k] < 0x7F;
    if (fits)
        memcpy(on->name, name, n);
    else
        snprintf(on->name, sizeof on->name, "interface%u", (unsigned)i);
}

static bool begin_interface(struct pcapng *p, const uint8_t *body, uint32_t n)
{
    uint32_t length;
    if (p->n_interfaces == PCAPNG_INTERFACES || n < 8)
        return false;
    struct pcapng_interface *on = &p->interface[p->n_interfaces];
    const uint8_t *name = find(p, body + 8, n - 8, OPTION_NAME, &length);
    memset(on, 0, sizeof *on);
    name_interface(on, p->n_interfaces, name, length);
    on->is_can = number(p, body, 2) == LINK_CAN;
    const uint8_t *resolution = find(p, body + 8, n - 8, OPTION_RESOLUTION, &length);
    on->power = resolution && length ? *resolution & 0x7F : MICROSECONDS;
    on->binary = resolution && length && *resolution & 0x80;
    p->n_interfaces++;
    bool tells_time = on->power <= (on->binary ? 63 : 19);
    on->is_can = on->is_can && tells_time; /* else its packets are passed over */
    return tells_time;
}

static uint64_t power_of_10(unsigned n)
{
    uint64_t value = 1;
    while (n--)
        value *= 10;
    return value;
}

/* Seconds and nanoseconds of a stamp. */
static uint64_t seconds_of(const struct pcapng_interface *on, uint64_t stamp, uint32_t *ns)
{
    if (on->binary) {
        uint64_t part = on->power ? stamp << (64 - on->power) >> 32 : 0; /* its first 32 bits */
        *ns = (uint32_t)(part * 1000000000u >> 32);
        return stamp >> on->power;
    }
    uint64_t unit = power_of_10(on->power), part = stamp % unit;
    *ns = (uint32_t)(on->power <= NANOSECONDS ? part * power_of_10(NANOSECONDS - on->power)
                                              : part / power_of_10(on->power - NANOSECONDS));
    return stamp / unit;
}

static int put_bytes(char *text, const uint8_t *data, int n)
{
    int length = 0;
    for (int i = 0; i < n; i++)
        length += snprintf(text + length, 3, "%02X", data[i]);
    return length;
}

/* "0C4#11223344", from the bytes of a SocketCAN frame. False where they are none. */
static bool frame_text(const uint8_t *can, uint32_t captured, char *text)
{
    uint32_t word = (uint32_t)can[0] << 24 | (uint32_t)can[1] << 16 | (uint32_t)can[2] << 8 | can[3];
    bool long_id = word & (CAN_EXTENDED | CAN_ERROR), fd = captured == CAN_FD_FRAME || can[5] & CAN_FDF;
    uint32_t id = word & ~(CAN_EXTENDED | CAN_REMOTE), length = can[4];
    bool remote = word & CAN_REMOTE && !(word & CAN_ERROR);
    uint32_t held = remote ? 0 : length;
    if (length > (fd ? LOG_FD_DATA : FRAME_DATA) || CAN_HEADER + held > captured)
        return false;
    text += long_id ? snprintf(text, 16, "%08X#", (unsigned)id) : snprintf(text, 16, "%03X#", (unsigned)id);
    if (remote)
        snprintf(text, 16, "R%X", (unsigned)length);
    else if (fd)
        put_bytes(text + snprintf(text, 16, "#%X", can[5] & ~CAN_FDF & 0xF), can + CAN_HEADER, (int)length);
    else
        put_bytes(text, can + CAN_HEADER, (int)length);
    return true;
}

/* The line of an enhanced packet block, whose body has n bytes. NULL, or what is wrong with it; *passed: it
 * is of another link. */
static const char *line_of(const struct pcapng *p, const uint8_t *body, uint32_t n, char *text, bool *passed)
{
    uint32_t i = number(p, body, 4), captured = n >= 20 ? number(p, body + 12, 4) : 0, ns, length;
    if (n < 20 || captured > n - 20 || i >= p->n_interfaces)
        return "a packet that is longer than its block, or of no interface";
    const struct pcapng_interface *on = &p->interface[i];
    *passed = !on->is_can;
    if (*passed)
        return NULL;
    uint64_t s = seconds_of(on, (uint64_t)number(p, body + 4, 4) << 32 | number(p, body + 8, 4), &ns);
    int head = snprintf(text, PCAPNG_LINE, "(%llu.%09u) %s ", (unsigned long long)s, (unsigned)ns, on->name);
    if (captured < CAN_HEADER || !frame_text(body + 20, captured, text + head))
        return "a packet that is no frame of SocketCAN";
    uint32_t at = 20 + padded(captured);
    const uint8_t *flags = at <= n ? find(p, body + at, n - at, OPTION_FLAGS, &length) : NULL;
    unsigned way = flags && length == 4 ? number(p, flags, 4) & 3u : 0;
    strcat(text, way == FLAGS_IN ? " R" : way == FLAGS_OUT ? " T" : "");
    return NULL;
}

/* Reads a block: its type, and up to BODY bytes of its body; the rest is passed over. */
static enum pcapng_got read_block(struct pcapng *p, FILE *f, uint32_t *type, uint8_t body[BODY], uint32_t *n)
{
    uint8_t head[12], tail[4];
    size_t got = fread(head, 1, 8, f);
    if (got < 8)
        return got ? PCAPNG_CUT : PCAPNG_END;
    *type = number(p, head, 4);
    if (*type == BLOCK_SECTION) { /* its length is in the order that its mark tells */
        if (fread(head + 8, 1, 4, f) < 4)
            return PCAPNG_CUT;
        begin_section(p, head + 8);
        (void)fseek(f, -4, SEEK_CUR);
    }
    uint32_t length = number(p, head + 4, 4);
    if (length < BLOCK_FRAME || length % 4) {
        (void)fseek(f, 0, SEEK_END); /* where the next one begins is not known */
        return PCAPNG_DAMAGED;
    }
    *n = length - BLOCK_FRAME;
    uint32_t kept = *n < BODY ? *n : BODY;
    if (fread(body, 1, kept, f) < kept)
        return PCAPNG_CUT;
    for (uint32_t i = kept; i < *n; i++) /* bounded by the file */
        if (getc_unlocked(f) == EOF)
            return PCAPNG_CUT;
    *n = kept;
    return fread(tail, 1, sizeof tail, f) < sizeof tail ? PCAPNG_CUT : PCAPNG_PACKET;
}

bool pcapng_is(FILE *f)
{
    uint8_t head[4];
    bool is = fread(head, 1, sizeof head, f) == sizeof head && memcmp(head, "\n\r\r\n", sizeof head) == 0;
    rewind(f);
    return is;
}

enum pcapng_got pcapng_next(struct pcapng *p, FILE *f, char text[PCAPNG_LINE], const char **why)
{
    uint8_t body[BODY];
    uint32_t type, n;
    enum pcapng_got got;
    *why = "a block whose length is none";
    while ((got = read_block(p, f, &type, body, &n)) == PCAPNG_PACKET) {
        bool passed = false;
        *why = NULL;
        if (type == BLOCK_INTERFACE && !begin_interface(p, body, n))
            *why = "an interface beyond the eighth, or with a resolution that is none";
        else if (type == BLOCK_PACKET)
            *why = line_of(p, body, n, text, &passed);
        if (*why)
            return PCAPNG_DAMAGED;
        if (type == BLOCK_PACKET && !passed)
            return PCAPNG_PACKET;
    }
    return got;
}
