/* metric.h - the metrics that a test may expect: one table with unit and meaning, and one measurement of
 * each.
 *
 * A measurement sees the plant's truth at the end of each tick and each located contact switch in the window
 * [from, to] of plant time. Sensors, sampling and the bus are not in between. */
#ifndef HOST_SIM_METRIC_H
#define HOST_SIM_METRIC_H

#include "firmware/app/app.h"
#include "host_sim/trial/fit.h"

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

enum { METRIC_UNIT = 64, METRIC_NOTE = 40, METRIC_SIGNALS = MODEL_OUTPUTS + MODEL_INPUTS + 2 /* at most */ };

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

/* Sums of a window, by ticks; times are plant time. */
struct metric_sums {
    uint64_t n, last_tick;                        /* samples, and the tick of the last one */
    double first_s, last_s, start, last, apart_s; /* the last two lie so far apart */
    double least, most, least_s, most_s;
    double integral, square, magnitude;     /* integrals of x, x^2, |x| */
    double error, error_square, error_time; /* integrals of |e|, e^2, t |e| */
    double tail, tail_s;                    /* integral of e over the last tenth, and its length */
    double outside_s;                       /* the last sample outside the band; -1: none */
};

struct measurement {
    struct metric_setting set;
    double tick_s;
    uint64_t from, to; /* ticks */
    struct metric_sums sum;
    struct fit fit;
    bool open; /* every contact, since open_s */
    double open_s;
    double lost_s, longest_s, longest_end_s, last_loss_s; /* clipped to the window */
    double count, peak, when_s;
    double before; /* a counter at the window's begin */
    uint64_t n_frames;
    double stopped_s;
    const char *untold; /* why nothing tells it in this run, or NULL */
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

/* A measurement of a plant before its first tick, with every contact open, or not. */
void measurement_begin(struct measurement *m, const struct metric_setting *s, double tick_s, bool all_open);

/* Whether ticks tell it anything. */
bool measurement_reads(const struct measurement *m);

/* Whether it tells a tone, which wants to know the drives. */
bool measurement_is_tone(const struct measurement *m);

/* The values of its signal at the ends of n ticks, tick 0 among them; NaN for what was not seen. drive: the
 * drives then, or NULL. */
void measurement_ticks(struct measurement *m, uint64_t first, int n, const double *value,
                       const struct fit_drive (*drive)[MODEL_INPUTS]);

/* One tick; value[METRIC_SIGNALS], of all signals. */
void measurement_tick(struct measurement *m, uint64_t tick, const double *value);

/* A located contact switch. */
void measurement_event(struct measurement *m, const struct event *e);

/* From plant time t on every contact is open, or not. */
void measurement_switch(struct measurement *m, double t, bool all_open);

/* The end of a bus frame, for metrics of controller and run: x is a count so far or a size now. For
 * METRIC_STOPPED it is when a command ended the session; negative: not yet. */
void measurement_frame(struct measurement *m, double t_s, double x);

/* The end of the run at plant time now_s; `hash`: the plant's. */
void measurement_end(struct measurement *m, double now_s, uint64_t hash, struct metric_value *v);

#endif
