/* memory.h - lockstep through memory that the plant's process shares with its controller's. It carries CAN
 * frames in packets of the cannelloni format (hal/link/cannelloni.h), as UDP does, but without a system call
 * while both run.
 *
 * The memory is a file, which the controller opens and maps. It holds two rings of packets
 * (hal/posix/memory_ring.h): to the plant, from the plant.
 *
 * A word is a packet, an empty one too, but not a malformed one. A flush sends a packet, an empty one too.
 * One of CANNELLONI_MORE bytes or more says that another follows. A frame that finds the ring full is
 * refused, as on every bus. The end of a bus frame that does goes later, in memory_await. A packet of no
 * bytes from the plant says that it has ended.
 *
 * Cost: 0.1 us a packet; a system call where one of the two has to sleep or be woken. */
#ifndef HAL_MEMORY_H
#define HAL_MEMORY_H

#include <stdbool.h>
#include <stdint.h>
#include "hal/hal.h"
#include "hal/link/cannelloni.h"
#include "hal/posix/memory_ring.h"

enum { MEMORY_PATH = 108 };

/* Both processes see it. */
struct memory_rings {
    struct memory_ring to_plant, from_plant;
};

/* The plant's side. */
struct memory {
    struct hal hal; /* give this to the app */
    int file;
    struct memory_rings *rings;
    char path[MEMORY_PATH]; /* for the controller */
    bool named;             /* that file goes with the plant */
    char reason[MEMORY_PATH + 120];
    struct frame frame[CANNELLONI_FRAMES_MAX]; /* the word being handed out */
    int n_frames, i_frame;
    struct cannelloni packet; /* being filled */
    bool owes;                /* the end of a bus frame that found the ring full */
    struct memory_wait wait;
    uint32_t malformed;   /* packets that were refused; reported as HAL_FOREIGN too */
    uint32_t passed_over; /* frames that are no classic data frames; HAL_FOREIGN, too */
    int fault;            /* hal_fault bits for the next recv */
};

/* Makes memory whose length nobody can change, so that no other process can end this one through it. At this
 * path, where nothing may be, it is found by a link to a file of this process; NULL: under m->path. Both end
 * with this process. NULL, or the reason. It must stay where it is. */
const char *memory_open(struct memory *m, const char *path);

/* True when the word of the next bus frame is here; sleeps at most `ms` for it. */
bool memory_await(struct memory *m, int ms);

void memory_close(struct memory *m);

#endif
