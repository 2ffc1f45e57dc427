/* ledger_beside_avx2.h - ledger_beside.h for AVX2, with equal bits; there with BESIDE_AVX2 only. */
#ifndef HOST_SIM_LEDGER_BESIDE_AVX2_H
#define HOST_SIM_LEDGER_BESIDE_AVX2_H

#include "host_sim/beside/ledger_beside.h"

ledger_beside_function *ledger_bind_beside_avx2(const struct model *m, unsigned active);

#endif
