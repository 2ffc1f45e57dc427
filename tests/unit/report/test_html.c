/* test_html.c - a report's data against JSON written by hand; text that would end a script stays inside its
 * string. */
#include "host_sim/cli/files.h"
#include "host_sim/report/html.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The data of a small report with every kind of section; to be freed. */
static char *data_of_report(char *page, size_t size)
{
    char path[] = "/tmp/contactplant_html_XXXXXX", sweep[] = "sweep", word[] = "a b", quoted[] = "it's";
    char *words[] = {sweep, word, quoted};
    struct html h;
    const double x[] = {0.0, 0.1}, y[] = {1e-300, (double)NAN}, high[] = {2.0, 3.0};
    char why_not[FILES_REASON];
    int fd = mkstemp(path);
    files_begin();
    if (fd < 0 || close(fd) || !files_take("report", path, false, why_not) ||
        html_begin(&h, path, "</script>\x01\xFF\xC3\xA4\"", "\\&", 3, words))
        return NULL;
    html_words(&h, "%d words", 2);
    html_table(&h, "t", "a,b");
    html_row(&h, false), html_cell(&h, "1"), html_cell(&h, "%s", "<b>");
    html_row(&h, true), html_cell(&h, "2");
    html_table(&h, "empty", "a");
    html_chart(&h, "c", "m", "time", "s");
    html_line(&h, HTML_STEPS, "l", 2, x, y);
    html_band(&h, "b", 2, x, 0.2, 0.5, x, high);
    html_open(&h, 2, 0.0, 1.0, x);
    html_span(&h, "s", 0.0, 0.1);
    html_marker(&h, 0.1, "%s", "m");
    html_text(&h, "s", "line\n");
    const char *why = html_end(&h);
    FILE *f = fopen(path, "r");
    size_t n = f ? fread(page, 1, size - 1, f) : 0;
    page[n] = '\0';
    if (f)
        (void)fclose(f);
    unlink(path);
    char *begin = strstr(page, "id=\"data\">\n");
    return why || !begin ? NULL : begin + strlen("id=\"data\">\n");
}

TEST(html_data_as_by_hand)
{
    static const char *const part[] = {
        "{\"kind\":\"report\",\"title\":\"\\u003c/"
        "script\\u003e\\u0001\xEF\xBF\xBD\xC3\xA4\\u0022 \\u005c\\u0026\",\"version\":\"",
        "\"command\":\"contactplant sweep 'a b' 'it'\\u005c''s'\",\"sections\":[\n",
        "{\"kind\":\"words\",\"text\":\"2 words\"}\n"
        ",{\"kind\":\"table\",\"title\":\"t\",\"columns\":\"a,b\",\"rows\":[\n"
        "{\"bad\":false,\"cells\":[\"1\",\"\\u003cb\\u003e\"]},\n{\"bad\":true,\"cells\":[\"2\"]}]}\n"
        ",{\"kind\":\"table\",\"title\":\"empty\",\"columns\":\"a\",\"rows\":[]}\n"
        ",{\"kind\":\"chart\",\"title\":\"c\",\"unit\":\"m\",\"x_name\":\"time\",\"x_unit\":\"s\",\"layers\":"
        "[\n"
        "{\"kind\":\"steps\",\"name\":\"l\",\"x\":[0,0.10000000000000001],\"y\":[1e-300,null]},\n"
        "{\"kind\":\"band\",\"name\":\"b\",\"period\":[0.5],\"x\":[0,0.10000000000000001],"
        "\"end\":[0.20000000000000001],\"low\":[0,0.10000000000000001],\"high\":[2,3]},\n"
        "{\"kind\":\"open\",\"name\":\"open\",\"ends\":[0,1],\"share\":[0,0.10000000000000001]},\n"
        "{\"kind\":\"span\",\"name\":\"s\",\"ends\":[0,0.10000000000000001]},\n"
        "{\"kind\":\"marker\",\"x\":[0.10000000000000001],\"name\":\"m\"}]}\n"
        ",{\"kind\":\"text\",\"title\":\"s\",\"text\":\"line\\u000a\"}\n]}\n</script>\n<script>\n"};
    enum { SIZE = 100000 };
    char *page = malloc(SIZE), *at = data_of_report(page, SIZE);
    check_true("a report", at != NULL);
    for (size_t i = 0; at && i < sizeof part / sizeof *part; i++) {
        at = i == 1 ? strstr(at, part[i]) : at;
        check_true("it goes on as written by hand", at && !strncmp(at, part[i], strlen(part[i])));
        at = at ? at + strlen(part[i]) : NULL;
    }
    free(page);
}

TEST(html_tells_of_a_full_disk)
{
    struct html h;
    char word[] = "run", *words[] = {word}, why[FILES_REASON];
    files_begin();
    check_true("no folder", !files_take("report", "/nowhere/report.html", false, why));
    check_true("taken", files_take("report", "/dev/full", false, why));
    check_true("a device without room opens", !html_begin(&h, "/dev/full", "t", NULL, 1, words));
    check_true("its end tells", html_end(&h) != NULL);
}
