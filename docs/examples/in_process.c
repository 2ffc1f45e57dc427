/* in_process.c - the whole program and a controller in one process: frames through memory, no socket and no
 * clock.
 *
 *   cc in_process.c $(pkg-config --cflags --libs contactplant) && ./a.out
 *
 * The controller is any code that speaks the protocol; here it is the library's client. Whenever it waits,
 * the plant runs a frame: it may be stopped by a debugger for as long as it likes. */
#include <contactplant.h>
#include <stdio.h>
#include <stdlib.h>

static union contactplant_memory plant_memory;
static union contactplant_client_memory client_memory;

/* ---- the transport: the other end of each function is the plant ---- */

static int receive(void *plant, struct contactplant_frame *frame)
{
    return contactplant_bus_take((struct contactplant *)plant, frame);
}

static int transmit(void *plant, const struct contactplant_frame *frame)
{
    return contactplant_bus_put((struct contactplant *)plant, frame) == CONTACTPLANT_OK;
}

static double run_frame(void *plant, double seconds)
{
    struct contactplant *p = (struct contactplant *)plant;
    (void)seconds;
    return contactplant_bus_frame(p) == CONTACTPLANT_OK ? contactplant_substeps(p) * contactplant_tick_time(p)
                                                        : -1.0;
}

static void must(int code, const struct contactplant_client *client)
{
    if (code == CONTACTPLANT_OK)
        return;
    fprintf(stderr, "%s\n", contactplant_client_error(client));
    exit(1);
}

int main(int argc, char **argv)
{
    unsigned long frames = argc > 1 ? strtoul(argv[1], NULL, 10) : 2000;
    struct contactplant_error error;
    struct contactplant_latest now;
    struct contactplant *plant =
        contactplant_open_bus(&plant_memory, sizeof plant_memory, "hertz_rig", &error);
    struct contactplant_transport link = {plant, receive, transmit, NULL, run_frame};
    struct contactplant_client *me =
        contactplant_client_open(&client_memory, sizeof client_memory, "hertz_rig", &link, &error);
    double force_N = 0.0;
    if (!plant || !me) {
        fprintf(stderr, "%s\n", error.text);
        return 1;
    }
    must(contactplant_client_begin(me, 5.0), me);
    must(contactplant_client_control(me, CONTACTPLANT_START, 0), me);
    must(contactplant_client_wait(me, CONTACTPLANT_WAIT_STATE, CONTACTPLANT_STATE_RUNNING, 1.0), me);
    must(contactplant_client_latest(me, &now, sizeof now), me);
    /* 3 N at 225 Hz, near the resonance, from 20 frames ahead */
    must(contactplant_client_arm(me, 0, 3.0, 225.0, 0.0, 0.1), me);
    must(contactplant_client_fire(me, 1u, now.tick + 20 * contactplant_substeps(plant), 0.0), me);
    for (unsigned long i = 0; i < frames; i++) {
        must(contactplant_client_wait(me, CONTACTPLANT_WAIT_CONTACT, now.contact_tick + 1, 1.0), me);
        must(contactplant_client_latest(me, &now, sizeof now), me);
        /* presses when the contact opens, and lets go slowly */
        force_N = now.in_contact ? 0.999 * force_N : force_N < 40.0 ? force_N + 1.0 : 40.0;
        must(contactplant_client_stream(me, 0, now.contact_tick / contactplant_substeps(plant) + 1, force_N),
             me);
        if (i % 10 == 0)
            must(contactplant_client_heartbeat(me), me);
    }
    must(contactplant_client_control(me, CONTACTPLANT_STOP, 0), me);
    must(contactplant_client_wait(me, CONTACTPLANT_WAIT_STATE, CONTACTPLANT_STATE_STOPPED, 1.0), me);
    must(contactplant_client_latest(me, &now, sizeof now), me);
    printf("%lu frames, %lu touchdowns, force %.3f N, %lu commands refused, hash %016llx\n", frames,
           (unsigned long)now.touchdowns, force_N, (unsigned long)now.refused,
           (unsigned long long)contactplant_hash(plant));
    return now.refused != 0;
}
