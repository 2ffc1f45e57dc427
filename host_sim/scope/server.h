/* server.h - the page and its events over HTTP: a fixed number of connections, and nobody is waited for.
 *
 * A new client always finds a place. When all are taken, the address that has most of them loses its oldest
 * connection that has neither a stream nor a command. Streams take at most SERVER_STREAMS places, and those
 * of one address half as many: whoever keeps connections open denies nobody a command or a page. */
#ifndef HOST_SIM_SERVER_H
#define HOST_SIM_SERVER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "host_sim/scope/connection.h"

enum {
    SERVER_CONNECTIONS = 256, /* requests and streams at a time; memory is taken by those in use */
    SERVER_STREAMS = 48,
    SERVER_ACCEPTS = 256, /* connections taken in one turn */
    SERVER_REASON = 256
};

struct server {
    int socket; /* -1: not open */
    bool rests; /* no connection could be taken: none is asked for in the next turn */
    struct site site;
    struct connection connection[SERVER_CONNECTIONS];
    uint32_t refused; /* connections whose place another one took */
};

/* Listens at "ADDRESS:PORT" or "PORT" of IPv4; port 0: the kernel chooses. False: why[SERVER_REASON] says
 * what to do. */
bool server_open(struct server *s, const char *at, char *why);

/* The address to open in a browser, into text[SERVER_REASON]. */
void server_describe(const struct server *s, char *text);

/* True where only this machine can come in. */
bool server_is_local(const struct server *s);

/* One event for every stream. */
void server_send(struct server *s, const char *text, size_t n);
void server_send_json(struct server *s, const struct json *j);

/* Serves whoever wants something, and waits at most `ms` for it. */
void server_turn(struct server *s, int ms);

void server_close(struct server *s);

#endif
