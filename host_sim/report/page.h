/* page.h - the files of the page and of the reports, which are part of the program. */
#ifndef HOST_SIM_PAGE_H
#define HOST_SIM_PAGE_H

#include <stdbool.h>
#include <stddef.h>

struct page_file {
    const char *path, *type; /* below the server's root; of the content */
    const char *begin, *end;
};

/* Those before PAGE_SERVED are served, PAGE_CONTROL with
 * --control only; the others are for reports (host_sim/report). */
enum {
    PAGE_HTML,
    PAGE_CSS,
    PAGE_JS,
    PAGE_DRAW,
    PAGE_KEYS,
    PAGE_VIEW,
    PAGE_VIEW_JS,
    PAGE_CONTROL,
    PAGE_SERVED,
    PAGE_REPORT = PAGE_SERVED,
    PAGE_REPORT_CSS,
    PAGE_FILES
};
extern const struct page_file page_file[PAGE_FILES];

/* The served file at this path, or NULL. With `logs` the page at / is that of recorded logs. */
const struct page_file *page_find(const char *path, bool logs);

#endif
