/* test_reader.h - common parts of the reader of a test file: values, ranges, signals, parameters. */
#ifndef HOST_SIM_TEST_READER_H
#define HOST_SIM_TEST_READER_H

#include "host_sim/test/test_file.h"

enum test_section { TEST_IN_NOTHING, TEST_IN_PLANT, TEST_IN_CONTROLLER, TEST_IN_CASE };

/* The parts of the reader share this. */
struct test_reader {
    struct scene_text text;
    struct test_file *test;
    bool (*load)(const char *file, const char *name, struct scene *s, char *why);
    struct test_case *now; /* NULL before the first case */
    enum test_section section;
    bool given[TEST_KEYS];     /* keys of this section */
    bool set_given[TEST_SETS]; /* and its parameters and settings */
};

/* One line into why: this line of the file, and the message. Always false. */
#define test_wrong(r, ...) scene_text_wrong((r)->text.file, (r)->text.line, (r)->text.why, __VA_ARGS__)

/* A value with its unit inside [min, max]. `name`: in messages. */
bool test_read_value(struct test_reader *r, const char *name, struct word w, const char *unit, double min,
                     double max, double *value);

/* A text into to[size]. */
bool test_copy(struct test_reader *r, struct word w, char *to, size_t size);

/* A whole number. */
bool test_read_count(struct test_reader *r, const char *name, struct word w, double min, double max,
                     double *value);

/* Splits at the first `..`; false where there is none. */
bool test_split_range(struct word w, struct word *from, struct word *to);

/* The wire index of a parameter or setting, mass_kg or mass; -1: there is none, and test_no_name is the
 * message, with keys that may stand there too. */
int test_find_set(struct test_reader *r, struct word name);
bool test_no_name(struct test_reader *r, struct word name, const char *const *key, int n_keys);

/* The model whose parameters and settings these are; a microscope's signals are another's. */
const struct model *test_model(const struct test_file *t);

/* A parameter or setting and its value. A name with its unit in it, as mass_kg, takes a bare number too. */
bool test_read_set(struct test_reader *r, struct word name, struct word value, struct action_set *set);

/* Takes ` MARK TAIL`, the last of its kind, off the end of *rest. */
bool test_take_tail(struct word *rest, const char *mark, struct word *tail);

/* Names of all signals into name[METRIC_SIGNALS], until the next call; the one that is wanted, or -1. */
int test_list_signals(const struct model *m, struct word wanted, const char **name);

/* The signal of this name; -1 after a message. */
int test_find_signal(struct test_reader *r, struct word name);

#endif
