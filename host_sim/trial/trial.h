/* trial.h - a test file: the plant, the controller, and cases of what happens and what is expected.
 *
 * docs/guide/controller-tests.md is the manual of the format. */
#ifndef HOST_SIM_TRIAL_H
#define HOST_SIM_TRIAL_H

#include "host_sim/listen/decode_rows.h"
#include "host_sim/live/action.h"
#include "host_sim/scene/range.h"
#include "host_sim/scene/scene_text.h"
#include "host_sim/trial/metric.h"

enum {
    TRIAL_BYTES = 65536,
    TRIAL_CASES = 64,
    TRIAL_NAME = 48,
    TRIAL_VALUE = SCENE_FILE_LINE + 1,
    TRIAL_ACTS = 48,         /* `at` lines of a case, those it has by `like` included */
    TRIAL_SETS = 12,         /* values of a plant */
    TRIAL_EXPECTS = 48,      /* in a case */
    TRIAL_STEPS = 1000,      /* seeds, or values of vary */
    TRIAL_KEYS = 16,         /* in a section */
    TRIAL_REQUIREMENTS = 16, /* that a case names */
    TRIAL_RECORD = 180,      /* characters of a name of records */
    TRIAL_REASON = SCENE_FILE_REASON
};

/* One `at` line. */
struct trial_act {
    double at_s;        /* plant time */
    bool waits;         /* a drive that a later fire applies */
    struct action what; /* a fire has the fields of all that were armed for it */
};

enum trial_operator { TRIAL_EQUAL, TRIAL_UNEQUAL, TRIAL_AT_MOST, TRIAL_AT_LEAST, TRIAL_BELOW, TRIAL_ABOVE };

struct trial_expect {
    int line;
    char text[TRIAL_VALUE]; /* as it stands in the file */
    struct metric_setting what;
    enum trial_operator op;
    double value;
    uint64_t hash;
};

/* The plant's own numbers beside its scene; 0 and none: the scene's. */
struct trial_plant {
    double rate_Hz;
    uint32_t substeps;
    int n;
    struct action_set set[TRIAL_SETS];
};

struct trial_case {
    char name[TRIAL_NAME];
    char record[TRIAL_RECORD]; /* how its recordings are called (record.h) */
    bool names_seed;           /* they and the report say which seed a run has */
    int line;
    double over_s; /* plant time */
    struct trial_plant plant;
    char link[TRIAL_VALUE]; /* faults of the link, or "" */
    uint32_t first_seed, n_seeds;
    int varied;        /* wire index, or -1 */
    struct range vary; /* n 1: there is none */
    bool has_target;
    int target_signal;
    double target, band;
    double lockin_Hz; /* 0: not said */
    int golden_line;
    char golden[TRIAL_VALUE];         /* a log to compare with, beside the file, or "" */
    double tolerance[DECODE_SIGNALS]; /* NaN: not compared */
    int requirement_line, n_requirements;
    char requirement[TRIAL_REQUIREMENTS][TRIAL_NAME]; /* identifiers */
    int n_acts, n_expects;
    struct trial_act act[TRIAL_ACTS]; /* by time */
    struct trial_expect expect[TRIAL_EXPECTS];
};

struct trial {
    const char *file;
    char scene_name[TRIAL_VALUE];
    struct scene scene; /* its model names the signals */
    struct scene lever; /* inside a microscope; else its model is NULL */
    struct trial_plant plant;
    bool loops;                /* the controller is the station's own loops */
    char command[TRIAL_VALUE]; /* runs the controller, or "" */
    bool attached;             /* it runs elsewhere and connects by itself */
    int namesakes;             /* test files of this name before it, in other folders */
    int n_cases;
    struct trial_case cases[TRIAL_CASES];
};

#endif
