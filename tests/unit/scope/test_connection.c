/* test_connection.c - streams of the server: whole for a
 * client that keeps pace, ended for one that does not. */
#include "host_sim/scope/connection.h"
#include "tests/unit/test.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { EVENT = 1000, EVENTS = 5000 }; /* bytes of one; nearly five times of what one may be behind */

static struct site *site;
static struct connection *connection;
static int client;

static void greet(void *context, struct json *j)
{
    (void)context;
    json_put(j, "hello\n\n");
}

static void begin_site(void)
{
    site = site ? site : calloc(1, sizeof *site);
}

static void begin_request(const char *request)
{
    int pair[2];
    begin_site();
    connection = calloc(1, sizeof *connection);
    site->greet = greet;
    check_int("sockets", socketpair(AF_UNIX, SOCK_STREAM, 0, pair), 0);
    client = pair[1];
    for (int i = 0; i < 2; i++)
        (void)fcntl(pair[i], F_SETFL, O_NONBLOCK);
    site->streams_most = site->streams_of_one = 1;
    site->connection = connection;
    site->n_connections = 1;
    check_true("begins", connection_begin(connection, pair[0], 0));
    check_int("the request goes", (int)write(client, request, strlen(request)), (int)strlen(request));
    connection_receive(connection, site);
}

static void end_request(void)
{
    connection_close(connection, site);
    close(client);
    free(site);
    site = NULL;
    free(connection);
}

/* Event k: its number, then letters that depend on it. */
static void make_event(int k, char *text)
{
    memset(text, 'a' + k % 26, EVENT);
    snprintf(text, EVENT, "%08d", k);
    text[8] = ' ';
    text[EVENT - 2] = text[EVENT - 1] = '\n';
}

/* Bytes of all that came which are not those of the stream, beginning with `next`, the number expected. */
static int read_events(int *next, size_t *n_part, char *part)
{
    char wanted[EVENT];
    int wrong = 0;
    for (ssize_t n; (n = read(client, part + *n_part, EVENT - *n_part)) > 0;) {
        *n_part += (size_t)n;
        if (*n_part < EVENT)
            continue;
        make_event((*next)++, wanted);
        wrong += memcmp(part, wanted, EVENT) != 0;
        *n_part = 0;
    }
    return wrong;
}

/* The answer's head and the greeting. */
static void read_greeting(void)
{
    char head[4096] = "";
    connection_turn(connection, site);
    size_t n = 0;
    while (n < sizeof head - 1 && !strstr(head, "hello\n\n") && read(client, head + n, 1) == 1)
        n++;
    check_contains("status", head, "HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\n");
    check_true("greeting", n > 0 && strstr(head, "\r\n\r\nretry: 1000\n\nhello\n\n"));
}

TEST(connection_stream_is_whole)
{
    char text[EVENT], part[EVENT];
    int next = 0, wrong = 0;
    size_t n_part = 0;
    begin_request("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    read_greeting();
    for (int k = 0; k < EVENTS; k++) {
        make_event(k, text);
        site_send(site, text, EVENT);
        connection_turn(connection, site);
        if (k % 40 == 0 || k == EVENTS - 1)
            wrong += read_events(&next, &n_part, part);
    }
    for (int i = 0; i < 100; i++) {
        connection_turn(connection, site);
        wrong += read_events(&next, &n_part, part);
    }
    check_int("events that came", next, EVENTS);
    check_int("of these wrong", wrong, 0);
    check_int("dropped", (int)site->dropped, 0);
    check_int("streams", (int)site->streams, 1);
    end_request();
}

/* A new stream with the past has all that the ring holds, event by event, and goes on. */
TEST(connection_past_is_whole)
{
    char text[EVENT], part[EVENT];
    int all = SITE_RING / EVENT + 3456, wrong = 0;
    int first = (int)(((uint64_t)all * EVENT - (SITE_RING - SITE_BEHIND)) / EVENT) + 1, next = first;
    size_t n_part = 0;
    begin_site();
    for (int k = 0; k < all; k++) {
        make_event(k, text);
        site_send(site, text, EVENT);
    }
    begin_request("GET /events?past HTTP/1.1\r\nHost: localhost\r\n\r\n");
    read_greeting();
    for (int k = 0; k < 2 * SITE_RING / CONNECTION_SEND_BUFFER && connection->state == CONNECTION_STREAMS;
         k++) {
        wrong += read_events(&next, &n_part, part);
        connection_turn(connection, site);
        make_event(all, text);
        if (k % 100 == 0)
            site_send(site, text, EVENT);
        all += k % 100 == 0;
    }
    check_int("events that came", next - first, all - first);
    check_int("of these wrong", wrong, 0);
    check_true("it has caught up", !connection->in_past);
    end_request();
}

TEST(connection_slow_stream_ends)
{
    char text[EVENT], part[EVENT];
    int next = 0, k;
    size_t n_part = 0;
    begin_request("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    read_greeting();
    for (k = 0; k < EVENTS && connection->state == CONNECTION_STREAMS; k++) {
        make_event(k, text);
        site_send(site, text, EVENT);
        connection_turn(connection, site);
    }
    check_is("events until it is dropped", k, >, SITE_BEHIND / EVENT);
    check_is("and no ring more", k, <, EVENTS);
    check_int("dropped", (int)site->dropped, 1);
    check_int("streams", (int)site->streams, 0);
    check_int("wrong ones among what it has", read_events(&next, &n_part, part), 0);
    check_int("then the end", (int)read(client, text, 1), 0);
    end_request();
}

TEST(connection_answers_and_ends)
{
    char text[4096] = "";
    begin_request("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n");
    connection_turn(connection, site);
    check_is("an answer", read(client, text, sizeof text - 1), >, 0);
    check_contains("refused", text, "HTTP/1.1 421 Misdirected Request\r\n");
    check_int("no more", (int)read(client, text, 1), 0);
    check_int("it waits for the client's end", connection->state, CONNECTION_ENDS);
    shutdown(client, SHUT_WR);
    connection_receive(connection, site);
    check_int("free", connection->state, CONNECTION_FREE);
    end_request();
}

/* A client that was answered and goes on sending is read up to a bound. */
TEST(connection_endless_body_ends)
{
    static char junk[1 << 16];
    int64_t sent = 0;
    begin_request("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n");
    for (int i = 0; i < 1000 && connection->state != CONNECTION_FREE; i++) {
        ssize_t n = write(client, junk, sizeof junk);
        sent += n > 0 ? n : 0;
        connection_receive(connection, site);
        connection_turn(connection, site);
    }
    check_int("ended", connection->state, CONNECTION_FREE);
    check_is("after all that is read, bytes", sent, >, CONNECTION_DRAIN);
    check_is("and no more than what lies in the sockets", sent, <, 2 * CONNECTION_DRAIN);
    end_request();
}

/* A client that has ended its side gets its answer, and its connection is no stream any more when that has
 * ended. */
TEST(connection_half_closed_gets_its_answer)
{
    char text[4096] = "";
    begin_request("GET /nosuch HTTP/1.1\r\nHost: localhost\r\n\r\n");
    shutdown(client, SHUT_WR);
    connection_receive(connection, site);
    check_true("nothing more is read", !connection_listens(connection));
    connection_turn(connection, site);
    check_is("an answer", read(client, text, sizeof text - 1), >, 0);
    check_contains("its status", text, "HTTP/1.1 404 Not Found\r\n");
    check_int("free", connection->state, CONNECTION_FREE);
    end_request();
}

TEST(connection_streams_are_counted)
{
    char text[4096] = "";
    begin_request("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    read_greeting();
    check_int("streams", (int)site->streams, 1);
    close(client);
    connection_receive(connection, site);
    check_int("when it has left", (int)site->streams, 0);
    end_request();
    begin_request("GET /ev");
    site->streams = 1;
    check_is("the rest", write(client, "ents HTTP/1.1\r\nHost: localhost\r\n\r\n", 34), ==, 34);
    connection_receive(connection, site);
    connection_turn(connection, site);
    check_is("an answer", read(client, text, sizeof text - 1), >, 0);
    check_contains("no stream more than allowed", text,
                   "503 Service Unavailable: all streams of the scope are taken");
    end_request();
}
