/* dissector.h - the dissector of a scene for Wireshark, in Lua: the messages of a plant on CAN, by name and
 * unit, with their checks, and the packets of cannelloni. */
#ifndef HOST_SIM_DISSECTOR_H
#define HOST_SIM_DISSECTOR_H

#include <stdio.h>
#include "host_sim/database/bus_signals.h"

/* Prints a table of the scene's messages, then dissector.lua, which works by it. The caller looks at
 * ferror(out). */
void dissector_print(FILE *out, const struct bus_scene *s);

#endif
