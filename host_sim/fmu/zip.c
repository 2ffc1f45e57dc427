/* zip.c - see zip.h. A local header stands before each file, and all of them again at the end of the
 * archive. */
#include "host_sim/fmu/zip.h"

#include <limits.h>
#include <string.h>
#include "firmware/bus/wire.h"

enum {
    LOCAL_HEADER = 0x04034B50,
    DIRECTORY_HEADER = 0x02014B50,
    DIRECTORY_END = 0x06054B50,
    NEEDS = 10, /* version 1.0: stored files */
    MADE_BY_UNIX = 3 << 8 | NEEDS,
    FIRST_DAY = 1 << 5 | 1, /* 1 January 1980 */
    REGULAR_FILE = 0100644
};

/* Little endian. */
static void put(struct zip *z, unsigned long value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        (void)putc((int)(value >> 8 * i & 0xFF), z->out);
    z->at += (unsigned long)bytes;
}

/* Both headers of a file have this: version needed to the length of its name. */
static void put_entry(struct zip *z, const struct zip_entry *e)
{
    put(z, NEEDS, 2);
    put(z, 0, 2); /* flags */
    put(z, 0, 2); /* stored */
    put(z, 0, 2); /* midnight */
    put(z, FIRST_DAY, 2);
    put(z, e->crc, 4);
    put(z, e->size, 4);
    put(z, e->size, 4);
    put(z, strlen(e->name), 2);
    put(z, 0, 2); /* no extra field */
}

static void put_bytes(struct zip *z, const void *bytes, size_t n)
{
    (void)fwrite(bytes, 1, n, z->out);
    z->at += n;
}

void zip_begin(struct zip *z, FILE *out)
{
    z->out = out;
    z->at = 0;
    z->n = 0;
}

bool zip_add(struct zip *z, const char *name, const void *bytes, size_t n)
{
    if (z->n == ZIP_FILES || strlen(name) >= ZIP_NAME || n > INT_MAX)
        return false;
    struct zip_entry *e = &z->entry[z->n++];
    memcpy(e->name, name, strlen(name) + 1);
    e->crc = wire_crc32(0, bytes, (int)n);
    e->size = n;
    e->at = z->at;
    put(z, LOCAL_HEADER, 4);
    put_entry(z, e);
    put_bytes(z, name, strlen(name));
    put_bytes(z, bytes, n);
    return !ferror(z->out);
}

bool zip_end(struct zip *z)
{
    unsigned long begin = z->at;
    for (int i = 0; i < z->n; i++) {
        const struct zip_entry *e = &z->entry[i];
        put(z, DIRECTORY_HEADER, 4);
        put(z, MADE_BY_UNIX, 2);
        put_entry(z, e);
        put(z, 0, 2); /* no comment */
        put(z, 0, 2); /* first disk */
        put(z, 0, 2); /* internal attributes */
        put(z, (unsigned long)REGULAR_FILE << 16, 4);
        put(z, e->at, 4);
        put_bytes(z, e->name, strlen(e->name));
    }
    unsigned long size = z->at - begin;
    put(z, DIRECTORY_END, 4);
    put(z, 0, 4); /* this disk, and that of the directory */
    put(z, (unsigned long)z->n, 2);
    put(z, (unsigned long)z->n, 2);
    put(z, size, 4);
    put(z, begin, 4);
    put(z, 0, 2); /* no comment */
    return !ferror(z->out);
}
