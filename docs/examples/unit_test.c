/* unit_test.c - a plant in a unit test of your own: excite it, advance it, assert on what happened.
 *
 *   cc unit_test.c $(pkg-config --cflags --libs contactplant) && ./a.out */
#include <contactplant.h>
#include <stdio.h>

static union contactplant_memory memory;
static int failed;

static void check(const char *what, int holds)
{
    printf("%s  %s\n", holds ? "ok  " : "FAIL", what);
    failed += !holds;
}

/* A rig of 5 kg instead of its own 6.5 kg, which starts with its drive at 225 Hz. */
static const char scene[] = "[plant]\n"
                            "model = hertz_rig\n"
                            "mass = 5 kg\n";

/* Half a second with this force at 225 Hz: how often the contact switched. */
static unsigned long shaken(struct contactplant *rig, double force_N)
{
    unsigned long before = (unsigned long)contactplant_counter(rig, CONTACTPLANT_SWITCHES);
    int force = contactplant_find(rig, CONTACTPLANT_INPUT, "force");
    if (contactplant_set_drive(rig, force, force_N, 225.0, 0.0, 0.1) != CONTACTPLANT_OK)
        check(contactplant_error(rig), 0);
    if (contactplant_advance_to(rig, contactplant_time(rig) + 0.5) != CONTACTPLANT_OK)
        check(contactplant_error(rig), 0);
    return (unsigned long)contactplant_counter(rig, CONTACTPLANT_SWITCHES) - before;
}

int main(void)
{
    struct contactplant_error error;
    struct contactplant_event event;
    struct contactplant *rig = contactplant_open(&memory, sizeof memory, scene, &error);
    double last_s = 0.0, hardest = 0.0;
    int ordered = 1, count = 0;
    if (!rig) {
        fprintf(stderr, "%s\n", error.text);
        return 1;
    }
    check("0.5 N: contact is kept", shaken(rig, 0.5) == 0);
    check("20 N: contact is lost", shaken(rig, 20.0) > 0);
    for (; contactplant_next_event(rig, &event); count++) {
        ordered = ordered && event.time_s >= last_s;
        last_s = event.time_s;
        if (event.touch && event.speed > hardest)
            hardest = event.speed;
    }
    check("its last events have their instants, in order", count > 0 && ordered);
    printf("      the hardest touchdown of %d switches: %.3g m/s\n", count, hardest);
    check("no energy came from nowhere", contactplant_residual(rig) < 1e-3 * contactplant_energy(rig));
    check("a mistake is told",
          contactplant_find(rig, CONTACTPLANT_INPUT, "forse") == -1 && contactplant_error(rig)[0] != '\0');
    printf("      %s\n", contactplant_error(rig));
    return failed != 0;
}
