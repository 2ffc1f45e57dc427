/* measure.h - a measurement: one metric over one window [from, to] of plant time.
 *
 * It sees the plant's truth at the end of each tick and each located contact switch. Sensors, sampling and
 * the bus are not in between. */
#ifndef HOST_SIM_MEASURE_H
#define HOST_SIM_MEASURE_H

#include "host_sim/test/fit.h"
#include "host_sim/test/metric.h"

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
