/* http.h - a request of HTTP/1.1 from bytes, and who may ask: pure functions, bounded, no heap. */
#ifndef HOST_SIM_HTTP_H
#define HOST_SIM_HTTP_H

#include <stdbool.h>
#include <stddef.h>

enum {
    HTTP_REQUEST = 16384, /* bytes of a request line with its headers */
    HTTP_HEADERS = 100,
    HTTP_TARGET = 1024,
    HTTP_HOST = 256,
    HTTP_TOKEN = 33, /* 32 digits and a NUL */
    HTTP_BODY = 1024 /* bytes of a command */
};

/* The answers that a request can earn by its form. */
enum http_status {
    HTTP_MORE = 0, /* the end of the headers has not come yet */
    HTTP_OK = 200,
    HTTP_BAD = 400,
    HTTP_FORBIDDEN = 403,
    HTTP_NOT_FOUND = 404,
    HTTP_NOT_ALLOWED = 405,
    HTTP_TIMEOUT = 408,
    HTTP_NO_LENGTH = 411,
    HTTP_LONG_BODY = 413,
    HTTP_LONG_TARGET = 414,
    HTTP_MISDIRECTED = 421,
    HTTP_LONG_HEADERS = 431,
    HTTP_FULL = 503,
    HTTP_VERSION = 505
};

struct http_request {
    bool head;                /* HEAD: the answer has no body */
    bool post;                /* POST to a target below HTTP_COMMAND */
    char target[HTTP_TARGET]; /* begins with '/'; without the query */
    char query[HTTP_TARGET];  /* behind the '?'; "" where there is none */
    char host[HTTP_HOST];     /* the header Host, lower case, without the port; "" where there is none */
    const char *why;          /* one sentence for a status that is no HTTP_OK */
    /* POST only: headers as they came, "" where there is none, and the body, a line of text */
    char authority[HTTP_HOST]; /* Host, lower case, with its port */
    char origin[HTTP_HOST];    /* Origin, lower case */
    char token[HTTP_TOKEN];    /* Authorization: Bearer TOKEN, with zeros behind */
    const char *body;          /* among the bytes */
    bool has_length;           /* Content-Length was there */
    size_t n_body;
};

#define HTTP_COMMAND    "/send/"
#define HTTP_ONLY_LOOKS "only GET and HEAD: the scope looks and never commands"

/* The request in the first n bytes, HTTP_REQUEST at most: GET, HEAD, or POST to HTTP_COMMAND. A body belongs
 * to POST only. */
enum http_status http_parse(const char *bytes, size_t n, struct http_request *r);

/* True where no page of another site sent this: there is no Origin, or the one that Host names. */
bool http_origin_is_ours(const struct http_request *r);

/* The time of the comparison does not depend on where they differ. Both have zeros behind the text. */
bool http_token_is(const char given[HTTP_TOKEN], const char token[HTTP_TOKEN]);

/* "Not Found" and so on. */
const char *http_phrase(enum http_status status);

/* True for a Host that means this machine: 127.0.0.1, localhost, [::1], the address that the server is
 * bound to, or the one that the connection came in by. A name that somebody else's DNS points here is none
 * of them. */
bool http_host_is_ours(const char *host, const char *bound, const char *local);

#endif
