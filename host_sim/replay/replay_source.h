/* replay_source.h - a recorded log as a hal: gives an app the commands of each bus frame and compares what it
 * sends.
 *
 *   replay_open(&r, path, interface, &scene, frame_s, excluded);
 *   app_init(&app, &config, &r.hal);
 *   while ((got = replay_frame(&r, app.frame)) > 0) {
 *       (void)!app_overrun(&app, r.missed);        the log says what was due
 *       if (app.frame != r.frame)                  the overrun has moved on
 *           got = replay_frame(&r, app.frame);
 *       app_frame(&app);
 *       difference = replay_check(&r);
 *   }
 *
 * The log is one of hal/posix/log.h: its stamps name bus frames, its lines stand in the order of the traffic.
 * Or candump took it on the bus; then host_sim/replay/log_bus.h finds the frames. The marks of the first kind
 * tell what was received, which is received again, whatever it is, and what was sent. Without marks, and on
 * the bus, commands are the identifiers base .. base + WIRE_COMMANDS - 1 of the scene, its telemetry the rest
 * of its WIRE_KINDS, and lines of others are passed over. Faults recorded as error frames are reported again.
 * That frame periods were missed is told by a line of its own, and without marks by the message OVERRUN.
 *
 * Every sent frame must equal the recorded one at this place, byte for byte. A message that `excluded`
 * accepts (timing reports, which depend on the machine) must only stand there. SELF_TEST is about the machine
 * altogether. Without marks its lines are excluded, and the app that replays gets no self-test. With marks it
 * gets one if the plant had one, because messages wait for those before them. A frame that the bus refused
 * while recording is refused again. A log that candump took cannot tell of those: it differs from its replay
 * there, and is not evidence against the plant. */
#ifndef HOST_SIM_REPLAY_SOURCE_H
#define HOST_SIM_REPLAY_SOURCE_H

#include <stdbool.h>
#include <stdint.h>
#include "firmware/bus/wire.h"
#include "host_sim/replay/log_bus.h"

enum { REPLAY_LINES = 1 << 18 }; /* lines of one direction in one bus frame: more than a flood brings */

struct replay_line {
    uint64_t number; /* in the file */
    struct frame frame;
    int fault;
    bool refused;
};

struct replay {
    struct hal hal; /* give this to the app */
    struct plant_log log;
    struct wire_scene scene;
    double frame_s;
    struct log_bus bus;                        /* reads the log where that is candump's */
    bool (*excluded)(const struct message *m); /* or NULL */
    bool ended;                                /* no line after `next` */
    bool has_next;
    struct log_line next; /* read ahead, belongs to a later frame */
    uint64_t number;      /* line number of `next` in the file */
    uint64_t frame;       /* loaded */
    struct replay_line command[REPLAY_LINES];
    struct replay_line telemetry[REPLAY_LINES];
    uint32_t n_commands, i_command, n_telemetry, i_telemetry;
    uint32_t missed; /* frame periods missed before this frame; 0 for none */
    /* counts so far */
    uint64_t commands, compared, excluded_lines, passed_over;
    bool differs;
    char reason[2 * LOG_REASON];
};

/* NULL, or the reason; see plant_log_open. *r must stay where it is, `path` valid. */
const char *replay_open(struct replay *r, const char *path, const char *interface,
                        const struct wire_scene *scene, double frame_s,
                        bool (*excluded)(const struct message *m));

/* After replay_open of a log taken on the bus: these lines go one frame later than they stand, see
 * log_bus.h. The list must stay valid. */
void replay_defer(struct replay *r, const uint64_t *number, uint32_t n);

/* Loads the lines of this bus frame: 1 done (there may be none), 0 the log ended before it, -1 bad log:
 * r->reason. Frames are asked for in rising order, none left out. */
int replay_frame(struct replay *r, uint64_t frame);

/* After app_frame: NULL, or the first difference between what was sent and what was recorded, with its
 * line. */
const char *replay_check(struct replay *r);

void replay_close(struct replay *r);

#endif
