/* log_read.c - the reading half of log.h. */
#include "hal/posix/log.h"

#include <errno.h>
#include <string.h>

enum { SECONDS_DIGITS = 12, MICRO_DIGITS = 6, READ_MAX = 256 };

/* A position in the line being parsed, and the first thing that was wrong with it. */
struct cursor {
    const char *at;
    const char *wrong;
};

static void expect(struct cursor *c, char wanted, const char *wrong)
{
    if (c->wrong)
        return;
    if (*c->at == wanted)
        c->at++;
    else
        c->wrong = wrong;
}

static int hex_digit(char ch)
{
    const char *digits = "0123456789ABCDEF0123456789abcdef";
    const char *found = ch ? strchr(digits, ch) : NULL;
    return found ? (int)(found - digits) % 16 : -1;
}

/* The digits at the cursor, base 10 or 16, and how many there were, up to max. */
static uint64_t digits(struct cursor *c, unsigned base, int max, int *n)
{
    uint64_t value = 0;
    for (*n = 0; *n < max && !c->wrong; ++*n, c->at++) {
        int digit = hex_digit(*c->at);
        if (digit < 0 || digit >= (int)base)
            break;
        value = value * base + (unsigned)digit;
    }
    return value;
}

static void fail_if(struct cursor *c, bool condition, const char *wrong)
{
    if (!c->wrong && condition)
        c->wrong = wrong;
}

static void parse_time(struct cursor *c, struct log_line *out)
{
    int n;
    expect(c, '(', "a line begins with (seconds.micros)");
    uint64_t seconds = digits(c, 10, SECONDS_DIGITS, &n);
    fail_if(c, n == 0, "seconds expected");
    expect(c, '.', "'.' expected after at most 12 digits of seconds");
    uint64_t micros = digits(c, 10, MICRO_DIGITS, &n);
    fail_if(c, n != MICRO_DIGITS, "6 digits of microseconds expected");
    expect(c, ')', "')' expected after 6 digits of microseconds");
    expect(c, ' ', "one space expected after the time");
    out->time_us = seconds * 1000000u + micros;
}

static void parse_interface(struct cursor *c, struct log_line *out)
{
    size_t n = c->wrong ? 0 : strcspn(c->at, " \t");
    fail_if(c, n < 1 || n >= LOG_INTERFACE, "an interface name of 1 to 15 characters expected");
    if (c->wrong)
        return;
    memcpy(out->interface, c->at, n);
    c->at += n;
    expect(c, ' ', "one space expected after the interface");
}

static void parse_identifier(struct cursor *c, struct log_line *out)
{
    int n;
    struct cursor begin = *c;
    uint32_t id = (uint32_t)digits(c, 16, 8, &n);
    const char *wrong = NULL;
    if (n != 3 && n != 8)
        wrong = "an identifier of 3 or 8 hex digits expected";
    else if (n == 3 && id > 0x7FF)
        wrong = "an 11-bit identifier is at most 7FF";
    else if (n == 8 && id > (LOG_ERROR_FRAME | 0x1FFFFFFFu))
        wrong = "a 29-bit identifier is at most 1FFFFFFF";
    if (wrong && !c->wrong) {
        c->at = begin.at;
        c->wrong = wrong;
    }
    out->frame.id = id;
    out->frame.flags = n == 8 ? FRAME_EXTENDED : 0;
    expect(c, '#', "'#' expected after the identifier");
    fail_if(c, !c->wrong && *c->at == '#', "CAN FD frame: only classic frames of up to 8 bytes are possible");
    fail_if(c, !c->wrong && *c->at == 'R', "remote frame: only data frames are possible");
}

static void parse_data(struct cursor *c, struct log_line *out)
{
    for (int n = 2; !c->wrong && hex_digit(*c->at) >= 0;) {
        fail_if(c, out->frame.length == FRAME_DATA, "more than 8 data bytes");
        uint8_t byte = (uint8_t)digits(c, 16, 2, &n);
        fail_if(c, n != 2, "half a data byte");
        if (!c->wrong)
            out->frame.data[out->frame.length++] = byte;
    }
    if (!c->wrong && c->at[0] == ' ' && (c->at[1] == 'R' || c->at[1] == 'T')) {
        out->way = c->at[1] == 'R' ? LOG_RECEIVED : LOG_SENT;
        c->at += 2;
    }
    fail_if(c, !c->wrong && *c->at != 0, "data bytes of two hex digits expected, and nothing after them");
}

static int line_fault(const struct frame *f)
{
    int recorded = f->data[LOG_FAULT_BYTE] & LOG_FAULT_BITS;
    if (recorded)
        return recorded;
    return f->id & LOG_ERROR_BUS_OFF ? HAL_BUS_OFF : HAL_ERROR_PASSIVE;
}

/* A line of the recorder that is no fault, see log.h: false when it is none of these. */
static bool read_own(struct log_line *out)
{
    const struct frame *f = &out->frame;
    const uint8_t *d = f->data, what = d[LOG_FAULT_BYTE];
    if (f->id != (LOG_ERROR_FRAME | LOG_ERROR_CONTROLLER) || f->length != FRAME_DATA)
        return false;
    if (d[LOG_REFUSED_BYTE] == LOG_REFUSED_CAUSE && what / LOG_NUMBERS == LOG_REFUSED / LOG_NUMBERS) {
        out->frame = (struct frame){.id = what % LOG_NUMBERS,
                                    .length = FRAME_DATA,
                                    .data = {0, 0, d[0], d[2], d[3], d[4], d[6], d[7]}};
        out->way = LOG_NO_ROOM;
        return true;
    }
    if (d[LOG_REFUSED_BYTE] != 0 || what != LOG_MISSED || d[6] != 0 || d[7] != 0)
        return false;
    out->missed = d[0] | (uint32_t)d[2] << 8 | (uint32_t)d[3] << 16 | (uint32_t)d[4] << 24;
    out->frame = (struct frame){.id = 0};
    out->way = LOG_OVERRUN;
    return true;
}

const char *log_parse(const char *text, struct log_line *out, int *column)
{
    struct cursor c = {text, NULL};
    memset(out, 0, sizeof *out);
    parse_time(&c, out);
    parse_interface(&c, out);
    parse_identifier(&c, out);
    parse_data(&c, out);
    if (!c.wrong && out->frame.id & LOG_ERROR_FRAME && !read_own(out))
        out->fault = line_fault(&out->frame);
    *column = (int)(c.at - text) + 1;
    return c.wrong;
}

/* ---- a file of lines ---- */

const char *log_reader_open(struct log_reader *r, const char *path)
{
    memset(r, 0, sizeof *r);
    r->path = path;
    r->file = fopen(path, "re");
    if (r->file)
        return NULL;
    snprintf(r->reason, sizeof r->reason, "log: cannot read %s: %s", path, strerror(errno));
    return r->reason;
}

static int bad_line(struct log_reader *r, int column, const char *what)
{
    snprintf(r->reason, sizeof r->reason, "%.120s:%llu:%d: %s", r->path, (unsigned long long)r->line, column,
             what);
    return -1;
}

int log_read_line(struct log_reader *r, struct log_line *out)
{
    char text[READ_MAX];
    int column;
    while (fgets(text, sizeof text, r->file)) {
        size_t n = strlen(text);
        r->line++;
        if (n == 0)
            return bad_line(r, 1, "a zero byte: not a text file");
        if (text[n - 1] != '\n')
            return bad_line(r, (int)n + 1,
                            n == sizeof text - 1 ? "line too long" : "cut off: no end of line");
        n -= n > 1 && text[n - 2] == '\r' ? 2 : 1;
        text[n] = 0;
        if (text[0] == 0 || text[0] == '#')
            continue;
        const char *wrong = log_parse(text, out, &column);
        return wrong ? bad_line(r, column, wrong) : 1;
    }
    return ferror(r->file) ? bad_line(r, 1, strerror(errno)) : 0;
}

void log_reader_close(struct log_reader *r)
{
    fclose(r->file);
    r->file = NULL;
}
