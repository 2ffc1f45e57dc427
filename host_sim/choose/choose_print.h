/* choose_print.h - the certificate in sentences, and the chosen scene as a file. */
#ifndef HOST_SIM_CHOOSE_PRINT_H
#define HOST_SIM_CHOOSE_PRINT_H

#include "host_sim/choose/choose.h"

void choose_print(FILE *out, const struct choose_certificate *c);
/* The chosen scene as a file to run. */
void choose_write(FILE *out, const struct choose_certificate *c);

#endif
