/* hub.c - see hub.h. */
#include "host_sim/scope/hub.h"
#include "host_sim/cli/clock.h"
#include "host_sim/library/contactplant.h"
#include "host_sim/scope/decoder_events.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum {
    BUDGET = 1 << 15, /* frames taken in one turn */
    TURN_MS = 5
};

static const double batch_s = 1.0 / 30.0, link_every_s = 1.0, timing_every_s = 0.5, silence_s = 1.0;

/* ---- events of all plants ---- */

static void put_hello(const struct hub *h, struct json *j)
{
    json_put(j, "event: hello\ndata: {'contract':%u,'version':%s,'batch_s':%n,'control':%b,'plants':[",
             (uint64_t)DECODER_CONTRACT, contactplant_version(), batch_s,
             h->server.site.control.token[0] != 0);
    for (int i = 0; i < h->n_decoders; i++)
        decoder_put_hello(h->decoder[i], j);
    json_put(j, "]}\n\n");
}

/* A new browser: everything that is known. */
static void greet(void *context, struct json *j)
{
    const struct hub *h = context;
    put_hello(h, j);
    for (int i = 0; i < h->n_decoders; i++) {
        decoder_put_status(h->decoder[i], j);
        if (client_identity(&h->decoder[i]->client) == CLIENT_SAME)
            decoder_put_values(h->decoder[i], j, NULL);
    }
}

/* The tables again where a plant has turned out to be the one of its scene, or another one. */
static void send_hello(struct hub *h)
{
    struct json j;
    bool news = false;
    for (int i = 0; i < h->n_decoders; i++)
        news = decoder_note_identity(h->decoder[i]) || news;
    if (!news)
        return;
    json_begin(&j, h->text, sizeof h->text);
    put_hello(h, &j);
    server_send_json(&h->server, &j);
}

static uint64_t lost(const struct hub *h)
{
    uint64_t sum = h->lost + h->ring.lost;
    for (int i = 0; i < h->n_sources; i++)
        if (h->source[i].bus && h->source[i].bus->kind == BUS_UDP)
            sum += h->source[i].bus->udp.dropped;
    return sum;
}

static void put_link(const struct hub *h, const struct decoder *d, struct json *j)
{
    double silent = d->received_s > 0.0 ? clock_now_s() - d->received_s : (double)NAN;
    json_put(j, "event: link\ndata: {'plant':%u,'t':%t,'frame':%u,'heard':%b,'silent_s':%n",
             (uint64_t)d->number, decoder_time(d), d->client.latest.frame, silent <= silence_s, silent);
    json_put(j, ",'bad':%u,'withheld':%u,'lost':%u,'browsers':%u,'dropped':%u,'others':[", d->client.bad,
             d->withheld, lost(h), (uint64_t)h->server.site.streams, (uint64_t)h->server.site.dropped);
    for (int i = 0; d->number == 0 && i < h->n_others; i++)
        json_item(j, "{'base_id':%u,'messages':%u}", (uint64_t)h->other[i].base_id, h->other[i].messages);
    json_put(j, "]}\n\n");
}

static void put_bins(struct json *j, const char *key, const struct histogram *h)
{
    json_item(j, "'%r':[", key);
    for (int i = 0; i < TIMING_BINS; i++)
        json_item(j, "%u", (uint64_t)h->bin[i]);
    json_put(j, "]");
}

static void send_timing(struct hub *h)
{
    struct json j;
    json_begin(&j, h->text, sizeof h->text);
    json_put(&j, "event: timing\ndata: {'plant':0");
    put_bins(&j, "lateness_us", &h->ring.timing.lateness);
    put_bins(&j, "compute_us", &h->ring.timing.compute);
    json_put(&j, "}\n\n");
    server_send_json(&h->server, &j);
}

static bool is_due(double *next_s, double every_s)
{
    double now = clock_now_s();
    if (now < *next_s)
        return false;
    *next_s = *next_s + every_s > now ? *next_s + every_s : now + every_s;
    return true;
}

static void send_all(struct hub *h)
{
    struct json j;
    send_hello(h);
    for (int i = 0; i < h->n_decoders; i++)
        decoder_send(h->decoder[i]);
    if (h->ring.memory && is_due(&h->timing_s, timing_every_s))
        send_timing(h);
    if (!is_due(&h->link_s, link_every_s))
        return;
    json_begin(&j, h->text, sizeof h->text);
    for (int i = 0; i < h->n_decoders; i++)
        put_link(h, h->decoder[i], &j);
    server_send_json(&h->server, &j);
}

/* ---- frames ---- */

static void note_other(struct hub *h, const struct frame *f)
{
    uint32_t base = f->id & ~(uint32_t)(WIRE_KINDS - 1);
    int i = 0;
    while (i < h->n_others && h->other[i].base_id != base)
        i++;
    if (i == HUB_OTHERS)
        return;
    if (i == h->n_others)
        h->other[h->n_others++] = (struct hub_other){.base_id = base};
    h->other[i].messages++;
}

static void dispatch(struct hub *h, const struct frame *f)
{
    for (int i = 0; i < h->n_decoders; i++)
        if (decoder_owns(h->decoder[i], f)) {
            decoder_take(h->decoder[i], f);
            return;
        }
    note_other(h, f);
}

/* The recording of a bus is stamped with the frames of its first plant. */
static void receive_from(struct hub *h, const struct source *s)
{
    const struct decoder *d = h->decoder[0];
    struct frame f;
    for (int n = 0; n < BUDGET; n++) {
        if (s->bus)
            bus_set_frame(s->bus, d->client.latest.frame, d->scene.config.frame_s, 0);
        int got = s->hal->recv(s->hal->context, &f);
        if (got == 0)
            break;
        if (got > 0)
            dispatch(h, &f);
        else if (!(s->bus && s->bus->kind == BUS_UDP)) /* which counts them itself */
            h->lost += s->bus && -got & HAL_DROPPED;
    }
    if (s->bus)
        s->hal->flush(s->hal->context);
}

/* Who can watch and who can command, where that is more than this machine's users looking. */
static void say_who(const struct hub *h, const char *name, const char *address)
{
    const char *token = h->server.site.control.token;
    if (token[0])
        fprintf(stderr, "contactplant %s: to command the plant, open %s#%s; whoever has this address can\n",
                name, address, token);
    if (!server_is_local(&h->server))
        fprintf(stderr, "contactplant %s: whoever reaches this machine at port %u can watch the plant; %s\n",
                name, h->server.site.port,
                token[0] ? "commands and their token travel unencrypted" : "nobody can command it there");
}

int hub_open(struct hub *h, const struct options *o, const char *at)
{
    char text[SERVER_REASON];
    if (options_given(o, "control") && !page_send_open(&h->server.site.control))
        return options_failure(o->usage, "--control: no random numbers for a token");
    if (!server_open(&h->server, at, text))
        return options_failure(o->usage, "%s", text);
    server_describe(&h->server, text);
    fprintf(stderr, "contactplant %s: the scope is at %s\n", o->usage->name, text);
    say_who(h, o->usage->name, text);
    return 0;
}

STATIC_ASSERT((int)HUB_PLANTS <= (int)PAGE_SEND_PLANTS, each_plant_can_be_commanded);

void hub_command(struct hub *h, const struct decoder *d, const struct options *o, const char *bus,
                 const char *peer)
{
    page_send_add(&h->server.site.control, o, d->name, d->scene.config.base_id, bus, peer);
}

struct decoder *hub_add(struct hub *h, const char *name)
{
    struct decoder *d = calloc(1, sizeof *d);
    if (!d)
        return NULL;
    d->number = h->n_decoders;
    d->server = &h->server;
    snprintf(d->name, sizeof d->name, "%s", name);
    h->server.site.greet = greet;
    h->server.site.context = h;
    h->decoder[h->n_decoders++] = d;
    return d;
}

void hub_turn(struct hub *h)
{
    for (int i = 0; i < h->n_sources; i++)
        receive_from(h, &h->source[i]);
    if (is_due(&h->send_s, batch_s))
        send_all(h);
    page_send_turn(&h->server.site.control);
    server_turn(&h->server, TURN_MS);
}

static void say_goodbye(struct hub *h, const char *why)
{
    struct json j;
    send_all(h);
    json_begin(&j, h->text, sizeof h->text);
    json_put(&j, "event: bye\ndata: {'why':%s}\n\n", why);
    server_send_json(&h->server, &j);
    server_turn(&h->server, 0);
}

void hub_close(struct hub *h, const char *why)
{
    if (h->server.socket >= 0)
        say_goodbye(h, why);
    server_close(&h->server);
    page_send_close(&h->server.site.control);
    for (int i = 0; i < h->n_decoders; i++) {
        scene_free(&h->decoder[i]->scene);
        free(h->decoder[i]);
    }
    h->n_decoders = 0;
}
