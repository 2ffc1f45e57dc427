/* png.c - see png.h. Each line is a stored block of deflate (RFC 1950, 1951; PNG 1.2). */
#include "host_sim/afm/png.h"

#include <stdint.h>
#include <string.h>
#include "firmware/bus/wire.h"

struct png {
    FILE *f;
    uint32_t crc, a, b; /* crc belongs to the chunk; a and b are the Adler-32 of the values */
};

static void put_bytes(struct png *p, const unsigned char *byte, size_t n)
{
    fwrite(byte, 1, n, p->f);
    p->crc = wire_crc32(p->crc, byte, (int)n);
}

static void put_32(struct png *p, uint32_t value)
{
    put_bytes(p, (unsigned char[]){value >> 24, value >> 16 & 0xFF, value >> 8 & 0xFF, value & 0xFF}, 4);
}

static void begin_chunk(struct png *p, uint32_t length, const char *kind)
{
    put_32(p, length);
    p->crc = 0; /* its length is not in it */
    put_bytes(p, (const unsigned char *)kind, 4);
}

static void put_value(struct png *p, unsigned char value)
{
    put_bytes(p, &value, 1);
    p->a = (p->a + value) % 65521;
    p->b = (p->b + p->a) % 65521;
}

/* A tEXt chunk: keyword and text. */
static void put_about(struct png *p, const char *about)
{
    static const char keyword[] = "Description";
    size_t n = strlen(about);
    begin_chunk(p, (uint32_t)(sizeof keyword + n), "tEXt");
    put_bytes(p, (const unsigned char *)keyword, sizeof keyword);
    put_bytes(p, (const unsigned char *)about, n);
    put_32(p, p->crc);
}

void png_write(FILE *f, const unsigned char *grey, size_t width, size_t height, const char *about)
{
    static const unsigned char signature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    struct png p = {.f = f, .a = 1};
    uint32_t length = (uint32_t)width + 1; /* with the filter's number */
    put_bytes(&p, signature, sizeof signature);
    begin_chunk(&p, 13, "IHDR");
    put_32(&p, (uint32_t)width);
    put_32(&p, (uint32_t)height);
    put_bytes(&p, (const unsigned char[]){8, 0, 0, 0, 0}, 5);
    put_32(&p, p.crc);
    if (about)
        put_about(&p, about);
    begin_chunk(&p, 2 + (uint32_t)height * (length + 5) + 4, "IDAT");
    put_bytes(&p, (const unsigned char[]){0x78, 0x01}, 2);
    for (size_t y = 0; y < height; y++) {
        put_bytes(&p,
                  (unsigned char[]){y + 1 == height, length & 0xFF, length >> 8, ~length & 0xFF,
                                    ~length >> 8 & 0xFF},
                  5);
        put_value(&p, 0);
        for (size_t x = 0; x < width; x++)
            put_value(&p, grey[y * width + x]);
    }
    put_32(&p, p.b << 16 | p.a);
    put_32(&p, p.crc);
    begin_chunk(&p, 0, "IEND");
    put_32(&p, p.crc);
}
