/* paragraph.h - sentences for a terminal, broken between words. */
#ifndef HOST_SIM_PARAGRAPH_H
#define HOST_SIM_PARAGRAPH_H

#include <stdio.h>

/* Prints `head`, then the text in lines of at most 100 columns that begin `indent` columns in; at most
 * 4095 bytes of text. */
void paragraph_print(FILE *out, int indent, const char *head, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#endif
