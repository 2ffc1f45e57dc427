/* explain.c - see explain.h. */
#include "firmware/bus/wire_table.h"
#include "host_sim/live/explain.h"
#include "firmware/bus/identity.h"
#include "host_sim/cli/names.h"
#include "host_sim/scene/scene_name.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Behind what stands in why[EXPLAIN_REASON]. */
#define add(why, ...) snprintf((why) + strlen(why), EXPLAIN_REASON - strlen(why), __VA_ARGS__)

/* The name of the model with this check. */
static const char *model_of(double check)
{
    for (int i = 0; i < SCENE_MODELS; i++)
        if (check == (double)identity_of_model(scene_model(i)))
            return scene_model(i)->name;
    return "of a name that is unknown here";
}

/* One part of the identity, where the plant has told it and this client assumes another. */
static void add_part(const struct client *c, char *why, unsigned item)
{
    struct named n = {"", "", ""};
    double assumed, told = c->latest.info[item];
    if (!identity_item(&c->scene, item, &assumed) || isnan(told) || told == (double)(float)assumed)
        return;
    (void)names_get(model_table[0], NAMES_INFO, item, &n);
    bool unit = *n.unit && strcmp(n.unit, "1");
    if (item == INFO_MODEL)
        add(why, " model %s, not %s;", model_of(told), model_of(assumed));
    else if (item == INFO_SETTINGS)
        add(why, " other --setting stream_linear_*, lockin_* or capture_every_ticks;");
    else
        add(why, " %s %.6g%s%s, not %.6g;", n.name, told, unit ? " " : "", unit ? n.unit : "", assumed);
}

void explain_identity(const struct client *c, char *why)
{
    *why = '\0';
    if (client_identity(c) == CLIENT_UNTOLD) {
        add(why, "the plant does not tell its identity (INFO), so no number of it can be trusted; update it "
                 "if its version is older");
        return;
    }
    add(why, "the plant is another one than this command assumes:");
    add_part(c, why, INFO_MODEL);
    for (unsigned i = 0; i < INFO_ITEMS; i++)
        if (i != INFO_IDENTITY && i != INFO_MODEL)
            add_part(c, why, i);
    add(why, " give the scene and the --set, --setting, --rate, --substeps and --dilation of the plant");
}

void explain_no_session(const struct client *c, char *why)
{
    *why = '\0';
    if (!c->latest.count[WIRE_STATUS])
        add(why, "no plant answers; start one with contactplant run, and see --bus, --peer and --base-id; "
                 "one of run --lockstep answers control --lockstep");
    else if (client_identity(c) != CLIENT_SAME)
        explain_identity(c, why);
    else if (c->latest.faults & FAULT_SELF_TEST)
        add(why, "the plant failed its self-test and takes no session; see contactplant selftest");
    else
        add(why, "the plant refuses a session; another controller may have one: stop that one, or wait for "
                 "its end");
}
