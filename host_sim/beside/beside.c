/* beside.c - see beside.h. */
#include "host_sim/beside/beside.h"

#include <stddef.h>
#include "firmware/method/auto.h"
#include "host_sim/beside/ledger_beside.h"
#include "host_sim/beside/rk4_beside.h"

static run_beside_function *bind_run(const struct plant *pl, unsigned active)
{
    const struct method *method = pl->method == &auto_method ? auto_now(pl->scratch) : pl->method;
    return method == &rk4 ? rk4_bind_beside(pl->model, active) : NULL;
}

const struct plant_beside beside_plants = {bind_run, ledger_bind_beside};
