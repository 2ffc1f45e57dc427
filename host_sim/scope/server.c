/* server.c - see server.h. */
#include "host_sim/scope/server.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { BACKLOG = 1024 };

static bool refuse_address(char *why, const char *at, const char *reason)
{
    snprintf(why, SERVER_REASON, "--http %s: %s", at, reason);
    return false;
}

/* ADDRESS:PORT or PORT. */
static bool read_address(const char *at, struct sockaddr_in *a)
{
    const char *colon = strrchr(at, ':'), *port = colon ? colon + 1 : at;
    char host[CONNECTION_ADDRESS] = "127.0.0.1", *end;
    if (colon && (size_t)(colon - at) < sizeof host)
        snprintf(host, sizeof host, "%.*s", (int)(colon - at), at);
    unsigned long number = strtoul(port, &end, 10);
    *a = (struct sockaddr_in){.sin_family = AF_INET, .sin_port = htons((uint16_t)number)};
    return *port >= '0' && *port <= '9' && !*end && number <= UINT16_MAX &&
           inet_pton(AF_INET, host, &a->sin_addr) == 1 && (!colon || (size_t)(colon - at) < sizeof host);
}

static bool listen_at(struct server *s, struct sockaddr_in *a)
{
    const int on = 1;
    socklen_t size = sizeof *a;
    s->socket = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    return s->socket >= 0 && !setsockopt(s->socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) &&
           !bind(s->socket, (struct sockaddr *)a, size) && !listen(s->socket, BACKLOG) &&
           !getsockname(s->socket, (struct sockaddr *)a, &size);
}

bool server_open(struct server *s, const char *at, char *why)
{
    struct sockaddr_in a;
    s->socket = -1;
    if (!read_address(at, &a))
        return refuse_address(why, at, "write ADDRESS:PORT with an address of IPv4, e.g. 127.0.0.1:8080");
    if (!listen_at(s, &a)) {
        bool taken = errno == EADDRINUSE;
        refuse_address(why, at, taken ? "this port is in use; choose another one" : strerror(errno));
        server_close(s);
        return false;
    }
    s->site.port = ntohs(a.sin_port);
    s->site.connection = s->connection;
    s->site.n_connections = SERVER_CONNECTIONS;
    s->site.streams_most = SERVER_STREAMS;
    s->site.streams_of_one = SERVER_STREAMS / 2;
    return inet_ntop(AF_INET, &a.sin_addr, s->site.bound, sizeof s->site.bound) != NULL;
}

bool server_is_local(const struct server *s)
{
    return !strncmp(s->site.bound, "127.", 4);
}

void server_describe(const struct server *s, char *text)
{
    bool every = !strcmp(s->site.bound, "0.0.0.0");
    snprintf(text, SERVER_REASON, "http://%s:%u/", every ? "127.0.0.1" : s->site.bound, s->site.port);
}

/* ---- places ---- */

static bool may_lose(const struct connection *c)
{
    return c->state == CONNECTION_READS || c->state == CONNECTION_ENDS || c->state == CONNECTION_ANSWERS;
}

static int places_of(const struct server *s, uint32_t address)
{
    int n = 0;
    for (int i = 0; i < SERVER_CONNECTIONS; i++)
        n += s->connection[i].state != CONNECTION_FREE && s->connection[i].address == address;
    return n;
}

/* Whether a loses its place before b: its address has more places. With as many, b is being answered and a is
 * not, or a came earlier. */
static bool goes_first(const struct server *s, const struct connection *a, const struct connection *b)
{
    int of_a = places_of(s, a->address), of_b = places_of(s, b->address);
    bool answered_a = a->state == CONNECTION_ANSWERS, answered_b = b->state == CONNECTION_ANSWERS;
    if (of_a != of_b)
        return of_a > of_b;
    return answered_a != answered_b ? answered_b : a->since_s < b->since_s;
}

/* One whose place a newer client takes hears so, if it was not answered and the kernel takes it at once. */
static void turn_away(struct server *s, struct connection *c)
{
    s->refused++;
    if (c->state == CONNECTION_READS)
        (void)send(c->socket, connection_no_room, strlen(connection_no_room), MSG_NOSIGNAL);
    connection_close(c, &s->site);
}

/* A free place, or the one that is made free. */
static struct connection *make_place(struct server *s)
{
    struct connection *last = NULL;
    for (int i = 0; i < SERVER_CONNECTIONS; i++) {
        struct connection *c = &s->connection[i];
        if (c->state == CONNECTION_FREE)
            return c;
        if (may_lose(c) && (!last || goes_first(s, c, last)))
            last = c;
    }
    if (last)
        turn_away(s, last);
    return last;
}

/* A request that has come already is read and answered at once: then it needs its place no more. */
static void take_client(struct server *s, int socket, uint32_t address)
{
    struct connection *c = make_place(s);
    if (!c || !connection_begin(c, socket, address)) { /* streams and commands leave some free */
        close(socket);
        return;
    }
    connection_receive(c, &s->site);
    connection_turn(c, &s->site);
}

static void take_clients(struct server *s)
{
    for (int n = 0; n < SERVER_ACCEPTS; n++) {
        struct sockaddr_in from = {0};
        socklen_t size = sizeof from;
        int socket = accept4(s->socket, (struct sockaddr *)&from, &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
        if (socket < 0) {
            s->rests = errno != EAGAIN && errno != EINTR && errno != ECONNABORTED;
            return;
        }
        take_client(s, socket, from.sin_addr.s_addr);
    }
}

void server_turn(struct server *s, int ms)
{
    struct pollfd p[SERVER_CONNECTIONS + 1];
    for (int i = 0; i < SERVER_CONNECTIONS; i++) {
        struct connection *c = &s->connection[i];
        connection_turn(c, &s->site);
        p[i] = (struct pollfd){.fd = c->state == CONNECTION_FREE ? -1 : c->socket,
                               .events = connection_listens(c) ? POLLIN : 0};
    }
    p[SERVER_CONNECTIONS] = (struct pollfd){.fd = s->rests ? -1 : s->socket, .events = POLLIN};
    s->rests = false;
    if (poll(p, SERVER_CONNECTIONS + 1, ms) <= 0)
        return;
    for (int i = 0; i < SERVER_CONNECTIONS; i++)
        if (p[i].revents)
            connection_receive(&s->connection[i], &s->site);
    if (p[SERVER_CONNECTIONS].revents)
        take_clients(s);
}

void server_send(struct server *s, const char *text, size_t n)
{
    site_send(&s->site, text, n);
}

void server_send_json(struct server *s, const struct json *j)
{
    site_send(&s->site, j->at, j->n);
}

void server_close(struct server *s)
{
    for (int i = 0; i < SERVER_CONNECTIONS; i++)
        connection_close(&s->connection[i], &s->site);
    if (s->socket >= 0)
        close(s->socket);
    s->socket = -1;
}
