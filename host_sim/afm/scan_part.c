/* scan_part.c - see scan_part.h. */
#include "host_sim/afm/scan_part.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include "firmware/plant/hash.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/files.h"

/* The file: this, then station, piezo, sensor and the image's channels as they are in memory. */
struct head {
    char magic[16];
    uint64_t identity, size, check; /* which scan it is; bytes behind the head, and their hash */
};
static const char part_magic[16] = "contactplant 1\n";

static uint64_t hash_bytes(uint64_t hash, const void *data, size_t n)
{
    const unsigned char *byte = data;
    uint64_t word = 0;
    for (size_t i = 0; i < n; i++) {
        word = word << 8 | byte[i];
        if (i % 8 == 7 || i + 1 == n)
            hash = hash_word(hash, word);
    }
    return hash;
}

/* A surface of --surface: two files may have equal counts, of other heights or over another area. */
static uint64_t hash_surface(uint64_t h, const struct surface_grid *g, const int16_t *count)
{
    h = hash_word(hash_word(h, g->nx), g->ny);
    h = hash_double(hash_double(hash_double(h, g->width), g->length), g->m_per_1);
    return hash_bytes(h, count, (size_t)g->nx * g->ny * sizeof *count);
}

/* All that decides the image, and the layout of what is kept. */
static uint64_t identity(const struct afm_bench *b)
{
    uint64_t h = hash_bytes(HASH_BEGIN, b->si, LEVER_PARAMETERS * sizeof b->si[0]);
    h = hash_bytes(h, b->number, sizeof b->number);
    h = hash_bytes(h, b->scene.stage, sizeof b->scene.stage);
    h = hash_double(h, b->tick_s);
    h = hash_word(h, sizeof b->station);
    h = hash_word(h, sizeof b->piezo);
    return b->count ? hash_surface(h, &b->grid, b->count) : h;
}

/* The parts of the file in their order, from a bench and an image. Returns how many. */
enum { PARTS = 3 + 2 * SCAN_CHANNELS };
struct piece {
    void *data;
    size_t size;
};

static void list_pieces(struct afm_bench *b, const struct scan_image *m, struct piece piece[PARTS])
{
    piece[0] = (struct piece){&b->station, sizeof b->station};
    piece[1] = (struct piece){&b->piezo, sizeof b->piezo};
    piece[2] = (struct piece){&b->sensor, sizeof b->sensor};
    for (int i = 0; i < 2 * SCAN_CHANNELS; i++)
        piece[3 + i] = (struct piece){m->value[i / SCAN_CHANNELS][i % SCAN_CHANNELS],
                                      m->pixels * m->lines * sizeof(float)};
}

static struct head head_of(const struct afm_bench *b, const struct piece piece[PARTS])
{
    struct head h = {.identity = identity(b), .check = HASH_BEGIN};
    memcpy(h.magic, part_magic, sizeof part_magic);
    for (int i = 0; i < PARTS; i++) {
        h.size += piece[i].size;
        h.check = hash_bytes(h.check, piece[i].data, piece[i].size);
    }
    return h;
}

int scan_part_open(struct scan_part *p, const struct afm_bench *b, const char *directory)
{
    int n = snprintf(p->path, sizeof p->path, "%s/scan.part", directory);
    p->kept_s = clock_now_s();
    p->lock = n < SCAN_PATH ? open(directory, O_RDONLY | O_CLOEXEC) : -1;
    if (p->lock < 0)
        return options_failure(b->usage, "cannot open --out %s: %s", directory,
                               n < SCAN_PATH ? strerror(errno) : "too long a name");
    if (flock(p->lock, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        return options_failure(b->usage, "--out %s: another scan is writing there; give another directory",
                               directory);
    return 0;
}

/* Pointers are of a process: those of a station that has just begun stay. */
static void keep_pointers(struct station *to, const struct station *from)
{
    struct microscope *m = &to->microscope;
    m->surface.grid.count = from->microscope.surface.grid.count;
    m->piezo = from->microscope.piezo;
    m->sensor = from->microscope.sensor;
}

/* Into the bench and the image. NULL, or what is wrong: then both are not to be used. */
static const char *take(FILE *f, struct afm_bench *b, struct scan_image *m)
{
    static struct station begun; /* large: not on the stack */
    struct piece piece[PARTS];
    struct head kept;
    begun = b->station;
    list_pieces(b, m, piece);
    struct head own = head_of(b, piece);
    if (fread(&kept, sizeof kept, 1, f) != 1 || memcmp(kept.magic, part_magic, sizeof part_magic) != 0)
        return "is no scan";
    if (kept.identity != own.identity || kept.size != own.size)
        return "belongs to a scan of other numbers";
    for (int i = 0; i < PARTS; i++)
        if (fread(piece[i].data, 1, piece[i].size, f) != piece[i].size)
            return "is damaged: bytes are missing";
    if (head_of(b, piece).check != kept.check || fgetc(f) != EOF)
        return "is damaged: its check does not fit";
    keep_pointers(&b->station, &begun);
    return NULL;
}

/* It is written beside the one before it and then takes its place. */
static void next_path(const struct scan_part *p, char next[SCAN_PATH + 8])
{
    snprintf(next, SCAN_PATH + 8, "%s.new", p->path);
}

/* NULL: nothing stands there, or what a scan wrote, though it was cut off while it did. Else what is wrong.
 */
static const char *look(const char *path)
{
    char begin[sizeof part_magic];
    struct stat s;
    if (lstat(path, &s))
        return errno == ENOENT ? NULL : strerror(errno);
    FILE *f = S_ISREG(s.st_mode) ? fopen(path, "re") : NULL;
    size_t n = f ? fread(begin, 1, sizeof begin, f) : 0;
    if (f)
        (void)fclose(f);
    return f && !memcmp(begin, part_magic, n) ? NULL : "is no scan";
}

int scan_part_read(const struct scan_part *p, struct afm_bench *b, struct scan_image *m, bool *found)
{
    char next[SCAN_PATH + 8];
    next_path(p, next);
    *found = false;
    const char *at = next, *why = look(next);
    if (!why)
        why = look(at = p->path);
    FILE *f = why ? NULL : fopen(p->path, "re");
    if (f) {
        why = take(f, b, m);
        fclose(f);
    }
    *found = f && !why;
    return why ? options_failure(
                     b->usage, "%s %s, and is left as it is; remove it to begin anew, or give another --out",
                     at, why)
               : 0;
}

int scan_part_write(struct scan_part *p, const struct afm_bench *b, const struct scan_image *m)
{
    char next[SCAN_PATH + 8];
    struct piece piece[PARTS];
    list_pieces((struct afm_bench *)(uintptr_t)b, m, piece); /* they are read only */
    struct head h = head_of(b, piece);
    next_path(p, next);
    FILE *f = files_create(next);
    bool good = f && fwrite(&h, sizeof h, 1, f) == 1;
    for (int i = 0; i < PARTS && good; i++)
        good = fwrite(piece[i].data, 1, piece[i].size, f) == piece[i].size;
    if (f)
        good = files_finish(f, good);
    p->kept_s = clock_now_s();
    return good && rename(next, p->path) == 0
               ? 0
               : options_failure(b->usage, "cannot keep the scan in %s: %s", p->path, files_unwritten(errno));
}

void scan_part_end(struct scan_part *p)
{
    char next[SCAN_PATH + 8];
    if (p->lock < 0)
        return;
    next_path(p, next);
    (void)unlink(next); /* left by a scan that ended while it wrote */
    (void)unlink(p->path);
    (void)close(p->lock);
    p->lock = -1;
}
