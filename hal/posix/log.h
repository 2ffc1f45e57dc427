/* log.h - records the traffic of another hal as a candump log, and reads logs, those of others too: of
 * candump, or pcapng (pcapng.h).
 *
 * It has one line per frame, `(seconds.micros) interface ID#DATA`. ID has 3 hex digits for an 11-bit
 * identifier and 8 for a 29-bit one, DATA two hex digits per byte. candump, canplayer, log2asc, SavvyCAN,
 * python-can and Wireshark read it. Everything that was received is there, also what is not for the plant.
 *
 * TIME BASE. A line's time stamp is not a wall-clock time but the bus frame that took or sent it: frame
 * number times frame period, plus one second (log_frame_us). log2asc takes second 0 for "no time yet".
 * With these stamps a replay (host_sim/replay/replay_source.h) gives every command to exactly the frame
 * that had it. Wall-clock stamps leave that open for a command close to a frame boundary. The owner calls
 * log_set_frame with app.frame before every app_overrun and every app_frame. canplayer still keeps the
 * original gaps.
 *
 * WAYS. A plant takes the first LOG_COMMANDS of each block of FRAME_IDS identifiers and sends the others. So
 * the identifier tells which way a frame went. The recording of a plant begins with an error frame 20000004
 * whose byte 5 is C1 hex. One with C2 hex stands before a frame that went the other way, a stray. Recordings
 * of earlier versions, and of candump -x, have ` R` or ` T` at the end of each line instead.
 *
 * FAULTS that the inner hal reports are recorded where they happened, as SocketCAN error frames:
 * identifier 20000004 (controller problem) or 20000040 (bus-off), data byte 5 = the hal_fault bits. Tools
 * show them, canplayer can play them, a replay reports them again.
 *
 * REFUSALS. A frame for which the inner hal had no room is recorded as an error frame too, where it was
 * tried. Its identifier is 20000004, data byte 1 = 2 (transmit buffer overflow). Byte 5 is 80 hex + the
 * lowest six bits of its identifier, and bytes 0, 2, 3, 4, 6, 7 are its bytes 2 to 7. A replay refuses the
 * same frame.
 *
 * OVERRUNS. The owner calls log_missed with the number that it gives to app_overrun, because the message
 * OVERRUN may come late or never. The line is an error frame 20000004 whose byte 5 is C0 hex, and bytes 0,
 * 2, 3, 4 = the periods missed, the lowest eight bits first.
 *
 * COST. Lines go to a buffer; flush writes it out when it is half full, about every 100 frames of full
 * telemetry. That write goes to the page cache (tens of microseconds), but a disk that cannot follow can
 * make it wait. Put the log on a fast or memory file system if this matters. A write error (full disk) is
 * latched. Recording ends with the last whole bus frame that fitted, so that the file replays. log_error
 * gives the reason, the next recv reports HAL_LOG_ENDED, and the traffic itself continues. At `limit`
 * bytes recording ends so, too. log_close writes the rest, so an orderly end (also by Ctrl-C) leaves a
 * complete file. */
#ifndef HAL_LOG_H
#define HAL_LOG_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include "hal/hal.h"

enum {
    LOG_BUFFER = 1 << 16,
    LOG_LINE_MAX = 80,
    LOG_INTERFACE = 16,
    LOG_FD_DATA = 64, /* bytes of a CAN FD frame */
    LOG_REASON = 256,
    LOG_START_US = 1000000,       /* stamp of frame 0 */
    LOG_ERROR_FRAME = 0x20000000, /* CAN_ERR_FLAG: this line is an error frame */
    LOG_ERROR_CONTROLLER = 0x04,  /* CAN_ERR_CRTL */
    LOG_ERROR_BUS_OFF = 0x40,     /* CAN_ERR_BUSOFF */
    LOG_FAULT_BYTE = 5,           /* the data byte that SocketCAN leaves to the controller */
    LOG_FAULT_BITS = HAL_DROPPED | HAL_FOREIGN | HAL_BUS_OFF | HAL_ERROR_PASSIVE | HAL_DOWN | HAL_UNSENT,
    LOG_REFUSED_BYTE = 1,
    LOG_REFUSED_CAUSE = 0x02, /* CAN_ERR_CRTL_TX_OVERFLOW */
    LOG_REFUSED = 0x80,       /* in LOG_FAULT_BYTE, with the number of the message */
    LOG_NUMBERS = 0x40,       /* numbers of messages: identifiers of one plant */
    LOG_MISSED = 0xC0,        /* in LOG_FAULT_BYTE */
    LOG_PLANT = 0xC1,         /* in LOG_FAULT_BYTE */
    LOG_AGAINST = 0xC2,       /* in LOG_FAULT_BYTE */
    LOG_COMMANDS = 0x10       /* that a plant takes of each block of FRAME_IDS; it sends the others */
};

/* The way of a line's frame. */
enum log_way {
    LOG_UNKNOWN, /* not told: the line of another tool */
    LOG_RECEIVED,
    LOG_SENT,
    /* was to be sent and refused: of the frame bytes 2 to 7 are known, and its id is the number of the
     * message */
    LOG_NO_ROOM,
    LOG_OVERRUN, /* no frame: frame periods were missed */
    LOG_BEGIN,   /* no frame: here begins what a plant recorded */
    LOG_TURN     /* no frame: the next one went against its identifier */
};

struct log {
    struct hal hal; /* give this to the app instead of the inner one */
    struct hal inner;
    int file;
    uint64_t time_us; /* stamp of the lines of this frame */
    char interface[LOG_INTERFACE];
    char buffer[LOG_BUFFER];
    uint32_t n_bytes;
    uint64_t limit; /* bytes that the file may have; 0: none. The owner sets it after log_open */
    bool listens;   /* no plant records here, but who hears one: no ways. The owner sets it after log_open */
    bool begun;     /* LOG_BEGIN is recorded */
    uint64_t written;    /* bytes in the file */
    uint64_t whole;      /* bytes up to the begin of the frame whose lines are being written */
    uint64_t lines;      /* recorded */
    uint64_t lines_lost; /* after a write error */
    bool failed, reported;
    bool limited; /* `failed` by its limit, as was asked for */
    char reason[LOG_REASON];
};

/* The stamp of a bus frame: LOG_START_US + frame * frame_s in microseconds, rounded to nearest. Frame
 * periods down to 1 us. */
uint64_t log_frame_us(uint64_t frame, double frame_s);

/* Creates or empties the file. NULL, or the reason (then nothing is open). *l must stay where it is.
 * `interface` is the name written in each line: no spaces, 1 to 15 characters. */
const char *log_open(struct log *l, const char *path, const char *interface, const struct hal *inner);

/* All lines from here on carry the stamp of this bus frame. */
void log_set_frame(struct log *l, uint64_t frame, double frame_s);

/* So many frame periods were missed before the frame that log_set_frame named; 0 is passed over. */
void log_missed(struct log *l, uint32_t missed);

/* NULL, or what went wrong when writing. */
const char *log_error(const struct log *l);

/* Writes what is buffered and closes. NULL, or the write error, now or earlier. */
const char *log_close(struct log *l);

/* The kinds of lines. */
enum log_kind {
    LOG_DATA,   /* a data frame, a fault, or a word of the recorder: a plant sends, takes or reports it */
    LOG_FD,     /* a CAN FD frame; this and what follows no plant sends */
    LOG_REMOTE, /* a remote frame */
    LOG_ERROR,  /* an error frame that no plant reports */
    LOG_DAMAGED,
    LOG_CUT, /* no end of line: the file ends there, and what is left of the line may still look whole */
    LOG_KINDS
};

/* A frame as it stands in a line, whatever its kind is. */
struct log_raw {
    uint32_t id; /* LOG_ERROR_FRAME included */
    bool extended, remote, fd;
    uint8_t flags;  /* a CAN FD frame has them */
    uint8_t length; /* bytes, or what a remote frame asks for */
    uint8_t data[LOG_FD_DATA];
};

/* One line of a log. */
struct log_line {
    enum log_kind kind;
    uint64_t time_us;
    char interface[LOG_INTERFACE];
    struct log_raw raw;
    struct frame frame; /* for LOG_DATA, where fault is 0 */
    int fault;          /* hal_fault bits of an error frame, or what a plant reports when it hears one */
    enum log_way way;
    uint32_t missed; /* periods of LOG_OVERRUN */
};

/* Writes a line of at most LOG_LINE_MAX - 1 characters, with '\n' and 0; returns its length. The way of a
 * data frame is not written. Pure. */
int log_format(char *text, const struct log_line *line);

/* The way that the identifier of a plant's frame tells. */
enum log_way log_way_of(const struct frame *f);

#endif
