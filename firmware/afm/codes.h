/* codes.h - converters of an AFM controller: 16 bits over +-10 V, beside the gains of what hangs on them.
 *
 * A DAC takes a code, holds it within 16 bits, and counts what it had to hold. An ADC rounds to the nearest
 * code and does the same. One code is 20 V/65536 = 0.305 mV. */
#ifndef FIRMWARE_AFM_CODES_H
#define FIRMWARE_AFM_CODES_H

#include <stdint.h>
#include "models/model.h"

#define CODES_VOLT (20.0 / 65536.0)

enum { CODES_DITHER, CODES_Z, CODES_XY, CODES_DEFLECTION, CODES_NUMBERS };
/* Their rows; a plant has some of them, too (afm_plant.h). */
/* clang-format off */
#define CODES_ROW_DITHER \
    {"dither_m_per_V", "m/V", 1e-15, 1.0, 10e-9, \
     "free amplitude at the resonance for a tone of 1 V on the DAC"}
#define CODES_ROW_Z \
    {"z_m_per_V", "m/V", 1e-15, 1.0, 100e-9, \
     "piezo: motion of the base for 1 V on the DAC; also of its sensor"}
#define CODES_ROW_XY \
    {"xy_m_per_V", "m/V", 1e-15, 1.0, 1e-6, "scanner: motion of the sample along x and y for 1 V"}
#define CODES_ROW_DEFLECTION \
    {"deflection_m_per_V", "m/V", 1e-15, 1.0, 50e-9, "photodiode: deflection for 1 V at the ADC"}
/* clang-format on */
extern const struct parameter codes_number[CODES_NUMBERS];

/* Volts of a DAC's code; *clipped is one more where the code is beyond 16 bits. */
double codes_to_volt(int32_t code, uint32_t *clipped);

/* The ADC's code of a voltage; *clipped is one more where it is beyond the range. A NaN reads as the least
 * code, and counts as clipped. */
int32_t codes_of_volt(double volt, uint32_t *clipped);

#endif
