/* latest.c - see latest.h. */
#include "host_sim/listen/latest.h"
#include "host_sim/listen/listen.h"

#include <math.h>
#include <string.h>

enum { OVERTAKEN_FRAMES = 64 }; /* a STATUS may come so late behind a newer one */

/* Fills n doubles with "not known yet". */
static void forget(double *x, int n)
{
    for (int i = 0; i < n; i++)
        x[i] = (double)NAN;
}

void latest_begin(struct latest *l)
{
    memset(l, 0, sizeof *l);
    l->reaction = REACTION_NONE;
    forget(&l->displacement_m, 1);
    forget(&l->velocity_m_per_s, 1);
    forget(&l->penetration_m, 1);
    forget(&l->force_N, 1);
    forget(&l->contact_loss, 1);
    forget(l->parameter, LATEST_PARAMETERS);
    forget(&l->drive[0][0], MODEL_INPUTS * LATEST_DRIVE_FIELDS);
    forget(l->lockin_amplitude, LOCKIN_SLOTS);
    forget(l->lockin_phase, LOCKIN_SLOTS);
    forget(l->ledger, LATEST_LEDGER);
    forget(l->health, DIAG_COUNTERS);
    forget(l->info, INFO_ITEMS);
}

/* table[index] = value where both are known. */
static void note(double *table, int n, double index, double value)
{
    if (index >= 0.0 && index < (double)n)
        table[(int)index] = value;
}

/* A STATUS that a later one has overtaken says what is
 * over. A plant that restarted begins at frame 0 again. */
static void take_status(struct latest *l, const struct message *m)
{
    uint64_t frame = listen_extend(l->frame, m, STATUS_FRAME);
    if (frame < l->status_frame && l->status_frame - frame <= OVERTAKEN_FRAMES)
        return;
    l->status_frame = frame;
    l->session = (uint8_t)m->value[SESSION];
    l->state = (enum plant_state)m->value[STATUS_STATE];
    l->reaction = (enum reaction)m->value[STATUS_REACTION];
    l->faults = (unsigned)m->value[STATUS_FAULTS];
    l->frame = frame;
}

static void take_slow(struct latest *l, const struct message *m)
{
    const double *v = m->value;
    switch (m->kind) {
    case WIRE_LOCKIN:
        note(l->lockin_amplitude, LOCKIN_SLOTS, v[LOCKIN_SLOT], v[LOCKIN_AMPLITUDE]);
        note(l->lockin_phase, LOCKIN_SLOTS, v[LOCKIN_SLOT], v[LOCKIN_PHASE]);
        break;
    case WIRE_DRIVE_ECHO:
        if (v[DRIVE_ECHO_CHANNEL] < MODEL_INPUTS)
            note(l->drive[(int)v[DRIVE_ECHO_CHANNEL]], LATEST_DRIVE_FIELDS, v[DRIVE_ECHO_FIELD],
                 v[DRIVE_ECHO_VALUE]);
        break;
    case WIRE_LEDGER:
        note(l->ledger, LATEST_LEDGER, v[LEDGER_ITEM], v[LEDGER_VALUE]);
        break;
    case WIRE_HEALTH:
        note(l->health, DIAG_COUNTERS, v[HEALTH_ITEM], v[HEALTH_VALUE]);
        break;
    case WIRE_PARAM_ECHO:
        note(l->parameter, LATEST_PARAMETERS, v[PARAM_ECHO_INDEX], v[PARAM_ECHO_VALUE]);
        break;
    case WIRE_INFO:
        note(l->info, INFO_ITEMS, v[INFO_ITEM], v[INFO_VALUE]);
        break;
    default:
        break;
    }
}

void latest_take(struct latest *l, uint32_t substeps, const struct message *m)
{
    const double *v = m->value;
    l->message[m->kind] = *m;
    l->count[m->kind]++;
    switch (m->kind) {
    case WIRE_STATUS:
        take_status(l, m);
        break;
    case WIRE_SYNC:
        (void)listen_sync(substeps, m, &l->frame, &l->tick);
        break;
    case WIRE_REPLY:
        if (v[REPLY_CAUSE] < CAUSES)
            l->reply[(int)v[REPLY_CAUSE]]++;
        break;
    case WIRE_EVENT_TIME:
        l->touchdowns += v[EVENT_TOUCH] > 0.0;
        l->liftoffs += !(v[EVENT_TOUCH] > 0.0);
        break;
    case WIRE_MOTION:
        l->displacement_m = v[MOTION_DISPLACEMENT];
        l->velocity_m_per_s = v[MOTION_VELOCITY];
        break;
    case WIRE_CONTACT:
        l->contact_tick = l->tick;
        l->in_contact = v[CONTACT_IN_CONTACT] > 0.0;
        l->penetration_m = v[CONTACT_PENETRATION];
        l->force_N = v[CONTACT_FORCE];
        break;
    case WIRE_EVENT_SUMMARY:
        l->contact_loss = v[SUMMARY_LOSS];
        break;
    default:
        take_slow(l, m);
    }
}
