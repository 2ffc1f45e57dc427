/* log_read.h - reads logs, those of others too: of candump, or pcapng (pcapng.h). */
#ifndef HAL_LOG_READ_H
#define HAL_LOG_READ_H

#include "hal/posix/log.h"
#include "hal/posix/pcapng.h"

/* Parses one line without its line end: its kind is in *out. NULL, or for LOG_DAMAGED the reason why it is
 * none at *column (from 1). Accepted beyond the own form, for candump writes them: lower-case digits, several
 * blanks before the interface, nanoseconds, a raw length ("_B") behind 8 bytes, " R" or " T" at the end. So
 * is the form that candump shows without -L, with a time in seconds or without. Pure. */
const char *log_parse(const char *text, struct log_line *out, int *column);

/* Reads a log line by line. */
struct log_reader {
    FILE *file;
    struct pcapng *packets; /* NULL: lines of text. Else a line is a packet */
    const char *path;
    uint64_t line;               /* number of the last line read, from 1 */
    const char *interface;       /* read its lines only; NULL: all. Set it after log_reader_open */
    uint64_t count[LOG_KINDS];   /* lines so far */
    uint64_t elsewhere;          /* and lines of other interfaces */
    bool of_plant;               /* LOG_BEGIN was read: identifiers tell the ways */
    bool turned;                 /* the next frame went against its identifier */
    char damage[LOG_REASON / 2]; /* why the first damaged line is none */
    char reason[LOG_REASON];
};

/* NULL, or the reason. The bytes of a pipe are kept in a file. `path` must stay valid. */
const char *log_reader_open(struct log_reader *r, const char *path);

/* 1 and *out filled with the next line of LOG_DATA, its way known if the log tells it. The other kinds are
 * passed over and counted; empty lines and those that begin with '#' are passed over. 0 at the end of the
 * file. -1 when it cannot be read, or at its end when no line was one of candump: then r->reason says so. */
int log_read_line(struct log_reader *r, struct log_line *out);

/* As log_read_line, but lines of all kinds except LOG_DAMAGED and LOG_CUT, and the recorder's words. */
int log_read_any(struct log_reader *r, struct log_line *out);

/* Back to the first line. */
void log_reader_rewind(struct log_reader *r);

void log_reader_close(struct log_reader *r);

/* A place between two lines, to come back to. */
struct log_place {
    long offset;           /* bytes from the begin of the file */
    uint64_t line;         /* number of the line before */
    bool of_plant, turned; /* as in struct log_reader */
    struct pcapng packets; /* the section, where the log has packets */
};

/* Where the reader is. */
void log_reader_tell(const struct log_reader *r, struct log_place *p);

/* Goes back there, or on to there. False when the file cannot be read. */
bool log_reader_seek(struct log_reader *r, const struct log_place *p);

#endif
