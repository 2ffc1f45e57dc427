/* log.c - a candump log: every line is taken or named, and a
 * line that was taken says the same when it is written again. */
#include "hal/posix/log.h"
#include "hal/posix/log_read.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fixture/packet.h"

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static void write_again(const struct log_line *l)
{
    char text[LOG_LINE_MAX];
    struct log_line again;
    int column, n = log_format(text, l);
    MUST(n > 0 && n < LOG_LINE_MAX && text[n - 1] == '\n');
    text[n - 1] = '\0';
    MUST(!log_parse(text, &again, &column));
    MUST(again.time_us == l->time_us && again.fault == l->fault && !strcmp(again.interface, l->interface));
    MUST(again.way == (l->way < LOG_NO_ROOM ? LOG_UNKNOWN : l->way) || l->fault);
    MUST(again.missed == l->missed);
    MUST(l->fault || packet_same(&again.frame, &l->frame));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    int file = memfd_create("log", 0), got = 1;
    char path[40];
    struct log_reader r;
    struct log_line l;
    MUST(file >= 0 && write(file, data, size) == (ssize_t)size);
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    MUST(!log_reader_open(&r, path));
    for (size_t i = 0; i <= size && got == 1; i++) {
        got = log_read_line(&r, &l);
        if (got == 1)
            write_again(&l);
    }
    MUST(got != 1 && (got == 0 || r.reason[0]));
    log_reader_close(&r);
    close(file);
    return 0;
}
