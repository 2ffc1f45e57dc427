/* fit.h - a scene from a measured rig: what is fitted to what, and what comes of it.
 *
 * An unknown is a number of the scene, in logarithms, or one of the measuring chain: gain.force, gain.sensor
 * (logarithms) and delay (seconds). A point of a curve gives two residuals, real and imaginary part, or one
 * where no phase is known: model less data over the standard deviation. The two points beside a jump of the
 * plant do not count: a motion at the end of its branch depends on the unknowns without bound.
 * docs/guide/fit.md is the manual. */
#ifndef HOST_SIM_FIT_FIT_H
#define HOST_SIM_FIT_FIT_H

#include "host_sim/fit/data/curve.h"
#include "host_sim/fit/data/lever.h"
#include "host_sim/fit/data/record.h"
#include "host_sim/fit/solve/matrix.h"
#include "host_sim/fit/motion/follow.h"
#include "host_sim/scene/scene_range.h"

enum { FIT_UNKNOWNS = 14, FIT_STARTS = 8, FIT_NAME = 64 };

/* From FIT_DELAY on they are fitted as they are, the others in logarithms. */
enum fit_kind {
    FIT_PARAMETER,
    FIT_GAIN_FORCE,
    FIT_GAIN_SENSOR,
    FIT_DELAY,
    FIT_OFFSET,
    FIT_CONTACT,  /* base of a force curve where the model's is 0 */
    FIT_BASELINE, /* deflection outside */
    FIT_POSITION, /* in which a record begins, from rest */
    FIT_VELOCITY,
    FIT_PHASE, /* a tone's, where that is not known */
    FIT_WHITE  /* noise of a spectrum's sensor */
};

struct fit_unknown {
    enum fit_kind kind;
    int index; /* number of the SI parameter, or of the record */
    char name[FIT_NAME];
    const char *unit;
    double min, max, start; /* SI */
    double unit_of_u;       /* from FIT_DELAY on a value is u times this; others are e^u */
};

struct fit_point {
    struct follow_point at; /* the motion that was taken */
    bool other;             /* it is not the one that the sweep's direction leads to, and differs from it */
    bool flank;             /* the plant's jump is beside it: it does not count */
};

struct fit_setup {
    struct options o;
    struct scene scene;
    const char *name; /* name of the scene */
    struct curves data;
    uint32_t crc; /* CRC-32 of the data files, one behind the other */
    struct records records;
    struct lever_set levers;
    const struct fit_unknown *held; /* that does not move, or NULL */
    bool only_starts;               /* only the unknowns of records move */
    int n;                          /* unknowns */
    struct fit_unknown unknown[FIT_UNKNOWNS];
    struct orbit_task task;
    bool noise_known;
    int n_active; /* curves that count, the smallest drives first */
    int n_residuals;
    struct fit_point *point[CURVES]; /* [curve.n], of the last residuals */
    bool smooth[CURVES];             /* there is no jump in them, and they may go on from there */
    double told_s;                   /* progress */
    bool told;                       /* and stands on the terminal */
};

/* It belongs to a record, and is not told. */
static inline bool fit_is_hidden(const struct fit_unknown *k)
{
    return k->kind >= FIT_POSITION;
}

#endif
