/* board_record.h - a log of a board (hal/posix/log.h) written at the other end of its wire: which bus frame
 * took each command is told by the board's own answers.
 *
 * The board sends one packet a bus frame, dated by its SYNC, and takes a whole packet of commands in one bus
 * frame. So each packet of commands gets a marker at its end: a CAPTURE stop, which changes nothing while
 * nothing is captured and is always answered, in the session or not. The packet that brings that REPLY names
 * the frame. A packet that was lost, either way, shows as a frame or marker that is missing. */
#ifndef TESTS_BOARD_RECORD_H
#define TESTS_BOARD_RECORD_H

#include <stdio.h>
#include "firmware/bus/wire.h"
#include "hal/posix/udp.h"

enum { RECORD_WAITING = 1024, RECORD_LINES = 256 };

struct board_record {
    struct hal hal; /* give this to the client */
    struct udp *udp;
    struct wire_scene scene;
    double frame_s;
    FILE *log;
    struct frame waiting[RECORD_WAITING]; /* commands whose bus frame is not known yet, markers included */
    int n_waiting;
    uint8_t session, marker;         /* session and counter of the next marker */
    struct frame line[RECORD_LINES]; /* telemetry of the packet that is coming in */
    int n_lines;
    uint32_t packet;       /* its number */
    uint64_t frame;        /* the next one expected */
    uint64_t taken_frame;  /* the bus frame that took the latest packet of commands */
    uint64_t out_of_order; /* bus frames or markers that were not the expected ones, and what found no room */
};

/* All pointers must stay valid; *r must stay where it is. */
void board_record_open(struct board_record *r, struct udp *udp, const struct wire_scene *scene,
                       double frame_s, FILE *log);

/* Writes what has come in, as the last frame. */
void board_record_close(struct board_record *r);

#endif
