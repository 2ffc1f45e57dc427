/* choose.h - the cheapest combination of model, method and step that meets a scene's tolerance within its
 * deadline.
 *
 * The candidates are the scene's own model, the full one here, and its reduced models. choose_ladder.c
 * says which there are, and writes the same scene for each. choose_theory.c has the tests that cost nothing;
 * choose_run.c runs a scene and compares. choose_search.c decides, from instruction counts (choose_cost.c)
 * and never from times: so the same scene gets the same answer everywhere. choose_print.c and
 * choose_json.c write the certificate.
 *
 * The error is that of the observable asked, inside and at the end of each frame, over all the time asked
 * from the start. It is the largest difference from the full model by a method of tight tolerance, over
 * the peak-to-peak value there (plus 1e-6 of the model's own unit, for motions at rest).
 *
 * No trajectory can be compared where full runs from starts that differ by 1e-9 of that unit part by more
 * than the tolerance (and 1e-4). Then the error is the worst of four: mean, rms about the mean, largest
 * value (each over the peak-to-peak value) and share of time without contact. Each has three standard
 * deviations among full runs from starts that differ by 1e-3 on top.
 *
 * A step is no choice either where the energy out of balance, by the ledger in any 100 frames, would raise
 * FAULT_LEDGER by its default. */
#ifndef HOST_SIM_CHOOSE_H
#define HOST_SIM_CHOOSE_H

#include <stdbool.h>
#include <stdio.h>
#include "host_sim/choose/choose_cost.h"
#include "host_sim/scene/plant_of_scene.h"
#include "host_sim/scene/range.h"

enum {
    CHOOSE_CANDIDATES = 8, /* models that one scene may be run by */
    CHOOSE_LOOKS = 3,      /* at the observable in a frame: inside, and at its end; a lever has more */
    CHOOSE_TEXT = 240,     /* characters of a sentence */
    CHOOSE_SPELLS = 8,     /* spells that the time asked is cut into, to see errors grow */
    CHOOSE_NEIGHBOURS = 8, /* full runs, for the scatter of statistics */
    CHOOSE_CONDITIONS = 8  /* most conditions of a certificate */
};

/* The drive of one input goes from one frequency to the other and back over the time asked, in Hz.n
 * equal holds each way. Between two holds the frequency moves over one frame, and the phase goes on. n 0:
 * no sweep. */
struct choose_sweep {
    int input;
    struct range Hz; /* real plant; either end may be the higher one */
};

/* The kinds of candidates. Each kind has its own tests and conditions. They are bits, so that several
 * kinds may share a test. */
enum choose_kind {
    KIND_OWN = 1,      /* the scene's own model */
    KIND_LINEAR = 2,   /* its contact as a linear spring */
    KIND_AVERAGED = 4, /* its slow motion, with a cubic force averaged over a fast drive */
    KIND_GAPLESS = 8,  /* the shaft without its gap springs */
    KIND_MODE = 16,    /* one mode of the shaft */
    KIND_FEWER = 32,   /* the lever with fewer modes */
    KIND_BARE = 64,    /* the lever over a sample that does not attract */
    KIND_ANY = 127
};

/* A candidate: the scene as that model has it. */
struct choose_candidate {
    char name[48]; /* the model's name, and which mode of the shaft or modes of the lever */
    struct scene scene;
    const char *refused; /* why this scene has no such model, else NULL */
    enum choose_kind kind;
};

/* The result of a run. Values are SI of the bus. */
struct choose_record {
    int n, wanted, looks, n_values; /* frames reached, and asked for; looks a frame, and all of them */
    double *value;                  /* the observable, the last of each frame's at its end */
    double low, high;               /* penetration of the unclipped contact there, model units of length */
    double loss;                    /* share of time with every contact open */
    double modes[3];                /* shaft: largest amplitude of each open mode, model units */
    unsigned switches;              /* contact switches */
    /* a reduced model at the ends of ticks: least and largest penetration, or position of a mode; a lever's
     * gap; model units */
    double reach[2];
    double imbalance; /* energy, the largest of 100 frames: beyond ledger_alarm the bus raises FAULT_LEDGER */
    double ns;        /* nanoseconds of one step, measured: information only */
    struct choose_series series; /* a step */
    const char *trouble;         /* why it did not go to the end, or NULL */
    bool is_apart;               /* it differed too much from a run beside it, and was ended */
};

enum { STATISTIC_MEAN, STATISTIC_RMS, STATISTIC_PEAK, STATISTIC_LOSS, STATISTICS };
extern const char *const choose_statistic_name[STATISTICS];

/* A run that one beside it is compared with while it goes: it ends where a value differs by more than `most`.
 */
struct choose_beside {
    const struct choose_record *record;
    double most; /* SI of the bus */
};

/* Facts that are known before anything is run. Amplitudes in model units of length, frequencies in rad per
 * model time. */
struct choose_facts {
    double amplitude;      /* amplitude of the contact's compression by linear theory, steady */
    double slow, fast;     /* fastest slow frequency (drives and eigenfrequency); the fast drive's, or 0 */
    double fast_amplitude; /* amplitude of the motion by the fast drive: an averaged model leaves it out */
    double multiplier; /* largest Floquet multiplier of the unaveraged linear part, 1 without modulation */
    double settle;     /* e-folding times of the free motion in the time asked, or in a hold of the sweep */
    /* shaft: the error of linear theory for passing a gap, of its amplitude: the part beyond the gap, by
     * the share that the gap's springs have in the forces there */
    double beyond_gap;
};
/* With a sweep (NULL: none) the facts are those of the hold that moves most. */
void choose_facts_of(const struct choose_candidate *candidate, int n, const struct choose_sweep *w,
                     struct choose_facts *f);

/* A method on a candidate: its coarsest step that meets the tolerance, or why none does. */
struct choose_attempt {
    bool met;
    struct scene scene;           /* as it was run last */
    struct scene coarser;         /* the last whose error was too large; no model: none */
    double bound;                 /* substeps below which its error bound refuses; 0: none */
    double error;                 /* there; negative: not run */
    double reach[2];              /* the plant's reach, see struct choose_record */
    double growth;                /* growth of that error in a spell, see choose_growth */
    double imbalance;             /* energy imbalance there; no choice beyond the default of ledger_alarm */
    struct choose_series series;  /* a step there, none before it was run */
    double cost[CHOOSE_MACHINES]; /* instructions of a step there; before it was run, a lower bound */
    double ns;                    /* nanoseconds of a step there, measured */
    char why[CHOOSE_TEXT];        /* met: why no coarser step; else why not */
};

struct choose_verdict {
    struct choose_candidate candidate;
    double predicted;          /* error of the model, before anything is run; negative: not predicted */
    double error;              /* the model's error by a tight method; negative: not run */
    char refused[CHOOSE_TEXT]; /* the model as such; empty: it meets the tolerance */
    struct choose_attempt attempt[CHOOSE_METHODS];
    int best; /* the best of its attempts, -1: none */
};

/* Who sees a condition when it comes. A plant has one watch: the nearest condition that the bus does not
 * refuse has it. */
enum choose_guard { GUARD_NONE, GUARD_BUS /* refuses it */, GUARD_WATCH };
extern const char *const choose_guard_name[3];

struct choose_condition {
    const char *name; /* its row in choose_watch.c */
    char text[CHOOSE_TEXT];
    double factor; /* how far it is: 2 means that something doubles first */
    enum choose_guard guard;
    struct scene_watch watch; /* with GUARD_WATCH: the watch of the plant that was chosen */
};

struct choose_certificate {
    const char *title;
    struct scene scene;
    struct choose_sweep sweep;
    int machine, n_candidates, n_conditions;
    int choice, method; /* chosen; or, with !met, the closest one; choice -1: none */
    bool met, in_time;
    struct choose_facts facts;
    struct choose_verdict verdict[CHOOSE_CANDIDATES];
    double unit, span, truth_error; /* SI, SI, relative */
    double neighbours;              /* relative difference of neighbouring full runs at most */
    double growth;                  /* growth of that difference in a spell, see choose_growth */
    bool statistics;                /* the measure: trajectories cannot be compared */
    bool heat; /* asked: a lever keeps its temperature. Its motion is random, so statistics are the measure */
    bool chaotic; /* because neighbouring full runs part; else the truth is not known well enough */
    double mean[STATISTICS],
        spread[STATISTICS]; /* statistics of the full runs; spread: 3 standard deviations */
    double low, high, switches, loss, modes[3]; /* the truth's, see struct choose_record */
    double given_cost; /* instructions of a frame as the scene is given, on the machine */
    double budget_s;   /* bus time that the steps of one frame may take */
    struct choose_condition condition[CHOOSE_CONDITIONS]; /* the watched one first, then the first to come */
};

enum { CHOOSE_WARNINGS = 32 };

#endif
