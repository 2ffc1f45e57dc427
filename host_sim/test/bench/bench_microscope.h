/* bench_microscope.h - the plant of a test as a microscope: its scene, signals and hash, and sets that it
 * refuses. */
#ifndef HOST_SIM_BENCH_MICROSCOPE_H
#define HOST_SIM_BENCH_MICROSCOPE_H

#include "firmware/afm/afm_plant.h"
#include "firmware/bus/mailbox.h"
#include "host_sim/scene/scene.h"
#include "host_sim/test/test_afm.h"

/* The scene around the file's lever, with the samples of a frame. False: why[TEST_REASON]. */
bool bench_microscope_make(struct scene_app *s, const struct test_file *t, const struct test_case *c,
                           const double *varied, char *why);

const struct station *bench_microscope_station(const struct plant *pl);

/* Values of all signals now, SI. */
void bench_microscope_read(const struct plant *pl, double *value);

/* NULL, or why a microscope's own loops cannot go on with this set: it would put another instrument in. Then
 * subject[SCENE_SUBJECT] names it. */
const char *bench_microscope_check_set(const struct plant *pl, const struct staged *set, char *subject);

/* The hash of a run without a bus. */
uint64_t bench_microscope_hash(const struct plant *pl);

#endif
