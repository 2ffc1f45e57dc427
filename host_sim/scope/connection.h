/* connection.h - one client of the server: its request, the answer, and the stream of events. It never waits.
 *
 * A client that ends its side of the connection gets its whole answer. While it waits for what a command
 * says, an empty line each second asks whether it is still there.
 *
 * Every stream says the same. The text stands in one ring, and each connection has a place in it. "?past"
 * begins with all that is still there. A client that falls behind by SITE_BEHIND after it has caught up is
 * dropped. So is one that takes nothing for CONNECTION_PATIENCE_S while something waits. */
#ifndef HOST_SIM_CONNECTION_H
#define HOST_SIM_CONNECTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "host_sim/scope/page_send.h"
#include "host_sim/scope/http.h"
#include "host_sim/out/json.h"

enum {
    CONNECTION_FIRST = 1 << 19, /* bytes of an answer's head, and of a stream before it reads the ring */
    CONNECTION_SEND_BUFFER = 1 << 17, /* asked for in the kernel */
    CONNECTION_TURN = 1 << 18,        /* bytes sent in one turn */
    CONNECTION_DRAIN = 1 << 20, /* bytes of a refused request that are read, so that the answer arrives */
    CONNECTION_ADDRESS = 64,
    SITE_BEHIND = 1 << 20,
    SITE_RING = 1 << 26 /* over ten minutes of default telemetry; memory is taken as it fills */
};

#define CONNECTION_PATIENCE_S 5.0 /* for a request to come, and for a byte to be taken */
#define CONNECTION_GOODBYE_S  1.0 /* for a client that was answered to hang up */
#define CONNECTION_ASK_S      1.0 /* between two empty lines to a client that has ended its side */

/* Shared by all connections. */
struct site {
    char bound[CONNECTION_ADDRESS]; /* the address that the server listens at */
    uint16_t port;
    char ring[SITE_RING];
    uint64_t written;                    /* bytes ever written into the ring */
    uint32_t streams, dropped;           /* open now; slow readers that were ended */
    uint32_t streams_most;               /* that may be open at a time, ... */
    uint32_t streams_of_one;             /* ... and of one address */
    const struct connection *connection; /* all of the server, to count the streams of an address */
    int n_connections;
    void (*greet)(void *context, struct json *j); /* writes what a new stream has first */
    /* Where recorded logs are shown, and there is no stream: writes the answer to a target. HTTP_OK,
     * HTTP_NOT_FOUND for a target that it does not know, or another status, whose reason is *why. */
    enum http_status (*ask)(void *context, const struct http_request *r, struct json *j, const char **why);
    void *context;
    struct page_send control; /* without a token: no command is taken */
};

struct connection {
    enum {
        CONNECTION_FREE,
        CONNECTION_READS,
        CONNECTION_ANSWERS,
        CONNECTION_COMMANDS, /* it gets what its command says */
        CONNECTION_STREAMS,
        CONNECTION_ENDS
    } state;
    int socket;
    double since_s, until_s;        /* when it came; the end of its time, unless something goes on */
    bool is_half_closed;            /* the client says nothing more */
    double ask_s;                   /* when such a client is asked again whether it is there */
    uint32_t address;               /* the client's, of IPv4, in network order */
    char local[CONNECTION_ADDRESS]; /* the address by which it came in */
    char request[HTTP_REQUEST];
    size_t n_request, drained;
    char *first; /* [CONNECTION_FIRST], sent before anything else; NULL in a free one */
    size_t n_first, first_sent;
    const char *body; /* a page, sent after it */
    size_t n_body, body_sent;
    uint64_t place;   /* a stream: how much of all that was written it was sent */
    bool in_past;     /* it has not caught up yet */
    int plant;        /* that it commands */
    uint32_t command; /* its number; see control.h */
};

/* A client that has just come from this address (IPv4, in network order), on a socket that does not block.
 * False: out of memory; the socket stays the caller's. */
bool connection_begin(struct connection *c, int socket, uint32_t address);

/* True where data from it are of interest: it is there and has not ended its side. */
bool connection_listens(const struct connection *c);

/* Something came from it: data, its end, or a reset. */
void connection_receive(struct connection *c, struct site *s);

/* Sends what waits, and ends what has had its time. */
void connection_turn(struct connection *c, struct site *s);

void connection_close(struct connection *c, struct site *s);

/* One event for every stream. */
void site_send(struct site *s, const char *text, size_t n);

/* The answer to a client for which there is no room, whole. */
extern const char connection_no_room[];

#endif
