/* lever_law.h - closed forms of models/afm_lever.h: the heat of a lever, and its rest over the sample.
 *
 * A lever of stiffness k over the sample rests where k x = F(base + x). Outside contact that is a cubic, of
 * which the largest root is stable; in contact there is one root at most. */
#ifndef HOST_SIM_FIT_LEVER_LAW_H
#define HOST_SIM_FIT_LEVER_LAW_H

#include <stdbool.h>

/* The density of the thermal motion at its sensor plus white noise, m^2/Hz; si in the order of afm_lever. */
double lever_law_density(const double *si, double white, double frequency_Hz);

/* The deflection x in m with the undeflected tip at this height over the sample; out: on the way out. False:
 * the lever has no such rest, and *x goes on from the last one, so that a fit finds back to it. */
bool lever_law_outside(const double *si, bool out, double base_m, double *x);
bool lever_law_contact(const double *si, bool out, double base_m, double *x);

#endif
