/* faults.h - a bus with faults around any other hal: seeded, timed, repeatable. For tests and contactplant
 * run --faults.
 *
 * Time is counted in flushes, one a plant frame. Each rule acts on frames that come in, go out, or both, from
 * one frame to another; equal seed and traffic give equal faults. Rules act in the order of enum faults_kind.
 * If several of one kind apply, a frame suffers from the first that hits it, and is held back by the longest
 * burst or freeze. Frames held back wait in a queue of FAULTS_QUEUE frames for each direction. Frames beyond
 * that are lost; incoming ones are reported as HAL_DROPPED. Bits are flipped and bytes cut in the data only:
 * a frame under another identifier is another frame. */
#ifndef HAL_FAULTS_H
#define HAL_FAULTS_H

#include <stdbool.h>
#include <stdint.h>
#include "hal/hal.h"

enum {
    FAULTS_QUEUE = 16384, /* frames held back in one direction: 10 s of a busy controller at 1 kHz */
    FAULTS_RULES = 16,
    FAULTS_HISTORY = 64, /* frames from which `repeat` takes an old one */
    FAULTS_READ = 512    /* frames of the inner hal read in one recv at most */
};

enum faults_kind {
    FAULTS_BUS_OFF,   /* nothing comes or goes; the first recv of it reports HAL_BUS_OFF */
    FAULTS_DROP,      /* a frame is lost */
    FAULTS_REPEAT,    /* an old frame of the last FAULTS_HISTORY comes again, counter and all */
    FAULTS_TRUNCATE,  /* the last bytes are missing, 1 to all */
    FAULTS_FLIP,      /* 1 to 3 bits change */
    FAULTS_DUPLICATE, /* a frame comes twice */
    FAULTS_REORDER,   /* a frame comes after those of the next plant frame */
    FAULTS_DELAY,     /* a frame comes `frames` plant frames later */
    FAULTS_BURST,     /* everything waits for the next multiple of `frames` plant frames */
    FAULTS_FREEZE,    /* the link stalls: everything comes at the end */
    FAULTS_REFUSE,    /* send finds no room */
    FAULTS_KINDS
};

struct faults_rule {
    enum faults_kind kind;
    bool in, out;
    double probability;    /* 0..1, of each frame; without meaning for BUS_OFF, BURST, FREEZE */
    uint32_t frames;       /* plant frames of DELAY and BURST, at least 1 */
    uint64_t begin, until; /* plant frames: acts while begin <= frame < until */
};

struct faults_held {
    uint64_t due; /* 2 x plant frame, + 1 after all others of that frame */
    struct frame frame;
};

/* Held frames in the order in which they leave. */
struct faults_line {
    struct faults_held held[FAULTS_QUEUE];
    uint32_t first, n;
    struct frame past[FAULTS_HISTORY];
    uint32_t n_past;
};

struct faults {
    struct hal hal; /* give this to the app instead of the inner one */
    struct hal inner;
    struct faults_rule rule[FAULTS_RULES];
    uint32_t n_rules;
    uint64_t seed, words; /* random words taken so far */
    uint64_t frame;       /* plant frames so far */
    bool off;             /* the bus is off */
    int report;           /* hal_fault bits for the next recv */
    struct faults_line in, out;
    uint64_t count[FAULTS_KINDS]; /* frames that suffered each kind; for BUS_OFF: frames lost */
    uint64_t lost;                /* frames that found the queue full */
};

extern const char *const faults_name[FAULTS_KINDS];

/* Wraps this hal, without a rule yet; it is copied. *f must stay where it is, and the app gets &f->hal.
 * Equal seeds give equal faults. */
void faults_init(struct faults *f, const struct hal *inner, uint64_t seed);

/* Adds a rule, which is copied. NULL, or the reason for a refusal that changed nothing. */
const char *faults_add(struct faults *f, const struct faults_rule *r);

#endif
