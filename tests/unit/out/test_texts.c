/* test_texts.c - texts of unknown origin in JSON and XML. The right forms are written by hand: as many U+FFFD
 * as the Unicode Standard, table 3-8, has. */
#include "host_sim/out/plain.h"
#include "host_sim/out/json.h"
#include "host_sim/out/utf8.h"
#include "host_sim/out/xml.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define BAD "\xEF\xBF\xBD"

static const struct {
    const char *what, *in, *json, *xml;
} text_table[] = {
    {"plain", "a b~", "a b~", "a b~"},
    {"empty", "", "", ""},
    {"quotes", "\"'\\/", "\\\"'\\\\/", "&quot;'\\/"},
    {"marks", "<a>&]]>", "<a>&]]>", "&lt;a&gt;&amp;]]&gt;"},
    {"blanks", "\t\n\r", "\\u0009\\u000a\\u000d", "&#9;&#10;&#13;"},
    {"controls", "\x01\x1F\x7F", "\\u0001\\u001f\x7F", BAD BAD "\x7F"},
    {"two bytes", "\xC2\x80\xC3\xBC\xDF\xBF", "\xC2\x80\xC3\xBC\xDF\xBF", "\xC2\x80\xC3\xBC\xDF\xBF"},
    {"three bytes", "\xE0\xA0\x80\xED\x9F\xBF\xEE\x80\x80", "\xE0\xA0\x80\xED\x9F\xBF\xEE\x80\x80",
     "\xE0\xA0\x80\xED\x9F\xBF\xEE\x80\x80"},
    {"four bytes", "\xF0\x90\x80\x80\xF0\x9F\x98\x80\xF4\x8F\xBF\xBF",
     "\xF0\x90\x80\x80\xF0\x9F\x98\x80\xF4\x8F\xBF\xBF", "\xF0\x90\x80\x80\xF0\x9F\x98\x80\xF4\x8F\xBF\xBF"},
    {"no characters of XML", "\xEF\xBF\xBE\xEF\xBF\xBF", "\xEF\xBF\xBE\xEF\xBF\xBF", BAD BAD},
    {"U+FFFD itself", BAD, BAD, BAD},
    {"latin-1",
     "pr\xFC"
     "f",
     "pr" BAD "f", "pr" BAD "f"},
    {"no first byte", "\x80\xBF\xF5\xFE\xFF", BAD BAD BAD BAD BAD, BAD BAD BAD BAD BAD},
    {"overlong, two bytes", "\xC0\xAF\xC1\xBF", BAD BAD BAD BAD, BAD BAD BAD BAD},
    {"overlong, three", "\xE0\x80\xAF", BAD BAD BAD, BAD BAD BAD},
    {"overlong, four", "\xF0\x8F\xBF\xBF", BAD BAD BAD BAD, BAD BAD BAD BAD},
    {"surrogates", "\xED\xA0\x80\xED\xBF\xBF", BAD BAD BAD BAD BAD BAD, BAD BAD BAD BAD BAD BAD},
    {"above U+10FFFF", "\xF4\x90\x80\x80", BAD BAD BAD BAD, BAD BAD BAD BAD},
    {"cut at the end", "a\xC3", "a" BAD, "a" BAD},
    {"cut after two of three", "\xE2\x82", BAD, BAD},
    {"cut after three of four", "\xF0\x9F\x98", BAD, BAD},
    {"cut before another",
     "\xF0\x9F\x98\xC3\xA4\xE2\x82"
     "b",
     BAD "\xC3\xA4" BAD "b", BAD "\xC3\xA4" BAD "b"},
};
enum { TEXTS = sizeof text_table / sizeof text_table[0], ROOM = 200 };

/* A file whose text stands in `text` when it is closed. */
static FILE *open_text(char text[ROOM])
{
    text[0] = '\0';
    FILE *f = fmemopen(text, ROOM, "w");
    check_true("a file in memory", f != NULL);
    return f ? f : stderr;
}

TEST(texts_in_json)
{
    for (int i = 0; i < TEXTS; i++) {
        char text[ROOM], right[ROOM];
        struct json j;
        json_begin(&j, text, sizeof text);
        json_put(&j, "%s", text_table[i].in);
        snprintf(right, sizeof right, "\"%s\"", text_table[i].json);
        check_string(text_table[i].what, text, right);
    }
}

TEST(texts_in_xml)
{
    for (int i = 0; i < TEXTS; i++) {
        char text[ROOM];
        FILE *f = open_text(text);
        xml_put(f, "%s", text_table[i].in);
        (void)fclose(f);
        check_string(text_table[i].what, text, text_table[i].xml);
    }
}

TEST(json_in_a_page_ends_no_script)
{
    char text[ROOM];
    struct json j;
    json_begin(&j, text, sizeof text);
    j.in_page = true;
    json_put(&j, "%s", "</script>&\"\\");
    check_string("text", text, "\"\\u003c/script\\u003e\\u0026\\u0022\\u005c\"");
}

TEST(json_into_a_file_as_into_a_buffer)
{
    char text[ROOM];
    struct json j;
    FILE *f = open_text(text);
    json_begin_file(&j, f);
    json_put(&j, "{'a':[");
    json_item(&j, "\n %i", -3);
    json_item(&j, "\n %e", 0.1);
    json_item(&j, "%h", UINT64_C(0xAB));
    json_put(&j, "],\n");
    json_put(&j, "'b':%e}\n", -(double)INFINITY);
    (void)fclose(f);
    check_string("text", text, "{\"a\":[\n -3,\n 0.10000000000000001,\"00000000000000ab\"],\n\"b\":null}\n");
}

TEST(xml_as_by_hand)
{
    char text[ROOM];
    FILE *f = open_text(text);
    xml_put(f, XML_HEAD "<a b='%s' c='%i' d='%u' %r", "\"", -1, 7u, "e='f'/>");
    xml_put(f, "<g h='%n' i='%n' j='%t' k='%p'/>", 0.1, 0.1 + 0.2, 1.0, 2.25);
    (void)fclose(f);
    check_string("text", text,
                 "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<a b=\"&quot;\" c=\"-1\" d=\"7\" e='f'/>"
                 "<g h=\"0.1\" i=\"0.30000000000000004\" j=\"1.000\" k=\"2.2\"/>");
}

/* As texts of a fixed size end: a character that is cut is left out, or told as a question mark. */
TEST(texts_that_are_cut)
{
    static const char text[] = "a\xC3\xBC\xE2\x82\xAC\xF0\x9F\x98\x80z";
    static const int right[] = {0, 1, 1, 3, 3, 3, 6, 6, 6, 6, 10, 11, 11};
    for (int i = 0; i < (int)(sizeof right / sizeof right[0]); i++)
        check_int("bytes of whole characters", utf8_fits(text, i), right[i]);
    char cut[ROOM] = "a\xC3\xBC\xFF\xE2\x82";
    utf8_mend(cut);
    check_string("mended", cut, "a\xC3\xBC???");
}

TEST(texts_in_a_line_for_people)
{
    char text[ROOM];
    FILE *f = open_text(text);
    plain_put(f, "a\nb\x1B[1m\x7F\xC2\x9B\xC2\xA0\xFF\"");
    (void)fclose(f);
    check_string("text", text, "a" BAD "b" BAD "[1m" BAD BAD "\xC2\xA0" BAD "\"");
}
