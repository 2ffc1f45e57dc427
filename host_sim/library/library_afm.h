/* library_afm.h - a microscope in the caller's memory. */
#ifndef HOST_SIM_LIBRARY_AFM_H
#define HOST_SIM_LIBRARY_AFM_H

#include "firmware/afm/codes.h"
#include "firmware/afm/station.h"
#include "host_sim/library/library.h"

struct contactplant_afm {
    uint64_t magic;
    struct contactplant_error error;
    double tick_s, si[LEVER_PARAMETERS];
    bool runs; /* from its first sample on; the numbers then stand. From here on it is saved */
    double number[STATION_NUMBERS + CODES_NUMBERS], dither_N_per_V;
    uint32_t clipped;
    struct station station;
};

bool library_is_afm(const struct contactplant_afm *a);

/* Its first sample begins: checks the numbers. CONTACTPLANT_OK, or the code of a refusal. */
int library_start_afm(struct contactplant_afm *a);

#endif
