/* surface.h - the sample below an AFM tip: its height, and where its second material is.
 *
 * All lengths are in metres, over the plane of the base material. A kind:
 *   flat     0
 *   step     0 for x < pitch, `height` beyond
 *   grating  lines along y of this pitch; the share `duty` of it is high
 *   sine     (height/2) sin(2 pi x/pitch)
 *   rough    64 cosines in all directions, wavelengths from pitch to pitch/64 in equal ratios, amplitude
 *            ~ wavelength^1.3 (Hurst exponent 0.8), phases from the seed, rms exactly `height`
 *   grid     a grid of counts over a rectangle, bilinear in between, and its edge beyond
 * The flanks of step and grating rise linearly over `edge`. The second material is a disc, or every second
 * square of a checker board. A function of place alone: nothing here has a state. */
#ifndef FIRMWARE_AFM_SURFACE_H
#define FIRMWARE_AFM_SURFACE_H

#include <stdint.h>
#include "models/check.h"

enum surface_kind {
    SURFACE_FLAT,
    SURFACE_STEP,
    SURFACE_GRATING,
    SURFACE_SINE,
    SURFACE_ROUGH,
    SURFACE_GRID,
    SURFACE_KINDS
};
enum surface_map { MAP_NONE, MAP_DISC, MAP_CHECKER, MAP_KINDS };
enum { SURFACE_WAVES = 64, SURFACE_GRID_MAX = 65535 /* points along one side */ };

/* Counts of a height, line by line; the memory stays the caller's. */
struct surface_grid {
    const int16_t *count;          /* [ny][nx] */
    uint32_t nx, ny;               /* at least 2 each */
    double width, length, m_per_1; /* the rectangle begins at (0, 0) */
};

struct surface {
    enum surface_kind kind;
    double height, pitch, duty, edge;
    enum surface_map map;
    double map_size, map_x, map_y; /* diameter of the disc or side of a square; centre or corner */
    struct surface_grid grid;
    struct surface_wave {
        double amplitude, along_x, along_y; /* waves a metre */
        uint64_t phase;                     /* turns * 2^64 */
    } wave[SURFACE_WAVES];
};

/* The waves of a rough surface, after its other fields are set. */
void surface_set_waves(struct surface *s, uint32_t seed);

/* Height at a place. */
double surface_height(const struct surface *s, double x, double y);

/* 1 where the second material is, else 0. */
int surface_material(const struct surface *s, double x, double y);

#endif
