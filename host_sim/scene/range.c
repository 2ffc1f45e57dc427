/* range.c - see range.h. */
#include "host_sim/scene/range.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/cli/options.h"
#include "host_sim/cli/unit.h"

enum { PARTS = 4, WORD = 64, SHOWN = 60 };

static bool refuse(char *why, const char *reason)
{
    snprintf(why, RANGE_REASON, "%s", reason);
    return false;
}

/* Without blanks at both ends. */
static void trim(const char **text, size_t *n)
{
    for (; *n && **text == ' '; --*n)
        ++*text;
    while (*n && (*text)[*n - 1] == ' ')
        --*n;
}

bool range_read_number(const char *text, size_t n, const struct range_rules *rules, double *value, char *why)
{
    bool unitless = !*rules->unit || !strcmp(rules->unit, "1");
    trim(&text, &n);
    if (!(rules->bare ? unit_read_or_bare : unit_read)(text, n, rules->unit, value, why))
        return false;
    if (*value >= rules->min && *value <= rules->max)
        return true;
    snprintf(why, RANGE_REASON, "%.*s is out of range; give %g to %g%s%s", n < SHOWN ? (int)n : SHOWN, text,
             rules->min, rules->max, unitless ? "" : " ", unitless ? "" : rules->unit);
    return false;
}

/* The parts between colons from `at` on; how many there are, one too many where there are more. */
static int split(const char *at, const char *part[PARTS], size_t length[PARTS])
{
    int n = 0;
    for (size_t whole; at && n < PARTS; at = at[whole] ? at + whole + 1 : NULL) {
        part[n] = at;
        length[n] = whole = strcspn(at, ":");
        trim(&part[n], &length[n]);
        n++;
    }
    return at ? PARTS + 1 : n;
}

static bool is_log(const char *part, size_t n)
{
    return n == 3 && !strncmp(part, "log", n);
}

static bool read_count(const char *text, size_t n, const struct range_rules *rules, struct range *r,
                       char *why)
{
    char count[WORD];
    double value;
    snprintf(count, sizeof count, "%.*s", (int)(n < WORD ? n : WORD), text);
    if (!options_read_number(count, &value) || value < rules->n_min || value > rules->n_max ||
        value != floor(value)) {
        snprintf(why, RANGE_REASON, "N is a whole number of values, %d to %d", rules->n_min, rules->n_max);
        return false;
    }
    r->n = (int)value;
    return true;
}

static bool in_order(const struct range *r, enum range_order order)
{
    return order == RANGE_ANY_ORDER || r->from < r->to ||
           (order == RANGE_UPWARDS_OR_EQUAL && r->from <= r->to);
}

static bool write_form(const struct range_rules *rules, char *why)
{
    const char *name = rules->named ? "NAME=" : "";
    if (rules->n_max)
        snprintf(why, RANGE_REASON, "write %sFROM:TO:N, or %sFROM:TO:N:log", name, name);
    else
        snprintf(why, RANGE_REASON, "write %sFROM:TO", name);
    return false;
}

bool range_read(const char *text, const struct range_rules *rules, struct range *r, char *why)
{
    const char *equal = rules->named ? strchr(text, '=') : NULL, *part[PARTS];
    size_t length[PARTS];
    int n = rules->named && !equal ? 0 : split(equal ? equal + 1 : text, part, length);
    bool logarithmic = n == 4 && is_log(part[3], length[3]);
    if (rules->n_max ? n != 3 && !logarithmic : n != 2)
        return write_form(rules, why);
    *r = (struct range){.logarithmic = logarithmic};
    if (!range_read_number(part[0], length[0], rules, &r->from, why) ||
        !range_read_number(part[1], length[1], rules, &r->to, why))
        return false;
    if (rules->n_max && !read_count(part[2], length[2], rules, r, why))
        return false;
    if (!in_order(r, rules->order))
        return refuse(why, "give the smaller end first");
    if (logarithmic && !(r->from > 0.0 && r->to > 0.0))
        return refuse(why, "a logarithmic range begins above 0");
    return true;
}

double range_value(const struct range *r, int i)
{
    double part = r->n > 1 ? (double)i / (r->n - 1) : 0.0;
    if (i == 0 || i == r->n - 1)
        return i ? r->to : r->from;
    return r->logarithmic ? r->from * pow(r->to / r->from, part) : r->from + (r->to - r->from) * part;
}
