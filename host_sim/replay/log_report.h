/* log_report.h - the report of a recorded log: charts of its rows and contact events. */
#ifndef HOST_SIM_LOG_REPORT_H
#define HOST_SIM_LOG_REPORT_H

#include "host_sim/cli/options.h"
#include "host_sim/replay/decode_rows.h"
#include "host_sim/report/decimate.h"
#include "host_sim/report/html.h"
#include "host_sim/scene/scene_app.h"

enum { LOG_SWITCHES_TOLD = 20 };

/* From t_s on these contacts are closed. */
struct log_switch {
    double t_s;
    unsigned closed;
};

struct log_report {
    struct html html;
    struct decimate rows, impacts;
    double first_s;  /* time of the first row */
    double marker_s; /* a line there in each chart; NaN: none */
    struct decode_event told[LOG_SWITCHES_TOLD];
    unsigned long touchdowns, liftoffs,
        seen; /* seen: changes of contact in the rows, whether sent as events or not */
    double hardest_m_per_s, peak_N;
    struct log_switch *change; /* [n_changes], grows */
    size_t n_changes, room;
    unsigned closed;
    bool no_memory;
};

/* A part of another report, and its end. */
void log_report_begin_in(struct log_report *p, const struct html *h, const struct model *m);
void log_report_end_in(struct log_report *p, struct html *h);

void log_report_row(struct log_report *p, const struct decode_row *row);
void log_report_event(struct log_report *p, const struct decode_event *e);

void log_report_charts(struct log_report *p, const struct scene_app *s);

/* The whole of a log as --report, if that was given. `more`
 * adds to it, or is NULL. 0, or the exit status after a line. */
int log_report(const struct options *o, const char *log, const struct scene_app *s, int argc, char **argv,
               void (*more)(struct html *h, const void *context), const void *context);

#endif
