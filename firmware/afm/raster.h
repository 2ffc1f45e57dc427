/* raster.h - where a scanner is: a triangle along x (trace and retrace), a slow ramp along y; and the ramp of
 * an approach that turns back at a trigger. Pure arithmetic of a sample's number. */
#ifndef FIRMWARE_AFM_RASTER_H
#define FIRMWARE_AFM_RASTER_H

#include <stdbool.h>
#include <stdint.h>

struct raster {
    double width_m, length_m; /* along x and y */
    uint32_t pixels, lines;   /* along them */
    uint32_t samples;         /* in a pixel */
};

/* A sample of a raster. */
struct raster_place {
    double x_m, y_m;      /* at its end */
    uint32_t line, pixel; /* the pixel counts along x, on the way back, too */
    bool back;            /* retrace */
    bool last;            /* the last sample of its pixel */
};

/* Sample `n`, from 0 on. False: the image is complete. */
bool raster_at(const struct raster *r, uint64_t n, struct raster_place *place);

/* All samples of an image. */
uint64_t raster_samples(const struct raster *r);

enum ramp_phase { RAMP_OFF, RAMP_IN, RAMP_DWELL, RAMP_OUT };

struct ramp {
    double speed_m_per_s, low_m, high_m; /* goes down to low_m at most, and back to high_m */
    double dwell_s;                      /* at the turn */
    enum ramp_phase phase;
    bool triggered; /* turned at its trigger, not at low_m */
    double z_m, waited_s;
};

/* One sample of length dt; `trigger`: it holds now. Returns
 * z at the end; the phase is RAMP_OFF when it is back. */
double ramp_run(struct ramp *r, bool trigger, double dt);

#endif
