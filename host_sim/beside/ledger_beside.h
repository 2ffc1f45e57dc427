/* ledger_beside.h - the books of several plants of one model side by side, to the bits of ledger.h. */
#ifndef HOST_SIM_LEDGER_BESIDE_H
#define HOST_SIM_LEDGER_BESIDE_H

#include "firmware/plant/ledger.h"

/* The function for plants of which no input but these sounds, as by rk4_beside.h. */
ledger_beside_function *ledger_bind_beside(const struct model *m, unsigned active);
ledger_beside_function *ledger_bind_beside_plain(const struct model *m, unsigned active);

#endif
