/* demodulator.h - a lock-in as AFM controllers have: mixer and a low-pass of two equal poles, sample by
 * sample.
 *
 * For a reading A cos(theta + phi) at the reference theta, in_phase goes to A cos(phi) and quadrature to
 * A sin(phi). An offset or a tone at distance f is lowered by (bandwidth/f)^2. A step of A is followed with
 * two time constants 1/(2 pi bandwidth): that is a delay of 1/(pi bandwidth).
 *
 * It serves the microscope's loops. LOCKIN on the bus is firmware/observe/lockin_fit.h, `contactplant test`
 * has host_sim/test/fit.h. */
#ifndef FIRMWARE_AFM_DEMODULATOR_H
#define FIRMWARE_AFM_DEMODULATOR_H

struct demodulator {
    double share;      /* share of a new value that one pole takes in one sample */
    double i[2], q[2]; /* behind the first and the second pole */
    double amplitude;  /* in the last sample */
};

/* Starts at zero; bandwidth of each pole. */
void demodulator_init(struct demodulator *d, double bandwidth_Hz, double sample_s);

/* One reading, with cosine and sine of the reference at its instant. */
void demodulator_run(struct demodulator *d, double reading, double cosine, double sine);

/* Phase of the reading against the reference, rad in (-pi, pi]. */
double demodulator_phase(const struct demodulator *d);

#endif
