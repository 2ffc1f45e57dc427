/* trial.h - a test file: the plant, the controller, and cases of what happens and what is expected.
 *
 * docs/guide/controller-tests.md is the manual of the format. Reading is pure but for `load`: a buffer in, a
 * trial or one line out, with file, line, what is wrong, what is allowed, and the nearest name. */
#ifndef HOST_SIM_TRIAL_H
#define HOST_SIM_TRIAL_H

#include "host_sim/replay/decode_rows.h"
#include "host_sim/scene/scene_text.h"
#include "host_sim/trial/metric.h"

enum {
    TRIAL_BYTES = 65536,
    TRIAL_CASES = 64,
    TRIAL_NAME = 48,
    TRIAL_VALUE = SCENE_FILE_LINE + 1,
    TRIAL_ACTS = 48,    /* `at` lines of a case, those it has by `like` included */
    TRIAL_SETS = 12,    /* values of one `at .. set`, and of a plant */
    TRIAL_EXPECTS = 48, /* in a case */
    TRIAL_STEPS = 1000, /* seeds, or values of vary */
    TRIAL_KEYS = 16,    /* in a section */
    TRIAL_LIST = 128,   /* characters of faults */
    TRIAL_RECORD = 180, /* characters of a name of records */
    TRIAL_REASON = SCENE_FILE_REASON
};

/* A parameter of the model or a setting, by wire index. */
struct trial_set {
    unsigned index;
    double value;
};

/* A drive, the instant of a drive, parameters and settings,
 * a sample of a sampled command, the faults of the link. */
enum trial_verb { TRIAL_ARM, TRIAL_FIRE, TRIAL_SET, TRIAL_STREAM, TRIAL_FAULTS, TRIAL_VERBS };

/* One `at` line. */
struct trial_act {
    double at_s; /* plant time */
    enum trial_verb verb;
    int input;      /* for a drive or sample */
    bool waits;     /* a drive that a later fire applies */
    unsigned given; /* fields of the drive; of a fire: all that were armed for it */
    double value[DRIVE_FIELDS];
    double sample; /* SI */
    char list[TRIAL_LIST];
    int n;
    struct trial_set set[TRIAL_SETS];
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
    struct trial_set set[TRIAL_SETS];
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
    int varied; /* wire index, or -1 */
    double vary_from, vary_to;
    int n_varied;
    bool has_target;
    int target_signal;
    double target, band;
    double lockin_Hz; /* 0: not said */
    int golden_line;
    char golden[TRIAL_VALUE];         /* a log to compare with, beside the file, or "" */
    double tolerance[DECODE_SIGNALS]; /* NaN: not compared */
    int n_acts, n_expects;
    struct trial_act act[TRIAL_ACTS]; /* by time */
    struct trial_expect expect[TRIAL_EXPECTS];
};

struct trial {
    const char *file;
    char scene_name[TRIAL_VALUE];
    struct scene scene;
    bool is_microscope; /* the plant is a lever with its station; then scene.model names its signals */
    struct scene lever; /* and this is its scene */
    struct trial_plant plant;
    bool loops;                /* the controller is the station's own loops */
    char command[TRIAL_VALUE]; /* runs the controller, or "" */
    bool attached;             /* it runs elsewhere and connects by itself */
    int namesakes;             /* test files of this name before it, in other folders */
    int n_cases;
    struct trial_case cases[TRIAL_CASES];
};

/* The n bytes of text, called `file` in messages. `load` finds a scene by its name: false with
 * why[SCENE_FILE_REASON]. False: why[TRIAL_REASON] is one line, and *t is not to be used. */
bool trial_parse(const char *file, const char *text, size_t n,
                 bool (*load)(const char *file, const char *name, struct scene *s, char *why),
                 struct trial *t, char *why);

enum trial_section { TRIAL_IN_NOTHING, TRIAL_IN_PLANT, TRIAL_IN_CONTROLLER, TRIAL_IN_CASE };

/* The parts of the reader share this. */
struct trial_reader {
    struct scene_text text;
    struct trial *trial;
    bool (*load)(const char *file, const char *name, struct scene *s, char *why);
    struct trial_case *now; /* NULL before the first case */
    enum trial_section section;
    bool given[TRIAL_KEYS]; /* keys of this section */
};

/* One line into why: this line of the file, and the message. Always false. */
#define trial_wrong(r, ...) scene_text_wrong((r)->text.file, (r)->text.line, (r)->text.why, __VA_ARGS__)

/* A value with its unit inside [min, max]. `name`: in messages. */
bool trial_read_value(struct trial_reader *r, const char *name, struct word w, const char *unit, double min,
                      double max, double *value);

/* A text into to[size]. */
bool trial_copy(struct trial_reader *r, struct word w, char *to, size_t size);

/* A line KEY = VALUE. */
bool trial_read_key(struct trial_reader *r, struct word w);

/* A whole number. */
bool trial_read_count(struct trial_reader *r, const char *name, struct word w, double min, double max,
                      double *value);

/* Splits at the first `..`; false where there is none. */
bool trial_split_range(struct word w, struct word *from, struct word *to);

/* The wire index of a parameter or setting, mass_kg or mass; -1: there is none, and trial_no_name is the
 * message, with keys that may stand there too. */
int trial_find_set(struct trial_reader *r, struct word name);
bool trial_no_name(struct trial_reader *r, struct word name, const char *const *key, int n_keys);

/* A parameter or setting and its value. A name with its unit in it, as mass_kg, takes a bare number too. */
bool trial_read_set(struct trial_reader *r, struct word name, struct word value, struct trial_set *set);

/* The model whose parameters and settings these are; a microscope's signals are another's. */
const struct model *trial_model(const struct trial *t);

/* The parameter or setting with this index; NULL where there is none. */
const struct parameter *trial_parameter(const struct trial *t, int index);

/* Takes ` MARK TAIL`, the last of its kind, off the end of *rest. */
bool trial_take_tail(struct word *rest, const char *mark, struct word *tail);

/* The signal of this name; -1 after a message. */
int trial_find_signal(struct trial_reader *r, struct word name);

/* `at TIME VERB WORDS`, without the `at`: arm INPUT FIELD=VALUE.., fire INPUT, set NAME=VALUE.., stream INPUT
 * VALUE, faults LIST. */
bool trial_read_at(struct trial_reader *r, struct word rest);

/* All lines of the case are known: gives each fire what was armed for it. */
bool trial_bind_fires(struct trial_reader *r, struct trial_case *c);

/* The instant of a fire, to a 256th of a tick as FIRE names it. */
struct instant trial_instant(const struct trial_act *a, double tick_s);

/* The i-th of the case's values of `vary`, of which it has some. */
double trial_varied_value(const struct trial_case *c, int i);

/* `expect METRIC OP VALUE [from TIME] [to TIME]`, without the `expect`. */
bool trial_read_expect(struct trial_reader *r, struct word rest);

#endif
