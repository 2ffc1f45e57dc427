/* library_bus.h - frames of the library and of the hal. */
#ifndef HOST_SIM_LIBRARY_BUS_H
#define HOST_SIM_LIBRARY_BUS_H

#include "host_sim/library/library.h"

bool library_frame_in(const struct contactplant_frame *from, struct frame *to);
void library_frame_out(const struct frame *from, struct contactplant_frame *to);

#endif
