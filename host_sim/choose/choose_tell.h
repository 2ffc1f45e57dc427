/* choose_tell.h - texts of a certificate, the progress that a long search shows, and warnings of a paper's
 * range. */
#ifndef HOST_SIM_CHOOSE_TELL_H
#define HOST_SIM_CHOOSE_TELL_H

#include "host_sim/choose/choose.h"
#include "host_sim/choose/choose_steps.h"

/* Writes text into a field of the certificate, cut at its size. */
void choose_say(char text[CHOOSE_TEXT], const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Prints a line of progress, once the search has taken two seconds. */
void choose_tell(const struct search *o, const char *what, const struct scene *s);

/* The facts of scenes_warning about the scene or, with a sweep, any of its holds, each once. Returns how
 * many. */
int choose_warnings(const struct choose_certificate *c, const char *warning[CHOOSE_WARNINGS]);

#endif
