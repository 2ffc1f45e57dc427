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

#define PI 3.14159265358979323846

static const char prefix[] = "zafpnum kMG"; /* 10^-21, -18, .. 10^9 */

enum { PREFIX_LEAST = -7 /* thousands */ };

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

/* The n bytes of text are `unit`; its blanks may be left out or be others. */
static bool same(const char *t, size_t n, const char *unit)
{
    size_t i = 0;
    for (; *unit; unit++) {
        if (*unit == ' ')
            for (; i < n && isspace((unsigned char)t[i]);)
                i++;
        else if (i == n || t[i++] != *unit)
            return false;
    }
    return i == n;
}

/* One unit of the text in units of the table: 10^shift times `factor`. */
struct scale {
    int shift;
    double factor;
};

/* The table's unit, or a decimal multiple of it. A kilogram's prefix is on the gram. */
static bool is_multiple(const char *t, size_t n, const char *unit, struct scale *scale)
{
    bool gram = !strncmp(unit, "kg", 2), micro = n > 2 && (!memcmp(t, "µ", 2) || !memcmp(t, "μ", 2));
    const char *base = gram ? unit + 1 : unit, *p;
    *scale = (struct scale){gram ? -3 : 0, 1.0};
    if (bare(unit) || !n)
        return bare(unit) && !n;
    if (same(t, n, base))
        return true;
    p = micro ? strchr(prefix, 'u') : *t == ' ' ? NULL : strchr(prefix, *t);
    if (!p || !same(t + 1 + micro, n - 1 - micro, base))
        return false;
    scale->shift += 3 * ((int)(p - prefix) + PREFIX_LEAST);
    return true;
}

/* Other units of what a table's unit measures. */
static const struct {
    const char *unit, *other;
    struct scale scale;
} other_table[] = {
    {"", "%", {-2, 1.0}},           {"1", "%", {-2, 1.0}},           {"N s/m", "kg/s", {0, 1.0}},
    {"s", "min", {0, 60.0}},        {"rad", "deg", {0, PI / 180.0}}, {"deg", "rad", {0, 180.0 / PI}},
    {"Hz", "rpm", {0, 1.0 / 60.0}},
};
enum { OTHERS = sizeof other_table / sizeof other_table[0] };

/* A rate, m/s, is told by the minute, too: nm/min. */
static bool by_minute(const char *t, size_t n, const char *unit, struct scale *scale)
{
    char second[UNIT_TEXT];
    size_t length = strlen(unit);
    if (length < 2 || strcmp(unit + length - 2, "/s") || n < 4 || n - 2 > sizeof second ||
        memcmp(t + n - 4, "/min", 4))
        return false;
    memcpy(second, t, n - 4);
    memcpy(second + n - 4, "/s", 2);
    if (!is_multiple(second, n - 2, unit, scale))
        return false;
    scale->factor /= 60.0;
    return true;
}

static bool scale_of(const char *t, size_t n, const char *unit, struct scale *scale)
{
    if (is_multiple(t, n, unit, scale) || by_minute(t, n, unit, scale))
        return true;
    for (int i = 0; i < OTHERS; i++) {
        if (strcmp(unit, other_table[i].unit))
            continue;
        bool kilograms = !strncmp(other_table[i].other, "kg", 2);
        if (kilograms && is_multiple(t, n, other_table[i].other, scale))
            return true;
        *scale = other_table[i].scale;
        if (same(t, n, other_table[i].other))
            return true;
    }
    return false;
}

/* ---- what a misspelt unit gets for an answer ---- */

static bool same_letters(const char *t, size_t n, const char *word)
{
    size_t i = 0;
    for (; i < n && word[i] && tolower((unsigned char)t[i]) == tolower((unsigned char)word[i]); i++)
        ;
    return i == n && !word[i];
}

/* The unit, or it with a prefix, that differs in capitals alone; the prefix as it stands counts first. */
static const char *nearest(const char *t, size_t n, const char *unit, char text[UNIT_TEXT])
{
    bool gram = !strncmp(unit, "kg", 2);
    const char *base = gram ? unit + 1 : unit;
    if (!n || bare(unit))
        return NULL;
    if (same_letters(t, n, unit))
        return unit;
    for (int any = 0; any < 2; any++)
        for (const char *p = prefix; *p; p++) {
            snprintf(text, UNIT_TEXT, "%c%s", *p, base);
            if (*p != ' ' && (any || *p == *t) && same_letters(t, n, text))
                return text;
        }
    for (int i = 0; i < OTHERS; i++)
        if (!strcmp(unit, other_table[i].unit) && same_letters(t, n, other_table[i].other))
            return other_table[i].other;
    return NULL;
}

static bool misfit(const char *t, size_t n, const char *unit, char *why)
{
    char text[UNIT_TEXT];
    const char *near = nearest(t, n, unit, text), *other = NULL;
    for (int i = 0; i < OTHERS; i++)
        other = strcmp(unit, other_table[i].unit) ? other : other_table[i].other;
    if (bare(unit))
        snprintf(why, UNIT_REASON, "\"%.*s\" behind the number; this one has no unit", (int)n, t);
    else if (!n)
        snprintf(why, UNIT_REASON, "the unit is missing; it is %s", unit);
    else if (near)
        snprintf(why, UNIT_REASON, "the unit \"%.*s\" does not fit; did you mean %s?", (int)n, t, near);
    else
        snprintf(why, UNIT_REASON, "the unit \"%.*s\" does not fit; give %s%s%s%s", (int)n, t, unit,
                 strcmp(unit, "kg") ? ", or it with a prefix z a f p n u m k M G" : ", g, mg, ..",
                 other ? ", or " : "", other ? other : "");
    return false;
}

/* Digits, a comma and a digit, as in many countries. */
static bool has_comma(const char *text, size_t length, size_t n)
{
    return length && length + 1 < n && text[length] == ',' && isdigit((unsigned char)text[length + 1]);
}

bool unit_read(const char *text, size_t n, const char *unit, double *value, char *why)
{
    char number[NUMBER_TEXT + 16];
    size_t mantissa, length;
    int exponent;
    struct scale scale;
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
    if (has_comma(text, length, n)) {
        snprintf(why, UNIT_REASON, "\"%.*s\": write the decimal comma as a point, %.*s.%c..",
                 n < 40 ? (int)n : 40, text, (int)length, text, text[length + 1]);
        return false;
    }
    while (n_rest && isspace((unsigned char)*rest))
        rest++, n_rest--;
    if (!scale_of(rest, n_rest, unit, &scale))
        return misfit(rest, n_rest < 40 ? n_rest : 40, unit, why);
    size_t n_digits = 0;
    for (size_t i = 0; i < mantissa; i++) {
        if (text[i] != '.')
            number[n_digits++] = text[i];
        else
            exponent -= (int)(mantissa - i - 1);
    }
    /* without a point: strtod takes the one of the user's locale */
    snprintf(number + n_digits, sizeof number - n_digits, "e%d", exponent + scale.shift);
    *value = strtod(number, NULL) * scale.factor + 0.0; /* and not -0 */
    if (isfinite(*value))
        return true;
    snprintf(why, UNIT_REASON, "\"%.*s\" is too large for a number", n < 40 ? (int)n : 40, text);
    return false;
}

bool unit_read_or_bare(const char *text, size_t n, const char *unit, double *value, char *why)
{
    size_t mantissa;
    int exponent;
    while (n && isspace((unsigned char)*text))
        text++, n--;
    while (n && isspace((unsigned char)text[n - 1]))
        n--;
    return unit_read(text, n, n && scan(text, n, &mantissa, &exponent) == n ? "" : unit, value, why);
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

/* micro: how its prefix is spelled; NULL: none is taken. */
static void write_number(double value, const char *unit, const char *micro, char text[UNIT_TEXT])
{
    char full[SHORT_TEXT], moved[SHORT_TEXT];
    int exponent = shortest(value, full), digits = (int)strcspn(full, "e");
    int step = (exponent + 30) / 3 - 10; /* thousands, rounded down */
    bool zero = !(value < 0.0) && !(value > 0.0);
    if (micro && !zero && step >= PREFIX_LEAST && step <= 3 && step != 0) {
        move_point(full, exponent - 3 * step, moved);
        const char one[] = {prefix[step - PREFIX_LEAST], 0};
        snprintf(text, UNIT_TEXT, "%s %s%s", moved, *one == 'u' ? micro : one, unit);
        return;
    }
    digits -= digits > 1 ? (strchr(full, '.') != NULL) + (*full == '-') : 0;
    if (exponent >= digits && exponent < PLAIN_DIGITS)
        digits = exponent + 1;
    snprintf(moved, sizeof moved, "%.*g", digits, value);
    snprintf(text, UNIT_TEXT, "%s%s%s", moved, bare(unit) ? "" : " ", bare(unit) ? "" : unit);
}

static bool takes_prefix(const char *unit)
{
    return !strcmp(unit, "m") || !strcmp(unit, "s") || !strcmp(unit, "N") || !strcmp(unit, "Hz") ||
           !strcmp(unit, "J");
}

void unit_write(double value, const char *unit, char text[UNIT_TEXT])
{
    write_number(value, unit, takes_prefix(unit) ? "u" : NULL, text);
}

void unit_tell(double value, int digits, const char *unit, char text[UNIT_TEXT])
{
    char rounded[SHORT_TEXT];
    snprintf(rounded, sizeof rounded, "%.*g", digits, value);
    write_number(strtod(rounded, NULL), unit, takes_prefix(unit) ? "µ" : NULL, text);
}

double unit_asked(const char *text, size_t n, const char *unit, char *asked)
{
    char one[UNIT_TEXT + 1], why[UNIT_REASON];
    double value = 1.0;
    size_t mantissa, length;
    int exponent;
    length = scan(text, n, &mantissa, &exponent);
    while (length < n && isspace((unsigned char)text[length]))
        length++;
    snprintf(one, sizeof one, "1%.*s", (int)(n - length), text + length);
    (void)unit_read(one, strlen(one), unit, &value, why);
    snprintf(asked, UNIT_TEXT, "%s", one + 1);
    return value;
}

void unit_write_asked(double value, const char *asked, char text[UNIT_TEXT])
{
    write_number(value, asked, NULL, text);
}
