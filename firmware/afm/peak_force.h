/* peak_force.h - peak force tapping: z swings far below the resonance of the lever, and each cycle is a force
 * curve, evaluated while it runs.
 *
 * A cycle goes from top to top. Its lowest point is the caller's, z = low + A (1 + cos(2 pi i/n)), and moves
 * to a new place in the first quarter, far from the sample. With the reading d and the true base z, the force
 * of the sample on the tip is that of an oscillator whose base moves:
 *
 *   F = k (d + d'/(Q w0) + (d'' + G z'')/w0^2),   G = 1.566 (beam_modes)
 *
 * by central differences of fourth order, from sample to sample. So a lever that rings after its pull-off
 * reads as no force. White noise of the sensor grows by 3.1/(w0 dt)^2 on this way: 81 times with 32 samples
 * in a period of the lever. From F over the place of the tip, s = z + d:
 *
 *   baseline    mean of F in the far half of the cycle; the forces below count from there
 *   peak        the largest F; snap-in: the deepest F before it, adhesion: the one after it
 *   work        -integral of F ds: what the sample takes in the cycle
 *   deformation way of the tip from F = 0 on the way in to the deepest point
 *   modulus     (F + adhesion)^(2/3) = (4/3 E sqrt(R))^(2/3) (s0 - s) by least squares, after the peak, where
 *               the law has 30 to 90 % of it (Derjaguin, Muller & Toporov 1975); a choice by the noisy forces
 *               themselves would lean the line
 *
 * The pull-off itself is faster than the samples. So the adhesion comes from the points before it, from F = 0
 * to 60 % of the deepest force: along the fitted law they are led to no indentation. Fit and adhesion are
 * found in turns. A cycle without contact has a peak, a baseline and a place, and nothing else.
 *
 * Source of the mode: Su & Lombrozo 2003 (off-resonance tapping with a deflection's peak held). */
#ifndef FIRMWARE_AFM_PEAK_FORCE_H
#define FIRMWARE_AFM_PEAK_FORCE_H

#include <stdbool.h>
#include <stdint.h>

enum {
    PEAK_FORCE_PERIOD_MIN = 32, /* samples in a period of the lever: fewer miss the contact resonance */
    PEAK_FORCE_STENCIL = 5,     /* readings of a difference */
    PEAK_FORCE_BAND = 128,      /* points that the fit keeps */
    PEAK_FORCE_LAST = 64,       /* the newest points, which must reach over the pull-off: */
    PEAK_FORCE_EACH = 3000,     /* one of n is kept from n - 1 times so many samples in a cycle on */
    PEAK_FORCE_PULLED = 32      /* points from before the pull-off */
};

/* The results of one cycle. */
struct force_cycle {
    uint32_t n;   /* cycles so far; 0: none, the rest is 0 */
    bool touched; /* else snap-in, adhesion, work and deformation are not known, and 0 */
    bool fitted;  /* else the modulus is not known, and 0 */
    double peak_N, snap_in_N, adhesion_N, baseline_N, work_J, deformation_m, modulus_Pa;
    double low_m; /* lowest true z */
};

struct peak_force_config {
    double stiffness, f0_Hz, quality, radius_m; /* the lever: N/m, Hz, 1, m */
    double sample_s, frequency_Hz, amplitude_m; /* a cycle */
};

struct force_point {
    double force, place;
};

struct peak_force {
    struct force_cycle cycle; /* the last one */
    uint32_t samples, i;      /* in a cycle; the present one, 0 at the top */
    double from_m, to_m;      /* the lowest point: where it was at the top, where it goes */
    double least_N;           /* a smaller peak is no contact; the caller sets it */
    /* the rest is its own */
    double amplitude_m, stiffness, hertz;
    double drag, mass; /* factors of the differences */
    uint32_t n_read;
    struct force_reading {
        double deflection, moved, place; /* moved: with the share of the base that has inertia */
    } read[PEAK_FORCE_STENCIL];          /* the oldest first */
    double baseline, far_sum;
    uint32_t n_far;
    bool whole; /* this near half was seen from its begin on */
    double low, peak, lowest, snap_in, deepest_force, deepest, contact, zero, work;
    struct force_point before; /* the last sample's */
    struct force_point band[PEAK_FORCE_BAND];
    uint32_t n_band, stride, skipped;
    struct force_point last[PEAK_FORCE_LAST];     /* the newest, by number */
    uint32_t n_last, each;                        /* points kept; one of so many */
    struct force_point pulled[PEAK_FORCE_PULLED]; /* in contact, before the pull-off */
    uint32_t n_pulled;
};

/* At the lowest point of a cycle, which is `low_m`. */
void peak_force_init(struct peak_force *p, const struct peak_force_config *c, double low_m);

/* Samples of a cycle at this frequency or a little more: a whole number. */
uint32_t peak_force_samples(double frequency_Hz, double sample_s);

/* A sample: the reading, and the true base. True when the near half of a cycle has ended: p->cycle is new. */
bool peak_force_read(struct peak_force *p, double deflection_m, double z_m);

/* z at the end of the next sample. At the top, p->i == 0, the caller may set from_m = to_m and another to_m
 * before. */
double peak_force_z(struct peak_force *p);

#endif
