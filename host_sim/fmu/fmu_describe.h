/* fmu_describe.h - modelDescription.xml of an FMU, out of the tables of its model. */
#ifndef HOST_SIM_FMU_DESCRIBE_H
#define HOST_SIM_FMU_DESCRIBE_H

#include <stdio.h>
#include "host_sim/fmu/fmu_variables.h"

/* The plant is what the text `scene` has given; `name` and `title` say what it is. */
void fmu_describe(FILE *out, struct contactplant *p, const char *name, const char *title, const char *scene);

#endif
