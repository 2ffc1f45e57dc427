/* connection.c - see connection.h. */
#include "host_sim/scope/connection.h"
#include "host_sim/cli/clock.h"
#include "host_sim/report/page.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { SENTENCE = 512, SCRAP = 16384 };

#define ALWAYS                                                                                               \
    "Connection: close\r\n"                                                                                  \
    "Cache-Control: no-store\r\n"                                                                            \
    "X-Content-Type-Options: nosniff\r\n"                                                                    \
    "Referrer-Policy: no-referrer\r\n"                                                                       \
    "Cross-Origin-Resource-Policy: same-origin\r\n"                                                          \
    "Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; " \
    "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n"

const char connection_no_room[] =
    "HTTP/1.1 503 Service Unavailable\r\n"
    "Content-Type: text/plain; charset=utf-8\r\n" ALWAYS "\r\n"
    "503 Service Unavailable: every connection of the scope is taken; close one "
    "and try again\n";

bool connection_begin(struct connection *c, int socket, uint32_t address)
{
    struct sockaddr_in at = {0};
    socklen_t size = sizeof at;
    const int room = CONNECTION_SEND_BUFFER;
    c->first = malloc(CONNECTION_FIRST);
    if (!c->first)
        return false;
    c->state = CONNECTION_READS;
    c->socket = socket;
    c->address = address;
    c->is_half_closed = false;
    c->since_s = clock_now_s();
    c->until_s = c->since_s + CONNECTION_PATIENCE_S;
    c->body = "";
    c->n_request = c->drained = c->n_first = c->first_sent = c->n_body = c->body_sent = 0;
    (void)setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &room, sizeof room);
    (void)getsockname(socket, (struct sockaddr *)&at, &size);
    if (!inet_ntop(AF_INET, &at.sin_addr, c->local, sizeof c->local))
        c->local[0] = '\0';
    return true;
}

void connection_close(struct connection *c, struct site *s)
{
    s->streams -= c->state == CONNECTION_STREAMS;
    if (c->state == CONNECTION_COMMANDS)
        page_send_leave(&s->control, c->plant, c->command);
    if (c->state != CONNECTION_FREE)
        close(c->socket);
    free(c->first);
    c->first = NULL;
    c->state = CONNECTION_FREE;
}

/* ---- answers ---- */

static void begin_answer(struct connection *c)
{
    c->state = CONNECTION_ANSWERS;
    c->until_s = clock_now_s() + CONNECTION_PATIENCE_S;
}

/* One sentence. */
static void answer_sentence(struct connection *c, enum http_status status, const char *why, bool head)
{
    char sentence[SENTENCE];
    int n = snprintf(sentence, sizeof sentence, "%d %s: %s\n", (int)status, http_phrase(status), why);
    c->n_first =
        (size_t)snprintf(c->first, CONNECTION_FIRST,
                         "HTTP/1.1 %d %s\r\nContent-Type: text/plain; charset=utf-8\r\n"
                         "Content-Length: %d\r\n%s" ALWAYS "\r\n%s",
                         (int)status, http_phrase(status), n,
                         status == HTTP_NOT_ALLOWED ? "Allow: GET, HEAD\r\n" : "", head ? "" : sentence);
    begin_answer(c);
}

static void answer_file(struct connection *c, const struct page_file *f, bool head)
{
    size_t n = (size_t)(f->end - f->begin);
    c->n_first = (size_t)snprintf(
        c->first, CONNECTION_FIRST,
        "HTTP/1.1 200 OK\r\nContent-Type: %s\r\nContent-Length: %zu\r\n" ALWAYS "\r\n", f->type, n);
    c->body = f->begin;
    c->n_body = head ? 0 : n;
    begin_answer(c);
}

/* The answer is that of site.ask. */
static void answer_question(struct connection *c, const struct site *s, const struct http_request *r)
{
    static const char head[] =
        "HTTP/1.1 200 OK\r\nContent-Type: application/json; charset=utf-8\r\n" ALWAYS "\r\n";
    const size_t n = sizeof head - 1;
    const char *why = "there is / and /log";
    struct json j;
    memcpy(c->first, head, n);
    json_begin(&j, c->first + n, CONNECTION_FIRST - n);
    enum http_status status = s->ask(s->context, r, &j, &why);
    if (status != HTTP_OK) {
        answer_sentence(c, status, why, r->head);
        return;
    }
    c->n_first = n + (r->head ? 0 : j.n);
    begin_answer(c);
}

/* NULL: one more stream may begin for the client. */
static const char *no_stream(const struct connection *c, const struct site *s)
{
    uint32_t own = 0;
    for (int i = 0; i < s->n_connections; i++)
        own += s->connection[i].state == CONNECTION_STREAMS && s->connection[i].address == c->address;
    if (s->streams >= s->streams_most)
        return "all streams of the scope are taken; close a page that shows it and try again";
    return own < s->streams_of_one ? NULL
                                   : "this address has all streams that one may have; close a page that "
                                     "shows the scope and try again";
}

/* The first event that will stay in the ring for a while. */
static uint64_t begin_of_past(const struct site *s)
{
    uint64_t at = s->written > SITE_RING - SITE_BEHIND ? s->written - (SITE_RING - SITE_BEHIND) : 0;
    bool found = at == 0;
    for (; !found && at < s->written; at++)
        found = s->ring[at % SITE_RING] == '\n' && s->ring[(at - 1) % SITE_RING] == '\n';
    return at;
}

static void answer_stream(struct connection *c, struct site *s, bool head, bool past)
{
    struct json j;
    const char *why = head ? NULL : no_stream(c, s);
    if (why) {
        answer_sentence(c, HTTP_FULL, why, false);
        return;
    }
    json_begin(&j, c->first, CONNECTION_FIRST);
    json_put(&j, "HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\n%r\r\n", ALWAYS);
    begin_answer(c);
    if (!head) {
        json_put(&j, "retry: 1000\n\n");
        s->greet(s->context, &j);
        c->place = past ? begin_of_past(s) : s->written;
        c->in_past = past;
        c->state = CONNECTION_STREAMS;
        s->streams++;
    }
    c->n_first = j.n;
}

/* The plant of a target HTTP_COMMAND and its number; -1: there is none. */
static int commanded_plant(const struct site *s, const char *target)
{
    double i;
    bool good = options_read_number(target + strlen(HTTP_COMMAND), &i) && i >= 0.0 && i < s->control.n_plants;
    return good && i == (int)i ? (int)i : -1;
}

/* Its command's words follow piece by piece, up to the end of the connection. */
static void answer_command(struct connection *c, struct site *s, const struct http_request *r)
{
    const char *why;
    c->plant = commanded_plant(s, r->target);
    if (c->plant < 0) {
        answer_sentence(c, HTTP_NOT_FOUND, "write " HTTP_COMMAND " and the number of a plant, from 0", false);
        return;
    }
    c->command = page_send_begin(&s->control, c->plant, r->body, r->n_body, &why);
    if (!c->command) {
        answer_sentence(c, HTTP_BAD, why, false);
        return;
    }
    c->n_first =
        (size_t)snprintf(c->first, CONNECTION_FIRST,
                         "HTTP/1.1 200 OK\r\nContent-Type: text/plain; charset=utf-8\r\n" ALWAYS "\r\n");
    begin_answer(c);
    c->state = CONNECTION_COMMANDS;
}

/* A POST from this machine: whether it may command. */
static void judge_command(struct connection *c, struct site *s, const struct http_request *r)
{
    if (!s->control.token[0])
        answer_sentence(c, HTTP_NOT_ALLOWED, HTTP_ONLY_LOOKS, false);
    else if (!http_origin_is_ours(r))
        answer_sentence(c, HTTP_FORBIDDEN, "a page of another site may not command the plant", false);
    else if (!http_token_is(r->token, s->control.token))
        answer_sentence(c, HTTP_FORBIDDEN, "a command needs the token that the scope printed", false);
    else
        answer_command(c, s, r);
}

static void answer(struct connection *c, struct site *s, const struct http_request *r)
{
    const struct page_file *f = page_find(r->target, s->ask != NULL);
    bool hidden = f == &page_file[PAGE_CONTROL] && !s->control.token[0];
    char why[SENTENCE];
    if (!http_host_is_ours(r->host, s->bound, c->local)) {
        snprintf(why, sizeof why, "the header Host names another machine; open http://%s:%u/", c->local,
                 s->port);
        answer_sentence(c, HTTP_MISDIRECTED, why, r->head);
    } else if (r->post)
        judge_command(c, s, r);
    else if (f && !hidden)
        answer_file(c, f, r->head);
    else if (s->ask)
        answer_question(c, s, r);
    else if (!strcmp(r->target, "/events"))
        answer_stream(c, s, r->head, !strcmp(r->query, "past"));
    else
        answer_sentence(c, HTTP_NOT_FOUND, "there is / and /events", r->head);
}

/* ---- what comes ---- */

static void read_request(struct connection *c, struct site *s)
{
    struct http_request r;
    ssize_t n = recv(c->socket, c->request + c->n_request, sizeof c->request - c->n_request, 0);
    if (n < 0) {
        if (errno != EAGAIN && errno != EINTR)
            connection_close(c, s);
        return;
    }
    c->n_request += (size_t)n;
    enum http_status status = http_parse(c->request, c->n_request, &r);
    if (status == HTTP_OK)
        answer(c, s, &r);
    else if (status != HTTP_MORE)
        answer_sentence(c, status, r.why, false);
    else if (n == 0)
        answer_sentence(c, HTTP_BAD, "the request ends before it is whole", false);
}

/* A client that has its answer: what it still says is of no interest, its end is. */
static void read_scraps(struct connection *c, struct site *s)
{
    char scrap[SCRAP];
    ssize_t n = recv(c->socket, scrap, sizeof scrap, 0);
    bool is_alive = n > 0 || (n < 0 && (errno == EAGAIN || errno == EINTR));
    c->drained += n > 0 ? (size_t)n : 0;
    if (n == 0 && (c->state == CONNECTION_ANSWERS || c->state == CONNECTION_COMMANDS)) {
        c->is_half_closed = true; /* it may still read */
        c->ask_s = clock_now_s();
    } else if (!is_alive || c->drained > CONNECTION_DRAIN)
        connection_close(c, s);
}

bool connection_listens(const struct connection *c)
{
    return c->state != CONNECTION_FREE && !c->is_half_closed;
}

void connection_receive(struct connection *c, struct site *s)
{
    if (c->is_half_closed) {
        connection_close(c, s); /* only its reset wakes us */
        return;
    }
    if (c->state == CONNECTION_READS)
        read_request(c, s);
    else if (c->state != CONNECTION_FREE)
        read_scraps(c, s);
}

/* ---- sending ---- */

/* Sends of these bytes what the kernel takes: how many, -1 when the client is gone. */
static ssize_t send_some(struct connection *c, const char *bytes, size_t n)
{
    ssize_t sent = n ? send(c->socket, bytes, n, MSG_NOSIGNAL) : 0;
    if (sent < 0)
        return errno == EAGAIN || errno == EINTR ? 0 : -1;
    if (sent > 0)
        c->until_s = clock_now_s() + CONNECTION_PATIENCE_S;
    return sent;
}

/* The next piece of what waits for this client; its length, 0 when nothing does. */
static size_t next_piece(const struct connection *c, const struct site *s, const char **piece)
{
    if (c->first_sent < c->n_first) {
        *piece = c->first + c->first_sent;
        return c->n_first - c->first_sent;
    }
    if (c->state != CONNECTION_STREAMS) {
        *piece = c->body + c->body_sent;
        return c->n_body - c->body_sent;
    }
    size_t at = (size_t)(c->place % SITE_RING), n = (size_t)(s->written - c->place);
    *piece = s->ring + at;
    return n < SITE_RING - at ? n : SITE_RING - at;
}

static void note_sent(struct connection *c, size_t n)
{
    if (c->first_sent < c->n_first)
        c->first_sent += n;
    else if (c->state == CONNECTION_STREAMS)
        c->place += n;
    else
        c->body_sent += n;
}

/* False when the client is gone. */
static bool send_waiting(struct connection *c, const struct site *s)
{
    const char *piece;
    for (size_t total = 0; total < CONNECTION_TURN;) {
        size_t n = next_piece(c, s, &piece);
        ssize_t sent = send_some(c, piece, n);
        if (sent <= 0)
            return sent == 0;
        note_sent(c, (size_t)sent);
        total += (size_t)sent;
    }
    return true;
}

static void turn_stream(struct connection *c, struct site *s)
{
    bool late = s->written - c->place > (c->in_past ? SITE_RING : SITE_BEHIND);
    bool alive = !late && send_waiting(c, s);
    if (alive && c->first_sent == c->n_first && c->place == s->written) {
        c->until_s = clock_now_s() + CONNECTION_PATIENCE_S;
        c->in_past = false;
    }
    if (late || (alive && clock_now_s() > c->until_s)) {
        s->dropped++;
        alive = false;
    }
    if (!alive)
        connection_close(c, s);
}

/* A client that has left answers an empty line with a reset. */
static void ask_whether_there(struct connection *c)
{
    double now = clock_now_s();
    if (!c->is_half_closed || c->n_first > 0 || now < c->ask_s)
        return;
    c->first[c->n_first++] = '\n';
    c->ask_s = now + CONNECTION_ASK_S;
}

/* More of what the command says, once all before is sent. A browser that takes nothing is no listener. */
static void turn_command(struct connection *c, struct site *s)
{
    bool over = false;
    if (c->first_sent == c->n_first) {
        c->first_sent = 0;
        c->n_first = page_send_read(&s->control, c->plant, c->command, c->first, CONNECTION_FIRST, &over);
        c->until_s = clock_now_s() + CONNECTION_PATIENCE_S;
        if (!over)
            ask_whether_there(c);
    }
    if (over)
        begin_answer(c);
    else if (!send_waiting(c, s) || clock_now_s() > c->until_s)
        connection_close(c, s);
}

static void turn_answer(struct connection *c, struct site *s)
{
    if (!send_waiting(c, s) || clock_now_s() > c->until_s) {
        connection_close(c, s);
        return;
    }
    if (c->first_sent < c->n_first || c->body_sent < c->n_body)
        return;
    if (c->is_half_closed) {
        connection_close(c, s);
        return;
    }
    (void)shutdown(c->socket, SHUT_WR);
    c->state = CONNECTION_ENDS;
    c->until_s = clock_now_s() + CONNECTION_GOODBYE_S;
}

void connection_turn(struct connection *c, struct site *s)
{
    if (c->state == CONNECTION_STREAMS)
        turn_stream(c, s);
    else if (c->state == CONNECTION_COMMANDS)
        turn_command(c, s);
    else if (c->state == CONNECTION_ANSWERS)
        turn_answer(c, s);
    else if (c->state == CONNECTION_READS && clock_now_s() > c->until_s)
        answer_sentence(c, HTTP_TIMEOUT, "the request did not come within 5 s", false);
    else if (c->state == CONNECTION_ENDS && clock_now_s() > c->until_s)
        connection_close(c, s);
}

void site_send(struct site *s, const char *text, size_t n)
{
    size_t at = (size_t)(s->written % SITE_RING), end = SITE_RING - at;
    memcpy(s->ring + at, text, n < end ? n : end);
    memcpy(s->ring, text + (n < end ? n : end), n < end ? 0 : n - end);
    s->written += n;
}
