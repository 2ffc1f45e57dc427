/* test_paragraph.c - sentences for a terminal: where lines end, and what is kept. */
#include <stdio.h>
#include "host_sim/cli/paragraph.h"
#include "tests/unit/test.h"

enum { SIZE = 8192 };

static const char *print_paragraph(int indent, const char *head, const char *text)
{
    static char out[SIZE];
    FILE *f = tmpfile();
    paragraph_print(f, indent, head, "%s", text);
    rewind(f);
    out[fread(out, 1, sizeof out - 1, f)] = '\0';
    fclose(f);
    return out;
}

/* Ten words of nine letters and their spaces are 99 columns, eleven are 109. */
TEST(paragraph)
{
    static const char ten[] =
        "aaaaaaaaa aaaaaaaaa aaaaaaaaa aaaaaaaaa aaaaaaaaa aaaaaaaaa aaaaaaaaa aaaaaaaaa aaaaaaaaa aaaaaaaaa";
    char text[256], expected[256];
    check_string("a short one", print_paragraph(6, "HEAD", "it does"), "HEAD  it does\n");
    snprintf(expected, sizeof expected, "%s\n", ten);
    check_string("a full line", print_paragraph(0, "", ten), expected);
    snprintf(text, sizeof text, "%s b", ten);
    snprintf(expected, sizeof expected, "%s\nb\n", ten);
    check_string("one column more is another line", print_paragraph(0, "", text), expected);
    snprintf(text, sizeof text, "%.89s bbbbbbbbb c", ten);
    snprintf(expected, sizeof expected, "H %.89s\n  bbbbbbbbb c\n", ten);
    check_string("below the text, not below its head", print_paragraph(2, "H", text), expected);
    check_string("nothing", print_paragraph(3, "", ""), "   \n");
}
