/* afm_demo.h - the virtual microscope in one picture. */
#ifndef HOST_SIM_AFM_DEMO_H
#define HOST_SIM_AFM_DEMO_H

#include "host_sim/cli/options.h"

/* Ten seconds of one core: DIRECTORY/afm.svg, and a line of verdicts on standard output. The exit status. */
int afm_demo(const struct options *o, const char *directory);

#endif
