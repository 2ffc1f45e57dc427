/* log_bus.h - gives the lines of a log that candump took on the bus the bus frames they belong to.
 *
 * The stamps of such a log are wall-clock times, not bus frames (hal/posix/log.h). But the plant says
 * which bus frame it is in: with the setting sync_every at 1, its default, a SYNC stands at the head of
 * what each frame reports. So:
 *   - telemetry from one SYNC to the next belongs to the first one's frame;
 *   - commands between them, and the REPLY and OVERRUN that come before a report, belong to the second
 *     one's frame.
 * Lines come out frame by frame, with the stamps that hal/posix/log would have given them. The frame of the
 * last SYNC is left out, since a log that ends there need not have all of it.
 *
 * DOUBT. A command that reached the bus after the plant had emptied its queue, but before its SYNC, was
 * taken one frame later. That window is the compute time of a frame, and as many frames as the SYNC waited
 * for the wire. A command with its REPLY behind it, by kind and counter, is beyond doubt, and so are those
 * before it. For the others the reader that finds a difference may try again. `doubtful` names the last
 * ones that were given out. A line named in `deferred` goes, with the commands behind it, to the frame
 * after; named twice, to the one after that.
 *
 * The log must begin before the plant's first frame. It does not show commands that waited for more than a
 * frame in a queue (a flood), nor faults that only the plant saw (its interface down). The plant's own
 * recording does. */
#ifndef HAL_LOG_BUS_H
#define HAL_LOG_BUS_H

#include "firmware/bus/wire.h"
#include "host_sim/replay/plant_log.h"

enum {
    LOG_BUS_LINES = 1024,  /* in one bus frame */
    LOG_BUS_DOUBTFUL = 128 /* remembered: a sample shows 64 frames after it came, beside 31 others */
};

struct log_bus_line {
    struct log_line line;
    uint64_t number; /* in the file */
    uint32_t held;   /* frames that it was held back: it or one before it is deferred */
};

struct log_bus_list {
    struct log_bus_line at[LOG_BUS_LINES];
    uint32_t n;
};

struct log_bus {
    struct plant_log *log; /* the caller's; its reader's reason tells what was wrong */
    const struct wire_scene *scene;
    double frame_s;
    struct log_bus_list out;   /* a complete frame, being given out */
    struct log_bus_list open;  /* the frame whose SYNC came last */
    struct log_bus_list later; /* after that SYNC, of the next frame */
    uint32_t i_out;
    uint64_t n_syncs, frame;                         /* frame of the last SYNC */
    uint64_t number;                                 /* line number of what was given out last */
    uint64_t passed_over;                            /* lines of others */
    uint64_t doubtful[LOG_BUS_DOUBTFUL], n_doubtful; /* line numbers, by n_doubtful modulo its size */
    const uint64_t *deferred;                        /* the caller's list of line numbers */
    uint32_t n_deferred;
};

/* Begins at the log's place. The log must stay where it is, and so must the caller's list. */
void log_bus_start(struct log_bus *b, struct plant_log *log, double frame_s);

/* Like plant_log_next, stamped with bus frames: 1, 0 at the end, -1 for a log that does not tell its frames:
 * log->reader.reason says what and where. */
int log_bus_read(struct log_bus *b, struct log_line *out);

#endif
