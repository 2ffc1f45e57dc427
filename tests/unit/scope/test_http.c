/* test_http.c - requests by hand: what each line of RFC 9112 asks for, and who may ask. */
#include "host_sim/scope/http.h"
#include "tests/unit/test.h"

#include <stdio.h>
#include <string.h>

static struct http_request r;

static int parse(const char *text)
{
    return (int)http_parse(text, strlen(text), &r);
}

TEST(http_takes_requests)
{
    check_int("GET", parse("GET / HTTP/1.1\r\nHost: 127.0.0.1:8080\r\n\r\n"), HTTP_OK);
    check_string("target", r.target, "/");
    check_string("host, without its port", r.host, "127.0.0.1");
    check_int("no HEAD", r.head, 0);
    check_int("HEAD, old version, any case", parse("HEAD /a/b?c=d?e HTTP/1.0\r\nhOST:\t LocalHost \r\n\r\n"),
              HTTP_OK);
    check_int("HEAD", r.head, 1);
    check_string("target, without its query", r.target, "/a/b");
    check_string("host in lower case", r.host, "localhost");
    check_int("IPv6", parse("GET /x HTTP/1.1\r\nA: b\r\nHost: [::1]:8080\r\n\r\nbody"), HTTP_OK);
    check_string("host with its brackets", r.host, "[::1]");
    static const char *const strange[] = {"127.0.0.1:80:evil",
                                          "localhost:evil.example",
                                          "[::1]:evil.example:80",
                                          "[::1]:80:80",
                                          "::1",
                                          "[::1",
                                          "localhost:8a",
                                          "a:b:80",
                                          ":80"};
    for (size_t i = 0; i < sizeof strange / sizeof strange[0]; i++) {
        char text[200];
        snprintf(text, sizeof text, "GET / HTTP/1.1\r\nHost: %s\r\n\r\n", strange[i]);
        check_int(strange[i], parse(text), HTTP_BAD);
    }
    check_int("two lengths",
              parse("POST /send/0 HTTP/1.1\r\nHost: a\r\nContent-Length: 0\r\nContent-Length: 4\r\n\r\nstop"),
              HTTP_BAD);
}

TEST(http_refuses_requests)
{
    check_int("method", parse("POST / HTTP/1.1\r\n"), HTTP_NOT_ALLOWED);
    check_int("no method", parse(" / HTTP/1.1\r\n"), HTTP_BAD);
    check_int("one word", parse("GET\r\n"), HTTP_BAD);
    check_int("absolute target", parse("GET http://127.0.0.1/ HTTP/1.1\r\n"), HTTP_BAD);
    check_int("version 2", parse("GET / HTTP/2.0\r\n"), HTTP_VERSION);
    check_int("no version", parse("GET / \r\n"), HTTP_BAD);
    check_int("lines without CR", parse("GET / HTTP/1.1\nHost: a\n\n"), HTTP_BAD);
    check_int("a NUL", (int)http_parse("GET / HTTP/1.1\r\n\0", 17, &r), HTTP_BAD);
    check_int("TLS", (int)http_parse("\x16\x03\x01\x02\x00", 5, &r), HTTP_BAD);
    check_int("no colon", parse("GET / HTTP/1.1\r\nHost\r\n"), HTTP_BAD);
    check_int("a blank in a name", parse("GET / HTTP/1.1\r\nHo st: a\r\n"), HTTP_BAD);
    check_int("no Host", parse("GET / HTTP/1.1\r\nA: b\r\n\r\n"), HTTP_BAD);
    check_contains("which it says", r.why, "Host is missing");
    check_int("two Hosts", parse("GET / HTTP/1.1\r\nHost: a\r\nHost: a\r\n"), HTTP_BAD);
    check_int("an empty Host", parse("GET / HTTP/1.1\r\nHost: :80\r\n"), HTTP_BAD);
}

#define COMMAND "POST /send/0 HTTP/1.1\r\nHost: 127.0.0.1:80\r\n"

TEST(http_takes_commands)
{
    check_int("POST",
              parse(COMMAND "Authorization: bEARER 0f\r\nOrigin: http://A:80\r\nContent-Length: 5\r\n\r\n"
                            "start, and more"),
              HTTP_OK);
    check_true("is one", r.post && !r.head);
    check_int("bytes of the command", (long long)r.n_body, 5);
    check_int("which it is", memcmp(r.body, "start", 5), 0);
    check_string("token", r.token, "0f");
    check_string("origin in lower case", r.origin, "http://a:80");
    check_string("authority", r.authority, "127.0.0.1:80");
    check_int("no command", parse(COMMAND "\r\n"), HTTP_OK);
    check_int("of no bytes", (long long)r.n_body, 0);
    check_int("another scheme", parse(COMMAND "Authorization: Basic 0f\r\n\r\n"), HTTP_OK);
    check_string("is no token", r.token, "");
}

TEST(http_refuses_commands)
{
    static char text[HTTP_REQUEST + 1];
    check_int("elsewhere", parse("POST /send/ HTTP/1.1\r\n"), HTTP_NOT_ALLOWED);
    check_int("1025 bytes", parse(COMMAND "Content-Length: 1025\r\n\r\n"), HTTP_LONG_BODY);
    check_int("1024 bytes", parse(COMMAND "Content-Length: 1024\r\n\r\n"), HTTP_MORE);
    check_int("more digits than a number has", parse(COMMAND "Content-Length: 18446744073709551617\r\n"),
              HTTP_BAD);
    check_int("a negative length", parse(COMMAND "Content-Length: -1\r\n"), HTTP_BAD);
    check_int("two lengths", parse(COMMAND "Content-Length: 5\r\nContent-Length: 6\r\n"), HTTP_BAD);
    check_int("chunks", parse(COMMAND "Transfer-Encoding: chunked\r\n"), HTTP_NO_LENGTH);
    check_int("two lines", parse(COMMAND "Content-Length: 5\r\n\r\na\nb\nc"), HTTP_BAD);
    check_int("two tokens", parse(COMMAND "Authorization: Bearer a\r\nAuthorization: Bearer b\r\n"),
              HTTP_BAD);
    size_t n = (size_t)snprintf(text, sizeof text, COMMAND "Content-Length: 9\r\nA: ");
    memset(text + n, 'b', HTTP_REQUEST - n);
    memcpy(text + HTTP_REQUEST - 12, "\r\n\r\n", 4);
    check_int("no room behind the headers", (int)http_parse(text, HTTP_REQUEST, &r), HTTP_LONG_HEADERS);
}

TEST(http_knows_its_pages)
{
    (void)parse(COMMAND "Origin: http://127.0.0.1:80\r\n\r\n");
    check_true("its own", http_origin_is_ours(&r));
    (void)parse(COMMAND "\r\n");
    check_true("a program that is no browser", http_origin_is_ours(&r));
    const char *const others[] = {
        "http://127.0.0.1", "http://127.0.0.1:8", "https://127.0.0.1:80", "http://evil.example:80", "null",
        "127.0.0.1:80"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        char text[256];
        snprintf(text, sizeof text, COMMAND "Origin: %s\r\n\r\n", others[i]);
        (void)parse(text);
        check_true(others[i], !http_origin_is_ours(&r));
    }
}

TEST(http_knows_its_token)
{
    const char token[HTTP_TOKEN] = "0123456789abcdef0123456789abcdef", none[HTTP_TOKEN] = "";
    char given[HTTP_TOKEN];
    memcpy(given, token, sizeof given);
    check_true("the token", http_token_is(given, token));
    int taken = 0;
    for (size_t i = 0; i < sizeof given; i++) {
        given[i] ^= 1;
        taken += http_token_is(given, token);
        given[i] ^= 1;
    }
    check_int("tokens with another digit", taken, 0);
    check_true("no token given", !http_token_is(none, token));
    check_true("no token at all", !http_token_is(none, none));
}

TEST(http_waits_for_the_end)
{
    const char whole[] = "GET / HTTP/1.1\r\nHost: a\r\n\r\n";
    int early = 0;
    for (size_t n = 0; n < sizeof whole - 1; n++)
        early += http_parse(whole, n, &r) != HTTP_MORE;
    check_int("parts that were taken for the whole", early, 0);
    check_int("the whole", parse(whole), HTTP_OK);
    const char command[] = COMMAND "Content-Length: 5\r\n\r\nstart";
    for (size_t n = 0; n < sizeof command - 1; n++)
        early += http_parse(command, n, &r) != HTTP_MORE;
    check_int("parts of a command", early, 0);
    check_int("the whole command", parse(command), HTTP_OK);
}

TEST(http_limits)
{
    static char text[HTTP_REQUEST + 1];
    size_t n = (size_t)snprintf(text, sizeof text, "GET / HTTP/1.1\r\nHost: a\r\n");
    for (int i = 1; i < HTTP_HEADERS; i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "A: b\r\n");
    snprintf(text + n, sizeof text - n, "\r\n");
    check_int("100 headers", parse(text), HTTP_OK);
    snprintf(text + n, sizeof text - n, "A: b\r\n\r\n");
    check_int("101 headers", parse(text), HTTP_LONG_HEADERS);
    n = (size_t)snprintf(text, sizeof text, "GET /%01022d HTTP/1.1\r\nHost: a\r\n\r\n", 0);
    check_int("a target of 1023 bytes", parse(text), HTTP_OK);
    snprintf(text, sizeof text, "GET /%01023d HTTP/1.1\r\nHost: a\r\n\r\n", 0);
    check_int("of 1024", parse(text), HTTP_LONG_TARGET);
    memset(text, 'A', sizeof text);
    check_int("a line that still goes on at 16383 bytes", (int)http_parse(text, HTTP_REQUEST - 1, &r),
              HTTP_MORE);
    check_int("at 16384", (int)http_parse(text, HTTP_REQUEST, &r), HTTP_LONG_TARGET);
    n = (size_t)snprintf(text, sizeof text, "GET / HTTP/1.1\r\nHost: a\r\nA: ");
    memset(text + n, 'b', sizeof text - n);
    check_int("a header that does", (int)http_parse(text, HTTP_REQUEST, &r), HTTP_LONG_HEADERS);
}

TEST(http_knows_its_host)
{
    const char *const ours[] = {"127.0.0.1", "localhost", "[::1]", "192.0.2.7", "192.0.2.9"};
    const char *const others[] = {"evil.example", "127.0.0.1.evil.example", "localhost.", "192.0.2.8", "",
                                  "::1"};
    for (size_t i = 0; i < sizeof ours / sizeof ours[0]; i++)
        check_true(ours[i], http_host_is_ours(ours[i], "192.0.2.7", "192.0.2.9"));
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        check_true(others[i], !http_host_is_ours(others[i], "192.0.2.7", "192.0.2.9"));
    check_true("no address known", !http_host_is_ours("", "", ""));
}
