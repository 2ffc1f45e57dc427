/* http.c - requests of browsers and of others: refused or taken, the same in pieces; and JSON texts that read
 * back as they were. */
#include "host_sim/scope/http.h"
#include "host_sim/out/json.h"
#include "tests/fuzz/fuzz.h"

#include <stdbool.h>
#include <string.h>

enum { TEXT = 300, ROOM = 700 };

static void check_request(const struct http_request *r, enum http_status status)
{
    MUST(status == HTTP_MORE || http_phrase(status)[0]);
    MUST((status == HTTP_OK || status == HTTP_MORE) == !r->why[0]);
    MUST(memchr(r->target, 0, sizeof r->target) && memchr(r->host, 0, sizeof r->host));
    MUST(!strchr(r->target, '?') && !strpbrk(r->target, "\r\n") && !strpbrk(r->host, "\r\n"));
    MUST(memchr(r->origin, 0, sizeof r->origin) && memchr(r->token, 0, sizeof r->token));
    if (status != HTTP_OK)
        return;
    MUST(r->target[0] == '/' && r->host[0] && !strncmp(r->authority, r->host, strlen(r->host)));
    MUST(r->post ? !r->head && !strncmp(r->target, HTTP_COMMAND, strlen(HTTP_COMMAND)) : r->n_body == 0);
    MUST(r->n_body <= HTTP_BODY && !http_token_is(r->token, (char[HTTP_TOKEN]){0}));
    for (size_t i = 0; i < r->n_body; i++)
        MUST((unsigned char)r->body[i] >= ' ' && r->body[i] != 0x7F);
    for (const char *p = r->host; *p; p++)
        MUST(*p < 'A' || *p > 'Z');
    MUST(!http_host_is_ours(r->host, "", "") || !strcmp(r->host, "127.0.0.1") ||
         !strcmp(r->host, "localhost") || !strcmp(r->host, "[::1]"));
}

/* The verdict on a part is the verdict on the whole, whatever comes behind it. */
static void read_request(const char *bytes, size_t n)
{
    struct http_request whole, part;
    size_t cut = n ? (unsigned char)bytes[n - 1] * n / 256 : 0;
    enum http_status status = http_parse(bytes, n, &whole), before = http_parse(bytes, cut, &part);
    check_request(&whole, status);
    check_request(&part, before);
    MUST(before == HTTP_MORE || (before == status && !strcmp(part.target, whole.target) &&
                                 part.body == whole.body && part.n_body == whole.n_body));
    MUST(status != HTTP_OK || !whole.post || whole.body + whole.n_body <= bytes + n);
    MUST(n < HTTP_REQUEST || status != HTTP_MORE);
}

/* The text of a JSON string that json_put wrote. */
static void unescape(const char *at, char *text)
{
    MUST(*at == '"');
    for (at++; *at != '"'; at++) {
        unsigned code = (unsigned char)*at;
        if (*at == '\\' && at[1] == 'u') {
            MUST(sscanf(at + 2, "%4x", &code) == 1);
            at += 5;
        } else if (*at == '\\')
            code = (unsigned char)*++at;
        *text++ = (char)code;
    }
    MUST(!at[1]);
    *text = '\0';
}

/* By the least code of each length: in another way than the writer. */
static bool is_utf8(const char *text)
{
    static const unsigned long least[] = {0, 0x80, 0x800, 0x10000};
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        int more = *c < 0x80             ? 0
                   : (*c & 0xE0) == 0xC0 ? 1
                   : (*c & 0xF0) == 0xE0 ? 2
                   : (*c & 0xF8) == 0xF0 ? 3
                                         : -1;
        int left = more;
        unsigned long code = more > 0 ? *c & (0x3Fu >> more) : *c;
        if (more < 0)
            return false;
        for (; left > 0; left--) {
            if ((*++c & 0xC0) != 0x80)
                return false;
            code = code << 6 | (*c & 0x3Fu);
        }
        if (code < least[more] || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000))
            return false;
    }
    return true;
}

static void write_text(const char *bytes, size_t n)
{
    char text[TEXT], again[ROOM], buffer[ROOM];
    struct json j;
    size_t size = n ? 1 + (unsigned char)bytes[0] * (sizeof buffer - 1) / 255 : 1;
    n = n < TEXT - 1 ? n : TEXT - 1;
    memcpy(text, bytes, n);
    text[n] = '\0';
    json_begin(&j, buffer, size);
    json_put(&j, "%s", text);
    MUST(j.n < size && strlen(buffer) == j.n && (j.full ? j.n == 0 : j.n >= 2));
    if (j.full)
        return;
    unescape(buffer, again);
    MUST(is_utf8(again));
    MUST(!is_utf8(text) || !strcmp(again, text));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char bytes[HTTP_REQUEST];
    size_t n = size < sizeof bytes ? size : sizeof bytes;
    memcpy(bytes, data, n);
    read_request(bytes, n);
    write_text(bytes, n);
    return 0;
}
