/* test_afm.h - a microscope in a test file: its signals by name, their values, and its contact. The numbers
 * of its parameters are those of a plant (firmware/afm/afm_plant.h). */
#ifndef HOST_SIM_TEST_AFM_H
#define HOST_SIM_TEST_AFM_H

#include "firmware/afm/station.h"
#include "host_sim/test/measure.h"
#include "host_sim/test/test_file.h"

/* Names alone: its functions are NULL. Inputs are those of struct microscope_in. */
extern const struct model test_afm_view;
enum {
    VIEW_AMPLITUDE,
    VIEW_PHASE,
    VIEW_AMPLITUDE_2,
    VIEW_DEFLECTION,
    VIEW_Z,
    VIEW_ERROR,
    VIEW_FORCE,
    VIEW_SURFACE,
    VIEW_CRASHES,
    VIEW_PEAK_FORCE,
    VIEW_ADHESION,
    VIEW_MODULUS,
    VIEW_SNAP_IN,
    VIEW_BASELINE,
    VIEW_OUTPUTS
};
enum { VIEW_IN_FORCE, VIEW_IN_Z, VIEW_IN_X, VIEW_IN_Y, VIEW_INPUTS };

/* NULL, or which lines of a case are about no microscope, over a bus or without one. */
const char *test_afm_refuse(const struct test_case *c);

/* The values of all signals now, SI, in the order of metric_signal; `in`: the commands. */
void test_afm_read(const struct station *s, const struct microscope_in *in, double *value);

/* Contact as a test sees it: open while no force has touched the tip for two periods of the lever. */
struct test_afm {
    bool open;
    uint64_t touched; /* the last sample with a force */
    double peak_N;    /* since the tip touched */
};

/* After a sample: tells the n measurements where the contact opened or closed. */
void test_afm_watch(struct test_afm *t, const struct station *s, uint64_t sample, struct measurement *m,
                    int n);

#endif
