/* change.c - the operations on a plant between two segments: set-up, new parameters (any doubles at all),
 * a climb, a reset, a state, and the functions that read it. */
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "tests/eva/any_plant.h"

static void set_up(const struct model *m)
{
    static double scratch[1];
    double si[MODEL_PARAMETERS];
    struct plant_config c = {.model = m, .method = &any_method, .si = si, .scratch = scratch};
    eva_any(si, sizeof si);
    eva_any(&c.tick_s, sizeof c.tick_s);
    eva_any(&c.dilation, sizeof c.dilation);
    (void)plant_init(&pl, &c);
}

static void parameters(const struct model *m)
{
    double si[MODEL_PARAMETERS];
    eva_any(si, sizeof si);
    any_plant(m);
    (void)plant_accepts(&pl, si);
    (void)plant_change(&pl, si);
    any_plant(m);
    if (m->full)
        (void)plant_promote(&pl, m->full);
}

static void state(const struct model *m)
{
    struct event e;
    double x[MODEL_STATES], output[MODEL_OUTPUTS];
    any_plant(m);
    (void)plant_take_event(&pl, &e);
    invariants_hold();
    eva_any(x, sizeof x);
    plant_set_state(&pl, x);
    plant_output(&pl, output);
    (void)plant_hash(&pl);
    (void)plant_residual(&pl);
    plant_reset(&pl);
    invariants_hold();
}

int main(void)
{
    /*@ loop unroll 14; */
    for (int i = 0; i < MODELS; i++) {
        set_up(model_table[i]);
        parameters(model_table[i]);
        state(model_table[i]);
    }
    return 0;
}
