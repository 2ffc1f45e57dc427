/* plant_log.h - the one reader of a plant's log, whoever wrote it: the plant itself, or candump on a bus that
 * others use too.
 *
 * It is read once when it is opened, before anything is printed of it. Then it is known on which interface
 * the plant is, how the log tells its frames, and whether it is of this plant. Where frames of the plant come
 * on several interfaces, two plants would be taken for one: the log is refused until one is chosen. A log
 * that tells another plant's identity is refused, too: its numbers mean other things. */
#ifndef HOST_SIM_PLANT_LOG_H
#define HOST_SIM_PLANT_LOG_H

#include "firmware/bus/wire.h"
#include "hal/posix/log.h"
#include "hal/posix/log_read.h"

enum { PLANT_LOG_INTERFACES = 8 };

/* Stamps from here on (September 2001) are wall-clock times; those of hal/posix/log.h count from the plant's
 * start. */
#define PLANT_LOG_EPOCH_US 1000000000000000u

/* An interface that carries frames of the plant, with a right checksum. */
struct plant_log_interface {
    char name[LOG_INTERFACE];
    bool has_identity, is_another; /* the plant there tells its identity; another one than the scene's */
};

struct plant_log {
    struct log_reader reader;
    struct wire_scene scene;
    struct plant_log_interface on[PLANT_LOG_INTERFACES];
    int n_on;
    char chosen[LOG_INTERFACE]; /* "": the lines of all */
    bool tells_identity;
    bool on_bus;      /* its stamps are wall-clock times */
    bool marked;      /* it tells which way each frame went: a plant's own recording */
    uint64_t others;  /* frames of others, so far */
    uint64_t unsound; /* frames under the plant's identifiers that fail their check, so far */
    char reason[2 * LOG_REASON];
};

/* Opens and looks through it. `interface`: the one to read, or NULL. NULL, or why it is refused, and then it
 * is closed. `path` must stay valid, and *l where it is. */
const char *plant_log_open(struct plant_log *l, const char *path, const char *interface,
                           const struct wire_scene *scene);

/* The next line that a plant may have sent, taken or reported, and the message in it (kind WIRE_KINDS: none).
 * 1, 0 at the end, -1 for a file that cannot be read: l->reader.reason says why. */
int plant_log_next(struct plant_log *l, struct log_line *line, struct message *m);

/* As plant_log_next, with the lines that no plant sends, and the recorder's words (log_read_any). */
int plant_log_any(struct plant_log *l, struct log_line *line, struct message *m);

/* Lines on stderr for people, once the log was read: what was passed over, and an identity that is not told.
 * `command`: its subcommand. */
void plant_log_tell(const struct plant_log *l, const char *command);

/* The last of these alone, where nothing is passed over. */
void plant_log_tell_identity(const struct plant_log *l, const char *command);

void plant_log_close(struct plant_log *l);

#endif
