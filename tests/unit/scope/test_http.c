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

TEST(http_waits_for_the_end)
{
    const char whole[] = "GET / HTTP/1.1\r\nHost: a\r\n\r\n";
    int early = 0;
    for (size_t n = 0; n < sizeof whole - 1; n++)
        early += http_parse(whole, n, &r) != HTTP_MORE;
    check_int("parts that were taken for the whole", early, 0);
    check_int("the whole", parse(whole), HTTP_OK);
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
