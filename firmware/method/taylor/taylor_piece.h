/* taylor_piece.h - one expansion of method taylor: its kind, its reach, its end and the state inside it.
 *
 * A piece is a series in time, for flight, for contact that is deep enough and for a plant without contact.
 * Or it is a series in s with eta = y^2, dt = 2 y ds, for contact about to be lost or just made. It holds
 * over any number of steps while the inputs run on. */
#ifndef FIRMWARE_TAYLOR_PIECE_H
#define FIRMWARE_TAYLOR_PIECE_H

#include "firmware/method/taylor/taylor.h"
#include "firmware/method/taylor/taylor_load.h"

/* Begins a piece from (eta, rate) and the regime `closed` under a load, `left` before the segment's end.
 * `short_lived`: it will not be read beyond that. False when the motion escaped or a number is not finite. */
bool taylor_begin(struct taylor *t, const struct taylor_load *load, double left, bool short_lived);

/* eta and rate at `now`, now <= end. */
void taylor_read(struct taylor *t);

/* eta, rate and root at the end; the regime turns when that is an event. The piece is over. */
void taylor_finish(struct taylor *t);

#endif
