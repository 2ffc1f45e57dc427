/* test_file.h - a test file: the plant, the controller, and cases of what happens and what is expected.
 *
 * docs/guide/controller-tests.md is the manual of the format. */
#ifndef HOST_SIM_TEST_FILE_H
#define HOST_SIM_TEST_FILE_H

#include "host_sim/listen/decode_rows.h"
#include "host_sim/live/action.h"
#include "host_sim/replay/compare.h"
#include "host_sim/scene/range.h"
#include "host_sim/scene/scene_text.h"
#include "host_sim/test/metric.h"

enum {
    TEST_BYTES = 65536,
    TEST_CASES = 64,
    TEST_NAME = 48,
    TEST_VALUE = SCENE_FILE_LINE + 1,
    TEST_ACTS = 48,         /* `at` lines of a case, those it has by `like` included */
    TEST_SETS = 12,         /* values of a plant */
    TEST_EXPECTS = 48,      /* in a case */
    TEST_STEPS = 1000,      /* seeds, or values of vary */
    TEST_KEYS = 16,         /* in a section */
    TEST_REQUIREMENTS = 16, /* that a case names */
    TEST_RECORD = 180,      /* characters of a name of records */
    TEST_REASON = SCENE_FILE_REASON
};

/* One `at` line. */
struct test_act {
    double at_s;        /* plant time */
    bool waits;         /* a drive that a later fire applies */
    struct action what; /* a fire has the fields of all that were armed for it */
};

enum test_operator { TEST_EQUAL, TEST_UNEQUAL, TEST_AT_MOST, TEST_AT_LEAST, TEST_BELOW, TEST_ABOVE };

struct test_expect {
    int line;
    char text[TEST_VALUE]; /* as it stands in the file */
    struct metric_setting what;
    enum test_operator op;
    double value;
    char unit[METRIC_UNIT]; /* in which it asks */
    double one;             /* such unit in the metric's */
    uint64_t hash;
};

/* The plant's own numbers beside its scene; 0 and none: the scene's. */
struct test_plant {
    double rate_Hz;
    uint32_t substeps;
    int n;
    struct action_set set[TEST_SETS];
};

struct test_case {
    char name[TEST_NAME];
    char record[TEST_RECORD]; /* how its recordings are called (record.h) */
    bool names_seed;          /* they and the report say which seed a run has */
    int line;
    double over_s; /* plant time */
    struct test_plant plant;
    char link[TEST_VALUE]; /* faults of the link, or "" */
    uint32_t first_seed, n_seeds;
    int varied;        /* wire index, or -1 */
    struct range vary; /* n 1: there is none */
    bool has_target;
    int target_signal;
    double target, band;
    double lockin_Hz; /* 0: not said */
    int golden_line;
    char golden[TEST_VALUE]; /* a log to compare with, beside the file, or "" */
    struct compare_limit limit[DECODE_SIGNALS];
    int requirement_line, n_requirements;
    char requirement[TEST_REQUIREMENTS][TEST_NAME]; /* identifiers */
    int n_acts, n_expects;
    struct test_act act[TEST_ACTS]; /* by time */
    struct test_expect expect[TEST_EXPECTS];
};

struct test_file {
    const char *file;
    char scene_name[TEST_VALUE];
    struct scene scene; /* its model names the signals */
    struct scene lever; /* inside a microscope; else its model is NULL */
    struct test_plant plant;
    bool loops;               /* the controller is the station's own loops */
    char command[TEST_VALUE]; /* runs the controller, or "" */
    bool attached;            /* it runs elsewhere and connects by itself */
    int namesakes;            /* test files of this name before it, in other folders */
    int n_cases;
    struct test_case cases[TEST_CASES];
};

#endif
