/* fmu_step.c - see fmu_step.h. */
#include "host_sim/fmu/fmu_step.h"

#include <math.h>

/* Takes out all events; true when there was a touchdown, and the first one of them. */
static bool take_touchdown(struct contactplant *p, struct contactplant_event *first)
{
    struct contactplant_event e;
    bool found = false;
    while (contactplant_next_event(p, &e))
        if (e.touch && !found) {
            *first = e;
            found = true;
        }
    return found;
}

/* Tick by tick to `to_s` of plant time, or to the end of the tick that has the first touchdown. */
static int search(struct contactplant *p, double to_s, struct contactplant_event *first, bool *found)
{
    double end_s;
    int code;
    do {
        end_s = (double)(contactplant_tick(p) + 1) * contactplant_tick_time(p);
        code = contactplant_advance_to(p, end_s < to_s ? end_s : to_s);
        *found = take_touchdown(p, first);
    } while (code == CONTACTPLANT_OK && !*found && end_s < to_s);
    return code;
}

/* From the step's begin once more, to the first 1/65536 of a tick behind the touchdown. A tick that is cut
 * there may close the contact a little later than the whole tick did: then it goes on. */
static int stand_behind(struct contactplant *p, const struct contactplant_event *touchdown)
{
    struct contactplant_event again;
    double tick = (double)touchdown->tick, part = floor(touchdown->fraction * TICK_FRACTIONS);
    int code = CONTACTPLANT_OK;
    for (uint32_t ahead = 1; code == CONTACTPLANT_OK && ahead <= TICK_FRACTIONS; ahead *= 2) {
        code =
            contactplant_advance_to(p, (tick + (part + ahead) / TICK_FRACTIONS) * contactplant_tick_time(p));
        if (take_touchdown(p, &again))
            break;
    }
    return code;
}

int fmu_step(struct contactplant *p, struct contactplant *begin, struct fmu_step *s)
{
    struct contactplant_event touchdown;
    s->reached_s = s->to_s;
    s->touched = false;
    if (contactplant_time(p) > s->to_s) /* it was rounded up at a touchdown */
        return CONTACTPLANT_OK;
    (void)take_touchdown(p, &touchdown);
    if (!begin) {
        int code = contactplant_advance_to(p, s->to_s);
        s->touched = take_touchdown(p, &touchdown);
        return code;
    }
    *begin = *p;
    int code = search(p, s->to_s, &touchdown, &s->touched);
    if (code != CONTACTPLANT_OK || !s->touched)
        return code;
    s->reached_s = fmin(touchdown.time_s, s->to_s);
    *p = *begin;
    return stand_behind(p, &touchdown);
}
