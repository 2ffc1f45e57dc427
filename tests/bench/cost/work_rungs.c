/* work_rungs.c - see work_rungs.h. */
#include "tests/bench/cost/work_rungs.h"

#include "firmware/plant/plant.h"
#include "firmware/method/taylor/taylor_piece.h"
#include "models/afm_lever.h"
#include "models/reduced/afm_tip_reduced.h"
#include "models/reduced/hertz_rig_reduced.h"
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
 * ticks, short: by one a tick. clang-format off: one line a rung */
#define RUNGS(RUNG)                                                                                          \
    RUNG(rig_rk4, hertz_rig, rk4, 0, FINE)                                                                   \
    RUNG(rig_float32, hertz_rig, rk4_float32, 0, FINE)                                                       \
    RUNG(rig_unlocated, hertz_rig, rk4_unlocated, 0, FINE)                                                   \
    RUNG(rig_taylor, hertz_rig, taylor, 0, FINE)                                                             \
    RUNG(rig_linear_rk4, hertz_rig_linear, rk4, 0, FINE)                                                     \
    RUNG(rig_linear_float32, hertz_rig_linear, rk4_float32, 0, FINE)                                         \
    RUNG(rig_linear_taylor, hertz_rig_linear, taylor, 0, FINE)                                               \
    RUNG(rig_linear_exact, hertz_rig_linear, exact, 0, FINE)                                                 \
    RUNG(rig_cubic_rk4, hertz_rig_cubic, rk4, 0, FINE)                                                       \
    RUNG(rig_cubic_float32, hertz_rig_cubic, rk4_float32, 0, FINE)                                           \
    RUNG(rig_cubic_taylor, hertz_rig_cubic, taylor, 0, FINE)                                                 \
    RUNG(rig_averaged_rk4, hertz_rig_averaged, rk4, 0, FINE)                                                 \
    RUNG(rig_averaged_float32, hertz_rig_averaged, rk4_float32, 0, FINE)                                     \
    RUNG(rig_averaged_taylor, hertz_rig_averaged, taylor, 0, FINE)                                           \
    RUNG(rolling_rk4, rolling_contact, rk4, 0, FINE)                                                         \
    RUNG(rolling_float32, rolling_contact, rk4_float32, 0, FINE)                                             \
    RUNG(rolling_unlocated, rolling_contact, rk4_unlocated, 0, FINE)                                         \
    RUNG(rolling_taylor, rolling_contact, taylor, 0, FINE)                                                   \
    RUNG(rolling_linear_rk4, rolling_contact_linear, rk4, 0, FINE)                                           \
    RUNG(rolling_linear_float32, rolling_contact_linear, rk4_float32, 0, FINE)                               \
    RUNG(rolling_linear_taylor, rolling_contact_linear, taylor, 0, FINE)                                     \
    RUNG(rolling_linear_exact, rolling_contact_linear, exact, 0, FINE)                                       \
    RUNG(tip_rk4, afm_tip, rk4, 0, FINE)                                                                     \
    RUNG(tip_float32, afm_tip, rk4_float32, 0, FINE)                                                         \
    RUNG(tip_unlocated, afm_tip, rk4_unlocated, 0, FINE)                                                     \
    RUNG(tip_taylor, afm_tip, taylor, 0, FINE)                                                               \
    RUNG(tip_linear_rk4, afm_tip_linear, rk4, 0, FINE)                                                       \
    RUNG(tip_linear_float32, afm_tip_linear, rk4_float32, 0, FINE)                                           \
    RUNG(tip_linear_taylor, afm_tip_linear, taylor, 0, FINE)                                                 \
    RUNG(tip_linear_exact, afm_tip_linear, exact, 0, FINE)                                                   \
    RUNG(tip_cubic_rk4, afm_tip_cubic, rk4, 0, FINE)                                                         \
    RUNG(tip_cubic_float32, afm_tip_cubic, rk4_float32, 0, FINE)                                             \
    RUNG(tip_cubic_taylor, afm_tip_cubic, taylor, 0, FINE)                                                   \
    RUNG(tip_averaged_rk4, afm_tip_averaged, rk4, 0, FINE)                                                   \
    RUNG(tip_averaged_float32, afm_tip_averaged, rk4_float32, 0, FINE)                                       \
    RUNG(tip_averaged_taylor, afm_tip_averaged, taylor, 0, FINE)                                             \
    RUNG(shaft_rk4, shaft_bearing, rk4, 1, FINE)                                                             \
    RUNG(shaft_float32, shaft_bearing, rk4_float32, 1, FINE)                                                 \
    RUNG(shaft_unlocated, shaft_bearing, rk4_unlocated, 1, FINE)                                             \
    RUNG(shaft_exact, shaft_bearing, exact, 1, FINE)                                                         \
    RUNG(shaft_linear_rk4, shaft_bearing_linear, rk4, 1, FINE)                                               \
    RUNG(shaft_linear_float32, shaft_bearing_linear, rk4_float32, 1, FINE)                                   \
    RUNG(shaft_linear_exact, shaft_bearing_linear, exact, 1, FINE)                                           \
    RUNG(shaft_mode_rk4, shaft_bearing_mode, rk4, 1, FINE)                                                   \
    RUNG(shaft_mode_float32, shaft_bearing_mode, rk4_float32, 1, FINE)                                       \
    RUNG(shaft_mode_unlocated, shaft_bearing_mode, rk4_unlocated, 1, FINE)                                   \
    RUNG(shaft_mode_exact, shaft_bearing_mode, exact, 1, FINE)                                               \
    RUNG(rig_stiffness_rk4, hertz_rig, rk4, RIG_STIFFNESS, FINE)                                             \
    RUNG(rig_stiffness_float32, hertz_rig, rk4_float32, RIG_STIFFNESS, FINE)                                 \
    RUNG(rig_stiffness_unlocated, hertz_rig, rk4_unlocated, RIG_STIFFNESS, FINE)                             \
    RUNG(rig_stiffness_taylor, hertz_rig, taylor, RIG_STIFFNESS, FINE)                                       \
    RUNG(rig_linear_stiffness_rk4, hertz_rig_linear, rk4, RIG_STIFFNESS, FINE)                               \
    RUNG(rig_linear_stiffness_float32, hertz_rig_linear, rk4_float32, RIG_STIFFNESS, FINE)                   \
    RUNG(rig_linear_stiffness_taylor, hertz_rig_linear, taylor, RIG_STIFFNESS, FINE)                         \
    RUNG(rig_linear_stiffness_exact, hertz_rig_linear, exact, RIG_STIFFNESS, FINE)                           \
    RUNG(rig_cubic_stiffness_rk4, hertz_rig_cubic, rk4, RIG_STIFFNESS, FINE)                                 \
    RUNG(rig_cubic_stiffness_float32, hertz_rig_cubic, rk4_float32, RIG_STIFFNESS, FINE)                     \
    RUNG(rig_cubic_stiffness_taylor, hertz_rig_cubic, taylor, RIG_STIFFNESS, FINE)                           \
    RUNG(rolling_waviness_rk4, rolling_contact, rk4, ROLLING_WAVINESS, FINE)                                 \
    RUNG(rolling_waviness_float32, rolling_contact, rk4_float32, ROLLING_WAVINESS, FINE)                     \
    RUNG(rolling_waviness_unlocated, rolling_contact, rk4_unlocated, ROLLING_WAVINESS, FINE)                 \
    RUNG(rolling_waviness_taylor, rolling_contact, taylor, ROLLING_WAVINESS, FINE)                           \
    RUNG(rolling_linear_waviness_rk4, rolling_contact_linear, rk4, ROLLING_WAVINESS, FINE)                   \
    RUNG(rolling_linear_waviness_float32, rolling_contact_linear, rk4_float32, ROLLING_WAVINESS, FINE)       \
    RUNG(rolling_linear_waviness_taylor, rolling_contact_linear, taylor, ROLLING_WAVINESS, FINE)             \
    RUNG(rolling_linear_waviness_exact, rolling_contact_linear, exact, ROLLING_WAVINESS, FINE)               \
    RUNG(tip_stiffness_rk4, afm_tip, rk4, TIP_STIFFNESS, FINE)                                               \
    RUNG(tip_stiffness_float32, afm_tip, rk4_float32, TIP_STIFFNESS, FINE)                                   \
    RUNG(tip_stiffness_unlocated, afm_tip, rk4_unlocated, TIP_STIFFNESS, FINE)                               \
    RUNG(tip_stiffness_taylor, afm_tip, taylor, TIP_STIFFNESS, FINE)                                         \
    RUNG(tip_linear_stiffness_rk4, afm_tip_linear, rk4, TIP_STIFFNESS, FINE)                                 \
    RUNG(tip_linear_stiffness_float32, afm_tip_linear, rk4_float32, TIP_STIFFNESS, FINE)                     \
    RUNG(tip_linear_stiffness_taylor, afm_tip_linear, taylor, TIP_STIFFNESS, FINE)                           \
    RUNG(tip_linear_stiffness_exact, afm_tip_linear, exact, TIP_STIFFNESS, FINE)                             \
    RUNG(tip_cubic_stiffness_rk4, afm_tip_cubic, rk4, TIP_STIFFNESS, FINE)                                   \
    RUNG(tip_cubic_stiffness_float32, afm_tip_cubic, rk4_float32, TIP_STIFFNESS, FINE)                       \
    RUNG(tip_cubic_stiffness_taylor, afm_tip_cubic, taylor, TIP_STIFFNESS, FINE)                             \
    RUNG(rig_coarse, hertz_rig, taylor, 0, COARSE)                                                           \
    RUNG(rig_linear_coarse, hertz_rig_linear, taylor, 0, COARSE)                                             \
    RUNG(rig_cubic_coarse, hertz_rig_cubic, taylor, 0, COARSE)                                               \
    RUNG(rig_averaged_coarse, hertz_rig_averaged, taylor, 0, COARSE)                                         \
    RUNG(rolling_coarse, rolling_contact, taylor, 0, COARSE)                                                 \
    RUNG(rolling_linear_coarse, rolling_contact_linear, taylor, 0, COARSE)                                   \
    RUNG(tip_coarse, afm_tip, taylor, 0, COARSE)                                                             \
    RUNG(tip_linear_coarse, afm_tip_linear, taylor, 0, COARSE)                                               \
    RUNG(tip_cubic_coarse, afm_tip_cubic, taylor, 0, COARSE)                                                 \
    RUNG(tip_averaged_coarse, afm_tip_averaged, taylor, 0, COARSE)                                           \
    RUNG(rig_stiffness_coarse, hertz_rig, taylor, RIG_STIFFNESS, COARSE)                                     \
    RUNG(rig_linear_stiffness_coarse, hertz_rig_linear, taylor, RIG_STIFFNESS, COARSE)                       \
    RUNG(rig_cubic_stiffness_coarse, hertz_rig_cubic, taylor, RIG_STIFFNESS, COARSE)                         \
    RUNG(rolling_waviness_coarse, rolling_contact, taylor, ROLLING_WAVINESS, COARSE)                         \
    RUNG(rolling_linear_waviness_coarse, rolling_contact_linear, taylor, ROLLING_WAVINESS, COARSE)           \
    RUNG(tip_stiffness_coarse, afm_tip, taylor, TIP_STIFFNESS, COARSE)                                       \
    RUNG(tip_linear_stiffness_coarse, afm_tip_linear, taylor, TIP_STIFFNESS, COARSE)                         \
    RUNG(tip_cubic_stiffness_coarse, afm_tip_cubic, taylor, TIP_STIFFNESS, COARSE)                           \
    RUNG(rig_short, hertz_rig, taylor, 0, SHORT)                                                             \
    RUNG(rig_linear_short, hertz_rig_linear, taylor, 0, SHORT)                                               \
    RUNG(rig_cubic_short, hertz_rig_cubic, taylor, 0, SHORT)                                                 \
    RUNG(rig_averaged_short, hertz_rig_averaged, taylor, 0, SHORT)                                           \
    RUNG(rolling_short, rolling_contact, taylor, 0, SHORT)                                                   \
    RUNG(rolling_linear_short, rolling_contact_linear, taylor, 0, SHORT)                                     \
    RUNG(tip_short, afm_tip, taylor, 0, SHORT_TIP)                                                           \
    RUNG(tip_linear_short, afm_tip_linear, taylor, 0, SHORT_TIP)                                             \
    RUNG(tip_cubic_short, afm_tip_cubic, taylor, 0, SHORT_TIP)                                               \
    RUNG(tip_averaged_short, afm_tip_averaged, taylor, 0, SHORT_TIP)                                         \
    RUNG(rig_stiffness_short, hertz_rig, taylor, RIG_STIFFNESS, SHORT)                                       \
    RUNG(rolling_waviness_short, rolling_contact, taylor, ROLLING_WAVINESS, SHORT)                           \
    RUNG(tip_stiffness_short, afm_tip, taylor, TIP_STIFFNESS, SHORT_TIP)                                     \
    RUNG(rig_cubic_stiffness_short, hertz_rig_cubic, taylor, RIG_STIFFNESS, SHORT)                           \
    RUNG(tip_cubic_stiffness_short, afm_tip_cubic, taylor, TIP_STIFFNESS, SHORT_TIP)                         \
    RUNG(lever_modal, afm_lever, modal, 0, FINE)                                                             \
    RUNG(lever_z_modal, afm_lever, modal, LEVER_Z, FINE)                                                     \
    RUNG(lever_modes_modal, afm_lever, modal, 0, MODES)                                                      \
    RUNG(lever_near_modal, afm_lever, modal, 0, NEAR)                                                        \
    RUNG(lever_near_modes_modal, afm_lever, modal, 0, NEAR_MODES)                                            \
    RUNG(rig_noise_rk4, hertz_rig, rk4, 0, NOISY)                                                            \
    RUNG(rig_noise_held_rk4, hertz_rig, rk4, 0, HELD)                                                        \
    RUNG(rig_switch_rk4, hertz_rig, rk4, 0, SWITCHING)                                                       \
    RUNG(rig_forces_switch_rk4, hertz_rig, rk4, 0, SWITCHING_TWO)                                            \
    RUNG(rig_switch_unlocated, hertz_rig, rk4_unlocated, 0, SWITCHING)                                       \
    RUNG(rig_forces_switch_unlocated, hertz_rig, rk4_unlocated, 0, SWITCHING_TWO)
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
RUNGS(FUNCTIONS)

#define ENTRY(name, model, method, input, period) {#name, setup_##name, once_##name},
const struct work_piece work_rung[WORK_RUNGS] = {RUNGS(ENTRY)};

#define KIND(name, model, method, input, period) {&model, &method, input, period},
const struct work_kind work_kind[WORK_RUNGS] = {RUNGS(KIND)};

const char *work_rungs_setup(int i)
{
    switches = false;
    work_rung[i].setup();
    return good ? 0 : work_rung[i].name;
}

int work_rungs_ticks(int i)
{
    return TICKS(work_kind[i].period);
}

int work_rungs_good(void)
{
    return good && (pl.counts.switches > 0) == switches;
}

double work_rungs_series(void)
{
    return (double)taylor_scratch()->count.time;
}
