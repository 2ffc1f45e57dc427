/* sensor.c - see sensor.h. */
#include "firmware/observe/sensor.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/noise.h"
#include "firmware/stage/stage.h"

enum { EACH_KIND = 0x111111 /* bits of `active`: one for each kind of fault */ };

void sensor_init(struct sensor *s)
{
    memset(s, 0xFF, sizeof *s); /* a double whose bits are all one is a NaN */
    s->newest = 0;
}

void sensor_change(struct sensor *s, const double *setting)
{
    s->active = 0;
    for (int k = 0; k < SENSOR_FAULTS; k++)
        s->active |= (uint32_t)(setting[SET_SENSOR_OFFSET + k] != 0.0) << k;
}

void sensor_record(struct sensor *s, uint64_t frame, const double *output)
{
    s->frame = frame;
    s->newest = (s->newest + 1) % SENSOR_RING;
    memcpy(s->past[s->newest], output, sizeof s->past[0]);
}

static double noise(uint64_t frame, int i, double seed, double deviation)
{
    uint64_t sequence = ((uint64_t)(MODEL_INPUTS + i) << 32) + (uint32_t)(int)seed;
    return deviation > 0.0 ? deviation * noise_deviate(noise_word(sequence, frame)) : 0.0;
}

static double saturated(double x, double limit)
{
    if (limit == 0.0 || !(fabs(x) > limit)) /* also what is not available */
        return x;
    return x > 0.0 ? limit : -limit;
}

double sensor_read(const struct sensor *s, const double *setting, int i, double *said)
{
    const double *own = &setting[SET_SENSOR_OFFSET + i]; /* each kind of fault has one setting a signal */
    unsigned delay = (unsigned)(int)own[SET_SENSOR_DELAY - SET_SENSOR_OFFSET];
    double x = s->past[(s->newest + SENSOR_RING - delay) % SENSOR_RING][i];

    if (own[SET_SENSOR_STUCK - SET_SENSOR_OFFSET] != 0.0 && *said == *said)
        return *said;
    if (s->active & (uint32_t)EACH_KIND << i) {
        x += own[0];
        x += noise(s->frame, i, setting[SET_SENSOR_SEED], own[SET_SENSOR_NOISE - SET_SENSOR_OFFSET]);
        x = saturated(x, own[SET_SENSOR_SATURATION - SET_SENSOR_OFFSET]);
        if (own[SET_SENSOR_QUANTUM - SET_SENSOR_OFFSET] != 0.0)
            x = stage_quantised(x, own[SET_SENSOR_QUANTUM - SET_SENSOR_OFFSET]);
    }
    return *said = x;
}
