/* test_plant_bounds.c - the ends of what a plant is configured with: the last value that is taken, the first that is not. */
#include "tests/test.h"

#include "firmware/plant.h"
#include "models/hertz_rig.h"

void test_plant_bounds(void);

/* What plant_init says; a step that the method would refuse is run by force. */
static const char *said(double tick_s, double dilation)
{
    static struct plant pl;
    const struct plant_config c = {
        .model = &hertz_rig, .method = &rk4, .tick_s = tick_s, .dilation = dilation, .force = true};
    const char *why = plant_init(&pl, &c);
    return why ? why : "taken";
}

void test_plant_bounds(void)
{
    static const char tick[] = "tick outside 1e-12..1e6 s", dilation[] = "dilation outside 1e-6..1e9";
    check_string("tick 1e-12 s", said(1e-12, 1.0), "taken");
    check_string("tick 0.999e-12 s", said(0.999e-12, 1.0), tick);
    check_string("tick 1e6 s", said(1e6, 1.0), "taken");
    check_string("tick 1.001e6 s", said(1.001e6, 1.0), tick);
    check_string("dilation 1e-6", said(1e-6, 1e-6), "taken");
    check_string("dilation 0.999e-6", said(1e-6, 0.999e-6), dilation);
    check_string("dilation 1e9", said(1e-6, 1e9), "taken");
    check_string("dilation 1.001e9", said(1e-6, 1.001e9), dilation);
}
