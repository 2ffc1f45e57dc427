/* free_motion.h - free, undamped motion of the Hertz rig by quadrature of its energy, in extended precision, for tests.
 *
 *   eta'^2/2 + (4/15) eta_+^{5/2} - (2/3) eta = E   (physics of models/hertz_rig.h, time in 1/nu) */
#ifndef TESTS_FREE_MOTION_H
#define TESTS_FREE_MOTION_H

/* E at eta_max, at rest there. */
long double free_energy(long double eta, long double rate);

/* From eta_max to eta_max. Contact is lost above (5/2)^{2/3}. */
double free_period(double eta_max);

/* From touchdown at speed v > 0 to lift-off, and the deepest eta. */
double free_contact_time(double v);
double free_peak(double v);

#endif
