/* options.h - a small table-driven parser of long options; the same table prints the help.
 *
 * It takes `--name VALUE` and `--name=VALUE`, words anywhere between them, `--` to end the options, and
 * `--help` always.
 *
 * Each mistake prints one line on stderr that says what to do. Mistakes are unknown options (the line
 * names the nearest valid one), options given twice, numbers that are malformed, not finite or out of
 * range, and missing or superfluous words. */
#ifndef HOST_SIM_OPTIONS_H
#define HOST_SIM_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum {
    OPTIONS_TABLES = 6,  /* tables that one command may combine */
    OPTIONS_GIVEN = 96,  /* options on one command line */
    OPTIONS_WORDS = 4096 /* words on one command line */
};

/* A value that names a file or a folder has a kind of its own, which keeps outputs from inputs (files.h). */
enum option_kind {
    OPTION_FLAG,
    OPTION_TEXT,
    OPTION_NUMBER,
    OPTION_INTEGER,
    OPTION_READS, /* a file that the command reads */
    OPTION_WRITES,
    OPTION_FOLDER /* into which it writes */
};

/* Whether an option of a map belongs to the identity of its rows (host_sim/maps/maps.h). A map refuses to run
 * with a row that does not say it. */
enum option_identity {
    IDENTITY_UNSAID,
    IDENTITY_OUTSIDE,  /* the rows are the same whatever it says */
    IDENTITY_IN_SCENE, /* it changes the scene, which the identity has anyway */
    IDENTITY_INSIDE    /* the rows depend on its value */
};

struct option {
    const char *name;     /* without the dashes; NULL ends the table */
    const char *argument; /* the placeholder of its value in the help; NULL for a flag */
    const char *meaning;  /* one sentence, units and default included */
    enum option_kind kind;
    double min, max;     /* range of a number, inclusive */
    const char *initial; /* the value when it is not given; NULL for none */
    bool many;           /* may be given more than once */
    enum option_identity identity;
};

/* The options and words that one command accepts, and its help. */
struct usage {
    const char *name;       /* the subcommand */
    const char *words;      /* how its words are written, e.g. "[MODEL]" */
    const char *summary;    /* its purpose; may have several lines */
    const char *words_help; /* the words' meaning, indented lines; NULL for nothing */
    const char *examples;   /* indented lines */
    int min_words, max_words;
    int words_written; /* the first so many words name files that are written */
    int words_read;    /* the next ones name files that are read; a SCENE is none of them */
    const struct option *table[OPTIONS_TABLES]; /* own options, then shared ones; NULL for none */
};

struct given {
    const struct option *option;
    const char *text;
    double number;
};

struct options {
    const struct usage *usage;
    int argc; /* the command line, as it was given */
    char **argv;
    int n_words, n_given;
    const char *word[OPTIONS_WORDS];
    struct given given[OPTIONS_GIVEN];
};

/* Parses argv[1..]. True when the command may go on; else *status is what to exit with: 0 after --help,
 * 2 after a mistake, which is on stderr. The strings stay argv's. */
bool options_parse(struct options *o, const struct usage *u, int argc, char **argv, int *status);

/* True when the option was on the command line. */
bool options_given(const struct options *o, const char *name);

/* Its i-th value, its default for i = 0 when it was not given, or NULL. */
const char *options_text(const struct options *o, const char *name, int i);

/* Its number, given or by default; NaN without either. */
double options_number(const struct options *o, const char *name);

/* How often it was given. */
int options_count(const struct options *o, const char *name);

/* A finite decimal (or 0x.. integer) number without anything behind it. */
bool options_read_number(const char *text, double *value);

/* Whether these files (NULL behind the last) may be written into the folder of an option, which need not be
 * there yet: none is an input or another output. 0, or the exit status after a line. */
int options_check_folder(const struct options *o, const char *name, const char *const *file);

/* The file of an option that writes one, to write as it comes, or in memory until options_close. NULL, after
 * a line on stderr, where it cannot be written. */
FILE *options_create(const struct options *o, const char *name);
FILE *options_compose(const struct options *o, const char *name);

/* Ends that file, or standard output in its place. why: NULL, or why it is not to be kept as it is. 0, or the
 * exit status after a line. */
int options_close(const struct options *o, const char *name, FILE *f, const char *why);

/* The stream of a command's summary: standard output, or standard error where that has the rows of --out. */
FILE *options_summary(const struct options *o);

enum { OPTIONS_ADVICE = 256 }; /* has room for most lists */

/* The place of an option's word among n names, or -1 after a line on stderr: what is `lacking`, and the
 * nearest name. */
int options_find(const struct options *o, const char *option, const char *const *name, int n,
                 const char *lacking);

/* Standard output is a pipe that its reader has closed: nothing more is wanted, and that is no failure. */
bool options_reader_left(void);

/* The end of command `name`: its status; a failure with its line where standard output could not be
 * written. */
int options_finish(const char *name, int status);

/* One line on stderr, `contactplant NAME: ...`; returns the exit status, 2 for misuse and 1 for a failure. */
int options_misuse(const struct usage *u, const char *format, ...) __attribute__((format(printf, 2, 3)));
int options_failure(const struct usage *u, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
