/* rolling_contact.h - a body that rolls or slides over a wavy surface on a preloaded Hertzian contact.
 *
 * Source: Nayak 1972, eqs 21 to 26.
 *
 *   m z'' + c z' + k (z + w)_+^{3/2} = N + F_force
 *
 * z is the position of the mass from first touch on the mean surface, positive into the contact. w is the
 * height of the waviness that passes under the contact. The damper c acts between mass and ground; in
 * models/hertz_rig.h it acts between mass and base. Units as there (zs, N, 1/nu). With zeta = c/(2 m nu), y =
 * z/zs, eta = y + w/zs:
 *
 *   y'' = (2/3) (1 + u_force - eta_+^{3/2}) - 2 zeta y'
 *
 * Nayak's eta'' + 2 zeta eta' + (2/3) (eta_+^{3/2} - 1) = f(tau) is this equation with f = w'' + 2 zeta w'
 * for a waviness, or with u_force = (3/2) f for a broadband f. State: y, y'; the paper's state is eta, eta'.
 * Contact is lost for eta < 0; at rest y = 1.
 *
 * rolling_contact_linear: y'' = (2/3) u_force - (y - 1 + w) - 2 zeta y', no contact loss. */
#ifndef MODELS_ROLLING_CONTACT_H
#define MODELS_ROLLING_CONTACT_H

#include "models/hertz_contact.h"
#include "models/lanes.h"
#include "models/model.h"

extern const struct model rolling_contact, rolling_contact_linear;

/* Inputs, the paper's parameters and prepared numbers; the SI parameters are those of models/hertz_rig.h. */
enum { ROLLING_FORCE, ROLLING_WAVINESS, ROLLING_INPUTS };
enum { ROLLING_PAPER_ZETA, ROLLING_PAPER_XI0, ROLLING_PAPER_OMEGA, ROLLING_PAPER_PHI, ROLLING_PAPER };
enum { ROLLING_P_TWO_ZETA };

#define real       double
#define number     double
#define REAL(name) name
#include "models/rolling_contact_text.h"
#undef real
#undef number
#undef REAL

#endif
