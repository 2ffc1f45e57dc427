/* log_report.h - the report of a recorded log: charts of its rows and contact events. */
#ifndef HOST_SIM_LOG_REPORT_H
#define HOST_SIM_LOG_REPORT_H

#include "host_sim/cli/options.h"
#include "host_sim/listen/decode_rows.h"
#include "host_sim/replay/log_series.h"
#include "host_sim/report/html.h"
#include "host_sim/scene/scene_app.h"

enum { LOG_SWITCHES_SHOWN = 20 };

/* From t_s on these contacts are closed, if that is known. */
struct log_switch {
    double t_s;
    unsigned closed;
    bool known;
};

/* The greatest and how many of something that events tell with a number. */
struct log_most {
    unsigned long n, n_beyond; /* events; those whose number was beyond the bus's range */
    unsigned long n_missing;   /* those whose number is missing in the log */
    double most;               /* the greatest of the others */
};

struct log_report {
    struct html html;
    struct log_series rows;
    struct decimate impacts;
    double first_s;  /* time of the first row */
    unsigned n_anew; /* how often plant time began anew */
    double marker_s; /* a line there in each chart; NaN: none */
    struct listen_event shown[LOG_SWITCHES_SHOWN];
    struct log_most impact, peak; /* speeds of touchdowns, forces of lift-offs */
    unsigned long seen;           /* changes of contact in the rows, whether sent as events or not */
    struct log_switch *change;    /* [n_changes], grows */
    size_t n_changes, room;
    unsigned closed;
    bool known; /* `closed` is */
    bool no_memory;
};

/* A part of another report, and its end. */
void log_report_begin_in(struct log_report *p, const struct html *h, const struct model *m);
void log_report_end_in(struct log_report *p, struct html *h);

void log_report_row(struct log_report *p, const struct decode_row *row);
void log_report_event(struct log_report *p, const struct listen_event *e);

/* The tally of the log tells what was not sent, and may be of a longer time than the rows. */
void log_report_charts(struct log_report *p, const struct scene_app *s, const struct log_tally *tally);

/* The whole of a log as --report, if that was given. `interface`: see plant_log_open. `more` adds to it, or
 * is NULL; with it stand the counters count[DIAG_COUNTERS] of the run itself. 0, or the exit status after a
 * line. */
int log_report(const struct options *o, const char *log, const char *interface, const struct scene_app *s,
               int argc, char **argv, const uint32_t *count,
               void (*more)(struct html *h, const void *context), const void *context);

#endif
