/* view.h - recorded logs as answers in JSON to a page that shows them.
 *
 *   /log                                   what there is: logs, runs, signals, names
 *   /range?log=&run=&from=&to=&pixels=     a part of plant time (s) in columns
 *   /row?log=&run=&at=                     the row at a time
 *   /next?log=&run=&at=&back=&kinds=       the next mark, or the one before
 *
 * Numbers have the digits of contactplant decode; null is not known. */
#ifndef HOST_SIM_VIEW_H
#define HOST_SIM_VIEW_H

#include "host_sim/cli/options.h"
#include "host_sim/out/json.h"
#include "host_sim/replay/compare.h"
#include "host_sim/scene/scene.h"
#include "host_sim/view/log_range.h"

enum { VIEW_LOGS = 2 };

struct view_log {
    const char *path;
    struct log_index index;
    uint64_t file, bytes; /* number of the file and its size when it was read last */
    const char *lost;     /* NULL, or why it cannot be followed any more */
};

struct view {
    struct scene_app scene;
    int n_logs;
    struct view_log log[VIEW_LOGS];
    struct compare_course course; /* two logs: what compare says, and ... */
    struct log_index apart;       /* ... the first less the second, as log 2 of /range */
    bool full;                    /* no memory for more of them */
    struct log_range range;
    bool follows;
    double looked_s; /* when the files were looked at last; of the clock */
    double part_s;   /* where two logs part; NaN: they do not, or no value of both does */
};

/* Opens the logs of --open, of this scene, and says on stderr what was passed over. All zero before. 0, or
 * the exit status after a line. */
int view_open(struct view *v, const struct options *o);

/* With --follow, twice a second: reads what the logs have more. */
void view_turn(struct view *v);

enum view_status { VIEW_DONE, VIEW_UNKNOWN, VIEW_BAD };

/* The answer to a target with its query: VIEW_UNKNOWN: there is no such target; VIEW_BAD: *why says it. */
enum view_status view_answer(struct view *v, const char *target, const char *query, struct json *j,
                             const char **why);

void view_close(struct view *v);

#endif
