/* choose.h - the cheapest combination of model, method and step that meets a scene's tolerance within its deadline.
 *
 * The ladder goes down from the scene's own model, the full one here: choose_ladder.c says which rungs a scene has and
 * writes the same scene for each; choose_test.c has the tests that cost nothing; choose_run.c runs a scene and compares;
 * choose_search.c decides, from instruction counts (choose_cost.c) and never from times, so that the same scene gets the
 * same answer everywhere; choose_print.c and choose_json.c write the certificate.
 *
 * The error is that of the observable asked, inside and at the end of each frame over all the time asked, start transients included: the
 * largest difference from the full model by a method of tight tolerance, over the peak-to-peak value that this one has
 * there (plus 1e-6 of the model's own unit, for motions at rest). Where full runs from starts that differ by 1e-9 of that
 * unit part by more than the tolerance (and 1e-4), no trajectory can be compared: then it is the error of mean, rms about the mean,
 * largest value (each over the peak-to-peak value) and share of time without contact, the worst of the four, plus three
 * standard deviations of that statistic among full runs from starts that differ by 1e-3. A step at which the energy that does
 * not balance, by the ledger in any 100 frames, would raise FAULT_LEDGER by its default is no choice. */
#ifndef HOST_SIM_CHOOSE_H
#define HOST_SIM_CHOOSE_H

#include <stdbool.h>
#include <stdio.h>
#include "firmware/method/taylor/taylor_piece.h"
#include "models/scenes/scenes.h"

enum {
    CHOOSE_RUNGS = 5,    /* models on one ladder */
    CHOOSE_METHODS = 5,  /* methods that a model may be run by */
    CHOOSE_MACHINES = 5, /* that costs are told for; the first is this host */
    CHOOSE_LOOKS = 3,    /* at the observable in a frame: inside, and at its end */
    CHOOSE_TEXT = 240,
    CHOOSE_SPELLS = 8,    /* of the time asked, in which errors grow */
    CHOOSE_TWINS = 8,     /* full runs, for the scatter of statistics */
    CHOOSE_CONDITIONS = 8 /* of a certificate */
};

/* The drive of one input goes from one frequency to the other and back, in `steps` equal holds each way, over the time asked;
 * from hold to hold the frequency moves over one frame, the phase goes on. steps 0: none. */
struct choose_sweep {
    int input, steps;
    double from_Hz, to_Hz;
};

/* The frequency of hold `place`, 0 to steps - 1, on the way there, of the real plant. */
double choose_sweep_Hz(const struct choose_sweep *w, int place);

/* ---- choose_ladder.c ---- */

/* One rung: the scene as that model has it. */
struct choose_rung {
    char name[48]; /* of the model, and which mode of the shaft */
    struct scene scene;
    const char *refused; /* this scene has no such rung: why; else NULL */
    int order;           /* of its force law in the deviation from rest; 0: the full one */
    int mode;            /* of the shaft, the one that it keeps; 0: it keeps all, or is no shaft */
};

/* The rungs of a scene, cheapest first, its own model last. Returns how many. */
int choose_ladder(const struct scene *s, struct choose_rung rung[CHOOSE_RUNGS]);

/* Does this model's state hold only the slow motion, averaged over a fast drive? */
bool choose_ladder_averaged(const struct model *m);

/* Are there rungs below this model that keep one mode of it? */
bool choose_ladder_modal(const struct model *m);

/* Share of mode k = 0..2 of the open shaft in a motion x[3]: its amplitude at the bearing that moves more. */
void choose_ladder_modes(const double *p, const double *x, double q[3]);

/* ---- choose_run.c ---- */

/* Series that taylor expanded in a run, per step (struct taylor_tally). */
struct choose_series {
    double time, regular, brief, further;
};

/* What a run gave. Values are SI of the bus. */
struct choose_record {
    int n, wanted, n_values; /* frames reached, and asked for; n_values: CHOOSE_LOOKS a frame */
    double *value;           /* the observable, the last of each frame's at its end */
    double low, high;        /* penetration of the unclipped contact there, model units of length */
    double loss;             /* share of time with every contact open */
    double modes[3];         /* shaft: largest amplitude of each open mode, model units */
    unsigned switches;       /* contact switches */
    double reach[2]; /* of a rung at the ends of ticks: penetration, or position of a mode; model units */
    double
        imbalance; /* of energy, the largest of 100 frames: beyond ledger_alarm the bus raises FAULT_LEDGER */
    double ns;     /* of one step, measured: information only */
    struct choose_series series; /* by taylor, a step */
    const char *trouble;         /* why it did not go to the end, or NULL */
};

enum { STATISTIC_MEAN, STATISTIC_RMS, STATISTIC_PEAK, STATISTIC_LOSS, STATISTICS };
extern const char *const choose_statistic_name[STATISTICS];

/* Frames in the time asked. */
double choose_frames(const struct scene *s);

/* Runs a scene from its start, the first state moved by `nudge` model units. NULL, or why it cannot be run; then as after
 * any run choose_record_free. */
const char *choose_run(const struct scene *s, const struct choose_sweep *w, double nudge,
                       struct choose_record *r);
void choose_record_free(struct choose_record *r);

/* Peak-to-peak value plus 1e-6 of `unit`. */
double choose_span(const struct choose_record *r, double unit);

/* Largest difference over `span`; infinite when one of them did not go to the end. */
double choose_difference(const struct choose_record *a, const struct choose_record *b, double span);

/* By what the largest difference so far multiplies in a spell, in the worst one of the second half of the time, at least 1; `least`
 * is the least difference, over `span`, that means anything. */
double choose_growth(const struct choose_record *a, const struct choose_record *b, double span, double least);

/* The statistics over `span` (the share of time as it is). */
void choose_statistics(const struct choose_record *r, double span, double statistic[STATISTICS]);

/* ---- choose_cost.c ---- */

/* What is counted on every machine, see tests/bench/cost/work_pieces.h. */
enum choose_piece {
    PIECE_RK4_TICK,
    PIECE_RK4_STEP,
    PIECE_FLOAT32_TICK,
    PIECE_TAYLOR_TICK,
    PIECE_EXACT_STEP,
    PIECE_DRIVE,
    PIECE_SERIES,
    PIECE_SERIES_LOST,
    PIECE_SWITCH,
    CHOOSE_PIECES
};
extern const char *const choose_piece_name[CHOOSE_PIECES]; /* in tests/data */

struct choose_machine {
    const char *name;
    double piece[CHOOSE_PIECES]; /* instructions */
    double ns[CHOOSE_METHODS];   /* assumed for an instruction of each method, the slow end; 0: not known */
};
extern const struct choose_machine choose_machine[CHOOSE_MACHINES];
extern const struct method *const choose_method[CHOOSE_METHODS];

/* What the cost of a step depends on. */
struct choose_work {
    const struct scene *scene;
    int drives;      /* that sound */
    bool moved;      /* an input that is no force sounds */
    double switches; /* a second of the real plant */
    struct choose_series
        series; /* a step, as a run had them; without one none: then it costs at least that */
};

/* Instructions of one step of the plant on a machine: method, ledger, drives, its share of contact switches. NaN where the
 * method does not take the model. */
double choose_cost_step(const struct choose_work *w, int method, int machine);

/* Entry i of the counts in the table by its name in tests/data/instructions.txt, and taylor's pieces a tick there; false when there
 * are no more. */
bool choose_cost_entry(int i, const char **name, double *instructions, double *series);

/* ---- choose_test.c ---- */

/* What is known before anything is run. Amplitudes in model units of length, frequencies in rad per model time. */
struct choose_facts {
    double amplitude;      /* of the contact's compression by linear theory, steady */
    double slow, fast;     /* fastest slow frequency (drives and eigenfrequency); of the fast drive, or 0 */
    double fast_amplitude; /* of the motion that it makes: what an averaged rung leaves out */
    double multiplier; /* largest Floquet multiplier of the unaveraged linear part, 1 without modulation */
    double settle;     /* e-folding times of the free motion in the time asked, or in a hold of the sweep */
    double
        beyond_gap; /* shaft: how far the motion by linear theory is wrong for passing a gap, of its amplitude: what is
                          * beyond, by the share that the gap's springs have in the forces there */
};
/* With a sweep (NULL: none) of the hold that moves most; linear theory's frequencies are those of the holds. */
void choose_facts_of(const struct choose_rung *rung, int n, const struct choose_sweep *w,
                     struct choose_facts *f);

/* Largest difference of two force laws over compressions of rest +- amplitude, over the range of the first. */
double choose_mismatch(const struct scene *full, const struct scene *rung, double amplitude);

/* ---- choose_search.c ---- */

/* A method on a rung: its coarsest step that meets the tolerance, or why none does. */
struct choose_trial {
    bool met;
    struct scene scene;           /* as it was run last */
    struct scene coarser;         /* the last whose error was too large; no model: none */
    double bound;                 /* substeps below which its error bound refuses; 0: none */
    double error;                 /* there; negative: not run */
    double reach[2];              /* of the plant, see struct choose_record */
    double growth;                /* of that error in a spell, see choose_growth */
    double imbalance;             /* of energy there; beyond the default of ledger_alarm it is no choice */
    struct choose_series series;  /* a step there, none before it was run */
    double cost[CHOOSE_MACHINES]; /* of a step there, instructions; at least, before it was run */
    double ns;                    /* of a step there, measured */
    char why[CHOOSE_TEXT];        /* met: why no coarser step; else why not */
};

struct choose_verdict {
    struct choose_rung rung;
    double predicted;          /* error of the model, before anything is run; negative: not predicted */
    double error;              /* of the model by a tight method; negative: not run */
    char refused[CHOOSE_TEXT]; /* the model as such; empty: it meets the tolerance */
    struct choose_trial trial[CHOOSE_METHODS];
    int best; /* of its trials, -1: none */
};

/* Who sees a condition when it comes. A plant has one watch: the nearest condition that the bus does not refuse has it. */
enum choose_guard { GUARD_NONE, GUARD_BUS /* refuses it */, GUARD_WATCH };
extern const char *const choose_guard_name[3];

struct choose_condition {
    char text[CHOOSE_TEXT];
    double factor; /* how far it is: 2 means that something doubles first */
    enum choose_guard guard;
    struct scene_watch watch; /* of the plant that was chosen, with GUARD_WATCH */
};

struct choose_certificate {
    const char *title;
    struct scene scene;
    struct choose_sweep sweep;
    int machine, n_rungs, n_conditions;
    int rung, method; /* chosen; or, with !met, the closest one; rung -1: none */
    bool met, in_time;
    struct choose_facts facts;
    struct choose_verdict verdict[CHOOSE_RUNGS];
    double unit, span, truth_error;              /* SI, SI, relative */
    double twins;                                /* relative difference of neighbouring full runs at most */
    double growth;                               /* of that difference in a spell, see choose_growth */
    bool statistics;                             /* the measure */
    double mean[STATISTICS], spread[STATISTICS]; /* of the full runs: 3 standard deviations */
    double low, high, switches, loss, modes[3];  /* of the truth, see struct choose_record */
    double given_cost; /* instructions of a frame as the scene is given, on the machine */
    double budget_s;   /* bus time that the steps of one frame may take */
    struct choose_condition condition[CHOOSE_CONDITIONS]; /* the watched one first, then the first to come */
};

/* The watch of a certificate, NULL where nothing is certified; a climb that it has is worth trying, and may be refused. */
const struct scene_watch *choose_watched(const struct choose_certificate *c);

/* Fills the certificate from scene, sweep and machine. NULL, or why there can be none (STATUS_ESCAPED with *escaped);
 * `progress` hears what is
 * being done once that has taken two seconds, NULL for nobody. */
const char *choose_search(struct choose_certificate *c, FILE *progress, bool *escaped);

/* Instructions of the steps of one frame on a machine, and bus seconds; 0: not known. */
double choose_frame_cost(const struct choose_trial *t, int machine);
double choose_time_s(const struct choose_trial *t, int method, int machine);

/* ---- choose_warn.c ---- */

enum { CHOOSE_WARNINGS = 32 };

/* The facts of scenes_warning that concern the scene or, with a sweep, any of its holds, each once, into
 * warning[CHOOSE_WARNINGS]; how many. */
int choose_warnings(const struct choose_certificate *c, const char **warning);

/* ---- choose_print.c, choose_json.c ---- */

void choose_print(FILE *out, const struct choose_certificate *c);
void choose_json(FILE *out, const struct choose_certificate *c);
/* The chosen scene as a file to run. */
void choose_write(FILE *out, const struct choose_certificate *c);

#endif
