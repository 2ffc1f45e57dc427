/* choose_json.h - the certificate as JSON (RFC 8259); a number that is not finite or not known is null. */
#ifndef HOST_SIM_CHOOSE_JSON_H
#define HOST_SIM_CHOOSE_JSON_H

#include "host_sim/choose/choose.h"

void choose_json(FILE *out, const struct choose_certificate *c);

#endif
