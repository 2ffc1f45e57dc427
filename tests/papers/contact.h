/* contact.h - Nayak 1972 in closed form: free vibration,
 * harmonic balance, the stationary density of random motion. */
#ifndef TESTS_PAPERS_CONTACT_H
#define TESTS_PAPERS_CONTACT_H

/* Free undamped vibration up to a largest compression
 * (above 1), by quadrature of the energy (Nayak sec. 3). */
struct free_vibration {
    double omega, amplitude, area; /* area: time average of eta_+ */
};
struct free_vibration contact_free(double eta_max);

/* Harmonic balance of first order, eqs 46 and 48: eta = a0 + a1 cos; stiffness is (2/3) A1/a1. */
struct balance {
    double a0, stiffness;
};
struct balance contact_balance(double a1);

/* The frequencies, ascending, at which a waviness of
 * amplitude xi0 makes the first harmonic a1; how many (0..2). */
int contact_balance_omega(double a1, double zeta, double xi0, double omega[2]);

/* The upward jump of harmonic balance: the least frequency
 * on the side of the low branch, where a1 turns; NaN: none. */
double contact_balance_jump(double zeta, double xi0);

/* Stationary random motion, eq 68, for Phi/zeta: p(eta), P(eta
 * > z), up-crossings of z per time, mean of eta_+^power. */
struct density {
    double cold, scale, speed; /* 2 zeta/(pi Phi), normalisation, standard deviation of the rate */
};
struct density contact_density(double phi_over_zeta);
double contact_density_at(const struct density *d, double eta);
double contact_above(const struct density *d, double z);
double contact_crossings(const struct density *d, double z);
double contact_mean(const struct density *d, double power);
/* Standard deviation of eta. */
double contact_deviation(const struct density *d);

#endif
