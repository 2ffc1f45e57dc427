/* beside.c - see beside.h. */
#include "host_sim/beside/beside.h"

#include <stddef.h>
#include "firmware/method/auto.h"
#include "host_sim/beside/rk4_beside.h"

plant_sides_function *beside_bind(const struct plant *pl, unsigned active)
{
    const struct method *method = pl->method == &auto_method ? auto_now(pl->scratch) : pl->method;
    return method == &rk4 ? rk4_bind_sides(pl->model, active) : NULL;
}
