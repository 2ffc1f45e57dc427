/* trial_afm.c - see trial_afm.h. */
#include "host_sim/afm/trial_afm.h"

#include <stddef.h>
#include "firmware/afm/station.h"
#include "firmware/bus/settings.h"

static const struct signal output[VIEW_OUTPUTS] = {
    [VIEW_AMPLITUDE] = {"amplitude", "m", "of the first tone, by the lock-in", QUANTITY_LENGTH, NULL},
    [VIEW_PHASE] = {"phase", "deg", "its phase; -90 at the free resonance", QUANTITY_RATIO, NULL},
    [VIEW_AMPLITUDE_2] = {"amplitude_2", "m", "of the second tone, that of DART", QUANTITY_LENGTH, NULL},
    [VIEW_DEFLECTION] = {"deflection", "m", "reading of the sensor", QUANTITY_LENGTH, NULL},
    [VIEW_Z] = {"z", "m", "true place of the base over its start", QUANTITY_LENGTH, NULL},
    [VIEW_ERROR] = {"error", "m", "of the z loop: how much the tip is too far away", QUANTITY_LENGTH, NULL},
    [VIEW_FORCE] = {"contact_force", "N", "largest in the sample, 0 apart", QUANTITY_FORCE, NULL},
    [VIEW_SURFACE] = {"surface", "m", "height below the tip", QUANTITY_LENGTH, NULL},
    [VIEW_CRASHES] = {"crashes", "1", "so far", QUANTITY_RATIO, NULL},
};

static const struct signal input[VIEW_INPUTS] = {
    [VIEW_IN_FORCE] = {"force", "N", "on the tip", QUANTITY_FORCE, NULL},
    [VIEW_IN_Z] = {"z", "m", "of the base, where no loop sets it", QUANTITY_LENGTH, NULL},
    [VIEW_IN_X] = {"x", "m", "place over the surface", QUANTITY_LENGTH, NULL},
    [VIEW_IN_Y] = {"y", "m", "place over the surface", QUANTITY_LENGTH, NULL},
};

const struct model trial_afm_view = {
    .name = "microscope",
    .title = "an AFM lever with the loops of a microscope",
    .n_inputs = VIEW_INPUTS,
    .n_outputs = VIEW_OUTPUTS,
    .n_contacts = 1,
    .input_signal = input,
    .output_signal = output,
};

const struct parameter *trial_afm_parameter(int index)
{
    if (index >= 0 && index < LEVER_PARAMETERS)
        return &afm_lever.parameter[index];
    if (index >= SETTING_FIRST && index < SETTING_FIRST + STATION_NUMBERS)
        return &station_number[index - SETTING_FIRST];
    return NULL;
}
