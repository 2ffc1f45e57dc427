/* rk4.c - one step of rk4 and of rk4_float32, through the model's instantiation, from any state under any
 * inputs, and the switch that is located in it.
 *
 * The results keep to method.h, as `plant` assumes of a method. State and inputs are any double, NaN and
 * infinities among them. */
#include "firmware/method/method.h"
#include "firmware/method/switch.h"
#include "models/models.h"
#include "tests/eva/angles.h"

static void any_segment(struct segment *e, int n_inputs)
{
    eva_any(e, sizeof *e);
    e->active = eva_uint(0, (1u << n_inputs) - 1);
    e->changed = eva_bool();
}

static void one_step(const struct model *m, const struct method *by, double h)
{
    struct segment e;
    struct scale scale;
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED] = {0}, x[MODEL_STATES], scratch[METHOD_SCRATCH];
    struct crossing c = {0.0, 0, 0, 0.0};
    /*@ loop unroll MODEL_PARAMETERS; */
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = eva_between(m->parameter[i].min, m->parameter[i].max);
    m->prepare(si, p, &scale);
    if (by->refuse(m, p, h, 0.0))
        return;
    by->prepare(m, p, h, 0.0, scratch);
    any_segment(&e, m->n_inputs);
    e.length = h;
    eva_any(x, sizeof x);
    unsigned regime = eva_bool() ? REGIME_ANY : eva_uint(0, (1u << m->n_contacts) - 1);
    enum step_status status = by->bind(m)(m, p, scratch, &e, regime, x, &c);
    /*@ assert contact_is_one: 0 <= c.contact && (m->n_contacts == 0 || c.contact < m->n_contacts); */
    /*@ assert status_is_one: status <= STEP_NOT_FINITE; */
    /*@ assert done_is_inside: status == STEP_END || status == STEP_NOT_FINITE || 0.0 <= c.done <= h; */
    /*@ assert no_contact_no_switch: m->n_contacts > 0 || status != STEP_SWITCH; */
}

int main(void)
{
    /*@ loop unroll 14; */
    for (int i = 0; i < MODELS; i++) {
        one_step(model_table[i], &rk4, 0x1p-20);
        one_step(model_table[i], &rk4, 0x1p-4);
        one_step(model_table[i], &rk4_float32, 0x1p-20);
    }
    return 0;
}
