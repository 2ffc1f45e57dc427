/* session.c - many frames with time between them: whatever
 * comes, the plant stays finite, on time and in its books. */
#include "firmware/app/app.h"
#include "firmware/method/method.h"
#include "hal/link/loopback.h"
#include "models/hertz_rig.h"
#include "tests/fuzz/fuzz.h"

#include <math.h>
#include <string.h>

enum { TICKS = 16, CAPTURE = 256, FRAMES_MAX = 400 };

static struct loopback_bus wires;
static struct app app;
static float capture[CAPTURE];
static uint64_t n_frames;

static void begin(void)
{
    const struct app_config c = {.model = &hertz_rig,
                                 .method = &rk4,
                                 .frame_s = 1e-3,
                                 .substeps = TICKS,
                                 .dilation = 1.0,
                                 .base_id = 0x200,
                                 .capture = capture,
                                 .n_capture = CAPTURE};
    loopback_init(&wires, 2, LOOPBACK_RING);
    MUST(!app_init(&app, &c, &wires.port[0].hal));
    n_frames = 0;
}

static void listen_to_plant(void)
{
    const struct hal *far = &wires.port[1].hal;
    struct message m;
    struct frame f;
    while (far->recv(far->context, &f) == 1)
        MUST(wire_decode(&app.scene, &f, &m) == WIRE_OK && m.kind >= WIRE_COMMANDS);
}

static void one_frame(void)
{
    uint64_t tick = app.plant.now.tick, frame = app.frame;
    app_frame(&app);
    MUST(app.frame == frame + 1);
    for (int i = 0; i < 2; i++)
        MUST(isfinite(app.plant.x[i]));
    bool moved = app.plant.now.tick != tick;
    MUST(!moved || app.state != STATE_READY);
    MUST(app.state == STATE_FAULT || app.plant.now.tick % TICKS == 0);
    MUST(app.state == STATE_FAULT || app.plant.now.tick - tick <= 2 * TICKS);
    MUST(app.mailbox.n_fires <= MAILBOX_FIRES && app.mailbox.n_samples <= MAILBOX_SAMPLES);
    listen_to_plant();
    n_frames++;
}

/* The one in force, or the one that may be opened. */
static unsigned session(void)
{
    return app.enabled ? app.session : app.session % WIRE_SESSIONS + 1u;
}

/* A frame of ours: the input says kind and bytes; session,
 * echo and CRC are made good where its flags ask for it. */
static void command(const uint8_t *d)
{
    struct frame f = {.id = 0x200u | (d[1] & 0x3F), .length = d[0] & 0x40 ? d[1] >> 5 : 8};
    memcpy(f.data, d + 2, 8);
    if (d[0] & 0x04)
        f.data[1] = (uint8_t)((f.data[1] & 0x0F) | session() << 4);
    if (d[0] & 0x08) {
        uint32_t now = (uint32_t)app.frame;
        memcpy(f.data + 4, &now, sizeof now);
    }
    if (!(d[0] & 0x10))
        f.data[0] = wire_crc8(f.id, f.data, 8);
    wires.port[1].hal.send(&wires.port[1], &f);
}

/* Records of 10 bytes: a flag byte, then a command, frames to run, missed frames or a fault of the hal. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    begin();
    for (; size >= 10 && n_frames < FRAMES_MAX; data += 10, size -= 10) {
        switch (data[0] & 3) {
        case 0:
        case 1:
            command(data);
            break;
        case 2:
            for (int i = 0; i <= data[1] % 16; i++)
                one_frame();
            break;
        default:
            if (data[1] & 1)
                wires.port[0].fault = data[2] & 0x1F;
            else
                for (uint32_t due = app_overrun(&app, data[2] % 8u); due > 0; due--)
                    one_frame();
        }
    }
    one_frame();
    return 0;
}
