/* fault_list.c - see fault_list.h. */
#include "host_sim/live/fault_list.h"

#include "host_sim/cli/options.h"
#include "host_sim/cli/options_nearest.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ITEM = 96 };

static bool refuse_item(char *why, const char *item, const char *reason)
{
    snprintf(why, FAULT_LIST_REASON, "\"%s\": %s", item, reason);
    return false;
}

/* The rule for the value of a kind, as text. */
static const char *value_of(enum faults_kind kind)
{
    switch (kind) {
    case FAULTS_DELAY:
        return "delay=P:FRAMES, e.g. delay=0.1:20";
    case FAULTS_BURST:
        return "burst=FRAMES, e.g. burst=10";
    case FAULTS_FREEZE:
    case FAULTS_BUS_OFF:
        return "KIND@FROM:UNTIL in seconds, e.g. freeze@2:12";
    default:
        return "KIND=P with a probability P of 0 to 1, e.g. drop=0.01";
    }
}

/* FROM:UNTIL in seconds, as whole frames. */
static bool read_times(struct faults_rule *r, char *text, double frame_s)
{
    char *colon = strchr(text, ':');
    double from, until;
    if (!colon)
        return false;
    *colon = '\0';
    if (!options_read_number(text, &from) || !options_read_number(colon + 1, &until))
        return false;
    if (!(from >= 0.0 && from < until && until <= 1e9))
        return false;
    r->begin = (uint64_t)llround(from / frame_s);
    r->until = (uint64_t)llround(until / frame_s);
    return r->begin < r->until;
}

static bool read_frames(struct faults_rule *r, const char *text)
{
    double frames;
    if (!options_read_number(text, &frames) || !(frames >= 1.0 && frames <= 1e6) || frames != floor(frames))
        return false;
    r->frames = (uint32_t)frames;
    return true;
}

static bool read_value(struct faults_rule *r, char *text)
{
    char *colon = text ? strchr(text, ':') : NULL;
    if (r->kind == FAULTS_FREEZE || r->kind == FAULTS_BUS_OFF)
        return !text && r->until != UINT64_MAX;
    if (!text || (colon != NULL) != (r->kind == FAULTS_DELAY))
        return false;
    if (r->kind == FAULTS_BURST)
        return read_frames(r, text);
    if (colon)
        *colon = '\0';
    return options_read_number(text, &r->probability) && r->probability >= 0.0 && r->probability <= 1.0 &&
           (!colon || read_frames(r, colon + 1));
}

static int find_kind(const char *name)
{
    int i = 0;
    while (i < FAULTS_KINDS && strcmp(name, faults_name[i]))
        i++;
    return i;
}

static bool read_kind(struct faults_rule *r, const char *name, const char *item, char *why)
{
    r->in = strncmp(name, "out.", 4) != 0;
    r->out = strncmp(name, "in.", 3) != 0;
    name += !r->in ? 4 : !r->out ? 3 : 0;
    int kind = find_kind(name);
    if (kind == FAULTS_KINDS) {
        char reason[ITEM + OPTIONS_ADVICE];
        snprintf(reason, sizeof reason, "no such fault%s",
                 options_advise(name, strlen(name), faults_name, FAULTS_KINDS, NULL));
        return refuse_item(why, item, reason);
    }
    r->kind = (enum faults_kind)kind;
    return true;
}

static bool read_item(struct faults *f, const char *item, double frame_s, char *why)
{
    struct faults_rule r = {.probability = 1.0, .frames = 1, .until = UINT64_MAX};
    char text[ITEM];
    snprintf(text, sizeof text, "%s", item);
    char *at = strchr(text, '@');
    if (at)
        *at = '\0';
    char *equals = strchr(text, '=');
    if (equals)
        *equals = '\0';
    if (!read_kind(&r, text, item, why))
        return false;
    if ((at && !read_times(&r, at + 1, frame_s)) || !read_value(&r, equals ? equals + 1 : NULL))
        return refuse_item(why, item, value_of(r.kind));
    const char *reason = faults_add(f, &r);
    return reason ? refuse_item(why, item, reason) : true;
}

bool fault_list_read(struct faults *f, const char *list, double frame_s, char *why)
{
    do {
        char item[ITEM];
        size_t n = strcspn(list, ",");
        if (n >= sizeof item)
            return refuse_item(why, "--faults", "an item is too long");
        memcpy(item, list, n);
        item[n] = '\0';
        if (!read_item(f, item, frame_s, why))
            return false;
        list += n;
    } while (*list++ == ',');
    return true;
}
