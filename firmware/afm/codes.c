/* codes.c - see codes.h. */
#include "firmware/afm/codes.h"

const struct parameter codes_number[CODES_NUMBERS] = {CODES_ROW_DITHER, CODES_ROW_Z, CODES_ROW_XY,
                                                      CODES_ROW_DEFLECTION};

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
