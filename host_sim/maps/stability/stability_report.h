/* stability_report.h - the findings of a stability map: how much of it is unstable and where, and a picture.
 */
#ifndef HOST_SIM_STABILITY_REPORT_H
#define HOST_SIM_STABILITY_REPORT_H

#include "host_sim/maps/stability/stability.h"

extern const struct maps_finding stability_finding; /* its context is a struct stability */

#endif
