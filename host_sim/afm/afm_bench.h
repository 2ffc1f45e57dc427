/* afm_bench.h - for scan, thermal and the demo of the microscope: a lever's scene, numbers of the station,
 * a surface from a file, warnings. */
#ifndef HOST_SIM_AFM_BENCH_H
#define HOST_SIM_AFM_BENCH_H

#include <stdio.h>
#include "firmware/afm/station.h"
#include "firmware/stage/stages.h"
#include "host_sim/cli/options.h"
#include "host_sim/scene/scene_load.h"

struct afm_bench {
    struct options o;
    const struct usage *usage;
    struct scene scene;
    enum scene_origin origin;
    double si[MODEL_PARAMETERS], number[STATION_NUMBERS], tick_s;
    struct surface_grid grid;
    int16_t *count;             /* memory of the grid */
    struct stage piezo, sensor; /* the scene has them as [stage z] and [stage deflection] */
    struct station station;
};

/* Defaults of the station; then the scene of the command's word and every --set, of the station or of the
 * scene. 0, or the exit status after a line; so for all below. */
int afm_bench_read(struct afm_bench *b);

/* The surface of --surface: a file of Gwyddion Simple Field. */
int afm_bench_read_surface(struct afm_bench *b);

/* The station, ready to run. */
int afm_bench_start(struct afm_bench *b);

/* A line on stderr where a pixel is shorter than the lever's ring time. */
void afm_bench_warn(const struct afm_bench *b);

/* Runs so many samples. */
int afm_bench_run(struct afm_bench *b, uint64_t samples);

/* As afm_bench_run; Ctrl-C before it is a failure, with a line on stderr. After clock_catch_signals. */
int afm_bench_run_on(struct afm_bench *b, uint64_t samples);

/* Lets the z loop find the surface and settle. */
int afm_bench_engage(struct afm_bench *b);

/* A file DIRECTORY/NAME for writing; NULL after a line. */
FILE *afm_bench_open(struct afm_bench *b, const char *directory, const char *name);

void afm_bench_free(struct afm_bench *b);

#endif
