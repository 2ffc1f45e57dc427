/* choose_html.h - the report of contactplant choose. */
#ifndef HOST_SIM_CHOOSE_HTML_H
#define HOST_SIM_CHOOSE_HTML_H

#include "host_sim/choose/choose.h"

/* Writes the certificate as a page. NULL, or why it cannot be written. */
const char *choose_html(const struct choose_certificate *c, const char *path, int argc, char **argv);

#endif
