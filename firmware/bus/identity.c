/* identity.c - see identity.h. */
#include "firmware/bus/identity.h"

#include "firmware/bus/settings.h"

static const uint32_t check_mask = 0xFFFFFFu;

uint32_t identity_of_model(const struct model *m)
{
    uint32_t crc = 0;
    for (const char *c = m->name; *c; c++) {
        uint8_t byte = (uint8_t)*c;
        crc = wire_crc32(crc, &byte, 1);
    }
    return crc & check_mask;
}

/* The check of the settings from stream_linear_0 to capture_every_ticks, by their wire index. */
static uint32_t of_settings(const double *setting)
{
    uint32_t crc = 0;
    for (unsigned i = SET_STREAM_LINEAR; i <= SET_CAPTURE_EVERY_TICKS; i++)
        crc = wire_crc32_entry(crc, SETTING_FIRST + i, setting[i]);
    return crc & check_mask;
}

bool identity_item(const struct wire_scene *s, unsigned item, double *value)
{
    const double part[INFO_ITEMS] = {
        [INFO_VERSION] = WIRE_VERSION, [INFO_FRAME_RATE_HZ] = s->frame_rate_Hz,
        [INFO_SUBSTEPS] = s->substeps, [INFO_DILATION] = s->dilation,
        [INFO_IDENTITY] = s->identity, [INFO_MODEL] = s->model,
        [INFO_LSB] = s->lsb[0],        [INFO_LSB + 1] = s->lsb[1],
        [INFO_LSB + 2] = s->lsb[2],    [INFO_LSB + 3] = s->lsb[3],
        [INFO_SETTINGS] = s->settings,
    };
    *value = part[item];
    return item != INFO_F0_REAL_HZ && item != INFO_F0_BUS_HZ && item != INFO_PROMOTED;
}

void identity_fill(struct wire_scene *s, const struct model *m, const double *setting)
{
    uint32_t crc = 0;
    double value;
    s->model = identity_of_model(m);
    s->settings = of_settings(setting);
    for (unsigned i = 0; i < INFO_ITEMS; i++) {
        if (i != INFO_IDENTITY && identity_item(s, i, &value))
            crc = wire_crc32_entry(crc, i, value);
    }
    s->identity = crc & check_mask;
}
