/* sizes.c - prints the memory that a port must find: structures, and the stack that a frame really used.
 *
 * `sizes app` and `sizes stack` print one number. The stack is painted, a busy second of frames runs (contact
 * loss, all drives, commands of every kind refused and taken), and what was overwritten is counted. */
#include <stdio.h>
#include <string.h>
#include <stdlib.h>
#include "hal/link/loopback.h"
#include "firmware/app/app.h"
#include "models/hertz_rig.h"

enum { PAINTED = 65536, PAINT = 0xA5 };

/* Paints the stack below the caller, or finds how deep it was used since: the same array both times. */
static __attribute__((noinline)) int stack_area(int paint)
{
    volatile unsigned char area[PAINTED];
    int untouched = 0;
    if (paint)
        memset((void *)(size_t)area, PAINT, sizeof area);
    while (untouched < PAINTED && area[untouched] == PAINT)
        untouched++;
    return PAINTED - untouched;
}

static void send(struct hal *hal, struct app *a, uint8_t kind, uint8_t counter, const double *value, int n)
{
    struct message m = {.kind = kind, .counter = counter};
    struct frame f;
    memcpy(m.value, value, (size_t)n * sizeof *value);
    wire_encode(&a->scene, &m, &f);
    hal->send(hal->context, &f);
}

static void busy_frames(struct app *a, struct hal *hal, int frames)
{
    for (int i = 0; i < frames; i++) {
        uint8_t counter = (uint8_t)(i % WIRE_COUNTER_STATES);
        double frame = (double)a->frame, tick = (double)(uint32_t)a->plant.now.tick;
        send(hal, a, WIRE_ENABLE, counter, (double[]){1, 1, frame}, 3);
        send(hal, a, WIRE_CONTROL, counter, (double[]){1, CONTROL_START, 0xFF ^ CONTROL_START, frame}, 4);
        for (uint8_t k = 0; k < MODEL_INPUTS; k++) {
            send(hal, a, (uint8_t)(WIRE_ARM + k), counter,
                 (double[]){1, ARM_AMPLITUDE, k == RIG_BASE ? 1e-5 : 3.0}, 3);
            send(hal, a, (uint8_t)(WIRE_STREAM + k), counter, (double[]){1, frame + 1, 0.0}, 3);
        }
        send(hal, a, WIRE_FIRE, counter, (double[]){1, 15, 0, 0.5, tick + 70}, 5);
        send(hal, a, WIRE_PARAM_WRITE, counter, (double[]){1, i % 2 ? 0 : 300, 6.0}, 3);
        send(hal, a, WIRE_PARAM_COMMIT, counter, (double[]){1, 1, 0, 0}, 4);
        app_frame(a);
        app_frame(a);
    }
}

static int stack_of_frames(void)
{
    static struct loopback_bus bus;
    static struct app a;
    loopback_init(&bus, 2, LOOPBACK_RING);
    struct app_config c = {
        .model = &hertz_rig, .method = &rk4, .frame_s = 1e-3, .substeps = 64, .dilation = 1.0};
    if (app_init(&a, &c, &bus.port[0].hal))
        return -1;
    stack_area(1);
    busy_frames(&a, &bus.port[1].hal, 1000);
    return stack_area(0);
}

int main(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "app") == 0) {
        printf("%zu\n", sizeof(struct app));
    } else if (argc > 1) {
        printf("%d\n", stack_of_frames());
    } else {
        printf("      struct app %zu, of it: plant %zu, mailbox %zu, segment %zu, drive %zu, events %zu "
               "bytes\n",
               sizeof(struct app), sizeof(struct plant), sizeof(struct mailbox), sizeof(struct segment),
               sizeof(struct drive), sizeof(struct event) * PLANT_EVENTS);
    }
    return 0;
}
