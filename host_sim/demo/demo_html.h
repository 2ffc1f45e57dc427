/* demo_html.h - the record as a page. */
#ifndef HOST_SIM_DEMO_HTML_H
#define HOST_SIM_DEMO_HTML_H

#include "host_sim/demo/demo_script.h"

/* The report --report. NULL, or what went wrong. */
const char *demo_write_html(const struct demo *d, const char *path, int argc, char **argv);

#endif
