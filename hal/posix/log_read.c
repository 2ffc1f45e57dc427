/* log_read.c - the reading half of log.h. */
#include "hal/posix/log_read.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum {
    SECONDS_DIGITS = 12,
    MICRO_DIGITS = 6,
    NANO_DIGITS = 9,
    READ_MAX = PCAPNG_LINE,
    /* in data byte 1 of an error frame of class LOG_ERROR_CONTROLLER, see linux/can/error.h */
    ERROR_OVERFLOW = 0x01,
    ERROR_PASSIVE = 0x3C /* warning or passive, receiving or sending */
};

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
    if (ch >= '0' && ch <= '9')
        return ch - '0';
    char upper = (char)(ch & ~('a' ^ 'A'));
    return upper >= 'A' && upper <= 'F' ? upper - 'A' + 10 : -1;
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

static void skip_blanks(struct cursor *c)
{
    if (!c->wrong)
        c->at += strspn(c->at, " ");
}

/* candump without -L begins with blanks, and has a time with -t alone. */
static void parse_time(struct cursor *c, struct log_line *out)
{
    int n;
    bool shown = *c->at == ' ';
    skip_blanks(c);
    if (shown && *c->at != '(')
        return;
    expect(c, '(', "a line begins with (seconds.micros)");
    uint64_t seconds = digits(c, 10, SECONDS_DIGITS, &n);
    fail_if(c, n == 0, "seconds expected");
    expect(c, '.', "'.' expected after at most 12 digits of seconds");
    uint64_t fraction = digits(c, 10, NANO_DIGITS, &n);
    fail_if(c, n != MICRO_DIGITS && n != NANO_DIGITS, "6 digits of microseconds expected");
    expect(c, ')', "')' expected after 6 digits of microseconds");
    expect(c, ' ', "a space expected after the time");
    out->time_us = seconds * 1000000u + (n == NANO_DIGITS ? fraction / 1000 : fraction);
}

static void parse_interface(struct cursor *c, struct log_line *out)
{
    skip_blanks(c); /* candump aligns names of several lengths */
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
    out->raw.id = id;
    out->raw.extended = n == 8;
}

static bool next_is(struct cursor *c, char ch)
{
    bool is = !c->wrong && *c->at == ch;
    c->at += is;
    return is;
}

/* At most `max` bytes. */
static void parse_bytes(struct cursor *c, int max, struct log_raw *raw)
{
    for (int n = 2; !c->wrong && hex_digit(*c->at) >= 0;) {
        fail_if(c, raw->length == max, "more data bytes than a frame has");
        uint8_t byte = (uint8_t)digits(c, 16, 2, &n);
        fail_if(c, n != 2, "half a data byte");
        if (!c->wrong)
            raw->data[raw->length++] = byte;
    }
}

static void parse_data(struct cursor *c, struct log_raw *raw)
{
    int n;
    raw->fd = next_is(c, '#');
    raw->remote = !raw->fd && next_is(c, 'R');
    if (raw->fd) {
        raw->flags = (uint8_t)digits(c, 16, 1, &n);
        fail_if(c, n != 1, "a digit of CAN FD flags expected");
    }
    if (raw->remote)
        raw->length = (uint8_t)digits(c, 16, 1, &n);
    else
        parse_bytes(c, raw->fd ? LOG_FD_DATA : FRAME_DATA, raw);
    if (!raw->fd && next_is(c, '_')) { /* the length as it was on the wire, 9 to F */
        (void)digits(c, 16, 1, &n);
        fail_if(c, n != 1, "a digit of the raw length expected");
    }
}

/* "RX - -" or "TX B E", as candump -x has it before the identifier. */
static void parse_marks(struct cursor *c, struct log_line *out)
{
    skip_blanks(c);
    if (c->wrong || c->at[0] == 0 || c->at[1] != 'X')
        return;
    out->way = c->at[0] == 'R' ? LOG_RECEIVED : LOG_SENT;
    c->at += 2;
    c->at += strspn(c->at, " -BE");
}

/* "[2]  11 22" behind the identifier, as candump shows it without -L; "[02]" is CAN FD. Whatever stands
 * behind the data is for people. */
static void parse_shown(struct cursor *c, struct log_raw *raw)
{
    int n;
    expect(c, '[', "'#' or a length in brackets expected after the identifier");
    raw->length = (uint8_t)digits(c, 10, 2, &n);
    expect(c, ']', "']' expected after the length");
    skip_blanks(c);
    raw->fd = n == 2;
    raw->remote = !raw->fd && next_is(c, 'r');
    fail_if(c, n == 0 || raw->length > (raw->fd ? LOG_FD_DATA : FRAME_DATA),
            "a length of at most 8, or 64 by two digits, expected");
    for (int i = 0; i < raw->length && !raw->remote && !c->wrong; i++, skip_blanks(c)) {
        raw->data[i] = (uint8_t)digits(c, 16, 2, &n);
        fail_if(c, n != 2, "a data byte expected");
    }
}

static void parse_end(struct cursor *c, struct log_line *out)
{
    if (!c->wrong && c->at[0] == ' ' && (c->at[1] == 'R' || c->at[1] == 'T')) {
        out->way = c->at[1] == 'R' ? LOG_RECEIVED : LOG_SENT;
        c->at += 2;
    }
    fail_if(c, !c->wrong && *c->at != 0, "data bytes of two hex digits expected, and nothing after them");
}

/* The error frame is all 0 but for some bits in byte 5: the recorder's. */
static bool is_own_fault(const struct frame *f)
{
    const uint8_t *d = f->data;
    uint32_t class = f->id & ~(uint32_t)LOG_ERROR_FRAME;
    bool known = class == LOG_ERROR_CONTROLLER || class == LOG_ERROR_BUS_OFF;
    return known && f->length == FRAME_DATA && d[LOG_FAULT_BYTE] && !(d[LOG_FAULT_BYTE] & ~LOG_FAULT_BITS) &&
           !(d[0] | d[1] | d[2] | d[3] | d[4] | d[6] | d[7]);
}

/* The hal_fault bits of an error frame, as hal/posix/socketcan.c reports them; 0: it passes it over. */
static int line_fault(const struct frame *f)
{
    if (is_own_fault(f))
        return f->data[LOG_FAULT_BYTE];
    int fault = f->id & LOG_ERROR_BUS_OFF ? HAL_BUS_OFF : 0;
    if (f->id & LOG_ERROR_CONTROLLER && f->data[1] & ERROR_PASSIVE)
        fault |= HAL_ERROR_PASSIVE;
    if (f->id & LOG_ERROR_CONTROLLER && f->data[1] & ERROR_OVERFLOW)
        fault |= HAL_DROPPED;
    return fault;
}

/* A word of the recorder without a number: its way; LOG_UNKNOWN for another line. */
static enum log_way read_word(const struct frame *f)
{
    const uint8_t *d = f->data;
    if (d[0] | d[2] | d[3] | d[4])
        return LOG_UNKNOWN;
    return d[LOG_FAULT_BYTE] == LOG_PLANT     ? LOG_BEGIN
           : d[LOG_FAULT_BYTE] == LOG_AGAINST ? LOG_TURN
                                              : LOG_UNKNOWN;
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
    if (d[LOG_REFUSED_BYTE] != 0 || d[6] != 0 || d[7] != 0)
        return false;
    out->way = what == LOG_MISSED ? LOG_OVERRUN : read_word(f);
    if (out->way == LOG_UNKNOWN)
        return false;
    out->missed = d[0] | (uint32_t)d[2] << 8 | (uint32_t)d[3] << 16 | (uint32_t)d[4] << 24;
    out->frame = (struct frame){.id = 0};
    return true;
}

/* The kind of its frame, and what a plant would hear of it. */
static void interpret(struct log_line *out)
{
    const struct log_raw *raw = &out->raw;
    out->kind = raw->fd ? LOG_FD : raw->remote ? LOG_REMOTE : LOG_DATA;
    out->frame = (struct frame){.id = raw->id, .flags = raw->extended ? FRAME_EXTENDED : 0};
    if (out->kind == LOG_DATA) {
        out->frame.length = raw->length;
        memcpy(out->frame.data, raw->data, FRAME_DATA);
    }
}

const char *log_parse(const char *text, struct log_line *out, int *column)
{
    struct cursor c = {text, NULL};
    memset(out, 0, sizeof *out);
    parse_time(&c, out);
    parse_interface(&c, out);
    parse_marks(&c, out);
    parse_identifier(&c, out);
    skip_blanks(&c);
    if (next_is(&c, '#')) {
        parse_data(&c, &out->raw);
        parse_end(&c, out);
    } else {
        parse_shown(&c, &out->raw);
    }
    interpret(out);
    if (c.wrong) {
        out->kind = LOG_DAMAGED;
    } else if (out->kind == LOG_DATA && out->frame.id & LOG_ERROR_FRAME && !read_own(out)) {
        out->fault = line_fault(&out->frame);
        out->kind = out->fault ? LOG_DATA : LOG_ERROR;
    }
    *column = (int)(c.at - text) + 1;
    return c.wrong;
}

/* ---- a file of lines ---- */

/* The bytes of a pipe as a file without a name; NULL where that cannot be had. */
static FILE *keep_pipe(FILE *pipe)
{
    FILE *kept = tmpfile();
    bool whole = kept != NULL;
    int ch;
    while (whole && (ch = getc_unlocked(pipe)) != EOF) /* bounded by the pipe */
        whole = putc_unlocked(ch, kept) != EOF;
    whole = whole && !ferror(pipe) && fflush(kept) == 0 && fseek(kept, 0, SEEK_SET) == 0;
    if (kept && !whole)
        (void)fclose(kept);
    (void)fclose(pipe);
    return whole ? kept : NULL;
}

const char *log_reader_open(struct log_reader *r, const char *path)
{
    memset(r, 0, sizeof *r);
    r->path = path;
    r->file = fopen(path, "re");
    if (r->file && fseek(r->file, 0, SEEK_CUR) != 0)
        r->file = keep_pipe(r->file);
    bool packets = r->file && pcapng_is(r->file);
    r->packets = packets ? calloc(1, sizeof *r->packets) : NULL;
    if (r->file && (r->packets || !packets))
        return NULL;
    snprintf(r->reason, sizeof r->reason, "log: cannot read %s: %s", path, strerror(errno));
    return r->reason;
}

void log_reader_rewind(struct log_reader *r)
{
    struct log_reader fresh = {
        .file = r->file, .packets = r->packets, .path = r->path, .interface = r->interface};
    rewind(r->file);
    *r = fresh;
}

void log_reader_tell(const struct log_reader *r, struct log_place *p)
{
    memset(p, 0, sizeof *p);
    p->offset = ftell(r->file);
    p->line = r->line;
    p->of_plant = r->of_plant;
    p->turned = r->turned;
    if (r->packets)
        p->packets = *r->packets;
}

bool log_reader_seek(struct log_reader *r, const struct log_place *p)
{
    r->line = p->line;
    r->of_plant = p->of_plant;
    r->turned = p->turned;
    if (r->packets)
        *r->packets = p->packets;
    clearerr(r->file);
    return fseek(r->file, p->offset, SEEK_SET) == 0;
}

static void note_damage(struct log_reader *r, int column, const char *what)
{
    if (*r->damage)
        return;
    if (r->packets)
        snprintf(r->damage, sizeof r->damage, "packet %llu: %s", (unsigned long long)r->line, what);
    else
        snprintf(r->damage, sizeof r->damage, "line %llu, column %d: %s", (unsigned long long)r->line, column,
                 what);
}

/* The next line without its end into text[READ_MAX], and its kind, LOG_KINDS at the end of the file. The rest
 * of a longer line is passed over. */
static enum log_kind read_text(struct log_reader *r, char *text)
{
    size_t n = 0;
    int ch;
    while ((ch = getc_unlocked(r->file)) != EOF && ch != '\n') { /* bounded by the file */
        if (n < READ_MAX - 1)
            text[n] = (char)ch;
        n++;
    }
    if (ch == EOF && n == 0)
        return LOG_KINDS;
    r->line++;
    text[n < READ_MAX ? n : READ_MAX - 1] = 0;
    if (ch == EOF)
        return LOG_CUT;
    if (n >= READ_MAX || strlen(text) != n) {
        note_damage(r, 1, n >= READ_MAX ? "line too long" : "a zero byte: not a text file");
        return LOG_DAMAGED;
    }
    if (n && text[n - 1] == '\r')
        text[n - 1] = 0;
    return LOG_DATA;
}

/* The next packet as such a line. */
static enum log_kind read_packet(struct log_reader *r, char *text)
{
    const char *why;
    enum pcapng_got got = pcapng_next(r->packets, r->file, text, &why);
    r->line += got != PCAPNG_END;
    if (got == PCAPNG_DAMAGED)
        note_damage(r, 0, why);
    return got == PCAPNG_PACKET    ? LOG_DATA
           : got == PCAPNG_DAMAGED ? LOG_DAMAGED
           : got == PCAPNG_CUT     ? LOG_CUT
                                   : LOG_KINDS;
}

static bool is_empty(const char *text)
{
    size_t blanks = strspn(text, " \t");
    return text[blanks] == 0 || text[blanks] == '#';
}

static int end_of_file(struct log_reader *r)
{
    uint64_t lines = r->elsewhere;
    for (int kind = 0; kind < LOG_DAMAGED; kind++)
        lines += r->count[kind];
    if (ferror(r->file))
        snprintf(r->reason, sizeof r->reason, "log: cannot read %.120s: %s", r->path, strerror(errno));
    else if (!lines)
        snprintf(r->reason, sizeof r->reason, "%.80s: no %s%s%s", r->path,
                 r->packets ? "packet of it is one of CAN" : "line of it is one of candump -L",
                 *r->damage ? "; " : "", r->damage);
    return ferror(r->file) || !lines ? -1 : 0;
}

/* The way of a line of LOG_DATA by the words before it. */
static void tell_way(struct log_reader *r, struct log_line *line)
{
    r->of_plant = r->of_plant || line->way == LOG_BEGIN;
    if (line->way == LOG_BEGIN || line->way == LOG_TURN) {
        r->turned = line->way == LOG_TURN;
        return;
    }
    if (line->fault || line->way != LOG_UNKNOWN || !r->of_plant)
        return;
    line->way = log_way_of(&line->frame);
    if (r->turned)
        line->way = line->way == LOG_SENT ? LOG_RECEIVED : LOG_SENT;
    r->turned = false;
}

int log_read_any(struct log_reader *r, struct log_line *out)
{
    char text[READ_MAX];
    enum log_kind kind;
    int column = 0;
    while ((kind = r->packets ? read_packet(r, text) : read_text(r, text)) != LOG_KINDS) {
        if (kind == LOG_DATA && is_empty(text))
            continue;
        const char *wrong = kind == LOG_DATA ? log_parse(text, out, &column) : NULL;
        if (wrong)
            note_damage(r, column, wrong);
        kind = kind == LOG_DATA ? out->kind : kind;
        bool here = kind >= LOG_DAMAGED || !r->interface || !strcmp(r->interface, out->interface);
        *(here ? &r->count[kind] : &r->elsewhere) += 1;
        if (here && kind == LOG_DATA)
            tell_way(r, out);
        if (here && kind < LOG_DAMAGED)
            return 1;
    }
    return end_of_file(r);
}

int log_read_line(struct log_reader *r, struct log_line *out)
{
    int got;
    while ((got = log_read_any(r, out)) > 0 &&
           (out->kind != LOG_DATA || out->way == LOG_BEGIN || out->way == LOG_TURN)) {
    }
    return got;
}

void log_reader_close(struct log_reader *r)
{
    fclose(r->file);
    free(r->packets);
    r->file = NULL;
    r->packets = NULL;
}
