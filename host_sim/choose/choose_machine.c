/* choose_machine.c - the methods and machines that contactplant choose ranks, and the names of what is
 * counted there. */
#include "host_sim/choose/choose_cost.h"

const struct method *const choose_method[CHOOSE_METHODS] = {&rk4,   &rk4_float32,   &taylor,
                                                            &exact, &rk4_unlocated, &modal};

/* Nanoseconds an instruction. Host: 1.25 instructions a cycle at 2 GHz, the slow end of desktops. Boards:
 * the latencies one after the other, docs/why/accuracy.md: 480 and 500 MHz; the M4F's 1.4 cycles at 168
 * MHz, docs/guide/porting.md. */
const struct choose_machine choose_machine[CHOOSE_MACHINES] = {
    {"host", {0.4, 0.4, 0.4, 0.4, 0.4, 0.4}},
    {"mps2-an500", {2.8 / 0.48, 2.4 / 0.48, 3.6 / 0.48, 2.6 / 0.48, 2.8 / 0.48, 2.8 / 0.48}},
    {"mps2-an386", {1.4 / 0.168, 1.4 / 0.168, 1.4 / 0.168, 1.4 / 0.168, 1.4 / 0.168, 1.4 / 0.168}},
    {"xlnx-zcu102-r5", {4.3 / 0.5, 3.0 / 0.5, 5.5 / 0.5, 3.7 / 0.5, 4.3 / 0.5, 4.3 / 0.5}},
    {"riscv-virt", {0.0}},
};

bool choose_takes(const struct model *m, int method)
{
    return (choose_method[method] == &modal) == (m->modal_form != NULL);
}

const char *const choose_extra_name[EXTRAS] = {
    "rig_noise_rk4",         "rig_noise_held_rk4",   "rig_switch_rk4",
    "rig_forces_switch_rk4", "rig_switch_unlocated", "rig_forces_switch_unlocated",
    "lever_modes_modal",     "lever_near_modal",     "lever_near_modes_modal"};
const char *const choose_piece_name[CHOOSE_PIECES] = {"rk4_tick",           "rk4_step",       "float32_tick",
                                                      "taylor_smooth_tick", "exact_step",     "drive",
                                                      "taylor_time",        "taylor_regular", "exact_event"};
