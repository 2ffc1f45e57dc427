/* account.c - see account.h. */
#include "firmware/app/account.h"

#include <math.h>
#include <string.h>
#include "firmware/app/app.h"
#include "firmware/app/session.h"

enum { BALANCE_FRAMES = 100 /* plant frames from one look at the balance to the next */ };

/* Energies below this fraction of the model's unit are too small to raise an alarm. */
#define BALANCE_FLOOR 1e-4

/* The energy above rest: what swings to and fro in the plant even when nothing flows in or out. */
static double swing(const struct plant *pl)
{
    struct input still[MODEL_INPUTS] = {{0.0, 0.0}};
    double x[MODEL_STATES];
    pl->model->rest(pl->p, x);
    return pl->model->energy(pl->p, pl->segment.at[2], pl->x) - pl->model->energy(pl->p, still, x);
}

/* The ledger's alarm: what did not balance since the last time, against all that flowed and swings. */
static void check_balance(struct app *a)
{
    struct plant *pl = &a->plant;
    double residual_J = plant_residual(pl);
    double moved_J = (pl->ledger.gross + fabs(swing(pl)) + BALANCE_FLOOR) * pl->scale.energy_J;
    if (!(fabs(residual_J - a->balance_residual_J) <= a->setting[SET_LEDGER_ALARM] * moved_J))
        session_fault(a, FAULT_LEDGER);
    a->balance_residual_J = residual_J;
    pl->ledger.gross = 0.0;
}

void account_judge(struct app *a, uint32_t advanced)
{
    if (a->plant.now.tick / a->config.substeps % BALANCE_FRAMES < advanced)
        check_balance(a);
}

void account_counts(const struct app *a, uint32_t *count)
{
    const struct plant_counts *p = &a->plant.counts;
    memcpy(count, a->count, sizeof a->count);
    count[DIAG_SWITCHES] = p->switches;
    count[DIAG_SWITCH_BUDGET] = p->budget;
    count[DIAG_METHOD_BUDGET] = p->work;
    count[DIAG_SWITCH_RESIDUAL] = p->residual;
    count[DIAG_EVENTS_LOST] = p->events_lost;
    count[DIAG_NOT_FINITE] = p->not_finite;
    count[DIAG_PIECES_MAX] = p->pieces_max;
    count[DIAG_COMMAND_AGE_FRAMES] = (uint32_t)session_command_age(a);
    count[DIAG_COMPUTE_MAX_US] = a->timing.compute.max_us;
    count[DIAG_COMPUTE_MAX_FRAME] = (uint32_t)a->timing.compute.max_frame;
    count[DIAG_TX_DEFERRED] = a->telemetry.deferred;
    count[DIAG_TX_REPLACED] = a->telemetry.replaced;
    count[DIAG_CAPTURE_STATE] = a->capture.state;
    count[DIAG_CAPTURE_PRETRIGGER] = a->capture.pretrigger;
    count[DIAG_CAPTURE_TICK] = (uint32_t)a->capture.trigger_tick;
    count[DIAG_LATENESS_MAX_US] = a->timing.lateness.max_us;
    count[DIAG_SENSOR_FAULTS] = a->sensor.active;
    count[DIAG_LATENESS_MAX_FRAME] = (uint32_t)a->timing.lateness.max_frame;
}
