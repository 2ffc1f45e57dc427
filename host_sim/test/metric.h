/* metric.h - the metrics that a test may expect: one table with unit and meaning, the signals that they are
 * about, and their values. */
#ifndef HOST_SIM_METRIC_H
#define HOST_SIM_METRIC_H

#include "firmware/app/app.h"
#include "host_sim/test/fit.h"

enum metric_kind {
    /* contacts, by located events */
    METRIC_CONTACT_LOSS,
    METRIC_LIFT_OFFS,
    METRIC_TOUCHDOWNS,
    METRIC_LAST_LOSS,
    METRIC_LONGEST_LOSS,
    METRIC_PEAK_FORCE,
    METRIC_IMPACT_SPEED,
    /* a signal's, tick by tick */
    METRIC_MIN,
    METRIC_MAX,
    METRIC_MEAN,
    METRIC_RMS,
    METRIC_CHANGE,
    METRIC_EFFORT,
    METRIC_AMPLITUDE,
    METRIC_PHASE,
    /* the target signal's */
    METRIC_OVERSHOOT,
    METRIC_SETTLING,
    METRIC_STEADY_ERROR,
    METRIC_IAE,
    METRIC_ISE,
    METRIC_ITAE,
    /* the controller's, by bus frames */
    METRIC_REFUSED,
    METRIC_LATE,
    METRIC_MISSED,
    METRIC_LOST,
    METRIC_MALFORMED,
    METRIC_TIMEOUTS,
    METRIC_SILENCE,
    METRIC_STOPPED,
    /* the run's */
    METRIC_FAULTS,
    METRIC_RESIDUAL,
    METRIC_WATCH,
    METRIC_HASH,
    METRICS
};

enum metric_of { OF_CONTACTS, OF_SIGNAL, OF_TARGET, OF_CONTROLLER, OF_RUN };

struct metric {
    const char *name; /* a signal's follows its name and a point */
    enum metric_of of;
    const char *unit; /* "" for none; U stands for that of the signal */
    const char *meaning;
};
extern const struct metric metric_table[METRICS];

enum { METRIC_UNIT = 64, METRIC_NOTE = 40, METRIC_SIGNALS = MODEL_OUTPUTS + MODEL_INPUTS + 4 /* at most */ };

/* A signal of the plant: output i; from n_outputs on the command of an input, its streamed sample; then the
 * frequency of the drives that sound, and the contact's eigenfrequency. */
int metric_signals(const struct model *m);
bool metric_is_frequency(const struct model *m, int i);
void metric_signal_name(const struct model *m, int i, char text[METRIC_UNIT]);
const struct signal *metric_signal(const struct model *m, int i);

/* The unit of a metric, of signal `i` where it has one. */
void metric_unit(const struct model *m, enum metric_kind kind, int i, char text[METRIC_UNIT]);

/* One metric over one window. */
struct metric_setting {
    enum metric_kind kind;
    int signal;          /* a signal's or target's; -1: none */
    double from_s, to_s; /* plant time */
    double target, band; /* a target's, SI */
    double frequency_Hz; /* for amplitude and phase */
};

/* A measured value. */
struct metric_value {
    bool known;             /* else nothing fell into the window */
    double value, when_s;   /* SI, a share in %; plant time of what decided it */
    uint64_t hash;          /* the value of METRIC_HASH */
    char note[METRIC_NOTE]; /* more about it, or "" */
};

/* Values of signals, SI, at the ends of n ticks that follow each other. */
enum { METRIC_TICKS = 64 };
struct metric_block {
    int n_signals, n;
    uint64_t first;            /* tick */
    bool outputs;              /* some signal is one */
    unsigned frequencies;      /* bit k: frequency[k] is read */
    const struct model *model; /* that the units belong to */
    struct scale scale;
    double output[MODEL_OUTPUTS], frequency[2]; /* now */
    struct metric_source {
        const double *now; /* model units */
        double unit;
        double *value; /* [METRIC_TICKS], SI */
        int signal;
    } source[METRIC_SIGNALS];
    double value[METRIC_SIGNALS][METRIC_TICKS]; /* by signal */
    bool tones;                                 /* the drives are read, too */
    struct fit_drive drive[METRIC_TICKS][MODEL_INPUTS];
};

/* An empty block, for the signals of this plant whose bits are set in `which`. Neither may be moved then. */
void metric_block_begin(struct metric_block *b, const struct plant *pl, uint32_t which);

/* Adds the values now; true when the block is full. */
bool metric_block_add(struct metric_block *b, const struct plant *pl);

/* The value of a metric that is a sum of the plant's counters, count[DIAG_COUNTERS]. */
double metric_count(enum metric_kind kind, const uint32_t *count);

/* Kinds of faults among these bits, beside a time-out. */
double metric_faults(unsigned faults);

#endif
