/* account.c - see account.h. */
#include "firmware/app/account.h"

#include <string.h>
#include "firmware/app/app.h"
#include "firmware/app/session.h"
#include "firmware/plant/plant_report.h"

enum { BALANCE_FRAMES = 100 /* plant frames from one look at the balance to the next */ };

void account_judge(struct app *a, uint32_t advanced)
{
    if (a->plant.now.tick / a->config.substeps % BALANCE_FRAMES >= advanced)
        return;
    if (!(plant_imbalance(&a->plant, &a->balance_residual_J) <= a->setting[SET_LEDGER_ALARM]))
        session_fault(a, FAULT_LEDGER);
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
    count[DIAG_LOCKIN_SHORT] = a->lockin.n_short;
    count[DIAG_LOCKIN_CLOSE] = a->lockin.n_close;
    count[DIAG_LATENESS_MAX_FRAME] = (uint32_t)a->timing.lateness.max_frame;
}
