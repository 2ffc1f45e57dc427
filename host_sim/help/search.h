/* search.h - words in the pages, with page and heading. */
#ifndef HOST_SIM_SEARCH_H
#define HOST_SIM_SEARCH_H

#include "host_sim/help/pages.h"

/* Prints each line of a page that has all words, whatever their capitals, as `PAGE: HEADING: LINE`; two lines
 * as one where a sentence that has them goes on. How many; -1 where the page cannot be read. */
int search_page(const struct pages *p, int page, const char *const *word, int n_words);

/* Prints each row of a page's tables, `| message | advice |`, whose message stands in the text, or has all
 * words of it; how many. */
int search_messages(const struct pages *p, int page, const char *text, const char *const *word, int n_words);

#endif
