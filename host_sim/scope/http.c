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
    {HTTP_NOT_FOUND, "Not Found"},
    {HTTP_NOT_ALLOWED, "Method Not Allowed"},
    {HTTP_TIMEOUT, "Request Timeout"},
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
    struct text path = target;
    if (target.at == target.end || *target.at != '/')
        return refuse(r, HTTP_BAD, "the target of a request begins with /");
    (void)take_until(&target, '?', &path);
    if (path.end - path.at >= HTTP_TARGET)
        return refuse(r, HTTP_LONG_TARGET, "the target is longer than 1023 bytes");
    memcpy(r->target, path.at, (size_t)(path.end - path.at));
    r->target[path.end - path.at] = '\0';
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
    if (!r->head && !same(method, "GET"))
        return refuse(r, HTTP_NOT_ALLOWED, "only GET and HEAD: the scope looks and never commands");
    return take_target(r, target);
}

/* The host without its port, in lower case. */
static bool take_host(struct http_request *r, struct text value)
{
    const char *end = value.end;
    for (const char *p = value.end; p > value.at && p[-1] != ']'; p--)
        if (p[-1] == ':')
            end = p - 1;
    if (end == value.at || end - value.at >= HTTP_HOST)
        return false;
    for (size_t i = 0; value.at + i < end; i++)
        r->host[i] = lower(value.at[i]);
    r->host[end - value.at] = '\0';
    return true;
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
    if (!same_name(name, "host"))
        return HTTP_OK;
    if (r->host[0] || !take_host(r, trim(line)))
        return refuse(r, HTTP_BAD, "a request has one header Host, with an address in it");
    return HTTP_OK;
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
            return r->host[0] ? HTTP_OK : refuse(r, HTTP_BAD, "the header Host is missing");
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
