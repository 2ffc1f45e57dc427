/* batch_piece.h - one piece of four trajectories of batch_taylor: how far its series goes, what ends it,
 * and readings inside it. */
#ifndef HOST_SIM_BATCH_PIECE_H
#define HOST_SIM_BATCH_PIECE_H

#include "host_sim/batch/batch_series.h"

enum batch_kind { BATCH_FLIGHT, BATCH_SHALLOW, BATCH_DEEP, BATCH_REGULAR, BATCH_KINDS };

/* One piece of four trajectories. */
struct batch_piece {
    const int *at;
    int n; /* lanes from here on only repeat the first */
    enum batch_kind kind;
    quad eta, rate; /* at the beginning; then at the end */
    quad y;         /* sqrt(eta) of a piece in s; -1 at the end of another */
    quad begin;     /* since the last sample */
    quad log2_tol, shallow;
    quad x, duration; /* length of the whole piece: s or time; time */
    mask event, residual, astray;
};

/* How far the piece goes, and what it ends with; its series are those of its kind. */
void batch_piece_end(struct batch_series *s, double tol, struct batch_piece *c);

/* eta and its rate `more` after the piece's beginning, where `lanes`. */
struct batch_reading {
    quad eta, rate;
    mask residual;
};

void batch_piece_read(const struct batch_series *s, const struct batch_piece *c, quad more, mask lanes,
                      struct batch_reading *r);

#endif
