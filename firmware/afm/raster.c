/* raster.c - see raster.h. */
#include "firmware/afm/raster.h"

uint64_t raster_samples(const struct raster *r)
{
    return 2 * (uint64_t)r->pixels * r->samples * r->lines;
}

bool raster_at(const struct raster *r, uint64_t n, struct raster_place *place)
{
    uint64_t one_way = (uint64_t)r->pixels * r->samples, line = n / (2 * one_way), at = n % (2 * one_way);
    if (line >= r->lines)
        return false;
    place->back = at >= one_way;
    uint64_t along = place->back ? 2 * one_way - 1 - at : at;
    place->line = (uint32_t)line;
    place->pixel = (uint32_t)(along / r->samples);
    place->last = (at + 1) % r->samples == 0;
    double x = place->back ? (double)along : (double)(along + 1);
    place->x_m = r->width_m * x / (double)one_way;
    place->y_m = r->length_m * (double)(n + 1) / (double)raster_samples(r);
    return true;
}

double ramp_run(struct ramp *r, bool trigger, double dt)
{
    double step = r->speed_m_per_s * dt;
    if (r->phase == RAMP_IN) {
        r->triggered = trigger;
        if (trigger || r->z_m - step < r->low_m)
            r->phase = RAMP_DWELL;
        else
            r->z_m -= step;
    } else if (r->phase == RAMP_DWELL) {
        r->waited_s += dt;
        if (r->waited_s >= r->dwell_s)
            r->phase = RAMP_OUT;
    } else if (r->phase == RAMP_OUT) {
        r->z_m = r->z_m + step < r->high_m ? r->z_m + step : r->high_m;
        if (r->z_m == r->high_m)
            r->phase = RAMP_OFF;
    }
    return r->z_m;
}
