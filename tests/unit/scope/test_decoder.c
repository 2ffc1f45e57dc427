/* test_decoder.c - frames of a plant as events of the scope: lost on the way, repeated, begun anew. */
#include "firmware/bus/wire_table.h"
#include "host_sim/scope/decoder_events.h"
#include "tests/unit/test.h"

#include <stdlib.h>
#include <string.h>

static struct decoder *d;
static struct server *server;

/* One message of the plant, with values in the order of its layout. */
static void say(unsigned kind, unsigned counter, const double *value)
{
    struct message m = {.kind = (uint8_t)kind, .counter = (uint8_t)counter};
    struct frame f;
    memcpy(m.value, value, sizeof(double) * wire_layout(kind)->n_fields);
    wire_encode(&d->scene.app.scene, &m, &f);
    if (decoder_owns(d, &f))
        decoder_take(d, &f);
}
#define SAY(kind, counter, ...) say(kind, counter, (const double[WIRE_FIELDS]){__VA_ARGS__})

static unsigned n_syncs;

static void sync_at(double frame)
{
    SAY(WIRE_SYNC, n_syncs++ % WIRE_COUNTER_STATES, frame, frame * 64.0);
}

/* All that was sent since the last time. */
static const char *sent_text(void)
{
    decoder_send(d);
    server->site.ring[server->site.written] = '\0';
    server->site.written = 0;
    return server->site.ring;
}

static void begin_decoder(bool known)
{
    char why[SCENE_REASON];
    d = calloc(1, sizeof *d);
    server = calloc(1, sizeof *server);
    d->server = server;
    check_true("a scene", scene_init(&d->scene, "hertz_rig", why) && scene_start(&d->scene, NULL, why));
    decoder_begin(d);
    if (known)
        SAY(WIRE_INFO, 0, INFO_IDENTITY, (double)d->scene.app.scene.identity);
    (void)sent_text();
}

static void end_decoder(void)
{
    scene_free(&d->scene);
    free(d);
    free(server);
}

TEST(decoder_rows)
{
    begin_decoder(true);
    sync_at(1.0);
    SAY(WIRE_MOTION, 0, 1.0, 7e-6, -2e-4);
    SAY(WIRE_CONTACT, 0, 1.0, 8e-6, 65.0);
    sync_at(2.0);
    SAY(WIRE_CONTACT, 1, 0.0, (double)d->scene.app.scene.lsb[2] * 1e9, 0.0);
    sync_at(4.0);
    sync_at(5.0);
    check_string("values, holes as null, none for frames that stand", sent_text(),
                 "event: rows\ndata: {\"plant\":0,\"rows\":["
                 "[1,0.001,1,7e-06,-0.0002,8e-06,65,null,null,null,null],"
                 "[2,0.002,0,null,null,null,0,null,null,null,null]]}\n\n");
    sync_at(6.0);
    check_string("no news, no event", sent_text(), "");
    end_decoder();
}

TEST(decoder_unknown_plant)
{
    begin_decoder(false);
    sync_at(1.0);
    SAY(WIRE_MOTION, 0, 1.0, 7e-6, -2e-4);
    sync_at(2.0);
    check_string("nothing of a plant that is not known", sent_text(), "");
    check_int("withheld", (int)d->withheld, 3);
    SAY(WIRE_STATUS, 0, 1.0, STATE_RUNNING, REACTION_NONE, 0.0, FAULT_TIMEOUT | FAULT_BUS, 3.0);
    check_string(
        "but its state", sent_text(),
        "event: status\ndata: {\"plant\":0,\"t\":0.002,\"frame\":3,\"state\":\"running\",\"session\":1,"
        "\"reaction\":\"none\",\"watch\":0,\"faults\":48,\"fault_names\":[\"bus\",\"timeout\"]}\n\n");
    SAY(WIRE_INFO, 0, INFO_IDENTITY, 1.0);
    sync_at(3.0);
    check_string("nor of another one", sent_text(), "");
    end_decoder();
}

TEST(decoder_numbers_without_a_name)
{
    begin_decoder(true);
    SAY(WIRE_STATUS, 0, 1.0, 15.0, 7.0, 0.0, 0.0, 3.0);
    SAY(WIRE_PARAM_ECHO, 0, (double)(SETTING_FIRST + SET_LOCKIN_CHANNEL), 1e30);
    SAY(WIRE_PARAM_ECHO, 1, (double)(SETTING_FIRST + SET_LOCKIN_OUTPUT), -1.0);
    SAY(WIRE_LOCKIN, 0, 0.0, 1.0, 0.5);
    const char *text = sent_text();
    check_contains("state", text, "\"state\":\"unknown\",\"session\":1,\"reaction\":\"unknown\"");
    check_contains("a slot of no input", text, "{\"slot\":0,\"input\":\"force\",\"output\":\"displacement\"");
    end_decoder();
}

TEST(decoder_contact_events)
{
    begin_decoder(true);
    sync_at(10.0);
    SAY(WIRE_EVENT_TIME, 0, 0.0, 1.0, 0.5, 700.0);
    SAY(WIRE_EVENT_TIME, 1, 1.0, 0.0, 0.25, 701.0);
    SAY(WIRE_EVENT_DATA, 1, 1.0, 0.0, 0.004, 0.0);
    SAY(WIRE_EVENT_DATA, 2, 0.0, 1.0, 0.003, 80.0);
    SAY(WIRE_EVENT_TIME, 3, 0.0, 0.0, 0.0, 702.0);
    SAY(WIRE_EVENT_DATA, 4, 0.0, 0.0, 0.005, 90.0);
    check_string("a half that is lost leaves null, or nothing", sent_text(),
                 "event: contact\ndata: {\"plant\":0,\"events\":[[0.0109453125,1,0,null,null],"
                 "[0.01095703125,0,1,0.004,0]]}\n\n");
    end_decoder();
}

TEST(decoder_restart)
{
    begin_decoder(true);
    sync_at(100.0);
    SAY(WIRE_MOTION, 0, 1.0, 7e-6, -2e-4);
    sync_at(101.0);
    sync_at(1.0);
    SAY(WIRE_MOTION, 0, 1.0, 7e-6, -2e-4);
    sync_at(2.0);
    const char *text = sent_text(), *again = strstr(text, "event: restart\ndata: {\"plant\":0}\n\n");
    const char *before = strstr(text, "[100,0.1,"), *after = strstr(text, "[1,0.001,");
    check_true("told between the rows of before and after",
               before && again && after && before < again && again < after);
    end_decoder();
}

TEST(decoder_bursts)
{
    begin_decoder(true);
    sync_at(1.0);
    for (int i = 0; i < 2; i++) {
        SAY(WIRE_CAPTURE_DATA, 0, 0.0, 0.0, 1.5);
        SAY(WIRE_CAPTURE_DATA, 1, 1.0, 0.0, 2.5);
        SAY(WIRE_CAPTURE_DATA, 2, 0.0, 1.0, 3.5);
    }
    const char *text = sent_text();
    check_contains(
        "one", text,
        "\"burst\":1,\"sample_s\":1.5625e-05,\"trigger_t\":null,\"pretrigger\":null,\"samples\":1000");
    check_contains("its values", text, "\"data\":[[0,0,1.5],[1,0,2.5],[0,1,3.5]]}\n\n");
    check_contains("then another", text, "\"burst\":2");
    SAY(WIRE_HEALTH, 0, DIAG_CAPTURE_PRETRIGGER, 100.0);
    SAY(WIRE_HEALTH, 1, DIAG_CAPTURE_TICK, 32.0);
    check_contains("its trigger, told later", sent_text(),
                   "\"burst\":2,\"sample_s\":1.5625e-05,\"trigger_t\":0.0005,\"pretrigger\":100");
    check_string("once", sent_text(), "");
    end_decoder();
}

TEST(decoder_values)
{
    begin_decoder(true);
    SAY(WIRE_LEDGER, 0, LEDGER_STORED, 0.5);
    SAY(WIRE_DRIVE_ECHO, 0, 2.0, ARM_FREQUENCY, 225.0);
    check_string(
        "by name", sent_text(),
        "event: values\ndata: "
        "{\"plant\":0,\"t\":0,\"ledger\":{\"stored\":0.5},\"drives\":{\"base\":{\"frequency\":225}}}\n\n");
    SAY(WIRE_LEDGER, 1, LEDGER_STORED, 0.5);
    SAY(WIRE_PARAM_ECHO, 0, 0.0, 5.0);
    check_contains("only what has changed", sent_text(), "\"t\":0,\"parameters\":{\"mass_kg\":5}}\n\n");
    struct json j;
    json_begin(&j, server->site.ring, sizeof server->site.ring);
    decoder_put_values(d, &j, NULL);
    check_contains("all for a new browser", j.at, "\"ledger\":{\"stored\":0.5}");
    end_decoder();
}

TEST(decoder_full_lane)
{
    begin_decoder(true);
    for (int i = 1; i <= 3000; i++) {
        sync_at(i);
        SAY(WIRE_MOTION, (unsigned)i % 15, 1.0, 7e-6, -2e-4);
    }
    int rows = 0;
    for (const char *at = sent_text(); (at = strstr(at, "e-06")); at++)
        rows++;
    check_int("a full list goes out by itself: rows", rows, 2999);
    end_decoder();
}
