/* instances.h - the one table of the models that rk4 and the energy ledger compile in.
 *
 * A row makes a copy of rk4's step, step_NAME, and one of the ledger's piece, piece_NAME, with the model's
 * functions inlined. A model without a row runs through the pointers of struct model: to the same bits, but
 * more slowly. Columns:
 *
 *   name       of the row
 *   for        the models that begin with this row, an expression in `m`; NOBODY: only other rows lead here
 *   jumps      JUMP(row, when) for each other row that does the step instead. `when` is an expression in
 *              `active`, whose bit i says that input i sounds; the first that holds counts. STAY: none
 *   states, contacts, n_inputs   as in struct model; fewer inputs where the last ones never reach the row
 *   rhs, gap, flow   as in struct model, for these inputs; static inline, in a header of the model
 *   lanes      flow for TICK_LANES ticks side by side (models/flows.h); NULL or left out: one tick at a time
 *
 * INSTANCES_BESIDE has the models whose plants go side by side, several in the lanes of a vector. `for` may
 * speak of `active`, and `numbers` says how many prepared numbers rhs, gap and flow read. Their names end in
 * _beside (models/flows.h).
 *
 * A file that compiles the table in defines JUMP and what a row becomes, and writes INSTANCES(that). */
#ifndef FIRMWARE_INSTANCES_H
#define FIRMWARE_INSTANCES_H

#include "models/afm_tip.h"
#include "models/flows.h"
#include "models/hertz_rig.h"
#include "models/reduced/polynomial.h"
#include "models/reduced/shaft_mode.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"

/* Rows of a model outside this tree: -DINSTANCES_EXTRA='"file.h"', a file that defines INSTANCES_MORE(X). */
#ifdef INSTANCES_EXTRA
#include INSTANCES_EXTRA
#else
#define INSTANCES_MORE(X)
#endif

#define NOBODY                           false
#define FLOW_AND_LANES(flow, lanes, ...) flow, lanes /* takes the columns from flow on, NULL, NULL */
#define STAY
#if TICK_LANES > 1
#define FLOW_LANES(flow) flow##_lanes
#else
#define FLOW_LANES(flow) NULL
#endif

/* Reduced models of one degree of freedom share rows, by degree of their force and number of inputs. */
#define SHAPED(degree, inputs) (polynomial_degree(m) == (degree) && m->n_inputs == (inputs))

/* clang-format off */
#define INSTANCES(X) \
    X(rig, m == &hertz_rig, JUMP(rig_moved, active & (1u << RIG_BASE | 1u << RIG_STIFFNESS)), \
      2, 1, RIG_BASE, hertz_rig_rhs_forced, hertz_rig_gap_forced, hertz_rig_flow_forced, FLOW_LANES(hertz_rig_flow_forced)) \
    X(rig_moved, NOBODY, STAY, 2, 1, RIG_INPUTS, hertz_rig_rhs, hertz_rig_gap, hertz_rig_flow, FLOW_LANES(hertz_rig_flow)) \
    X(rolling_contact, m == &rolling_contact, STAY, 2, 1, ROLLING_INPUTS, \
      rolling_contact_rhs, rolling_contact_gap, rolling_contact_flow, FLOW_LANES(rolling_contact_flow)) \
    X(afm_tip, m == &afm_tip, STAY, 2, 1, TIP_INPUTS, afm_tip_rhs, afm_tip_gap, afm_tip_flow, FLOW_LANES(afm_tip_flow)) \
    X(shaft_bearing, m == &shaft_bearing, STAY, 6, SHAFT_CONTACTS, SHAFT_INPUTS, \
      shaft_bearing_rhs, shaft_bearing_gap, shaft_bearing_flow, FLOW_LANES(shaft_bearing_flow)) \
    X(shaft_linear, m == &shaft_bearing_linear, STAY, 6, 0, SHAFT_INPUTS, \
      shaft_bearing_rhs_open, model_no_gap, shaft_bearing_flow_open, FLOW_LANES(shaft_bearing_flow_open)) \
    X(shaft_mode, m == &shaft_bearing_mode, STAY, 2, SHAFT_CONTACTS, SHAFT_INPUTS, \
      shaft_mode_rhs, shaft_mode_gap, shaft_mode_flow, FLOW_LANES(shaft_mode_flow)) \
    X(linear_4, SHAPED(1, 4), \
      JUMP(linear_force, active <= 1u) JUMP(linear_forces, active <= 3u) JUMP(linear_last, !(active & 4u)), \
      2, 0, 4, polynomial_rhs_linear_4, model_no_gap, polynomial_flow_linear_4, FLOW_LANES(polynomial_flow_linear_4)) \
    X(linear_2, SHAPED(1, 2), JUMP(linear_force, active <= 1u), \
      2, 0, 2, polynomial_rhs_linear_2, model_no_gap, polynomial_flow_linear_2, FLOW_LANES(polynomial_flow_linear_2)) \
    X(linear_force, SHAPED(1, 1), STAY, \
      2, 0, 1, polynomial_rhs_linear_force, model_no_gap, polynomial_flow_linear_force, FLOW_LANES(polynomial_flow_linear_force)) \
    X(linear_forces, NOBODY, STAY, \
      2, 0, 2, polynomial_rhs_linear_forces, model_no_gap, polynomial_flow_linear_forces, FLOW_LANES(polynomial_flow_linear_forces)) \
    X(linear_last, NOBODY, STAY, \
      2, 0, 4, polynomial_rhs_linear_last, model_no_gap, polynomial_flow_linear_last, FLOW_LANES(polynomial_flow_linear_last)) \
    X(cubic_4, SHAPED(3, 4), \
      JUMP(cubic_force, active <= 1u) JUMP(cubic_forces, active <= 3u) JUMP(cubic_last, !(active & 4u)), \
      2, 0, 4, polynomial_rhs_cubic_4, model_no_gap, polynomial_flow_cubic_4, FLOW_LANES(polynomial_flow_cubic_4)) \
    X(cubic_2, SHAPED(3, 2), JUMP(cubic_force, active <= 1u), \
      2, 0, 2, polynomial_rhs_cubic_2, model_no_gap, polynomial_flow_cubic_2, FLOW_LANES(polynomial_flow_cubic_2)) \
    X(cubic_force, SHAPED(3, 1), STAY, \
      2, 0, 1, polynomial_rhs_cubic_force, model_no_gap, polynomial_flow_cubic_force, FLOW_LANES(polynomial_flow_cubic_force)) \
    X(cubic_forces, NOBODY, STAY, \
      2, 0, 2, polynomial_rhs_cubic_forces, model_no_gap, polynomial_flow_cubic_forces, FLOW_LANES(polynomial_flow_cubic_forces)) \
    X(cubic_last, NOBODY, STAY, \
      2, 0, 4, polynomial_rhs_cubic_last, model_no_gap, polynomial_flow_cubic_last, FLOW_LANES(polynomial_flow_cubic_last)) \
    INSTANCES_MORE(X)

#define INSTANCES_BESIDE(X) \
    X(rig, m == &hertz_rig && !(active & (1u << RIG_BASE | 1u << RIG_STIFFNESS)), \
      1, 2, 1, RIG_BASE, hertz_rig_rhs_forced, hertz_rig_gap_forced, hertz_rig_flow_forced) \
    X(rig_moved, m == &hertz_rig, 1, 2, 1, RIG_INPUTS, hertz_rig_rhs, hertz_rig_gap, hertz_rig_flow) \
    X(rolling_contact, m == &rolling_contact, \
      1, 2, 1, ROLLING_INPUTS, rolling_contact_rhs, rolling_contact_gap, rolling_contact_flow) \
    X(afm_tip, m == &afm_tip, 2, 2, 1, TIP_INPUTS, afm_tip_rhs, afm_tip_gap, afm_tip_flow)
/* clang-format on */

#endif
