/* console.c - text and numbers for a board's console; see console.h. */
#include "hal/board/console.h"

enum { DECIMAL_DIGITS = 20 };

static struct {
    char byte[CONSOLE_RING];
    uint32_t first, n;
} ring;

static void put(char c)
{
    if (ring.n < CONSOLE_RING)
        ring.byte[(ring.first + ring.n++) % CONSOLE_RING] = c;
}

void console_text(const char *text)
{
    for (; *text != '\0'; text++)
        put(*text);
}

void console_number(uint64_t value)
{
    char digit[DECIMAL_DIGITS];
    int n = 0;
    do {
        digit[n++] = (char)('0' + value % 10);
        value /= 10;
    } while (value > 0);
    while (n > 0)
        put(digit[--n]);
}

void console_hex(uint64_t value, int digits)
{
    while (digits-- > 0)
        put("0123456789abcdef"[value >> (4 * digits) & 15]);
}

void console_poll(void)
{
    while (ring.n > 0 && board_put(ring.byte[ring.first])) {
        ring.first = (ring.first + 1) % CONSOLE_RING;
        ring.n--;
    }
}

void console_flush(void)
{
    for (int i = 0; i < CONSOLE_TRIES && ring.n > 0; i++)
        console_poll();
}

static const char *kind_name(uint32_t kind)
{
    static const char *const name[] = {"no fault", "assert", "exception", "stack", "clock", "watchdog"};
    return kind <= BOARD_WATCHDOG ? name[kind] : "unknown";
}

void console_fault(const struct board_fault *f, uint32_t starts)
{
    console_text("last run ended: ");
    console_text(kind_name(f->kind));
    if (f->kind == BOARD_ASSERT) {
        console_text(" ");
        console_text(f->file);
        console_text(":");
        console_number(f->line);
    }
    if (f->address != 0) {
        console_text(" at ");
        console_hex(f->address, 8);
        console_text(" cause ");
        console_hex(f->cause, 8);
    }
    if (starts > 1) {
        console_text(", starts since ");
        console_number(starts);
    }
    console_text("\n");
}
