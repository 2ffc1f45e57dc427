/* session.c - see session.h. */
#include "firmware/app/session.h"

#include "firmware/app/app.h"

void session_drives_to_zero(struct app *a, double ramp_s)
{
    plant_drives_to_zero(&a->plant, ramp_s);
    mailbox_empty(&a->mailbox);
    a->streaming = 0;
}

void session_fault(struct app *a, enum fault_bit fault)
{
    capture_trigger_now(&a->capture, TRIGGER_FAULT, a->plant.now.tick);
    a->faults |= (uint8_t)fault;
    if (fault & (FAULT_NOT_FINITE | FAULT_OVERRUN | FAULT_ASSERT | FAULT_SELF_TEST)) {
        session_drives_to_zero(a, 0.0);
        a->state = STATE_FAULT;
        a->step_left = 0;
    }
}

void session_end(struct app *a)
{
    a->enabled = false;
    a->echo_from = a->frame + 1;
    a->step_left = 0;
    mailbox_empty(&a->mailbox);
    a->streaming = 0;
}

/* ---- the age of commands ---- */

uint32_t session_behind(const struct app *a)
{
    return a->due > 0 ? a->due - 1 : 0;
}

/* The bus frame by the clock; the number of the present one lags while frames are made up. */
static uint64_t now(const struct app *a)
{
    return a->frame + session_behind(a);
}

/* The heartbeat may have come at any time since the frame before: at worst at the beginning of an absence. */
void session_hear_heartbeat(struct app *a)
{
    a->heartbeat_frame = now(a) - a->away;
    a->absent = a->away;
}

uint64_t session_command_age(const struct app *a)
{
    return now(a) - a->heartbeat_frame;
}

void session_time_out(struct app *a)
{
    session_end(a);
    session_fault(a, FAULT_TIMEOUT);
    a->count[DIAG_TIMEOUTS]++;
    a->reaction = (enum reaction)(int)a->setting[SET_REACTION];
    if (a->reaction == REACTION_RAMP)
        session_drives_to_zero(a, a->setting[SET_REACTION_RAMP_S]);
    if (a->reaction == REACTION_ZERO)
        session_drives_to_zero(a, 0.0);
    if (a->reaction == REACTION_FREEZE && (a->state == STATE_RUNNING || a->state == STATE_PAUSED))
        a->state = STATE_FROZEN;
}

/* Frames that the plant missed itself are forgiven once, as many as the time-out has. */
void session_check_age(struct app *a)
{
    uint64_t limit = (uint64_t)a->setting[SET_TIMEOUT_FRAMES];
    uint64_t forgiven = a->absent < limit ? a->absent : limit;
    if (a->enabled && session_command_age(a) > limit + forgiven)
        session_time_out(a);
}
