/* log_record.h - a record from a log of a plant, or of a rig that speaks its protocol.
 *
 * It is the longest part of the log in which the drive of one input is known and does not change: a tone of
 * DRIVE_ECHO, samples of STREAM, or both. Frames that are missing are gaps. Values beyond the range of the
 * bus are left out and counted. The motion is the first of the outputs that the bus carries. */
#ifndef HOST_SIM_FIT_LOG_RECORD_H
#define HOST_SIM_FIT_LOG_RECORD_H

#include "host_sim/fit/data/record.h"

/* Adds the record of the log `path` of this plant; the options name its interface and identifiers. *crc goes
 * on. 0, or the exit status after a line. */
int log_record_read(const struct options *o, const char *path, uint32_t *crc, struct records *all);

#endif
