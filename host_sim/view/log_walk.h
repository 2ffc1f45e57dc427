/* log_walk.h - a plant's log row by row, with what happened between the rows, from any place on that was
 * noted before. */
#ifndef HOST_SIM_LOG_WALK_H
#define HOST_SIM_LOG_WALK_H

#include "host_sim/replay/decode_log.h"

enum log_mark_kind {
    LOG_MARK_TOUCHDOWN,
    LOG_MARK_LIFTOFF,
    LOG_MARK_REFUSAL,
    LOG_MARK_FAULT, /* a bit more is set */
    LOG_MARK_OVERRUN,
    LOG_MARK_MISSING, /* frames of the plant */
    LOG_MARK_SESSION, /* another one */
    LOG_MARK_STATE,   /* another one of enum plant_state */
    LOG_MARKS
};

struct log_mark {
    enum log_mark_kind kind;
    double t_s;                 /* plant time: of an event its own, else that of the row it comes behind */
    unsigned what;              /* contact; message that was refused; faults that are new; session; state */
    unsigned cause;             /* why it was refused */
    double n;                   /* periods missed, frames missing; else 1 */
    double speed, peak_force_N; /* those of a contact event; NaN: not known */
};

/* The plant as it was told last. */
struct log_walk_plant {
    int state; /* -1: no STATUS came yet */
    unsigned session, faults;
    uint64_t missing; /* frames, told as marks */
};

struct log_walk_place {
    struct log_place file;
    struct decode rows;
    struct log_walk_plant plant;
};

struct log_walk {
    struct decode_log log;
    struct log_walk_plant plant;
    void (*mark)(void *context, const struct log_mark *m); /* each, before its row is given; NULL: none */
    void *context;
};

/* NULL, or the reason; see plant_log_open. *w must stay where it is. */
const char *log_walk_open(struct log_walk *w, const char *path, const char *interface,
                          const struct wire_scene *scene, double tick_s);

/* As decode_log_next. */
int log_walk_next(struct log_walk *w, struct decode_row *row);

/* Between two rows: where it is, and back there. A copy of a walk may go, too, while the first one rests. */
void log_walk_tell(const struct log_walk *w, struct log_walk_place *p);
bool log_walk_go(struct log_walk *w, const struct log_walk_place *p);

#endif
