/* decode_signals.h - the signals of a decoded log by name, and the common parts of commands that read one. */
#ifndef HOST_SIM_DECODE_SIGNALS_H
#define HOST_SIM_DECODE_SIGNALS_H

#include <stdio.h>
#include "host_sim/cli/options.h"
#include "host_sim/listen/decode_rows.h"
#include "host_sim/scene/scene.h"

enum { DECODE_NAME = 64 };

/* For the help. */
#define DECODE_LOG_WORDS                                                                                     \
    "LOG is a log of contactplant run --log, of contactplant test --log, or of candump -L. Lines that no\n"  \
    "plant sends are passed over and counted on stderr. A log of another plant is refused.\n"

/* --interface of the commands that read one; and --model and --interface of those that read several. */
extern const struct option decode_log_options[], decode_logs_options[];

/* That of log i, or the one given for all; NULL: none. */
const char *decode_interface(const struct options *o, int i);

/* Signal i of a row: outputs that the bus carries, then command_INPUT. */
int decode_signals(const struct model *m);
const struct signal *decode_signal(const struct model *m, int i);
void decode_name(const struct model *m, int i, char text[DECODE_NAME]);

/* A row as CSV, and the line above the first one. */
void decode_put_header(FILE *f, const struct model *m);
void decode_put_row(FILE *f, const struct model *m, const struct decode_row *r);

/* The failure of a log without rows. */
int decode_no_rows(const struct options *o, const char *path);

#endif
