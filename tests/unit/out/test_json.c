/* test_json.c - JSON in a buffer: against texts written by hand, and at every size of the buffer. */
#include "host_sim/out/json.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static void put(struct json *j)
{
    json_put(j, "{'a':%s,'b':%n,'c':[", "\"x\\\n\xC3\xA4", 5.093e-06);
    json_item(j, "%u", UINT64_MAX);
    json_item(j, "%b", 1);
    json_item(j, "%n", (double)NAN);
    json_item(j, "%t", 2.353010010719299);
    json_put(j, "]%r}", ",\"d\":-0");
}

TEST(json_as_by_hand)
{
    char text[200];
    struct json j;
    json_begin(&j, text, sizeof text);
    put(&j);
    check_string("text", text,
                 "{\"a\":\"\\\"x\\\\\\u000a\xC3\xA4\",\"b\":5.093e-06,\"c\":[18446744073709551615,true,null,"
                 "2.3530100107193],\"d\":-0}");
    check_int("length", (int)j.n, (int)strlen(text));
}

TEST(json_leaves_out_whole)
{
    char whole[200], text[200];
    struct json j;
    int bad = 0;
    json_begin(&j, whole, sizeof whole);
    put(&j);
    size_t n = j.n;
    for (size_t size = 1; size <= n + 1; size++) {
        memset(text, '#', sizeof text);
        json_begin(&j, text, size);
        put(&j);
        bool good = text[size] == '#' && j.n < size && strlen(text) == j.n && !strncmp(text, whole, j.n);
        bad += !good || j.full != (size <= n) || (j.n && j.full && text[j.n - 1] == ',');
    }
    check_int("sizes at which it is cut inside a piece, or passes its end", bad, 0);
}
