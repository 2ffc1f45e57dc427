/* roff.h - a page of the docs as a manual page of section 7. */
#ifndef HOST_SIM_ROFF_H
#define HOST_SIM_ROFF_H

/* Prints the text of a page, in the part of Markdown that the docs use: headings, paragraphs, lists, rows of
 * tables, code. `name` is the manual page's, `version` the program's. */
void roff_print(const char *name, const char *version, const char *text);

#endif
