/* station.h - a whole AFM around the microscope: tones, lock-ins, raster, approach ramp, and reference loops.
 *
 * One call is one sample of the controller. Each loop can be off; what it would have set is then the
 * caller's:
 *
 *   z loop   1: holds the amplitude, 2: holds the deflection at the set point; sets z
 *   agc      holds the amplitude; sets the force of the tone
 *   pll      holds the phase; sets the frequency of the tone
 *   dart     holds the amplitudes of two tones, dart_distance apart, equal; sets the frequency between them
 *   raster   sets x and y, from station_begin_scan to the end of the image
 *   ramp     sets z, from station_begin_ramp until it is back
 *
 * A tone of amplitude drive_m is the force that moves the free lever so far at its resonance, without heat.
 * With drive_m = 0 the station has no tone, and the force is the caller's alone. The numbers are a table with
 * names, units, ranges and defaults, as a model's parameters. Loops act on the reading of the same sample,
 * and move the next one: the delay is one sample and that of the low-pass. */
#ifndef FIRMWARE_AFM_STATION_H
#define FIRMWARE_AFM_STATION_H

#include "firmware/afm/demodulator.h"
#include "firmware/afm/loop.h"
#include "firmware/afm/microscope.h"
#include "firmware/afm/raster.h"

enum {
    STATION_TICKS,
    STATION_SURFACE,
    STATION_SURFACE_HEIGHT,
    STATION_SURFACE_PITCH,
    STATION_SURFACE_DUTY,
    STATION_SURFACE_EDGE,
    STATION_SURFACE_SEED,
    STATION_MAP,
    STATION_MAP_SIZE,
    STATION_MAP_X,
    STATION_MAP_Y,
    STATION_MAP_MODULUS,
    STATION_MAP_HAMAKER,
    STATION_MAP_HAMAKER_OUT,
    STATION_MAP_VISCOSITY,
    STATION_SCAN_WIDTH,
    STATION_SCAN_LENGTH,
    STATION_PIXELS,
    STATION_LINES,
    STATION_PIXEL,
    STATION_DRIVE,
    STATION_FREQUENCY,
    STATION_BANDWIDTH,
    STATION_Z_LOOP,
    STATION_SETPOINT,
    STATION_KI,
    STATION_KP,
    STATION_Z_MIN,
    STATION_Z_MAX,
    STATION_AGC,
    STATION_AGC_SETPOINT,
    STATION_AGC_KI,
    STATION_PLL,
    STATION_PLL_PHASE,
    STATION_PLL_KP,
    STATION_PLL_KI,
    STATION_DART,
    STATION_DART_DISTANCE,
    STATION_DART_KI,
    STATION_CRASH,
    STATION_NUMBERS
};
extern const struct parameter station_number[STATION_NUMBERS];

enum { Z_OFF, Z_AMPLITUDE, Z_DEFLECTION };

struct station_config {
    const double *si;                      /* [LEVER_PARAMETERS] */
    double tick_s;                         /* a tick of the microscope */
    const double *number;                  /* [STATION_NUMBERS] */
    const struct surface_grid *grid;       /* for a surface of kind SURFACE_GRID; else NULL */
    struct microscope_stage piezo, sensor; /* ideal where run is NULL */
};

/* One pixel: means over its samples, and the largest force. */
struct pixel {
    uint32_t line, column;
    bool back;
    double height_m, error_m, amplitude_m, phase_rad, peak_N, frequency_Hz, surface_m;
};

struct station {
    struct microscope microscope;
    double number[STATION_NUMBERS];
    double sample_s, f0_Hz, free_force; /* force of the tone per metre of free amplitude */
    struct microscope_in in;            /* last input of the microscope */
    struct microscope_out out;
    struct demodulator lockin[MICROSCOPE_TONES];
    struct loop z, agc, pll, dart;
    struct ramp ramp;
    struct raster raster;
    bool scans;
    uint64_t scanned; /* samples of the raster done */
    double frequency_Hz, error_m;
    uint32_t n_limited; /* samples in which z was at z_min or z_max */
    struct pixel pixel; /* the last one that was completed */
    bool pixel_ready;   /* in this sample */
    struct pixel_sum {
        uint32_t n;
        double height, error, amplitude, in_phase, quadrature, peak, frequency, surface;
    } sum;
};

/* Numbers at their defaults. */
void station_defaults(double *number);

/* Would station_init take these? NULL, or the reason; *which is the number's index, or -1. */
MUST_CHECK const char *station_check(const struct station_config *c, int *which);

/* At rest, away from the surface, loops on. NULL, or the reason of a refusal. */
MUST_CHECK const char *station_init(struct station *s, const struct station_config *c);

/* Other numbers from the next sample on: all but ticks, bandwidth and materials may change. Each loop goes on
 * from where it stands. NULL, or the reason of a refusal, which changes nothing; *which is the number's
 * index. */
MUST_CHECK const char *station_change(struct station *s, const struct station_config *c, int *which);

/* The next sample begins an image. */
void station_begin_scan(struct station *s);

/* The next sample begins an approach: down until the trigger, or z_min. The trigger is an amplitude at or
 * below the set point with a tone, a deflection at or above it without. After dwell_s z goes back. A z loop
 * waits meanwhile. */
void station_begin_ramp(struct station *s, double speed_m_per_s, double dwell_s);

/* One sample. The caller's part of `user` counts where no loop sets it. False when the motion left the finite
 * numbers. The reading is in s->out and s->lockin. */
bool station_run(struct station *s, const struct microscope_in *user);

/* 2 Q/w0, s: an amplitude follows no faster than that. */
double station_ring_time(const double *si);

#endif
