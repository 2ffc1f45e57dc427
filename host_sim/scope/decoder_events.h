/* decoder_events.h - the events of a plant that are not lists, and what stands before the lists. */
#ifndef HOST_SIM_DECODER_EVENTS_H
#define HOST_SIM_DECODER_EVENTS_H

#include "host_sim/scope/decoder.h"

/* Takes note of what is known of the plant's identity now; true for news. */
bool decoder_note_identity(struct decoder *d);

/* The plant's tables: one element of hello. */
void decoder_put_hello(const struct decoder *d, struct json *j);

/* The event status. */
void decoder_put_status(const struct decoder *d, struct json *j);

/* The event values: all that is known, or what differs from `sent`, which then has it. */
void decoder_put_values(const struct decoder *d, struct json *j, struct decoder_sent *sent);

/* Stands in an event between the plant's number and its list. */
void decoder_put_head(const struct decoder *d, enum event_list list, struct json *j);

double decoder_time(const struct decoder *d);

#endif
