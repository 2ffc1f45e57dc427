/* test_log.c - candump lines against what candump itself prints, broken logs and a full disk. */
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>
#include "hal/posix/log.h"
#include "hal/link/loopback.h"
#include "hal/posix/log_read.h"
#include "tests/unit/test.h"

static struct loopback_bus bus;
static struct log record;
static char log_file[] = "/tmp/contactplant_log_XXXXXX";

/* A file of its own for each test. */
static void make_file(const char *text)
{
    memcpy(log_file + strlen(log_file) - 6, "XXXXXX", 6);
    int fd = mkstemp(log_file);
    FILE *f = fdopen(fd, "w");
    fputs(text, f);
    fclose(f);
}

static size_t read_file(char *out, size_t size)
{
    FILE *f = fopen(log_file, "r");
    size_t n = fread(out, 1, size - 1, f);
    out[n] = 0;
    fclose(f);
    return n;
}

static int format(char *text, uint64_t time_us, const char *interface, const struct frame *f, int fault)
{
    struct log_line line = {.time_us = time_us, .fault = fault};
    if (f)
        line.frame = *f;
    snprintf(line.interface, sizeof line.interface, "%s", interface);
    return log_format(text, &line);
}

/* Lines as candump -L (can-utils 2020.11) printed them for cansend 123#1122, 18DAF110#0102030405060708, 7FF#
 * and 20000040#0000000000040000, up to the interface's name. */
TEST(log_golden)
{
    char text[LOG_LINE_MAX];
    const struct frame standard = {0x123, 2, 0, {0x11, 0x22}};
    const struct frame extended = {0x18DAF110, 8, FRAME_EXTENDED, {1, 2, 3, 4, 5, 6, 7, 8}};
    const struct frame empty = {0x7FF, 0, 0, {0}};
    int n = format(text, 1795226529752604, "vcan1", &standard, 0);
    check_string("11 bits", text, "(1795226529.752604) vcan1 123#1122\n");
    check_int("its length", n, (int64_t)strlen(text));
    format(text, 1000, "can0", &extended, 0);
    check_string("29 bits", text, "(0000000000.001000) can0 18DAF110#0102030405060708\n");
    format(text, 0, "c", &empty, 0);
    check_string("no data", text, "(0000000000.000000) c 7FF#\n");
    format(text, 0, "c", NULL, HAL_BUS_OFF);
    check_string("bus-off", text, "(0000000000.000000) c 20000040#0000000000040000\n");
    format(text, 0, "c", NULL, HAL_DROPPED | HAL_DOWN);
    check_string("dropped and down", text, "(0000000000.000000) c 20000004#0000000000110000\n");
    n = format(text, UINT64_MAX, "fifteen_letters", &extended, 0);
    check_below("the longest line", n, LOG_LINE_MAX - 1);
    check_int("stamp of frame 7 at 3 kHz, rounded", (int64_t)log_frame_us(7, 1.0 / 3000), 1002333);
    check_int("stamp of frame 1e9 at 1 kHz", (int64_t)log_frame_us(1000000000, 1e-3), 1000001000000);
}

static void parsed(const char *text, uint64_t time_us, uint32_t id, int length, int fault)
{
    struct log_line line;
    int column;
    const char *wrong = log_parse(text, &line, &column);
    printf("%s\n", text);
    check_string("accepted", wrong ? wrong : "", "");
    check_int("time, us", (int64_t)line.time_us, (int64_t)time_us);
    check_hex("identifier", line.frame.id, id);
    check_int("length", line.frame.length, length);
    check_int("fault", line.fault, fault);
}

static bool same(const struct frame *a, const struct frame *b)
{
    return a->id == b->id && a->flags == b->flags && a->length == b->length &&
           memcmp(a->data, b->data, sizeof a->data) == 0;
}

TEST(log_parse)
{
    struct log_line line;
    int column;
    char text[LOG_LINE_MAX];
    parsed("(1795226529.752604) vcan1 123#1122", 1795226529752604, 0x123, 2, 0);
    parsed("(0.001000) can0 18DAF110#0102030405060708", 1000, 0x18DAF110, 8, 0);
    parsed("(1436509052.249713) vcan0 044#2a366c2bba", 1436509052249713, 0x044, 5, 0);
    parsed("(1436509052.249713) vcan0 044#2A R", 1436509052249713, 0x044, 1, 0);
    parsed("(1436509052.249713) vcan0 044# T", 1436509052249713, 0x044, 0, 0);
    parsed("(0000000000.000000) c 20000004#0000000000110000", 0, 0x20000004, 8, HAL_DROPPED | HAL_DOWN);
    parsed("(0000000000.000000) c 20000040#0000000000000000", 0, 0x20000040, 8, HAL_BUS_OFF);
    parsed("(0000000000.000000) c 20000204#0008000000000000", 0, 0x20000204, 8, HAL_ERROR_PASSIVE);
    int64_t wrong = 0;
    for (uint32_t i = 0; i < 4096; i++) { /* parse(format(x)) = x */
        struct frame f = {i, (uint8_t)(i % 9), i & 1 ? FRAME_EXTENDED : 0, {0}};
        f.id = i & 1 ? i * 131071u % 0x20000000u : i % 0x800u;
        for (int k = 0; k < f.length; k++)
            f.data[k] = (uint8_t)(i * 7u + (unsigned)k * 31u);
        int n = format(text, i * 1234567u, "vcan0", &f, 0);
        text[n - 1] = 0;
        wrong += log_parse(text, &line, &column) || line.time_us != i * 1234567u || !same(&line.frame, &f) ||
                 strcmp(line.interface, "vcan0") != 0;
    }
    check_int("lines that do not read as they were written", wrong, 0);
}

/* A word of the recorder, or a data frame, gives back its input; the way of a frame stands in no line. */
TEST(log_ways)
{
    char text[LOG_LINE_MAX];
    struct log_line line = {.interface = "can0", .frame = {0x254, 2, 0, {1, 2}}, .way = LOG_RECEIVED}, again;
    int column, wrong = 0;
    log_format(text, &line);
    check_string("a frame", text, "(0000000000.000000) can0 254#0102\n");
    line = (struct log_line){.interface = "can0",
                             .frame = {0x254, 8, 0, {0x10, 0x21, 0x32, 0x43, 0x54, 0x65, 0x76, 0x87}},
                             .way = LOG_NO_ROOM};
    log_format(text, &line);
    check_string("refused: message 14", text, "(0000000000.000000) can0 20000004#3202435465947687\n");
    line = (struct log_line){.interface = "can0", .way = LOG_OVERRUN, .missed = 0x01020304};
    log_format(text, &line);
    check_string("missed", text, "(0000000000.000000) can0 20000004#0400030201C00000\n");
    for (uint32_t i = 0; i < 4096; i++) {
        line = (struct log_line){.interface = "c", .way = (enum log_way)(LOG_RECEIVED + i % 6)};
        line.missed = line.way == LOG_OVERRUN ? i * 1048583u : 0;
        line.frame = (struct frame){0x240 + i % 64, 8, 0, {0}};
        for (int k = 0; k < 8; k++)
            line.frame.data[k] = (uint8_t)(i * 7u + (unsigned)k * 31u);
        int n = log_format(text, &line);
        text[n - 1] = 0;
        wrong += log_parse(text, &again, &column) != NULL || again.kind != LOG_DATA || again.fault != 0 ||
                 again.way != (line.way < LOG_NO_ROOM ? LOG_UNKNOWN : line.way) ||
                 again.missed != line.missed;
        if (line.way == LOG_NO_ROOM)
            wrong += again.frame.id != i % 64 || memcmp(again.frame.data + 2, line.frame.data + 2, 6) != 0;
        else if (line.way < LOG_NO_ROOM)
            wrong += !same(&again.frame, &line.frame);
    }
    check_int("lines that do not read as they were written", wrong, 0);
    check_int("a command is received by its plant", log_way_of(&(struct frame){.id = 0x24F}), LOG_RECEIVED);
    check_int("telemetry is sent", log_way_of(&(struct frame){.id = 0x250}), LOG_SENT);
}

/* Lines as candump (can-utils 2020.11 and newer), python-can 4 and hands write them. Error frames by
 * linux/can/error.h: a plant reports bus-off, warning, passive and overflow; other classes say nothing of it.
 */
static const struct {
    const char *text;
    enum log_kind kind;
    int fault;
} row[] = {
    {"(1436509052.249713) vcan0 123#1122", LOG_DATA, 0},
    {"(1436509052.249713) vcan0 123#", LOG_DATA, 0},
    {"(1436509052.249713)   can0 123#1122", LOG_DATA, 0},
    {"(1436509052.249713123) can0 123#1122", LOG_DATA, 0},
    {"(1436509052.249713) can0 123#1122334455667788_B", LOG_DATA, 0},
    {"(1436509052.249713) can0 123#1122 R", LOG_DATA, 0},
    {"(1436509052.249713) can0 18DAF110#0102030405060708 T", LOG_DATA, 0},
    {"(1436509052.249713) can0 345##1112233445566778899AABBCC", LOG_FD, 0},
    {"(1436509052.249713) can0 345##1112233445566778899AABBCC R", LOG_FD, 0},
    {"(1436509052.249713) can0 345##0", LOG_FD, 0},
    {"(1436509052.249713) can0 18DAF110##311", LOG_FD, 0},
    {"(1436509052.249713) can0 123#R", LOG_REMOTE, 0},
    {"(1436509052.249713) can0 123#R8", LOG_REMOTE, 0},
    {"(1436509052.249713) can0 123#R8_F", LOG_REMOTE, 0},
    {"(1436509052.249713) can0 18DAF110#R T", LOG_REMOTE, 0},
    {"(1436509052.249713) can0 20000080#0000000000000000", LOG_ERROR, 0},
    {"(1436509052.249713) can0 20000088#0000080000000000", LOG_ERROR, 0},
    {"(1436509052.249713) can0 20000004#0040000000000000", LOG_ERROR, 0},
    {"(1436509052.249713) can0 20000100#0000000000000000", LOG_ERROR, 0},
    {"(1436509052.249713) can0 20000004#", LOG_ERROR, 0},
    {"(1436509052.249713) can0 20000040#0000000000000000", LOG_DATA, HAL_BUS_OFF},
    {"(1436509052.249713) can0 20000204#0008000000006000", LOG_DATA, HAL_ERROR_PASSIVE},
    {"(1436509052.249713) can0 20000004#0010000000000000", LOG_DATA, HAL_ERROR_PASSIVE},
    {"(1436509052.249713) can0 20000004#0001000000000000", LOG_DATA, HAL_DROPPED},
    {"(1436509052.249713) can0 20000044#0005000000000000", LOG_DATA,
     HAL_BUS_OFF | HAL_DROPPED | HAL_ERROR_PASSIVE},
    {"(1436509052.249713) can0 20000004#0000000000110000", LOG_DATA, HAL_DROPPED | HAL_DOWN},
    {"(1436509052.249713) can0 20000004#0000000000110001", LOG_ERROR, 0},
    {"(1436509052.249713) can0 20000004#0000000000410000", LOG_ERROR, 0},
    {"(1436509052.249713) can0 20000004#0000000000C10000", LOG_DATA, 0},
    {"(1436509052.249713) can0 20000004#0100000000C10000", LOG_ERROR, 0},
    {"(1436509052.249713) can0 20000004#0400030201C00001", LOG_ERROR, 0},
    {"(1436509052.249713) can0 20000004#0404030201C00000", LOG_DATA, HAL_ERROR_PASSIVE},
    {"(1436509052.249713) can0 20000004#3202435465147687", LOG_ERROR, 0},
    {"(1436509052.249713) can0 345##", LOG_DAMAGED, 0},
    {"(1436509052.249713) can0 345##1112", LOG_DAMAGED, 0},
    {"(1436509052.249713) can0 123#RX", LOG_DAMAGED, 0},
    {"(1436509052.249713) can0 123#1122_", LOG_DAMAGED, 0},
    {"  can0  123   [2]  11 22", LOG_DATA, 0},
    {" (1436509052.249713)  can0  18DAF110   [8]  01 02 03 04 05 06 07 08   '........'", LOG_DATA, 0},
    {"  can0  RX - -  123   [0] ", LOG_DATA, 0},
    {"  can0  TX - -  123   [2]  remote request", LOG_REMOTE, 0},
    {"  can0  RX B -  123  [12]  00 11 22 33 44 55 66 77 88 99 AA BB", LOG_FD, 0},
    {"  can0  123  [02]  00 11", LOG_FD, 0},
    {"  can0  20000080   [8]  00 00 00 00 00 00 00 00   ERRORFRAME", LOG_ERROR, 0},
    {"  can0  20000040   [8]  00 00 00 00 00 00 00 00   ERRORFRAME", LOG_DATA, HAL_BUS_OFF},
    {"  can0  123   [2]  11", LOG_DAMAGED, 0},
    {"  can0  123   [2]  11 2", LOG_DAMAGED, 0},
    {"  can0  123   [9]  11 22 33 44 55 66 77 88 99", LOG_DAMAGED, 0},
    {"  can0  123   []", LOG_DAMAGED, 0},
    {"  can0  123   [2", LOG_DAMAGED, 0},
    {"  can0  123", LOG_DAMAGED, 0},
    {"  can0", LOG_DAMAGED, 0},
    {"hello", LOG_DAMAGED, 0},
};

TEST(log_kinds)
{
    struct log_line line;
    int column;
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        const char *wrong = log_parse(row[i].text, &line, &column);
        check_int(row[i].text, line.kind, row[i].kind);
        check_int("  fault", line.fault, row[i].fault);
        check_true("  a reason where it is damaged", (wrong != NULL) == (row[i].kind == LOG_DAMAGED));
    }
}

static void refused(const char *text, int at, const char *part)
{
    struct log_line line;
    int column;
    const char *wrong = log_parse(text, &line, &column);
    printf("%s\n    column %d: %s\n", text, column, wrong ? wrong : "(accepted)");
    check_contains("refused with its reason", wrong, part);
    check_int("column", column, at);
}

TEST(log_refused)
{
    const char *good = "(0000000000.001000) can0 123#1122";
    char text[LOG_LINE_MAX];
    struct log_line line;
    int64_t taken = 0;
    int column;
    refused("0.001 can0 123#1122", 1, "begins with (");
    refused("(.001000) can0 123#1122", 2, "seconds");
    refused("(0.001) can0 123#1122", 7, "6 digits");
    refused("(0.0010000) can0 123#1122", 11, "6 digits");
    refused("(0.0010000000) can0 123#1122", 13, "')' expected");
    refused("(0.001000)can0 123#1122", 11, "space");
    refused("(0.001000)  123#1122", 21, "space expected after the interface");
    refused("(0.001000) a_name_too_long_ 123#1122", 12, "interface");
    refused("(0.001000) can0 123", 20, "'#'");
    refused("(0.001000) can0 12#1122", 17, "3 or 8");
    refused("(0.001000) can0 1234#1122", 17, "3 or 8");
    refused("(0.001000) can0 FFF#1122", 17, "7FF");
    refused("(0.001000) can0 40000000#1122", 17, "1FFFFFFF");
    refused("(0.001000) can0 123#112", 24, "half");
    refused("(0.001000) can0 123#112233445566778899", 37, "more data bytes");
    refused("(0.001000) can0 123#1122 ", 25, "nothing after");
    refused("(0.001000) can0 123#1122 X", 25, "nothing after");
    refused("(0.001000) can0 123#11 22", 23, "nothing after");
    refused("", 1, "begins with (");
    for (size_t n = 0; n < strlen(good); n++) { /* every length, but those that end after a whole byte */
        memcpy(text, good, n);
        text[n] = 0;
        taken += log_parse(text, &line, &column) == NULL;
    }
    check_int("beginnings of a line that are lines themselves: 123# and 123#11", taken, 2);
    uint32_t random = 1;
    for (int i = 0; i < 100000; i++) { /* any bytes: no crash, nothing impossible */
        strcpy(text, good);
        for (int k = 0; k < 3; k++) {
            random = random * 1664525u + 1013904223u;
            text[(random >> 8) % strlen(good)] = (char)(random >> 24);
        }
        if (!log_parse(text, &line, &column))
            taken += line.frame.length > FRAME_DATA || line.fault < 0;
    }
    check_int("random lines parsed to something impossible", taken - 2, 0);
}

/* ---- recording ---- */

static void peer_sends(uint32_t id)
{
    struct frame f = {.id = id, .length = 1, .data = {0xAA}};
    bus.port[1].hal.send(bus.port[1].hal.context, &f);
}

static void plant_sends(uint32_t id)
{
    struct frame f = {.id = id, .length = 2, .data = {1, 2}};
    record.hal.send(record.hal.context, &f);
}

TEST(log_record)
{
    char text[512];
    struct frame f;
    make_file("");
    loopback_init(&bus, 2, 8);
    check_no_error("opens", log_open(&record, log_file, "plant0", &bus.port[0].hal));
    log_set_frame(&record, 3, 1e-3);
    peer_sends(0x241);
    peer_sends(0x254); /* a stray under telemetry */
    bus.port[0].fault = HAL_ERROR_PASSIVE;
    check_int("a fault goes through", record.hal.recv(record.hal.context, &f), -HAL_ERROR_PASSIVE);
    check_int("a frame goes through", record.hal.recv(record.hal.context, &f), 1);
    check_int("another one goes through", record.hal.recv(record.hal.context, &f), 1);
    check_int("none goes through", record.hal.recv(record.hal.context, &f), 0);
    plant_sends(0x254);
    bus.port[0].tx_limit = 1;
    plant_sends(0x255);
    record.hal.flush(record.hal.context);
    log_set_frame(&record, 4, 1e-3);
    log_missed(&record, 0);
    log_missed(&record, 3);
    plant_sends(0x256);
    bus.now_us = 77;
    check_int("the clock goes through", record.hal.now_us(record.hal.context), 77);
    record.hal.healthy(record.hal.context);
    check_int("healthy goes through", bus.port[0].healthy, 1);
    check_no_error("closes without error", log_close(&record));
    read_file(text, sizeof text);
    check_string("the file", text,
                 "(0000000001.003000) plant0 20000004#0000000000C10000\n"
                 "(0000000001.003000) plant0 20000004#0000000000080000\n"
                 "(0000000001.003000) plant0 241#AA\n"
                 "(0000000001.003000) plant0 20000004#0000000000C20000\n"
                 "(0000000001.003000) plant0 254#AA\n"
                 "(0000000001.003000) plant0 254#0102\n"
                 "(0000000001.003000) plant0 20000004#0002000000950000\n"
                 "(0000000001.004000) plant0 20000004#0300000000C00000\n"
                 "(0000000001.004000) plant0 256#0102\n");
    check_int("lines", (int64_t)record.lines, 9);
    static const enum log_way way[] = {LOG_UNKNOWN, LOG_RECEIVED, LOG_RECEIVED, LOG_SENT,
                                       LOG_NO_ROOM, LOG_OVERRUN,  LOG_SENT};
    struct log_reader r;
    struct log_line line;
    int n = 0;
    check_no_error("it is read", log_reader_open(&r, log_file));
    for (; log_read_line(&r, &line) > 0; n++)
        check_int("  the way", line.way, n < 7 ? (int)way[n] : -1);
    check_int("its lines without the words on ways", n, 7);
    log_reader_close(&r);
    unlink(log_file);
}

/* /dev/full takes no byte at all. */
TEST(log_full_disk)
{
    const char *reason;
    loopback_init(&bus, 1, 1);
    reason = log_open(&record, "/nosuchdir/x.log", "can0", &bus.port[0].hal);
    printf("%s\n", reason ? reason : "(opened)");
    check_contains("no such directory", reason, "cannot write /nosuchdir/x.log: No such file");
    reason = log_open(&record, "/dev/null", "can 0", &bus.port[0].hal);
    check_contains("bad interface name", reason, "no interface name");
    check_no_error("/dev/full opens", log_open(&record, "/dev/full", "can0", &bus.port[0].hal));
    int64_t first_error = 0, sent = 0, told = 0;
    for (int i = 1; i <= 5000; i++) {
        struct frame f = {.id = 0x254, .length = 8}, none;
        log_set_frame(&record, (uint64_t)i, 1e-3);
        int got = record.hal.recv(record.hal.context, &none);
        told += got == -HAL_LOG_ENDED;
        sent += record.hal.send(record.hal.context, &f);
        record.hal.flush(record.hal.context);
        if (log_error(&record) && !first_error)
            first_error = i;
    }
    check_int("the traffic goes on", sent, 5000);
    /* the first line has 51 bytes, each other one 46: more than 32768 are reached with frame 712 */
    check_int("found at the first write, when the buffer is half full", first_error, 712);
    check_int("and told to the plant, once", told, 1);
    check_int("every line is counted", (int64_t)(record.lines + record.lines_lost), 5001);
    check_int("as lost", (int64_t)record.lines_lost, 5001);
    reason = log_close(&record);
    printf("%s\n", reason ? reason : "(no error)");
    check_contains("reported", reason, "No space left on device");
}

static int64_t lines_until(const char *part)
{
    struct log_reader r;
    struct log_line line;
    int64_t n = 0;
    int got = log_reader_open(&r, log_file) ? -2 : 1;
    while (got > 0 && (got = log_read_line(&r, &line)) > 0)
        n++;
    if (part)
        printf("%s\n", r.reason);
    check_int(part ? "ends with an error" : "ends well", got, part ? -1 : 0);
    check_true("the reason", !part || strstr(r.reason, part));
    log_reader_close(&r);
    unlink(log_file);
    return n;
}

/* Bus frames of seven lines, 46 bytes each. */
static void record_frames(int n)
{
    const struct frame f = {.id = 0x254, .length = 8};
    for (int i = 0; i < n; i++) {
        log_set_frame(&record, (uint64_t)i, 1e-3);
        for (int k = 0; k < 7; k++)
            record.hal.send(record.hal.context, &f);
        record.hal.flush(record.hal.context);
    }
}

/* A limit of the file size takes part of a write and then none, as a disk that fills up does. Here it
 * takes a first line of 51 bytes, 102 of 46 and a piece of the next: 14 whole frames and a piece of the 15th.
 */
TEST(log_disk_fills_up)
{
    struct rlimit old, limit;
    make_file("");
    loopback_init(&bus, 1, 1);
    check_no_error("opens", log_open(&record, log_file, "can0", &bus.port[0].hal));
    getrlimit(RLIMIT_FSIZE, &old);
    limit = old;
    limit.rlim_cur = 51 + 102 * 46 + 17;
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit); /* nothing may be printed under the limit: output may be a file */
    record_frames(1000);
    const char *reason = log_close(&record);
    setrlimit(RLIMIT_FSIZE, &old);
    signal(SIGXFSZ, handler);
    printf("%s\n", reason ? reason : "(no error)");
    check_contains("reported", reason, "File too large; recorded 99 lines");
    check_int("lines recorded", (int64_t)record.lines, 99);
    check_int("lines lost", (int64_t)record.lines_lost, 7001 - 99);
    check_true("not by a limit of ours", !record.limited);
    check_int("the file ends with its last whole bus frame", lines_until(NULL), 98);
}

static int64_t file_size(void)
{
    FILE *f = fopen(log_file, "r");
    fseek(f, 0, SEEK_END);
    int64_t size = ftell(f);
    fclose(f);
    return size;
}

/* Every limit leaves whole frames, and as many as it has room
 * for; also where one frame has more lines than the buffer. */
TEST(log_limit)
{
    enum { FRAME = 7 * 46, FRAMES = 300, LONG = 3 * LOG_BUFFER / 46 };
    int64_t limit[] = {1,          FRAME - 1,         FRAME,           FRAME + 1,
                       50 * FRAME, 100 * FRAME + 200, 199 * FRAME - 1, FRAMES * FRAME};
    int wrong = 0;
    loopback_init(&bus, 1, 1);
    for (size_t i = 0; i < sizeof limit / sizeof limit[0]; i++) {
        make_file("");
        wrong += log_open(&record, log_file, "can0", &bus.port[0].hal) != NULL;
        record.limit = (uint64_t)limit[i];
        record.listens = true; /* no line but those of frames */
        record_frames(FRAMES);
        bool told = log_close(&record) != NULL;
        wrong += told != (limit[i] < FRAMES * FRAME) || record.limited != told;
        wrong += file_size() != limit[i] / FRAME * FRAME;
        wrong += record.lines != (uint64_t)(limit[i] / FRAME * 7) ||
                 record.lines + record.lines_lost != 7 * FRAMES;
        unlink(log_file);
    }
    check_int("limits that leave another file than their whole frames", wrong, 0);
    const struct frame f = {.id = 0x254, .length = 8};
    make_file("");
    check_no_error("opens", log_open(&record, log_file, "can0", &bus.port[0].hal));
    record.limit = 2 * LOG_BUFFER;
    record_frames(2);
    for (int i = 0; i < LONG; i++)
        record.hal.send(record.hal.context, &f);
    record.hal.flush(record.hal.context);
    check_error("a frame of more lines than the buffer, beyond the limit", log_close(&record));
    check_int("goes as a whole", lines_until(NULL), 7);
}

/* All kinds in one file, and two interfaces of which one is read. */
/* The log of a running plant is not that of another one, too. */
TEST(log_of_two)
{
    static struct log other;
    char text[512];
    make_file("of before\n");
    loopback_init(&bus, 2, 8);
    check_no_error("opens", log_open(&record, log_file, "plant0", &bus.port[0].hal));
    plant_sends(0x254);
    check_contains("a second one", log_open(&other, log_file, "plant0", &bus.port[0].hal),
                   "another process writes it");
    check_no_error("the first one ends", log_close(&record));
    (void)read_file(text, sizeof text);
    check_string("  whole", text,
                 "(0000000000.000000) plant0 20000004#0000000000C10000\n"
                 "(0000000000.000000) plant0 254#0102\n");
    check_no_error("then it is free", log_open(&other, log_file, "plant0", &bus.port[0].hal));
    check_no_error("  and ends", log_close(&other));
    unlink(log_file);
}

TEST(log_reader)
{
    static const int64_t count[LOG_KINDS] = {4, 2, 1, 1, 3, 1};
    struct log_reader r;
    struct log_line line;
    make_file("# recorded yesterday\n\n   \n(0.001000) can0 123#11\r\n(0.002000) can0 345##112\n"
              "(0.002000) can0 345##1\n(0.003000) can0 123#R\n(0.003000) can1 123#R\n"
              "(0.004000) can0 20000080#0000000000000000\n(0.005000) can0 123#1\nsome text\n"
              "(0.005000) can1 123#2233\n(0.006000) can0 123#2233\n(0.006000) can0 18DAF110#\n"
              "(0.006000) can0 20000040#0000000000000000\n");
    FILE *f = fopen(log_file, "a");
    for (int i = 0; i < 5000; i++)
        fputc('x', f);
    fputs("\n(0.007000) can0 123#1122334455667788", f);
    fclose(f);
    check_no_error("opens", log_reader_open(&r, log_file));
    r.interface = "can0";
    int n = 0;
    for (int twice = 0; twice < 2; twice++) {
        for (n = 0; log_read_line(&r, &line) > 0; n++)
            check_string("  its interface", line.interface, "can0");
        check_int("lines taken", n, 4);
        for (int k = 0; k < LOG_KINDS; k++)
            check_int("  lines of kind", (int64_t)r.count[k], count[k]);
        check_int("lines of the other interface", (int64_t)r.elsewhere, 2);
        check_string("the first damaged one", r.damage, "line 10, column 22: half a data byte");
        log_reader_rewind(&r);
    }
    log_reader_close(&r);
    unlink(log_file);
}

TEST(log_cut_off)
{
    struct log_reader r;
    const char *reason = log_reader_open(&r, "/nosuchdir/x.log");
    check_contains("no such log", reason, "cannot read /nosuchdir/x.log: No such file");
    make_file("(0.001000) can0 123#11\n(0.002000) can0 123#1122");
    check_int("a last line without its end is left out", lines_until(NULL), 1);
    make_file("(0.001000) can0 123#11\n(0.002000) ca");
    check_int("a last line cut in the middle", lines_until(NULL), 1);
    make_file("");
    check_int("an empty file", lines_until("no line of it is one of candump -L"), 0);
    make_file("# a comment\n\n");
    check_int("nothing but comments", lines_until("no line of it is one of candump -L"), 0);
    make_file("t_s,frame\n0.001,1\n");
    check_int("no log at all", lines_until("candump -L; line 1, column 1: a line begins with ("), 0);
    make_file("(0.001000) can0 123#1122");
    check_int("a line without end", lines_until("no line of it is one of candump -L"), 0);
    make_file("(0.001000) can0 123#R\n");
    check_int("frames of others alone are a log", lines_until(NULL), 0);
}
