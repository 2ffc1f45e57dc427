/* unit.c - see unit.h. */
#include "host_sim/cli/unit.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    NUMBER_TEXT = 40,
    EXPONENT_MAX = 9999,
    DIGITS = 17,
    PLAIN_DIGITS = 6 /* digits before the point, and more as a power of ten */,
    SHORT_TEXT = 32 /* sign, 17 digits, point, exponent */
};

static const char prefix[] = "fpnum kMG"; /* 10^-15, -12, .. 10^9 */

static bool bare(const char *unit)
{
    return !*unit || !strcmp(unit, "1");
}

/* Sign, digits with one point, exponent: the length of the mantissa and of all of it; 0 when it is no
 * number. */
static size_t scan(const char *t, size_t n, size_t *mantissa, int *exponent)
{
    size_t i = n && (*t == '+' || *t == '-'), digits = 0, points = 0;
    for (; i < n && (isdigit((unsigned char)t[i]) || t[i] == '.'); i++)
        *(t[i] == '.' ? &points : &digits) += 1;
    *mantissa = i;
    *exponent = 0;
    if (!digits || points > 1)
        return 0;
    if (i + 1 < n && (t[i] == 'e' || t[i] == 'E')) {
        size_t j = i + 1 + (t[i + 1] == '+' || t[i + 1] == '-'), first = j;
        for (; j < n && isdigit((unsigned char)t[j]); j++)
            *exponent = *exponent < EXPONENT_MAX ? 10 * *exponent + (t[j] - '0') : *exponent;
        if (j > first) {
            *exponent = t[i + 1] == '-' ? -*exponent : *exponent;
            return j;
        }
    }
    return i;
}

/* The n bytes of text are `unit`, any white space as one blank. */
static bool same(const char *t, size_t n, const char *unit)
{
    size_t i = 0;
    for (; *unit; unit++) {
        if (i == n || (*unit == ' ' ? !isspace((unsigned char)t[i]) : t[i] != *unit))
            return false;
        for (i++; *unit == ' ' && i < n && isspace((unsigned char)t[i]);)
            i++;
    }
    return i == n;
}

/* The decimal exponent by which a unit's text differs from the table's unit; false when it does not fit. */
static bool shift_of(const char *t, size_t n, const char *unit, int *shift)
{
    bool gram = !strcmp(unit, "kg");
    const char *base = gram ? "g" : unit, *p;
    *shift = gram ? -3 : 0;
    if (bare(unit) || !n)
        return bare(unit) && !n;
    if (same(t, n, base))
        return true;
    p = *t == ' ' ? NULL : strchr(prefix, *t);
    if (!p || !same(t + 1, n - 1, base))
        return false;
    *shift += 3 * ((int)(p - prefix) - 5);
    return true;
}

static bool misfit(const char *t, size_t n, const char *unit, char *why)
{
    if (bare(unit))
        snprintf(why, UNIT_REASON, "\"%.*s\" behind the number; this one has no unit", (int)n, t);
    else if (!n)
        snprintf(why, UNIT_REASON, "the unit is missing; it is %s", unit);
    else
        snprintf(why, UNIT_REASON, "the unit \"%.*s\" does not fit; give %s%s", (int)n, t, unit,
                 strcmp(unit, "kg") ? ", or it with a prefix f p n u m k M G" : ", g, mg, ..");
    return false;
}

bool unit_read(const char *text, size_t n, const char *unit, double *value, char *why)
{
    char number[NUMBER_TEXT + 16];
    size_t mantissa, length;
    int exponent, shift;
    length = scan(text, n, &mantissa, &exponent);
    const char *rest = text + length;
    size_t n_rest = n - length;
    if (length && mantissa > NUMBER_TEXT) {
        snprintf(why, UNIT_REASON, "\"%.*s..\" has more than %d digits", NUMBER_TEXT, text, NUMBER_TEXT);
        return false;
    }
    if (!length || (n_rest && (isalnum((unsigned char)*rest) && bare(unit)))) {
        snprintf(why, UNIT_REASON, "\"%.*s\" is not a finite number%s%s", n < 40 ? (int)n : 40, text,
                 bare(unit) ? "" : " with a unit; give it in ", bare(unit) ? "" : unit);
        return false;
    }
    while (n_rest && isspace((unsigned char)*rest))
        rest++, n_rest--;
    if (!shift_of(rest, n_rest, unit, &shift))
        return misfit(rest, n_rest < 40 ? n_rest : 40, unit, why);
    size_t n_digits = 0;
    for (size_t i = 0; i < mantissa; i++) {
        if (text[i] != '.')
            number[n_digits++] = text[i];
        else
            exponent -= (int)(mantissa - i - 1);
    }
    /* without a point: strtod takes the one of the user's locale */
    snprintf(number + n_digits, sizeof number - n_digits, "e%d", exponent + shift);
    *value = strtod(number, NULL) + 0.0; /* and not -0 */
    if (isfinite(*value))
        return true;
    snprintf(why, UNIT_REASON, "\"%.*s\" is too large for a number", n < 40 ? (int)n : 40, text);
    return false;
}

/* Digits d.ddd and decimal exponent of the shortest text that reads back. */
static int shortest(double value, char text[SHORT_TEXT])
{
    for (int digits = 1; digits <= DIGITS; digits++) {
        snprintf(text, SHORT_TEXT, "%.*e", digits - 1, value);
        if (memcmp(&(double){strtod(text, NULL)}, &value, sizeof value) == 0)
            break;
    }
    return atoi(strchr(text, 'e') + 1);
}

/* The point of d.ddd moved by 0 to 2 places. */
static void move_point(const char *from, int places, char to[SHORT_TEXT])
{
    char digits[DIGITS + 8];
    int n = 0, sign = *from == '-';
    for (const char *c = from + sign; *c != 'e'; c++)
        if (*c != '.')
            digits[n++] = *c;
    while (n <= places)
        digits[n++] = '0';
    snprintf(to, SHORT_TEXT, "%s%.*s%s%.*s", sign ? "-" : "", places + 1, digits, n > places + 1 ? "." : "",
             n - places - 1, digits + places + 1);
}

void unit_write(double value, const char *unit, char text[UNIT_TEXT])
{
    char full[SHORT_TEXT], moved[SHORT_TEXT];
    int exponent = shortest(value, full), digits = (int)strcspn(full, "e");
    bool prefixed = !strcmp(unit, "m") || !strcmp(unit, "s") || !strcmp(unit, "N") || !strcmp(unit, "Hz");
    int step = (exponent + 30) / 3 - 10; /* thousands, rounded down */
    bool zero = !(value < 0.0) && !(value > 0.0);
    if (prefixed && !zero && step >= -5 && step <= 3 && step != 0) {
        move_point(full, exponent - 3 * step, moved);
        snprintf(text, UNIT_TEXT, "%s %c%s", moved, prefix[step + 5], unit);
        return;
    }
    digits -= digits > 1 ? (strchr(full, '.') != NULL) + (*full == '-') : 0;
    if (exponent >= digits && exponent < PLAIN_DIGITS)
        digits = exponent + 1;
    snprintf(moved, sizeof moved, "%.*g", digits, value);
    snprintf(text, UNIT_TEXT, "%s%s%s", moved, bare(unit) ? "" : " ", bare(unit) ? "" : unit);
}
