/* paragraph.c - see paragraph.h. */
#include "host_sim/cli/paragraph.h"

#include <stdarg.h>
#include <stdbool.h>
#include <string.h>

enum { LINE_WIDTH = 100, TEXT = 4096 };

void paragraph_print(FILE *out, int indent, const char *head, const char *format, ...)
{
    char text[TEXT];
    va_list a;
    va_start(a, format);
    vsnprintf(text, sizeof text, format, a);
    va_end(a);
    int column = fprintf(out, "%-*s", indent, head);
    bool first = true;
    for (const char *word = text; *word;) {
        int length = (int)strcspn(word, " ");
        if (!first && column + 1 + length > LINE_WIDTH) {
            column = fprintf(out, "\n%*s", indent, "") - 1;
            first = true;
        }
        column += fprintf(out, "%s%.*s", first ? "" : " ", length, word);
        first = false;
        word += length;
        word += strspn(word, " ");
    }
    fputc('\n', out);
}
