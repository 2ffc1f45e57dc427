/* http.c - see http.h. */
#include "host_sim/scope/http.h"

#include <string.h>

/* Bytes still to be read. */
struct text {
    const char *at, *end;
};

static const struct {
    enum http_status status;
    const char *phrase;
} phrases[] = {
    {HTTP_OK, "OK"},
    {HTTP_BAD, "Bad Request"},
    {HTTP_FORBIDDEN, "Forbidden"},
    {HTTP_NOT_FOUND, "Not Found"},
    {HTTP_NOT_ALLOWED, "Method Not Allowed"},
    {HTTP_TIMEOUT, "Request Timeout"},
    {HTTP_NO_LENGTH, "Length Required"},
    {HTTP_LONG_BODY, "Content Too Large"},
    {HTTP_LONG_TARGET, "URI Too Long"},
    {HTTP_MISDIRECTED, "Misdirected Request"},
    {HTTP_LONG_HEADERS, "Request Header Fields Too Large"},
    {HTTP_FULL, "Service Unavailable"},
    {HTTP_VERSION, "HTTP Version Not Supported"},
};

const char *http_phrase(enum http_status status)
{
    for (size_t i = 0; i < sizeof phrases / sizeof phrases[0]; i++)
        if (phrases[i].status == status)
            return phrases[i].phrase;
    return "";
}

static enum http_status refuse(struct http_request *r, enum http_status status, const char *why)
{
    r->why = why;
    return status;
}

/* The next line, which ends with CR LF, without it. False where it has no end; *bad where a byte is no
 * text. */
static bool take_line(struct text *t, struct text *line, bool *bad)
{
    for (const char *p = t->at; p < t->end; p++) {
        unsigned char c = (unsigned char)*p;
        if (c == '\r' && p + 1 == t->end)
            return false;
        if (c == '\r' && p[1] == '\n') {
            *line = (struct text){t->at, p};
            t->at = p + 2;
            return true;
        }
        if ((c < ' ' && c != '\t') || c == 0x7F) {
            *bad = true;
            return false;
        }
    }
    return false;
}

/* The text up to `stop`, which is taken too. False where there is none. */
static bool take_until(struct text *t, char stop, struct text *part)
{
    const char *p = memchr(t->at, stop, (size_t)(t->end - t->at));
    if (!p)
        return false;
    *part = (struct text){t->at, p};
    t->at = p + 1;
    return true;
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static bool same(struct text t, const char *word)
{
    return (size_t)(t.end - t.at) == strlen(word) && !memcmp(t.at, word, strlen(word));
}

/* Equal but for the case; `word` is lower case. */
static bool same_name(struct text t, const char *word)
{
    size_t n = strlen(word);
    bool good = (size_t)(t.end - t.at) == n;
    for (size_t i = 0; good && i < n; i++)
        good = lower(t.at[i]) == word[i];
    return good;
}

/* A letter, digit or sign of RFC 9110's token. */
static bool is_token(struct text t)
{
    bool good = t.at < t.end;
    for (; good && t.at < t.end; t.at++) {
        char c = lower(*t.at);
        good = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || (c && strchr("!#$%&'*+-.^_`|~", c));
    }
    return good;
}

static enum http_status take_target(struct http_request *r, struct text target)
{
    struct text path = target, query = {"", ""};
    if (target.at == target.end || *target.at != '/')
        return refuse(r, HTTP_BAD, "the target of a request begins with /");
    if (take_until(&target, '?', &path))
        query = target;
    if (path.end - path.at >= HTTP_TARGET || query.end - query.at >= HTTP_TARGET)
        return refuse(r, HTTP_LONG_TARGET, "the target, or its query, is longer than 1023 bytes");
    memcpy(r->target, path.at, (size_t)(path.end - path.at));
    memcpy(r->query, query.at, (size_t)(query.end - query.at));
    return HTTP_OK;
}

/* METHOD TARGET HTTP/1.x */
static enum http_status take_request(struct http_request *r, struct text line)
{
    struct text method, target;
    if (!take_until(&line, ' ', &method) || !is_token(method) || !take_until(&line, ' ', &target))
        return refuse(r, HTTP_BAD, "a request begins with METHOD TARGET HTTP/1.1");
    if (!same(line, "HTTP/1.1") && !same(line, "HTTP/1.0")) {
        bool http = line.end - line.at >= 5 && !memcmp(line.at, "HTTP/", 5);
        return refuse(r, http ? HTTP_VERSION : HTTP_BAD, "this server speaks HTTP/1.1");
    }
    r->head = same(method, "HEAD");
    r->post = same(method, "POST") && target.end - target.at > (ptrdiff_t)strlen(HTTP_COMMAND) &&
              !memcmp(target.at, HTTP_COMMAND, strlen(HTTP_COMMAND));
    if (!r->head && !r->post && !same(method, "GET"))
        return refuse(r, HTTP_NOT_ALLOWED, HTTP_ONLY_LOOKS);
    return take_target(r, target);
}

/* The text in lower case. False where there is none, too much, or one already. */
static bool take_text(char to[HTTP_HOST], struct text value)
{
    if (to[0] || value.at == value.end || value.end - value.at >= HTTP_HOST)
        return false;
    for (size_t i = 0; value.at + i < value.end; i++)
        to[i] = lower(value.at[i]);
    to[value.end - value.at] = '\0';
    return true;
}

/* NAME, NAME:PORT or [ADDRESS]:PORT: the last colon has nothing but digits behind it, and only an address in
 * brackets has further ones. */
static bool take_host(struct http_request *r, struct text value)
{
    struct text host = value;
    const char *digits = value.end;
    while (digits > value.at && digits[-1] >= '0' && digits[-1] <= '9')
        digits--;
    if (digits > value.at && digits[-1] == ':')
        host.end = digits - 1;
    bool has_colon = memchr(host.at, ':', (size_t)(host.end - host.at)) != NULL;
    bool is_bracketed = host.end - host.at > 2 && *host.at == '[' && host.end[-1] == ']';
    return has_colon == is_bracketed && take_text(r->host, host) && take_text(r->authority, value);
}

/* Bearer and a token; anything else is no token. */
static bool take_token(struct http_request *r, struct text value)
{
    struct text scheme;
    bool first = !r->token[0];
    if (take_until(&value, ' ', &scheme) && same_name(scheme, "bearer") && value.end - value.at < HTTP_TOKEN)
        memcpy(r->token, value.at, (size_t)(value.end - value.at));
    return first;
}

/* Digits, so few that they do not overflow. */
static bool take_length(struct http_request *r, struct text value)
{
    bool good = !r->has_length && value.at < value.end && value.end - value.at < 10;
    r->has_length = true;
    for (; good && value.at < value.end; value.at++) {
        good = *value.at >= '0' && *value.at <= '9';
        r->n_body = 10 * r->n_body + (size_t)(*value.at - '0');
    }
    return good;
}

static struct text trim(struct text t)
{
    while (t.at < t.end && (*t.at == ' ' || *t.at == '\t'))
        t.at++;
    while (t.at < t.end && (t.end[-1] == ' ' || t.end[-1] == '\t'))
        t.end--;
    return t;
}

static enum http_status take_header(struct http_request *r, struct text line)
{
    struct text name;
    if (!take_until(&line, ':', &name) || !is_token(name))
        return refuse(r, HTTP_BAD, "a header is NAME: VALUE");
    struct text value = trim(line);
    if (same_name(name, "host") && !take_host(r, value))
        return refuse(r, HTTP_BAD, "a request has one header Host, with an address in it");
    if (!r->post)
        return HTTP_OK;
    if (same_name(name, "transfer-encoding"))
        return refuse(r, HTTP_NO_LENGTH, "a command comes in one piece, with Content-Length");
    bool bad = (same_name(name, "content-length") && !take_length(r, value)) ||
               (same_name(name, "origin") && !take_text(r->origin, value)) ||
               (same_name(name, "authorization") && !take_token(r, value));
    return bad ? refuse(r, HTTP_BAD, "Content-Length, Origin or Authorization is malformed, or there twice")
               : HTTP_OK;
}

/* The body of a POST, behind its headers. */
static enum http_status take_body(struct http_request *r, struct text t, const char *bytes)
{
    r->body = t.at;
    if (r->n_body > HTTP_BODY)
        return refuse(r, HTTP_LONG_BODY, "a command has at most 1024 bytes");
    if ((size_t)(t.at - bytes) + r->n_body > HTTP_REQUEST)
        return refuse(r, HTTP_LONG_HEADERS, "headers and command have more than 16384 bytes");
    if ((size_t)(t.end - t.at) < r->n_body)
        return HTTP_MORE;
    for (size_t i = 0; i < r->n_body; i++)
        if ((unsigned char)r->body[i] < ' ' || r->body[i] == 0x7F)
            return refuse(r, HTTP_BAD, "a command is one line of text");
    return HTTP_OK;
}

static enum http_status end_headers(struct http_request *r, struct text t, const char *bytes)
{
    if (!r->host[0])
        return refuse(r, HTTP_BAD, "the header Host is missing");
    return r->post ? take_body(r, t, bytes) : HTTP_OK;
}

/* After the bytes at hand: nothing is wrong, but the end is not there. */
static enum http_status wait_for_more(struct http_request *r, size_t n, int lines, bool bad)
{
    if (bad)
        return refuse(r, HTTP_BAD, "lines are text and end with CR LF");
    if (n < HTTP_REQUEST)
        return HTTP_MORE;
    if (lines == 0)
        return refuse(r, HTTP_LONG_TARGET, "the first line has more than 16384 bytes");
    return refuse(r, HTTP_LONG_HEADERS, "the headers have more than 16384 bytes");
}

enum http_status http_parse(const char *bytes, size_t n, struct http_request *r)
{
    struct text t = {bytes, bytes + n}, line;
    enum http_status status;
    bool bad = false;
    *r = (struct http_request){.why = ""};
    if (!take_line(&t, &line, &bad))
        return wait_for_more(r, n, 0, bad);
    status = take_request(r, line);
    for (int lines = 1; status == HTTP_OK; lines++) {
        if (!take_line(&t, &line, &bad))
            return wait_for_more(r, n, lines, bad);
        if (line.at == line.end)
            return end_headers(r, t, bytes);
        if (lines > HTTP_HEADERS)
            return refuse(r, HTTP_LONG_HEADERS, "there are more than 100 headers");
        status = take_header(r, line);
    }
    return status;
}

bool http_host_is_ours(const char *host, const char *bound, const char *local)
{
    const char *const ours[] = {"127.0.0.1", "localhost", "[::1]", bound, local};
    for (size_t i = 0; i < sizeof ours / sizeof ours[0]; i++)
        if (host[0] && !strcmp(host, ours[i]))
            return true;
    return false;
}

bool http_origin_is_ours(const struct http_request *r)
{
    static const char scheme[] = "http://";
    size_t n = sizeof scheme - 1;
    return !r->origin[0] || (!strncmp(r->origin, scheme, n) && !strcmp(r->origin + n, r->authority));
}

bool http_token_is(const char given[HTTP_TOKEN], const char token[HTTP_TOKEN])
{
    volatile unsigned differs = 0;
    for (int i = 0; i < HTTP_TOKEN; i++)
        differs |= (unsigned)(given[i] ^ token[i]);
    return differs == 0 && token[0];
}
