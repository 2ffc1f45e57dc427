/* xml.h - the one writer of XML 1.0 and SVG text. Every text is UTF-8 when it is written
 * (host_sim/out/utf8.h); characters that XML does not allow, controls for example, are U+FFFD. */
#ifndef HOST_SIM_XML_H
#define HOST_SIM_XML_H

#include <stdio.h>

#define XML_MARK "<?contactplant %s?>\n"                    /* for readers of this program */
#define XML_HEAD "<?xml version='1.0' encoding='UTF-8'?>\n" /* first in a pattern */

/* Writes a pattern. In it ' stands for ", and these for an argument:
 *   %s text, escaped for an element or an attribute    %i int
 *   %r text as it is                                   %u unsigned
 *   %n double, as many digits as read back the same    %t double, 3 decimals (seconds)
 *   %p double, 1 decimal (a place in a picture) */
void xml_put(FILE *file, const char *pattern, ...);

/* Takes the escapes of %s back, in place. */
void xml_read(char *text);

#endif
