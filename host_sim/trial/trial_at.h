/* trial_at.h - the `at` lines of a test file: what happens to the plant, in the words of contactplant send.
 */
#ifndef HOST_SIM_TRIAL_AT_H
#define HOST_SIM_TRIAL_AT_H

#include "host_sim/trial/trial_reader.h"

/* `at TIME VERB WORDS`, without the `at`: arm INPUT FIELD=VALUE.., fire INPUT, set NAME=VALUE.., stream INPUT
 * VALUE, faults LIST. */
bool trial_read_at(struct trial_reader *r, struct word rest);

/* All lines of the case are known: gives each fire what was armed for it. */
bool trial_bind_fires(struct trial_reader *r, struct trial_case *c);

/* The instant of a fire, to a 256th of a tick as FIRE names it. */
struct instant trial_instant(const struct trial_act *a, double tick_s);

#endif
