/* ear.c - see ear.h. */
#include "host_sim/scope/ear.h"
#include "host_sim/cli/clock.h"
#include "host_sim/library/contactplant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum {
    HEAR_BUDGET = 1 << 15, /* frames taken in one turn */
    TURN_MS = 5
};

static const double batch_s = 1.0 / 30.0, link_every_s = 1.0, timing_every_s = 0.5, silence_s = 1.0;

/* ---- what the browsers hear of all plants ---- */

static void put_hello(const struct ear *e, struct json *j)
{
    json_put(j, "event: hello\ndata: {'contract':%u,'version':%s,'batch_s':%n,'control':%b,'plants':[",
             (uint64_t)VOICE_CONTRACT, contactplant_version(), batch_s, e->server.site.control.token[0] != 0);
    for (int i = 0; i < e->n_voices; i++)
        voice_put_hello(e->voice[i], j);
    json_put(j, "]}\n\n");
}

/* A new browser: everything that is known. */
static void greet(void *context, struct json *j)
{
    const struct ear *e = context;
    put_hello(e, j);
    for (int i = 0; i < e->n_voices; i++) {
        voice_put_status(e->voice[i], j);
        if (client_identity(&e->voice[i]->client) == CLIENT_SAME)
            voice_put_values(e->voice[i], j, NULL);
    }
}

/* The tables again where a plant has turned out to be the one of its scene, or another one. */
static void tell_hello(struct ear *e)
{
    struct json j;
    bool news = false;
    for (int i = 0; i < e->n_voices; i++)
        news = voice_note_identity(e->voice[i]) || news;
    if (!news)
        return;
    json_begin(&j, e->text, sizeof e->text);
    put_hello(e, &j);
    server_tell_json(&e->server, &j);
}

static uint64_t lost(const struct ear *e)
{
    uint64_t sum = e->lost + e->tee.lost;
    for (int i = 0; i < e->n_sources; i++)
        if (e->source[i].bus && e->source[i].bus->kind == BUS_UDP)
            sum += e->source[i].bus->udp.dropped;
    return sum;
}

static void put_link(const struct ear *e, const struct voice *v, struct json *j)
{
    double silent = v->heard_s > 0.0 ? clock_now_s() - v->heard_s : (double)NAN;
    json_put(j, "event: link\ndata: {'plant':%u,'t':%t,'frame':%u,'heard':%b,'silent_s':%n",
             (uint64_t)v->number, voice_time(v), v->client.latest.frame, silent <= silence_s, silent);
    json_put(j, ",'bad':%u,'withheld':%u,'lost':%u,'browsers':%u,'dropped':%u,'others':[", v->client.bad,
             v->withheld, lost(e), (uint64_t)e->server.site.streams, (uint64_t)e->server.site.dropped);
    for (int i = 0; v->number == 0 && i < e->n_others; i++)
        json_item(j, "{'base_id':%u,'messages':%u}", (uint64_t)e->other[i].base_id, e->other[i].messages);
    json_put(j, "]}\n\n");
}

static void put_bins(struct json *j, const char *key, const struct histogram *h)
{
    json_item(j, "'%r':[", key);
    for (int i = 0; i < TIMING_BINS; i++)
        json_item(j, "%u", (uint64_t)h->bin[i]);
    json_put(j, "]");
}

static void tell_timing(struct ear *e)
{
    struct json j;
    json_begin(&j, e->text, sizeof e->text);
    json_put(&j, "event: timing\ndata: {'plant':0");
    put_bins(&j, "lateness_us", &e->tee.timing.lateness);
    put_bins(&j, "compute_us", &e->tee.timing.compute);
    json_put(&j, "}\n\n");
    server_tell_json(&e->server, &j);
}

static bool is_due(double *next_s, double every_s)
{
    double now = clock_now_s();
    if (now < *next_s)
        return false;
    *next_s = *next_s + every_s > now ? *next_s + every_s : now + every_s;
    return true;
}

static void tell_all(struct ear *e)
{
    struct json j;
    tell_hello(e);
    for (int i = 0; i < e->n_voices; i++)
        voice_tell(e->voice[i]);
    if (e->tee.memory && is_due(&e->timing_s, timing_every_s))
        tell_timing(e);
    if (!is_due(&e->link_s, link_every_s))
        return;
    json_begin(&j, e->text, sizeof e->text);
    for (int i = 0; i < e->n_voices; i++)
        put_link(e, e->voice[i], &j);
    server_tell_json(&e->server, &j);
}

/* ---- hearing ---- */

static void note_other(struct ear *e, const struct frame *f)
{
    uint32_t base = f->id & ~(uint32_t)(WIRE_KINDS - 1);
    int i = 0;
    while (i < e->n_others && e->other[i].base_id != base)
        i++;
    if (i == EAR_OTHERS)
        return;
    if (i == e->n_others)
        e->other[e->n_others++] = (struct ear_other){.base_id = base};
    e->other[i].messages++;
}

static void dispatch(struct ear *e, const struct frame *f)
{
    for (int i = 0; i < e->n_voices; i++)
        if (voice_owns(e->voice[i], f)) {
            voice_hear(e->voice[i], f);
            return;
        }
    note_other(e, f);
}

/* The recording of a bus is stamped with the frames of its first plant. */
static void hear_source(struct ear *e, const struct source *s)
{
    const struct voice *v = e->voice[0];
    struct frame f;
    for (int n = 0; n < HEAR_BUDGET; n++) {
        if (s->bus)
            bus_set_frame(s->bus, v->client.latest.frame, v->scene.config.frame_s, 0);
        int got = s->hal->recv(s->hal->context, &f);
        if (got == 0)
            break;
        if (got > 0)
            dispatch(e, &f);
        else if (!(s->bus && s->bus->kind == BUS_UDP)) /* which counts them itself */
            e->lost += s->bus && -got & HAL_DROPPED;
    }
    if (s->bus)
        s->hal->flush(s->hal->context);
}

/* Who can watch and who can command, where that is more than this machine's users looking. */
static void say_who(const struct ear *e, const char *name, const char *address)
{
    const char *token = e->server.site.control.token;
    if (token[0])
        fprintf(stderr, "contactplant %s: to command the plant, open %s#%s; whoever has this address can\n",
                name, address, token);
    if (!server_is_local(&e->server))
        fprintf(stderr, "contactplant %s: whoever reaches this machine at port %u can watch the plant; %s\n",
                name, e->server.site.port,
                token[0] ? "commands and their token travel unencrypted" : "nobody can command it there");
}

int ear_open(struct ear *e, const struct options *o, const char *at)
{
    char text[SERVER_REASON];
    if (options_given(o, "control") && !control_open(&e->server.site.control))
        return options_failure(o->usage, "--control: no random numbers for a token");
    if (!server_open(&e->server, at, text))
        return options_failure(o->usage, "%s", text);
    server_describe(&e->server, text);
    fprintf(stderr, "contactplant %s: the scope is at %s\n", o->usage->name, text);
    say_who(e, o->usage->name, text);
    return 0;
}

STATIC_ASSERT((int)EAR_PLANTS <= (int)CONTROL_PLANTS, each_plant_that_is_heard_can_be_commanded);

void ear_command(struct ear *e, const struct voice *v, const struct options *o, const char *bus,
                 const char *peer)
{
    control_add(&e->server.site.control, o, v->name, v->scene.config.base_id, bus, peer);
}

struct voice *ear_add(struct ear *e, const char *name)
{
    struct voice *v = calloc(1, sizeof *v);
    if (!v)
        return NULL;
    v->number = e->n_voices;
    v->server = &e->server;
    snprintf(v->name, sizeof v->name, "%s", name);
    e->server.site.greet = greet;
    e->server.site.context = e;
    e->voice[e->n_voices++] = v;
    return v;
}

void ear_turn(struct ear *e)
{
    for (int i = 0; i < e->n_sources; i++)
        hear_source(e, &e->source[i]);
    if (is_due(&e->tell_s, batch_s))
        tell_all(e);
    control_turn(&e->server.site.control);
    server_turn(&e->server, TURN_MS);
}

static void say_goodbye(struct ear *e, const char *why)
{
    struct json j;
    tell_all(e);
    json_begin(&j, e->text, sizeof e->text);
    json_put(&j, "event: bye\ndata: {'why':%s}\n\n", why);
    server_tell_json(&e->server, &j);
    server_turn(&e->server, 0);
}

void ear_close(struct ear *e, const char *why)
{
    if (e->server.socket >= 0)
        say_goodbye(e, why);
    server_close(&e->server);
    control_close(&e->server.site.control);
    for (int i = 0; i < e->n_voices; i++) {
        scene_free(&e->voice[i]->scene);
        free(e->voice[i]);
    }
    e->n_voices = 0;
}
