/* batch_rk4.h - the plant's rk4 for many trajectories of one model with a Hertzian contact, side by side in
 * vectors.
 *
 * A trajectory has the plant's bits: those of a whole plant with `rk4_unlocated`, and with `rk4` up to its
 * first switch. The steps are those of `rk4` (firmware/method/rk4.c) through switches (REGIME_ANY), on the
 * segments of the plant's drives (firmware/plant/drive.h). The bits depend on nothing but the trajectory's
 * own numbers. Its place, its company, the machine's vectors, the compiler (flags of the Makefile) and the
 * number of steps in a call do not matter.
 *
 * All trajectories have equal drives in turns. An input has one phase and one number of turns a step, so that
 * struct drive itself makes its phasors once for all. A trajectory has its own parameters, amplitudes, state
 * and step, and by the step its own frequencies. */
#ifndef HOST_SIM_BATCH_RK4_H
#define HOST_SIM_BATCH_RK4_H

#include "firmware/plant/drive.h"

enum {
    BATCH_BLOCK = 32, /* trajectories that are computed together */
    BATCH_ROWS = MODEL_INPUTS + 1,
    BATCH_BASE_RATE = MODEL_INPUTS, /* the row of the base's rate; the others are the inputs' values */
    BATCH_NUMBERS = 2               /* prepared parameters that the models' equations use */
};

/* |x[0]| + |x[1]| beyond this at the end of a step: the motion has escaped. */
#define BATCH_RK4_LIMIT 1e6

struct batch_rk4_block {
    double p[BATCH_NUMBERS][BATCH_BLOCK];
    double scale[BATCH_ROWS][BATCH_BLOCK]; /* amplitudes; of the base's rate -amplitude omega */
    double step[BATCH_BLOCK];
    double x[2][BATCH_BLOCK],
        largest[BATCH_BLOCK];       /* now; |x[0]| + |x[1]|, the largest since the interval began */
    double end[2][BATCH_BLOCK];     /* x where the last good interval ended */
    int64_t good[BATCH_BLOCK];      /* -1; 0: has escaped */
    int64_t intervals[BATCH_BLOCK]; /* completed */
};

/* Cosines (of the base's rate: sines) of a run of steps: at begin, middle and end of step k in [2 k], [2 k
 * + 1], [2 k + 2]. */
struct batch_rk4_table {
    double at[BATCH_ROWS][2 * PHASOR_RESYNC_TICKS + 1];
    int steps;
};

/* Which inputs the equation has: silent ones left out, for the same bits. */
enum batch_rk4_pattern {
    PATTERN_FORCE,  /* rig and rolling contact under one force */
    PATTERN_FORCES, /* the rig: two forces; force and base; every input */
    PATTERN_BASE,
    PATTERN_RIG,
    PATTERN_ROLLING,
    PATTERN_TIP
};

/* The functions compiled for one width of vectors: the steps of a table, and the end of an interval. The end
 * puts x[0] and x[1] of n of the block's trajectories into samples and samples + stride (NULL: nowhere), NaN
 * for those that have escaped. */
struct batch_rk4_kernel {
    void (*steps)(struct batch_rk4_block *k, enum batch_rk4_pattern pattern, const struct batch_rk4_table *t);
    void (*end)(struct batch_rk4_block *k, int n, double *samples, int stride);
};

/* Whose equation it is. */
enum batch_rk4_form { FORM_RIG, FORM_ROLLING, FORM_TIP, FORMS };

struct batch_rk4 {
    int n;
    const struct model *model;
    enum batch_rk4_form form;
    struct drive drive[MODEL_INPUTS]; /* with amplitude 1, now; may be set between calls */
    unsigned active;                  /* bit i: input i sounds in some trajectory */
    double base_omega;                /* radians a step of the base's drive */
    struct batch_rk4_kernel kernel;   /* the widest that the processor takes */
    struct batch_rk4_block *block;
};

/* A trajectory; model units. */
struct batch_rk4_lane {
    const double *p; /* prepared parameters */
    double step;     /* model time */
    double amplitude[MODEL_INPUTS];
    double x[2]; /* state */
};

/* Memory for n trajectories, and the batch in it: all with every number 0. drive: of each input phase and
 * turns a step, its amplitude is not read. NULL, or why there is no batch of this model and these drives. */
size_t batch_rk4_bytes(int n);
const char *batch_rk4_init(struct batch_rk4 *b, int n, const struct model *m,
                           const struct drive_setting *drive, void *memory);

/* Trajectory i from now on. NULL, or why it cannot be one of the batch (then nothing is changed): what the
 * plant's rk4 refuses, and amplitudes beyond DRIVE_LIMIT. */
const char *batch_rk4_set(struct batch_rk4 *b, int i, const struct batch_rk4_lane *lane);

/* x[2] where trajectory i stands: where its last good interval ended. How many intervals it has completed;
 * false once it has escaped, which disturbs no other one. */
void batch_rk4_state(const struct batch_rk4 *b, int i, double *x);
int64_t batch_rk4_intervals(const struct batch_rk4 *b, int i);
bool batch_rk4_good(const struct batch_rk4 *b, int i);

/* `intervals` intervals of `steps` steps of all trajectories. samples: NULL, or x[0] and x[1] at the end
 * of interval j in samples[2 j n + i] and samples[(2 j + 1) n + i], NaN where trajectory i has escaped.
 * NULL, or the reason for a refusal that changed nothing. */
const char *batch_rk4(struct batch_rk4 *b, int steps, int intervals, double *samples);

/* The kernels: for what the compiler was told of the machine, and with BATCH_AVX2 (the Makefile, on
 * x86-64, whose default knows no AVX2) once more for AVX2. The bits are the same: batch_lanes.h. */
extern const struct batch_rk4_kernel batch_rk4_plain, batch_rk4_avx2;

#endif
