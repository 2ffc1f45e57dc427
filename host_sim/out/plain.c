/* plain.c - see plain.h. */
#include "host_sim/out/plain.h"
#include "host_sim/out/utf8.h"

void plain_put(FILE *file, const char *text)
{
    while (*text) {
        struct utf8_character c = utf8_next(&text);
        if (c.code < ' ' || (c.code >= 0x7F && c.code < 0xA0))
            fputs(UTF8_REPLACEMENT, file);
        else
            (void)fwrite(c.bytes, 1, c.n, file);
    }
}
