/* demo_picture.h - the record as one picture. */
#ifndef HOST_SIM_DEMO_PICTURE_H
#define HOST_SIM_DEMO_PICTURE_H

#include "host_sim/demo/demo_record.h"

/* False: why says what went wrong. */
bool demo_write_picture(const struct demo_record *r, const char *path, char *why);

#endif
