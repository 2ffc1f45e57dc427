/* pcapng.h - packets of a pcapng file (draft-ietf-opsawg-pcapng) that hold SocketCAN frames: link type 227.
 *
 * Written: one section, little endian, one description for each interface, stamps in nanoseconds, the way of
 * a frame as epb_flags, and a comment where there is one. wireshark, tshark, capinfos, editcap and tcpdump
 * read it.
 *
 * Read: sections of either byte order and any resolution of stamps. A packet becomes the line that candump -L
 * would have written of it, so that log.h has one parser. Packets of other links, and blocks that are not
 * known, are passed over. */
#ifndef HAL_PCAPNG_H
#define HAL_PCAPNG_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include "hal/posix/log.h"

enum {
    PCAPNG_INTERFACES = 8,
    PCAPNG_LINE = 256 /* bytes of a line of candump, the last one is 0 */
};

/* A section, as far as it is read. */
struct pcapng {
    bool swapped; /* the file has the other byte order */
    uint32_t n_interfaces;
    struct pcapng_interface {
        char name[LOG_INTERFACE];
        bool is_can;
        bool binary;   /* the resolution is a power of 2, else of 10 */
        uint8_t power; /* 10^-power or 2^-power seconds */
    } interface[PCAPNG_INTERFACES];
};

enum pcapng_got { PCAPNG_PACKET, PCAPNG_END, PCAPNG_CUT, PCAPNG_DAMAGED };

/* The begin of a file: `program` is who writes it, then the names of its interfaces. The caller looks at
 * ferror. */
void pcapng_begin(FILE *f, const char *program, const char *const *interface, int n);

/* A frame of interface i at its time; `comment` is "" for none. */
void pcapng_put(FILE *f, int i, uint64_t time_us, enum log_way way, const struct log_raw *raw,
                const char *comment);

/* Whether the file, read from its begin, is one; it is at its begin again. */
bool pcapng_is(FILE *f);

/* The next packet of a CAN bus as a line of candump -L without its end. *why is what is damaged. */
enum pcapng_got pcapng_next(struct pcapng *p, FILE *f, char text[PCAPNG_LINE], const char **why);

#endif
