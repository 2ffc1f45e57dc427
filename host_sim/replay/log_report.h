/* log_report.h - the report of a recorded log: charts of its rows and contact events. */
#ifndef HOST_SIM_LOG_REPORT_H
#define HOST_SIM_LOG_REPORT_H

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

/* Opens the file. NULL, or what went wrong. */
const char *log_report_begin(struct log_report *p, const char *path, const char *title, const struct model *m,
                             int argc, char **argv);
/* Begin and end of such a part inside of another report. */
void log_report_begin_in(struct log_report *p, const struct html *h, const struct model *m);
void log_report_end_in(struct log_report *p, struct html *h);

void log_report_row(struct log_report *p, const struct decode_row *row);
void log_report_event(struct log_report *p, const struct decode_event *e);

/* The charts; then the caller may add tables to p->html. */
void log_report_charts(struct log_report *p, const struct scene_app *s);

/* The scene, and the end of the file. NULL, or what went wrong. */
const char *log_report_end(struct log_report *p, const struct scene_app *s);

#endif
