/* ledger_beside_avx2.c - ledger_beside.c for AVX2. */
#ifdef BESIDE_AVX2
#define BESIDE_COPY
#define ledger_bind_beside_plain ledger_bind_beside_avx2
#include "host_sim/beside/ledger_beside.c"
#endif
