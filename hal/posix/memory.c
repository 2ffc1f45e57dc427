/* memory.c - lockstep through shared memory; see memory.h. */
#include "hal/posix/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include "hal/posix/clock.h"

/* ---- sending ---- */

static bool transmit(struct memory *m)
{
    if (!memory_ring_put(&m->rings->from_plant, m->packet.bytes, m->packet.n_bytes))
        return false;
    cannelloni_next(&m->packet);
    return true;
}

static int append(void *context, const struct frame *f)
{
    struct memory *m = context;
    if (!cannelloni_has_room(&m->packet, f) && !transmit(m))
        return 0;
    cannelloni_add(&m->packet, f);
    return 1;
}

/* The frames of this bus frame, and its end; false where the ring is full. */
static bool transmit_frame(struct memory *m)
{
    if (m->packet.n_bytes >= CANNELLONI_MORE && !transmit(m))
        return false;
    return transmit(m);
}

static void flush(void *context)
{
    struct memory *m = context;
    m->owes = !transmit_frame(m);
}

/* ---- receiving ---- */

/* The next packet into m->frame; false where it is malformed. */
static bool take_packet(struct memory *m)
{
    uint8_t packet[MEMORY_BYTES];
    int n = memory_ring_take(&m->rings->to_plant, packet);
    uint32_t before = m->passed_over;
    m->i_frame = 0;
    m->n_frames =
        n < 0 ? n : cannelloni_parse(packet, (size_t)n, m->frame, CANNELLONI_FRAMES_MAX, &m->passed_over);
    m->fault |= m->passed_over != before ? HAL_FOREIGN : 0;
    if (m->n_frames >= 0)
        return true;
    m->n_frames = 0;
    m->malformed++;
    m->fault |= HAL_FOREIGN;
    return false;
}

/* An app takes so many frames at a time only: the rest of a word is the next turn's. */
bool memory_await(struct memory *m, int ms)
{
    if (m->owes)
        m->owes = !transmit_frame(m);
    if (m->i_frame < m->n_frames)
        return true;
    return memory_ring_await(&m->rings->to_plant, &m->wait, ms) && take_packet(m);
}

static int receive(void *context, struct frame *f)
{
    struct memory *m = context;
    int fault = m->fault;
    m->fault = 0;
    if (fault)
        return -fault;
    if (m->i_frame == m->n_frames)
        return 0;
    *f = m->frame[m->i_frame++];
    return 1;
}

static uint32_t stand(void *context)
{
    (void)context;
    return 0;
}

/* ---- opening ---- */

static const char *fail(struct memory *m, const char *why)
{
    snprintf(m->reason, sizeof m->reason, "memory: %s: %s", m->path, why);
    memory_close(m);
    return m->reason;
}

/* Memory that no process can make shorter or longer: a plant that touches it is never killed for that. */
static bool open_sealed(struct memory *m)
{
    m->file = memfd_create("contactplant", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    if (m->file < 0 || fchmod(m->file, 0600) != 0 || ftruncate(m->file, sizeof *m->rings) != 0 ||
        fcntl(m->file, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0)
        return false;
    void *rings = mmap(NULL, sizeof *m->rings, PROT_READ | PROT_WRITE, MAP_SHARED, m->file, 0);
    m->rings = rings == MAP_FAILED ? NULL : rings;
    return m->rings != NULL;
}

const char *memory_open(struct memory *m, const char *path)
{
    char own[MEMORY_PATH];
    memset(m, 0, sizeof *m);
    m->file = -1;
    if (path && strlen(path) >= sizeof m->path)
        return "memory: the path of the file is too long";
    bool good = open_sealed(m);
    snprintf(own, sizeof own, "/proc/%ld/fd/%d", (long)getpid(), m->file);
    snprintf(m->path, sizeof m->path, "%s", path ? path : own);
    if (!good)
        return fail(m, strerror(errno));
    m->named = path && symlink(own, path) == 0;
    if (path && !m->named)
        return fail(m, errno == EEXIST ? "exists; another plant has it, or remove it" : strerror(errno));
    cannelloni_begin(&m->packet, 0);
    m->hal = (struct hal){m, receive, append, flush, stand, clock_no_watchdog};
    return NULL;
}

/* The file with this name is still this one: another plant may have made its own since it was removed. */
static bool has_its_name(const struct memory *m)
{
    struct stat own, there;
    return m->named && fstat(m->file, &own) == 0 && stat(m->path, &there) == 0 &&
           own.st_ino == there.st_ino && own.st_dev == there.st_dev;
}

void memory_close(struct memory *m)
{
    if (m->rings) {
        (void)memory_ring_put(&m->rings->from_plant, "",
                              0); /* the end; a ring that is full has other words to read */
        munmap(m->rings, sizeof *m->rings);
    }
    if (has_its_name(m))
        (void)unlink(m->path);
    if (m->file >= 0)
        close(m->file);
    m->named = false;
    m->rings = NULL;
    m->file = -1;
}
