/* afm_plant.h - a whole AFM as the plant of an app: a model, its method, and its calls.
 *
 *     static double memory[AFM_PLANT_DOUBLES];
 *     struct app_config c = {.model = &afm_plant, .method = &afm_plant_method, .scratch = memory,
 *                            .stage_calls = &afm_plant_calls, .stages = (struct stages *)(void *)memory,
 * ...};
 *
 * A tick of this plant is a sample of the station (station.h), which has the number `ticks` of the lever's
 * own. So the bus sees an AFM as it sees any plant. The inputs are force, z, x and y: a drive or a sampled
 * command gives what no loop of the station sets. The parameters are those of the lever, the numbers of the
 * station, the recipe (`scan` begins an image, `ramp_speed_m_per_s` an approach), and the gains of the
 * converters. The outputs are the readings.
 *
 *   - The held force is that at the begin of a tick; z, x and y are those at its end. A command inside a tick
 *     counts for the whole sample: nothing is shorter than that.
 *   - A change of lever, materials, ticks, bandwidth or stages puts another instrument in. It begins anew, at
 *     rest where the piezo stands: z, x and y go on, and the z loop from there. All other numbers act from
 *     the next sample on, those of an image from the next image on.
 *   - The contact is closed as long as a force has touched the tip in the last period of the lever or the one
 *     before; contact_force is the largest of that time. A crash is counted.
 *   - A stage before z is the piezo, one behind displacement the sensor; there are no others.
 *   - Where a lock-in slot of other plants reads the results of stages 0 to 3, it reads of the last cycle of
 *     peak force its snap-in and baseline (N), deformation (m) and work (J).
 *   - Blocks of codes (DAC and ADC of the wire) have one sample a tick. DITHER is a force that is held, Z a
 *     straight line over the sample: those of contactplant_afm_sample. Codes are read behind the sensors.
 *   - The station keeps no books of energy: those of this plant are 0. */
#ifndef FIRMWARE_AFM_PLANT_H
#define FIRMWARE_AFM_PLANT_H

#include "firmware/afm/station.h"
#include "firmware/plant/plant.h"

enum {
    AFM_PLANT_NUMBERS = LEVER_PARAMETERS, /* first number of the station */
    AFM_PLANT_SCAN = AFM_PLANT_NUMBERS + STATION_NUMBERS,
    AFM_PLANT_RAMP_SPEED,
    AFM_PLANT_RAMP_DWELL,
    AFM_PLANT_DITHER_GAIN,
    AFM_PLANT_Z_GAIN,
    AFM_PLANT_DEFLECTION_GAIN,
    AFM_PLANT_PARAMETERS
};
enum { AFM_PLANT_FORCE, AFM_PLANT_Z, AFM_PLANT_X, AFM_PLANT_Y, AFM_PLANT_INPUTS };
enum {
    AFM_PLANT_DISPLACEMENT,
    AFM_PLANT_VELOCITY,
    AFM_PLANT_PENETRATION,
    AFM_PLANT_CONTACT_FORCE,
    AFM_PLANT_AMPLITUDE,
    AFM_PLANT_PHASE,
    AFM_PLANT_HEIGHT,
    AFM_PLANT_ERROR,
    AFM_PLANT_SHIFT,
    AFM_PLANT_CRASHES,
    AFM_PLANT_ADHESION,
    AFM_PLANT_MODULUS,
    AFM_PLANT_OUTPUTS
};

extern const struct model afm_plant; /* the one model without an equation of its own: its rhs is NULL */
extern const struct method afm_plant_method;
extern const struct plant_stage_calls afm_plant_calls;

/* The station of such a plant, by its scratch memory. */
const struct station *afm_plant_station(const double *scratch);

/* The memory may be copied at any time. Without its pointers it may also be kept as bytes; the next sample
 * finds them again. */
void afm_plant_forget_pointers(double *scratch);

/* NULL, or why these parameters make no sense together; *which is the parameter's index, or -1. */
MUST_CHECK const char *afm_plant_check(const double *si, int *which);

/* Settings of the app that suit an AFM. Samples of z, x and y are led in straight lines. The four slots of
 * the lock-in send the mean over each frame of amplitude, phase, height and frequency shift. */
void afm_plant_settings(double *setting);

#endif
