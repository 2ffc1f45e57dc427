/* utf8.h - text of unknown origin as UTF-8 (RFC 3629): what is well formed stays, the rest is U+FFFD. */
#ifndef HOST_SIM_UTF8_H
#define HOST_SIM_UTF8_H

#include <stddef.h>
#include <stdint.h>

#define UTF8_REPLACEMENT "\xEF\xBF\xBD" /* U+FFFD */

enum { UTF8_MAX = 4 }; /* bytes of a character */

struct utf8_character {
    const char *bytes; /* n of them; not ended by a NUL */
    size_t n;          /* 1 to UTF8_MAX */
    uint32_t code;
};

/* The character at *at, which is not the end of the text; *at moves behind it. Ill-formed are overlong forms,
 * surrogates, codes above U+10FFFF and sequences that are cut. As many bytes as could begin a character
 * become one U+FFFD. */
struct utf8_character utf8_next(const char **at);

/* The bytes of a byte order mark at the begin of a text: 3, or 0. */
size_t utf8_mark(const char *text, size_t n);

/* The bytes of the text's whole characters among its first `size` bytes: `%.*s` cuts no character. */
int utf8_fits(const char *text, int size);

/* Bytes of a field for so many characters: `%-*s` aligns the well-formed text. */
int utf8_field(const char *text, int characters);

/* Bytes that are ill-formed, a character that a buffer has cut among them, become question marks. */
void utf8_mend(char *text);

#endif
