/* station.h - a whole AFM around the microscope: tones, lock-ins, raster, approach ramp, and reference loops.
 *
 * One call is one sample of the controller. Each loop can be off; what it would have set is then the
 * caller's:
 *
 *   z loop   1: holds the amplitude, 2: holds the deflection at the set point; sets z
 *   agc      holds the amplitude; sets the force of the tone
 *   pll      holds the phase; sets the frequency of the tone
 *   dart     holds the amplitudes of two tones, dart_distance apart, equal; sets the frequency between them
 *   peak     in the place of tone and z loop: z swings, and its lowest point holds the peak force of a cycle
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
#include "firmware/afm/peak_force.h"
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
    STATION_PEAK_FORCE,
    STATION_NUMBERS
};
/* The rows of their table, which is part of that of a plant (afm_plant.h). */
/* clang-format off */
#define STATION_ROWS \
    {"ticks", "1", 1.0, MICROSCOPE_TICKS_MAX, 4.0, "ticks of the lever in a sample of the controller"}, \
    {"surface", "1", 0.0, SURFACE_GRID, 0.0, "0 flat, 1 step, 2 grating, 3 sine, 4 rough, 5 from a file"}, \
    {"surface_height_m", "m", -1e-5, 1e-5, 20e-9, "height of step, grating and sine; rms of rough"}, \
    {"surface_pitch_m", "m", 1e-9, 1e-3, 500e-9, "place of the step; pitch; longest wave of rough"}, \
    {"surface_duty", "1", 0.01, 0.99, 0.5, "share of the pitch that is high"}, \
    {"surface_edge_m", "m", 0.0, 1e-4, 5e-9, "width of a flank"}, \
    {"surface_seed", "1", 0.0, 4294967295.0, 1.0, "of a rough surface"}, \
    {"map", "1", 0.0, MAP_CHECKER, 0.0, "second material: 0 nowhere, 1 in a disc, 2 in squares"}, \
    {"map_size_m", "m", 1e-9, 1e-3, 300e-9, "diameter of the disc, side of a square"}, \
    {"map_x_m", "m", -1e-3, 1e-3, 500e-9, "centre of the disc, corner of a square"}, \
    {"map_y_m", "m", -1e-3, 1e-3, 500e-9, "the same along y"}, \
    {"map_modulus_Pa", "Pa", 1.0, 1e13, 1e9, "reduced modulus of the second material"}, \
    {"map_hamaker_J", "J", 0.0, 1e-17, 6.4e-20, "its Hamaker constant, on the way in"}, \
    {"map_hamaker_out_J", "J", 0.0, 1e-17, 6.4e-20, "the same on the way out, at least map_hamaker_J"}, \
    {"map_viscosity_Pa_s", "Pa s", 0.0, 1e6, 100.0, "its viscosity"}, \
    {"scan_width_m", "m", 1e-9, 1e-3, 1e-6, "of the image, along the fast axis x"}, \
    {"scan_length_m", "m", 1e-9, 1e-3, 1e-6, "along the slow axis y"}, \
    {"pixels", "1", 1.0, 65536.0, 128.0, "in a line, one way"}, \
    {"lines", "1", 1.0, 65536.0, 48.0, "each with trace and retrace"}, \
    {"pixel_s", "s", 1e-7, 100.0, 1e-3, "time of a pixel, one way"}, \
    {"drive_m", "m", 0.0, 1e-5, 20e-9, \
     "amplitude of the free lever at its resonance, 0: no tone; with peak_force that of z"}, \
    {"frequency_Hz", "Hz", 0.0, 1e9, 0.0, "of the tone, 0: f0 of the lever; of peak_force, 0: 2 kHz or f0/8"}, \
    {"bandwidth_Hz", "Hz", 1e-2, 1e8, 5000.0, "of the lock-in: each of two poles"}, \
    {"z_loop", "1", 0.0, Z_DEFLECTION, 1.0, "0 off, 1 holds the amplitude, 2 the deflection"}, \
    {"setpoint_m", "m", -1e-5, 1e-5, 14e-9, "of amplitude or deflection; also the trigger of a ramp"}, \
    {"ki", "1/s", 0.0, 1e7, 275.0, "integral gain of the z loop"}, \
    {"kp", "1", 0.0, 1e3, 0.0, "proportional gain of the z loop"}, \
    {"z_min_m", "m", -1e-3, 0.0, -1e-6, "lowest z of the piezo, relative to the start"}, \
    {"z_max_m", "m", 0.0, 1e-3, 1e-6, "highest z of the piezo"}, \
    {"agc", "1", 0.0, 1.0, 0.0, "1: the drive holds the amplitude at agc_setpoint"}, \
    {"agc_setpoint_m", "m", 0.0, 1e-5, 14e-9, "set point of the amplitude"}, \
    {"agc_ki", "1/s", 0.0, 1e7, 500.0, "free amplitude per error of amplitude and second"}, \
    {"pll", "1", 0.0, 1.0, 0.0, "1: the frequency holds the phase at pll_phase"}, \
    {"pll_phase_rad", "rad", -3.2, 3.2, -0.5 * ELEMENTARY_PI, \
     "set point of the phase; -pi/2 is the resonance"}, \
    {"pll_kp", "Hz/rad", 0.0, 1e9, 100.0, "proportional gain of the PLL"}, \
    {"pll_ki", "Hz/(rad s)", 0.0, 1e12, 50e3, "integral gain of the PLL"}, \
    {"dart", "1", 0.0, 1.0, 0.0, "1: two tones; the frequency holds their amplitudes equal"}, \
    {"dart_distance_Hz", "Hz", 1e-3, 1e8, 4e3, "distance of the two tones"}, \
    {"dart_ki", "Hz/s", 0.0, 1e12, 1e5, "integral gain for (A1 - A2)/(A1 + A2)"}, \
    {"crash_N", "N", 0.0, 1.0, 100e-9, "a larger contact force is a crash; 0: none is"}, \
    {"peak_force_N", "N", 0.0, 1.0, 0.0, "0: off; else z swings, and its loop holds this peak force of each cycle"}
/* clang-format on */
extern const struct parameter station_number[STATION_NUMBERS];

enum { Z_OFF, Z_AMPLITUDE, Z_DEFLECTION };

struct station_config {
    const double *si;                      /* [LEVER_PARAMETERS] */
    double tick_s;                         /* a tick of the microscope */
    const double *number;                  /* [STATION_NUMBERS] */
    const struct surface_grid *grid;       /* for a surface of kind SURFACE_GRID; else NULL */
    struct microscope_stage piezo, sensor; /* ideal where run is NULL */
    struct microscope_in at; /* places where it begins, as the last input would have left them */
    double z_m;              /* at.z_m behind the piezo */
};

/* One pixel: means over its samples, and the largest force. */
struct pixel {
    uint32_t line, column;
    bool back;
    double height_m, error_m, amplitude_m, phase_rad, peak_N, frequency_Hz, surface_m;
    struct force_cycle force; /* means over its n cycles, whose lowest points are the height then */
};

struct station {
    struct microscope microscope;
    double number[STATION_NUMBERS];
    double sample_s, f0_Hz, stiffness, radius_m;
    double free_force;       /* force of the tone per metre of free amplitude */
    struct microscope_in in; /* last input of the microscope */
    struct microscope_out out;
    struct demodulator lockin[MICROSCOPE_TONES];
    struct loop z, agc, pll, dart;
    struct ramp ramp;
    struct peak_force swing; /* with a peak force to hold */
    bool cycle_ready;        /* a cycle of it was completed in this sample */
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
        uint32_t n_touched, n_fitted;
        struct force_cycle force;
    } sum;
};

/* Numbers at their defaults. */
void station_defaults(double *number);

/* Would station_init take these? NULL, or the reason; *which is the number's index, or -1. */
MUST_CHECK const char *station_check(const struct station_config *c, int *which);

/* At rest at c->at, loops on; the z loop goes on from there. NULL, or the reason of a refusal. */
MUST_CHECK const char *station_init(struct station *s, const struct station_config *c);

/* The numbers of the second material, [LEVER_PARAMETERS]; false: there is none. */
bool station_second(const struct station_config *c, double *second);

/* The surface that these numbers describe. */
void station_surface(struct surface *s, const struct station_config *c);

/* A number in which these differ and that station_change refuses to change; -1: none. */
int station_fixed(const struct station *s, const double *number);

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

/* Goes on with a hash: lever, z, frequency, lock-in, crashes and tick. */
uint64_t station_hash(const struct station *s, uint64_t hash);

/* With these numbers z swings, to hold a peak force; there is no tone. */
bool station_swings(const double *number);

/* 2 Q/w0, s: an amplitude follows no faster than that. */
double station_ring_time(const double *si);

#endif
