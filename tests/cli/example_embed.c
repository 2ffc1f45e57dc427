/* example_embed.c - a unit test of your own, without a bus: make a plant, excite it, step it, assert on contact.
 *
 *   cc -std=c99 -I. -Ibuild tests/cli/example_embed.c build/libcontactplant.a -lm && ./a.out */
#include <stdio.h>
#include <stdlib.h>
#include "firmware/plant/plant.h"
#include "models/hertz_rig.h"

int main(void)
{
    static struct plant rig;
    struct plant_config c = {.model = &hertz_rig, .method = &rk4, .tick_s = 1e-3 / 64, .dilation = 1.0};
    const char *why = plant_init(&rig, &c); /* the default rig: 6.5 kg on a 230 Hz contact, 64 N preload */
    if (why) {
        fprintf(stderr, "%s\n", why);
        return 1;
    }
    plant_drive(&rig, RIG_FORCE, 0.5, 225.0, 0.0, 0.1); /* 0.5 N at 225 Hz, ramped up in 0.1 s */
    int ok = plant_run(&rig, 64 * 500) && rig.counts.switches == 0;
    printf("0.5 N: contact force %.1f N, contact kept: %s\n", plant_read(&rig, "contact_force"),
           ok ? "yes" : "no");

    plant_drive(&rig, RIG_FORCE, 3.0, 225.0, 0.0, 0.1); /* six times as much */
    ok = ok && plant_run(&rig, 64 * 500) && rig.counts.switches > 0;
    printf("3.0 N: %u contact switches\n", rig.counts.switches);
    printf("%d passed, %d failed\n", ok, !ok);
    return !ok;
}
