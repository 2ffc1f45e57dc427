/* scope.c - the scope's decoder: whatever a plant says, browsers get whole events of valid JSON. */
#include "host_sim/scope/decoder_events.h"
#include "tests/fuzz/fuzz.h"

#include <ctype.h>
#include <string.h>

enum { PIECE = 9, DEPTH = 16 };

static const char *value(const char *at, int depth);

static const char *text(const char *at)
{
    MUST(*at == '"');
    for (at++; *at != '"'; at++) {
        MUST((unsigned char)*at >= ' ');
        if (*at == '\\')
            at++;
    }
    return at + 1;
}

static const char *number(const char *at)
{
    const char *begin = at;
    at += *at == '-';
    MUST(isdigit((unsigned char)*at));
    at += strspn(at, "0123456789.e+-");
    MUST(at - begin < 32);
    return at;
}

/* A list, or an object with its names. */
static const char *bracket(const char *at, int depth)
{
    char open = *at++, close = open == '[' ? ']' : '}';
    MUST(depth < DEPTH);
    while (*at != close) {
        if (open == '{') {
            at = text(at);
            MUST(*at++ == ':');
        }
        at = value(at, depth + 1);
        MUST(*at == ',' || *at == close);
        at += *at == ',' && at[1] != close;
    }
    return at + 1;
}

static const char *value(const char *at, int depth)
{
    static const char *const word[] = {"null", "true", "false"};
    if (*at == '[' || *at == '{')
        return bracket(at, depth);
    if (*at == '"')
        return text(at);
    for (int i = 0; i < 3; i++)
        if (!strncmp(at, word[i], strlen(word[i])))
            return at + strlen(word[i]);
    return number(at);
}

/* event: NAME, data: VALUE, an empty line; and so on to the end. */
static void check_events(const char *at)
{
    while (*at) {
        MUST(!strncmp(at, "event: ", 7));
        at = strchr(at, '\n') + 1;
        MUST(!strncmp(at, "data: ", 6));
        at = value(at + 6, 0);
        MUST(at[0] == '\n' && at[1] == '\n');
        at += 2;
    }
}

static void check_sent(struct decoder *d)
{
    struct server *s = d->server;
    decoder_send(d);
    MUST(s->site.written < SITE_RING);
    s->site.ring[s->site.written] = '\0';
    check_events(s->site.ring);
    s->site.written = 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct server server;
    static struct scene_app scene;
    static struct decoder d;
    static char greeting[CONNECTION_FIRST];
    char why[SCENE_REASON];
    struct json j;
    if (!scene.config.model)
        MUST(scene_init(&scene, "hertz_rig", why) && scene_start(&scene, NULL, why));
    memset(&d, 0, sizeof d);
    d.scene = scene;
    d.server = &server;
    decoder_begin(&d);
    d.client.latest.info[INFO_IDENTITY] = (double)scene.app.scene.identity;
    for (; size >= PIECE; data += PIECE, size -= PIECE) {
        struct frame f = {.id = scene.config.base_id + data[0] % WIRE_KINDS, .length = FRAME_DATA};
        memcpy(f.data, data + 1, FRAME_DATA);
        f.data[0] = wire_crc8(f.id, f.data, FRAME_DATA);
        decoder_take(&d, &f);
        if (data[1] == 0)
            check_sent(&d);
    }
    check_sent(&d);
    json_begin(&j, greeting, sizeof greeting);
    json_put(&j, "event: hello\ndata: [");
    decoder_put_hello(&d, &j);
    json_put(&j, "]\n\n");
    decoder_put_status(&d, &j);
    decoder_put_values(&d, &j, NULL);
    MUST(!j.full);
    check_events(greeting);
    return 0;
}
