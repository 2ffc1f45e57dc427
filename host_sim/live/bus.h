/* bus.h - opens the bus that the options name, as one struct hal, and records it when asked.
 *
 *   udp:PORT, udp:HOST:PORT   CAN frames in cannelloni packets; binds there (loopback unless HOST says
 *                             otherwise) and talks with the listed peers only
 *   can:IFACE                 a SocketCAN interface
 *   memory:FILE               memory that the plant shares with its one controller, in lockstep
 *                             (hal/posix/memory.h); "memory:": a file without a name
 *
 * By default a plant is at udp:20000 and speaks with 127.0.0.1:20001 (its controller), :20002 (a monitor) and
 * :20003 (contactplant send); these three speak with 127.0.0.1:20000. */
#ifndef HOST_SIM_BUS_H
#define HOST_SIM_BUS_H

#include "firmware/bus/wire.h"
#include "hal/link/faults.h"
#include "hal/posix/log.h"
#include "hal/posix/memory.h"
#include "hal/posix/socketcan.h"
#include "hal/posix/udp.h"
#include "host_sim/cli/options.h"

enum { BUS_REASON = 512, BUS_PEERS = 16 };

enum bus_role { BUS_PLANT, BUS_CONTROLLER, BUS_MONITOR, BUS_SENDER };

/* --bus and --peer. */
extern const struct option bus_options[];

/* One open bus. It must not be moved: its hal points into it. */
struct bus {
    struct hal hal; /* the one to use: the device, or the recorder around it */
    bool recording;
    enum { BUS_NONE, BUS_UDP, BUS_CAN, BUS_MEMORY } kind;
    const char *interface; /* name on CAN, and in the log */
    struct udp udp;
    struct socketcan can;
    struct memory memory;
    uint32_t n_plants;     /* whose identifiers follow each other; the owner sets it before opening. 0: one */
    struct faults *faults; /* NULL: none */
    struct log log;
    uint32_t strangers_told; /* by bus_news */
    bool peer_told[UDP_PEERS], malformed_told[UDP_PEERS], passed_over_told[UDP_PEERS], log_told;
};

/* Opens `spec` (see above) with these peers ("HOST:PORT"; UDP only). On CAN only the identifiers of
 * the scene are received. False: why[BUS_REASON] says what to do. */
bool bus_open(struct bus *b, const char *spec, const char *const *peer, int n_peers,
              const struct wire_scene *scene, char *why);

/* Checks how a bus and its peers are written: NULL, or the mistake. */
const char *bus_misspelt(const char *spec, const char *const *peer, int n_peers, enum bus_role role);

/* Opens what --bus and --peer say, with the role's defaults. 0, or the exit status after a line on stderr. */
int bus_open_options(struct bus *b, const struct options *o, enum bus_role role,
                     const struct wire_scene *scene);

/* "udp:20000", "can:can0": what it is, into text[BUS_REASON]. */
void bus_describe(const struct bus *b, char *text);

/* Faults of a list (host_sim/live/fault_list.h; "": none yet) between the device and everyone else, a
 * recording included. False: why says what to do. */
bool bus_add_faults(struct bus *b, const char *list, uint64_t seed, double frame_s, char *why);

/* Waits until something may have come, `seconds` at most,
 * less when a signal comes. `context` is the struct bus. */
void bus_wait(void *context, double seconds);

/* The listed peer i as HOST:PORT, or who has the memory; into text[BUS_REASON]. */
void bus_describe_peer(const struct bus *b, int i, char *text);

/* Records everything that is received and sent from now on into a candump log of at most `limit` bytes; 0: no
 * limit. False: why says what to do. */
bool bus_record(struct bus *b, const char *path, uint64_t limit, char *why);

/* Tells the recorder that all that follows belongs to this bus frame, before which `missed` frame periods
 * were missed. */
void bus_set_frame(struct bus *b, uint64_t frame, double frame_s, uint32_t missed);

/* The next piece of news of the link, as a line of text for stderr; false when there is no more. News are
 * a sender that is not listed, a peer that cannot be sent to, sends malformed packets or frames that no plant
 * takes, and a recording that has ended. */
bool bus_news(struct bus *b, char text[BUS_REASON]);

/* Ends the recording, if any: false when the file is not
 * complete (disk full, but not its limit), and why says so. */
bool bus_end_record(struct bus *b, char *why);

/* Ends the recording silently and closes. */
void bus_close(struct bus *b);

#endif
