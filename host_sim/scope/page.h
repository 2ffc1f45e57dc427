/* page.h - the files of the page, which are part of the program. */
#ifndef HOST_SIM_PAGE_H
#define HOST_SIM_PAGE_H

#include <stddef.h>

struct page_file {
    const char *path, *type; /* below the server's root; of the content */
    const char *begin, *end;
};

enum { PAGE_FILES = 3 };
extern const struct page_file page_file[PAGE_FILES];

/* The file at this path, or NULL. */
const struct page_file *page_find(const char *path);

#endif
