/* work_models.c - see work_models.h. */
#include "tests/bench/cost/work_models.h"

#include "firmware/plant/plant.h"
#include "firmware/method/taylor/taylor_piece.h"
#include "firmware/plant/plant_change.h"
#include "models/afm_lever.h"
#include "models/reduced/afm_tip_reduced.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/reduced/shaft_mode.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/afm/paper_tip.h"

static const double small = 0.01; /* in the model's unit */

static struct plant pl;
static double scratch[METHOD_SCRATCH];
static bool good, switches;

static const struct taylor *taylor_scratch(void)
{
    return (const struct taylor *)(const void *)scratch;
}

static const char *start(const struct model *m, const struct method *method, int input, int period)
{
    struct scale scale;
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = paper_tip_is(m) ? paper_tip_parameter(m, i) : m->parameter[i].initial;
    if (paper_tip_is(m)) /* the published sign is soft at rest, and stiff elsewhere */
        si[TIP_SIGN] = -1.0;
    if (m == &afm_lever) {
        si[LEVER_MODES] = period == MODES || period == NEAR_MODES ? MODEL_MODES : 1.0;
        si[LEVER_HEIGHT] = period == NEAR || period == NEAR_MODES ? -2e-9 : si[LEVER_HEIGHT];
    }
    m->prepare(si, p, &scale);
    double period_s = 2.0 * 3.141592653589793 / m->eigenfrequency(p) * scale.time_s;
    if (paper_tip_is(m))
        si[TIP_SIGN] = 1.0;
    const struct plant_config c = {.model = m,
                                   .method = method,
                                   .si = si,
                                   .tick_s = period_s / (period > FINE ? FINE : period),
                                   .dilation = 1.0,
                                   .tol = method->order > 0 ? 0.0
                                          : period == FINE || period == COARSE
                                              ? 1e-6
                                              : 8e-3, /* relative to so small a motion */
                                   .scratch = scratch};
    const char *why = plant_init(&pl, &c);
    if (why)
        return why;
    double unit = scale_of(&scale, m->input_signal[input].quantity);
    plant_drive_start(&pl, input, small * unit, 0.9 / period_s, 0.0);
    if (period == NOISY || period == HELD)
        plant_noise(&pl, input, small * unit, period == HELD ? 64 : 1, 7, 0.0);
    if (period == SWITCHING_TWO)
        plant_drive_start(&pl, input + 1, small * unit, 0.8 / period_s, 0.0);
    good = plant_run(&pl, 2 * FINE) &&
           (period > FINE || period == FINE || period == COARSE || taylor_scratch()->kind == TAYLOR_NONE);
    return good ? 0 : "the motion escapes";
}

/* Closed, and apart within a tick. */
static void lift_off(void)
{
    pl.x[0] = 0.02;
    pl.x[1] = -0.6;
    pl.regime = 1;
    switches = true;
}

/* By the input that sounds; coarse: taylor by long series in long
 * ticks, short: by one a tick. clang-format off: one line each */
#define EACH_MODEL(MODEL)                                                                                    \
    MODEL(rig_rk4, hertz_rig, rk4, 0, FINE)                                                                  \
    MODEL(rig_float32, hertz_rig, rk4_float32, 0, FINE)                                                      \
    MODEL(rig_unlocated, hertz_rig, rk4_unlocated, 0, FINE)                                                  \
    MODEL(rig_taylor, hertz_rig, taylor, 0, FINE)                                                            \
    MODEL(rig_linear_rk4, hertz_rig_linear, rk4, 0, FINE)                                                    \
    MODEL(rig_linear_float32, hertz_rig_linear, rk4_float32, 0, FINE)                                        \
    MODEL(rig_linear_taylor, hertz_rig_linear, taylor, 0, FINE)                                              \
    MODEL(rig_linear_exact, hertz_rig_linear, exact, 0, FINE)                                                \
    MODEL(rig_cubic_rk4, hertz_rig_cubic, rk4, 0, FINE)                                                      \
    MODEL(rig_cubic_float32, hertz_rig_cubic, rk4_float32, 0, FINE)                                          \
    MODEL(rig_cubic_taylor, hertz_rig_cubic, taylor, 0, FINE)                                                \
    MODEL(rig_averaged_rk4, hertz_rig_averaged, rk4, 0, FINE)                                                \
    MODEL(rig_averaged_float32, hertz_rig_averaged, rk4_float32, 0, FINE)                                    \
    MODEL(rig_averaged_taylor, hertz_rig_averaged, taylor, 0, FINE)                                          \
    MODEL(rolling_rk4, rolling_contact, rk4, 0, FINE)                                                        \
    MODEL(rolling_float32, rolling_contact, rk4_float32, 0, FINE)                                            \
    MODEL(rolling_unlocated, rolling_contact, rk4_unlocated, 0, FINE)                                        \
    MODEL(rolling_taylor, rolling_contact, taylor, 0, FINE)                                                  \
    MODEL(rolling_linear_rk4, rolling_contact_linear, rk4, 0, FINE)                                          \
    MODEL(rolling_linear_float32, rolling_contact_linear, rk4_float32, 0, FINE)                              \
    MODEL(rolling_linear_taylor, rolling_contact_linear, taylor, 0, FINE)                                    \
    MODEL(rolling_linear_exact, rolling_contact_linear, exact, 0, FINE)                                      \
    MODEL(tip_rk4, afm_tip, rk4, 0, FINE)                                                                    \
    MODEL(tip_float32, afm_tip, rk4_float32, 0, FINE)                                                        \
    MODEL(tip_unlocated, afm_tip, rk4_unlocated, 0, FINE)                                                    \
    MODEL(tip_taylor, afm_tip, taylor, 0, FINE)                                                              \
    MODEL(tip_linear_rk4, afm_tip_linear, rk4, 0, FINE)                                                      \
    MODEL(tip_linear_float32, afm_tip_linear, rk4_float32, 0, FINE)                                          \
    MODEL(tip_linear_taylor, afm_tip_linear, taylor, 0, FINE)                                                \
    MODEL(tip_linear_exact, afm_tip_linear, exact, 0, FINE)                                                  \
    MODEL(tip_cubic_rk4, afm_tip_cubic, rk4, 0, FINE)                                                        \
    MODEL(tip_cubic_float32, afm_tip_cubic, rk4_float32, 0, FINE)                                            \
    MODEL(tip_cubic_taylor, afm_tip_cubic, taylor, 0, FINE)                                                  \
    MODEL(tip_averaged_rk4, afm_tip_averaged, rk4, 0, FINE)                                                  \
    MODEL(tip_averaged_float32, afm_tip_averaged, rk4_float32, 0, FINE)                                      \
    MODEL(tip_averaged_taylor, afm_tip_averaged, taylor, 0, FINE)                                            \
    MODEL(shaft_rk4, shaft_bearing, rk4, 1, FINE)                                                            \
    MODEL(shaft_float32, shaft_bearing, rk4_float32, 1, FINE)                                                \
    MODEL(shaft_unlocated, shaft_bearing, rk4_unlocated, 1, FINE)                                            \
    MODEL(shaft_exact, shaft_bearing, exact, 1, FINE)                                                        \
    MODEL(shaft_linear_rk4, shaft_bearing_linear, rk4, 1, FINE)                                              \
    MODEL(shaft_linear_float32, shaft_bearing_linear, rk4_float32, 1, FINE)                                  \
    MODEL(shaft_linear_exact, shaft_bearing_linear, exact, 1, FINE)                                          \
    MODEL(shaft_mode_rk4, shaft_bearing_mode, rk4, 1, FINE)                                                  \
    MODEL(shaft_mode_float32, shaft_bearing_mode, rk4_float32, 1, FINE)                                      \
    MODEL(shaft_mode_unlocated, shaft_bearing_mode, rk4_unlocated, 1, FINE)                                  \
    MODEL(shaft_mode_exact, shaft_bearing_mode, exact, 1, FINE)                                              \
    MODEL(rig_stiffness_rk4, hertz_rig, rk4, RIG_STIFFNESS, FINE)                                            \
    MODEL(rig_stiffness_float32, hertz_rig, rk4_float32, RIG_STIFFNESS, FINE)                                \
    MODEL(rig_stiffness_unlocated, hertz_rig, rk4_unlocated, RIG_STIFFNESS, FINE)                            \
    MODEL(rig_stiffness_taylor, hertz_rig, taylor, RIG_STIFFNESS, FINE)                                      \
    MODEL(rig_linear_stiffness_rk4, hertz_rig_linear, rk4, RIG_STIFFNESS, FINE)                              \
    MODEL(rig_linear_stiffness_float32, hertz_rig_linear, rk4_float32, RIG_STIFFNESS, FINE)                  \
    MODEL(rig_linear_stiffness_taylor, hertz_rig_linear, taylor, RIG_STIFFNESS, FINE)                        \
    MODEL(rig_linear_stiffness_exact, hertz_rig_linear, exact, RIG_STIFFNESS, FINE)                          \
    MODEL(rig_cubic_stiffness_rk4, hertz_rig_cubic, rk4, RIG_STIFFNESS, FINE)                                \
    MODEL(rig_cubic_stiffness_float32, hertz_rig_cubic, rk4_float32, RIG_STIFFNESS, FINE)                    \
    MODEL(rig_cubic_stiffness_taylor, hertz_rig_cubic, taylor, RIG_STIFFNESS, FINE)                          \
    MODEL(rolling_waviness_rk4, rolling_contact, rk4, ROLLING_WAVINESS, FINE)                                \
    MODEL(rolling_waviness_float32, rolling_contact, rk4_float32, ROLLING_WAVINESS, FINE)                    \
    MODEL(rolling_waviness_unlocated, rolling_contact, rk4_unlocated, ROLLING_WAVINESS, FINE)                \
    MODEL(rolling_waviness_taylor, rolling_contact, taylor, ROLLING_WAVINESS, FINE)                          \
    MODEL(rolling_linear_waviness_rk4, rolling_contact_linear, rk4, ROLLING_WAVINESS, FINE)                  \
    MODEL(rolling_linear_waviness_float32, rolling_contact_linear, rk4_float32, ROLLING_WAVINESS, FINE)      \
    MODEL(rolling_linear_waviness_taylor, rolling_contact_linear, taylor, ROLLING_WAVINESS, FINE)            \
    MODEL(rolling_linear_waviness_exact, rolling_contact_linear, exact, ROLLING_WAVINESS, FINE)              \
    MODEL(tip_stiffness_rk4, afm_tip, rk4, TIP_STIFFNESS, FINE)                                              \
    MODEL(tip_stiffness_float32, afm_tip, rk4_float32, TIP_STIFFNESS, FINE)                                  \
    MODEL(tip_stiffness_unlocated, afm_tip, rk4_unlocated, TIP_STIFFNESS, FINE)                              \
    MODEL(tip_stiffness_taylor, afm_tip, taylor, TIP_STIFFNESS, FINE)                                        \
    MODEL(tip_linear_stiffness_rk4, afm_tip_linear, rk4, TIP_STIFFNESS, FINE)                                \
    MODEL(tip_linear_stiffness_float32, afm_tip_linear, rk4_float32, TIP_STIFFNESS, FINE)                    \
    MODEL(tip_linear_stiffness_taylor, afm_tip_linear, taylor, TIP_STIFFNESS, FINE)                          \
    MODEL(tip_linear_stiffness_exact, afm_tip_linear, exact, TIP_STIFFNESS, FINE)                            \
    MODEL(tip_cubic_stiffness_rk4, afm_tip_cubic, rk4, TIP_STIFFNESS, FINE)                                  \
    MODEL(tip_cubic_stiffness_float32, afm_tip_cubic, rk4_float32, TIP_STIFFNESS, FINE)                      \
    MODEL(tip_cubic_stiffness_taylor, afm_tip_cubic, taylor, TIP_STIFFNESS, FINE)                            \
    MODEL(rig_coarse, hertz_rig, taylor, 0, COARSE)                                                          \
    MODEL(rig_linear_coarse, hertz_rig_linear, taylor, 0, COARSE)                                            \
    MODEL(rig_cubic_coarse, hertz_rig_cubic, taylor, 0, COARSE)                                              \
    MODEL(rig_averaged_coarse, hertz_rig_averaged, taylor, 0, COARSE)                                        \
    MODEL(rolling_coarse, rolling_contact, taylor, 0, COARSE)                                                \
    MODEL(rolling_linear_coarse, rolling_contact_linear, taylor, 0, COARSE)                                  \
    MODEL(tip_coarse, afm_tip, taylor, 0, COARSE)                                                            \
    MODEL(tip_linear_coarse, afm_tip_linear, taylor, 0, COARSE)                                              \
    MODEL(tip_cubic_coarse, afm_tip_cubic, taylor, 0, COARSE)                                                \
    MODEL(tip_averaged_coarse, afm_tip_averaged, taylor, 0, COARSE)                                          \
    MODEL(rig_stiffness_coarse, hertz_rig, taylor, RIG_STIFFNESS, COARSE)                                    \
    MODEL(rig_linear_stiffness_coarse, hertz_rig_linear, taylor, RIG_STIFFNESS, COARSE)                      \
    MODEL(rig_cubic_stiffness_coarse, hertz_rig_cubic, taylor, RIG_STIFFNESS, COARSE)                        \
    MODEL(rolling_waviness_coarse, rolling_contact, taylor, ROLLING_WAVINESS, COARSE)                        \
    MODEL(rolling_linear_waviness_coarse, rolling_contact_linear, taylor, ROLLING_WAVINESS, COARSE)          \
    MODEL(tip_stiffness_coarse, afm_tip, taylor, TIP_STIFFNESS, COARSE)                                      \
    MODEL(tip_linear_stiffness_coarse, afm_tip_linear, taylor, TIP_STIFFNESS, COARSE)                        \
    MODEL(tip_cubic_stiffness_coarse, afm_tip_cubic, taylor, TIP_STIFFNESS, COARSE)                          \
    MODEL(rig_short, hertz_rig, taylor, 0, SHORT)                                                            \
    MODEL(rig_linear_short, hertz_rig_linear, taylor, 0, SHORT)                                              \
    MODEL(rig_cubic_short, hertz_rig_cubic, taylor, 0, SHORT)                                                \
    MODEL(rig_averaged_short, hertz_rig_averaged, taylor, 0, SHORT)                                          \
    MODEL(rolling_short, rolling_contact, taylor, 0, SHORT)                                                  \
    MODEL(rolling_linear_short, rolling_contact_linear, taylor, 0, SHORT)                                    \
    MODEL(tip_short, afm_tip, taylor, 0, SHORT_TIP)                                                          \
    MODEL(tip_linear_short, afm_tip_linear, taylor, 0, SHORT_TIP)                                            \
    MODEL(tip_cubic_short, afm_tip_cubic, taylor, 0, SHORT_TIP)                                              \
    MODEL(tip_averaged_short, afm_tip_averaged, taylor, 0, SHORT_TIP)                                        \
    MODEL(rig_stiffness_short, hertz_rig, taylor, RIG_STIFFNESS, SHORT)                                      \
    MODEL(rolling_waviness_short, rolling_contact, taylor, ROLLING_WAVINESS, SHORT)                          \
    MODEL(tip_stiffness_short, afm_tip, taylor, TIP_STIFFNESS, SHORT_TIP)                                    \
    MODEL(rig_cubic_stiffness_short, hertz_rig_cubic, taylor, RIG_STIFFNESS, SHORT)                          \
    MODEL(tip_cubic_stiffness_short, afm_tip_cubic, taylor, TIP_STIFFNESS, SHORT_TIP)                        \
    MODEL(lever_modal, afm_lever, modal, 0, FINE)                                                            \
    MODEL(lever_z_modal, afm_lever, modal, LEVER_Z, FINE)                                                    \
    MODEL(lever_modes_modal, afm_lever, modal, 0, MODES)                                                     \
    MODEL(lever_near_modal, afm_lever, modal, 0, NEAR)                                                       \
    MODEL(lever_near_modes_modal, afm_lever, modal, 0, NEAR_MODES)                                           \
    MODEL(rig_noise_rk4, hertz_rig, rk4, 0, NOISY)                                                           \
    MODEL(rig_noise_held_rk4, hertz_rig, rk4, 0, HELD)                                                       \
    MODEL(rig_switch_rk4, hertz_rig, rk4, 0, SWITCHING)                                                      \
    MODEL(rig_forces_switch_rk4, hertz_rig, rk4, 0, SWITCHING_TWO)                                           \
    MODEL(rig_switch_unlocated, hertz_rig, rk4_unlocated, 0, SWITCHING)                                      \
    MODEL(rig_forces_switch_unlocated, hertz_rig, rk4_unlocated, 0, SWITCHING_TWO)
/* clang-format on */

enum { RUN = 50 };
#define TICKS(period) ((period) >= SWITCHING ? 1 : RUN)

#define FUNCTIONS(name, model, method, input, period)                                                        \
    static void setup_##name(void)                                                                           \
    {                                                                                                        \
        good = !start(&model, &method, input, period);                                                       \
    }                                                                                                        \
    __attribute__((noinline)) static void once_##name(void)                                                  \
    {                                                                                                        \
        if (period >= SWITCHING)                                                                             \
            lift_off();                                                                                      \
        good &= plant_run(&pl, TICKS(period));                                                               \
    }
EACH_MODEL(FUNCTIONS)

#define ENTRY(name, model, method, input, period) {#name, setup_##name, once_##name},
const struct work_piece work_model[WORK_MODELS] = {EACH_MODEL(ENTRY)};

#define KIND(name, model, method, input, period) {&model, &method, input, period},
const struct work_kind work_kind[WORK_MODELS] = {EACH_MODEL(KIND)};

const char *work_models_setup(int i)
{
    switches = false;
    work_model[i].setup();
    return good ? 0 : work_model[i].name;
}

int work_models_ticks(int i)
{
    return TICKS(work_kind[i].period);
}

int work_models_good(void)
{
    return good && (pl.counts.switches > 0) == switches;
}

double work_models_series(void)
{
    return (double)taylor_scratch()->count.time;
}
