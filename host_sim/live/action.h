/* action.h - actions on a plant, with one table of verbs and one reader. The commands of contactplant send
 * are actions, and so are the `at` lines of a test file. The scope's page runs send.
 *
 * Who acts takes some of the verbs: send those of a controller, a test those that its plant can do. */
#ifndef HOST_SIM_ACTION_H
#define HOST_SIM_ACTION_H

#include <stdbool.h>
#include <stdint.h>
#include "firmware/plant/plant.h"
#include "host_sim/scene/scene_name.h"
#include "host_sim/scene/scene_text.h"
#include "models/model.h"

enum action_verb {
    ACTION_ENABLE,
    ACTION_DISABLE,
    ACTION_START,
    ACTION_STOP,
    ACTION_PAUSE,
    ACTION_STEP,
    ACTION_RUN_UNTIL,
    ACTION_RESET,
    ACTION_ARM,
    ACTION_FIRE,       /* all that is armed */
    ACTION_FIRE_INPUT, /* the drive that is armed for one input */
    ACTION_STREAM,
    ACTION_SET,
    ACTION_READ,
    ACTION_CAPTURE,
    ACTION_FAULTS, /* the link's */
    ACTION_VERBS
};

enum { ACTION_SETS = 32, ACTION_TEXT = 128 };

/* A parameter or setting, by wire index. */
struct action_set {
    unsigned index;
    double value;
};

struct action {
    enum action_verb verb;
    int input;                  /* arm, fire, stream */
    unsigned given;             /* arm: fields */
    double value[DRIVE_FIELDS]; /* SI */
    double sample;              /* stream: SI */
    int n;                      /* set: how many; read: 1 */
    struct action_set set[ACTION_SETS];
    uint64_t argument;      /* step: frames; run-until: tick */
    int operation;          /* capture: enum capture_operation */
    uint32_t first, count;  /* capture read: samples; count 0: all */
    char text[ACTION_TEXT]; /* read: the name; faults: their list */
};

/* Which verb of these (bits 1 << enum action_verb) the word is; ACTION_VERBS: none. */
enum action_verb action_find(unsigned verbs, struct word word);

/* Names of these verbs into name[ACTION_VERBS]: how many. */
int action_names(unsigned verbs, const char **name);

/* The words behind a verb into *a. False: why[SCENE_REASON] is one line without the verb's place. */
bool action_read(const struct model *m, enum action_verb verb, struct word words, struct action *a,
                 char *why);

/* The values of a set, as a client takes them: index[ACTION_SETS], value[ACTION_SETS]. */
void action_split_set(const struct action *a, unsigned *index, double *value);

/* The fields of a drive into field[DRIVE_FIELDS], as a client arms them: NaN where not given. */
void action_fields(const struct action *a, double *field);

#endif
