/* batch_taylor_avx2.c - batch_taylor.c, its pieces, series and roots for AVX2; see batch_taylor.h. */
#ifdef BATCH_AVX2
#include "host_sim/batch/batch_taylor_avx2.h"

#define batch_taylor_plain   batch_taylor_avx2
#define batch_series_root    batch_series_root_avx2
#define batch_series_regular batch_series_regular_avx2
#define batch_series_flight  batch_series_flight_avx2
#define batch_series_contact batch_series_contact_avx2
#define batch_piece_end      batch_piece_end_avx2
#define batch_piece_read     batch_piece_read_avx2
#include "host_sim/batch/batch_piece.c"
#include "host_sim/batch/batch_root.c"
#include "host_sim/batch/batch_series.c"
#include "host_sim/batch/batch_taylor.c"
#endif
