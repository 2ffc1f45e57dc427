/* unit.h - numbers with units as text: `6.5 kg`, `254 um`, `1.5e-3`.
 *
 * A unit is one of those of the tables (kg, N/m^1.5, N s/m, ..), or such a one with a decimal prefix before
 * its first symbol: z a f p n u m k M G (kg: on the gram). Blanks in it may be left out. Other units are
 * taken where they measure the same: kg/s for N s/m, deg for rad, rpm for Hz, min for s, % for a number
 * without a unit. "1" and "" take a bare number. The prefix moves the decimal exponent before the conversion,
 * so that 254 um is the double nearest to 2.54e-4, and what unit_write gives reads back to the last bit.
 * There is no -0: it is read as 0. */
#ifndef HOST_SIM_UNIT_H
#define HOST_SIM_UNIT_H

#include <stdbool.h>
#include <stddef.h>

enum { UNIT_TEXT = 64, UNIT_REASON = 160 };

/* The n bytes of text as a finite value in `unit`. False: why[UNIT_REASON] says what to write instead. */
bool unit_read(const char *text, size_t n, const char *unit, double *value, char *why);

/* As unit_read; a number without a unit is in `unit`, too. */
bool unit_read_or_bare(const char *text, size_t n, const char *unit, double *value, char *why);

/* The shortest text that reads back as this finite value, with a prefix where the unit is m, s, N or Hz. */
void unit_write(double value, const char *unit, char text[UNIT_TEXT]);

/* A finite value for people, with so many digits and µ for micro. */
void unit_tell(double value, int digits, const char *unit, char text[UNIT_TEXT]);

/* The unit behind a number that unit_read took, as it stands there, into asked[UNIT_TEXT]. Returns one of it
 * in `unit`. */
double unit_asked(const char *text, size_t n, const char *unit, char *asked);

/* As unit_write, in this very unit: an answer in the unit of its question. */
void unit_write_asked(double value, const char *asked, char text[UNIT_TEXT]);

#endif
