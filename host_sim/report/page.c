/* page.c - see page.h. The assembler takes the files in as they are: no step of the build turns them into C.
 *
 * Paths are those of a build in the top folder; the Makefile knows that this file depends on them. */
#include "host_sim/report/page.h"

#include <string.h>

#define EMBED(name, file)                                                                                    \
    __asm__(".pushsection .rodata\n"                                                                         \
            "page_" name "_begin:\n"                                                                         \
            ".incbin \"host_sim/report/page/" file "\"\n"                                                    \
            "page_" name "_end:\n"                                                                           \
            ".byte 0\n"                                                                                      \
            ".globl page_" name "_begin, page_" name "_end\n"                                                \
            ".popsection\n")

EMBED("html", "scope.html");
EMBED("css", "scope.css");
EMBED("js", "scope.js");
EMBED("draw", "draw.js");
EMBED("keys", "keys.js");
EMBED("view", "view.html");
EMBED("view_js", "view.js");
EMBED("control", "control.js");
EMBED("report", "report.js");
EMBED("report_css", "report.css");

extern const char page_html_begin[], page_html_end[], page_css_begin[], page_css_end[], page_js_begin[],
    page_js_end[], page_draw_begin[], page_draw_end[], page_control_begin[], page_control_end[],
    page_keys_begin[], page_keys_end[], page_view_begin[], page_view_end[], page_view_js_begin[],
    page_view_js_end[], page_report_begin[], page_report_end[], page_report_css_begin[],
    page_report_css_end[];

const struct page_file page_file[PAGE_FILES] = {
    [PAGE_HTML] = {"/", "text/html; charset=utf-8", page_html_begin, page_html_end},
    [PAGE_CSS] = {"/scope.css", "text/css; charset=utf-8", page_css_begin, page_css_end},
    [PAGE_JS] = {"/scope.js", "text/javascript; charset=utf-8", page_js_begin, page_js_end},
    [PAGE_DRAW] = {"/draw.js", "text/javascript; charset=utf-8", page_draw_begin, page_draw_end},
    [PAGE_KEYS] = {"/keys.js", "text/javascript; charset=utf-8", page_keys_begin, page_keys_end},
    [PAGE_VIEW] = {"/view", "text/html; charset=utf-8", page_view_begin, page_view_end},
    [PAGE_VIEW_JS] = {"/view.js", "text/javascript; charset=utf-8", page_view_js_begin, page_view_js_end},
    [PAGE_CONTROL] = {"/control.js", "text/javascript; charset=utf-8", page_control_begin, page_control_end},
    [PAGE_REPORT] = {"/report.js", "text/javascript; charset=utf-8", page_report_begin, page_report_end},
    [PAGE_REPORT_CSS] = {"/report.css", "text/css; charset=utf-8", page_report_css_begin,
                         page_report_css_end},
};

const struct page_file *page_find(const char *path, bool logs)
{
    if (logs && !strcmp(path, "/"))
        return &page_file[PAGE_VIEW];
    for (int i = 0; i < PAGE_SERVED; i++)
        if (!strcmp(path, page_file[i].path))
            return &page_file[i];
    return NULL;
}
