/* codes.c - see codes.h. */
#include "firmware/afm/codes.h"

const struct parameter codes_number[CODES_NUMBERS] = {
    {"dither_m_per_V", "m/V", 1e-15, 1.0, 10e-9,
     "free amplitude at the resonance for a tone of 1 V on the DAC"},
    {"z_m_per_V", "m/V", 1e-15, 1.0, 100e-9,
     "piezo: motion of the base for 1 V on the DAC; also of its sensor"},
    {"xy_m_per_V", "m/V", 1e-15, 1.0, 1e-6, "scanner: motion of the sample along x and y for 1 V"},
    {"deflection_m_per_V", "m/V", 1e-15, 1.0, 50e-9, "photodiode: deflection for 1 V at the ADC"},
};

static const int32_t most = 32767, least = -32768;

double codes_to_volt(int32_t code, uint32_t *clipped)
{
    *clipped += code > most || code < least;
    return CODES_VOLT * (code > most ? most : code < least ? least : code);
}

int32_t codes_of_volt(double volt, uint32_t *clipped)
{
    double code = volt / CODES_VOLT;
    if (!(code < most + 0.5 && code > least - 0.5)) {
        ++*clipped;
        return code > 0.0 ? most : least;
    }
    return (int32_t)(code < 0.0 ? code - 0.5 : code + 0.5);
}
