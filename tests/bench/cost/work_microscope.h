/* work_microscope.h - samples of a microscope whose cost is counted (tests/bench/cost/instructions.c) and
 * timed (bench_microscope.c).
 *
 * The lever has heat, and 128 ticks in a period; four ticks are a sample. A piezo of 5 kHz moves the base all
 * the time, and a lock-in listens to each tone. */
#ifndef TESTS_WORK_MICROSCOPE_H
#define TESTS_WORK_MICROSCOPE_H

#include "tests/bench/cost/work_pieces.h"

enum { WORK_MICROSCOPES = 3, WORK_MICROSCOPE_TICKS = 4 };

/* Four modes: far with one tone, far with two (DART), and tapping with the z loop. */
extern const struct work_piece work_microscope[WORK_MICROSCOPES];

enum work_place { WORK_FAR, WORK_FAR_TWO_TONES, WORK_TAPPING };

/* The lever of a scene begins, with so many modes; and runs until it swings. NULL, or the reason of a
 * refusal.
 */
const char *work_microscope_start(const char *lever, int modes, enum work_place place);

/* A sample. */
void work_microscope_run(void);

/* Ticks a second of the true lever. */
double work_microscope_rate(void);

/* NULL, or the last start that was not what it should be. */
const char *work_microscope_fault(void);

#endif
