/* choose_search.h - from the truth over cheap tests and runs to the choice. */
#ifndef HOST_SIM_CHOOSE_SEARCH_H
#define HOST_SIM_CHOOSE_SEARCH_H

#include "host_sim/choose/choose.h"

/* Fills the certificate from scene, sweep and machine. NULL, or why there can be none (STATUS_ESCAPED with
 * *escaped). After two seconds `progress` (or NULL) is told what is being done. */
const char *choose_search(struct choose_certificate *c, FILE *progress, bool *escaped);

#endif
