/* decoder_events.c - see decoder_events.h. */
#include "firmware/bus/wire_table.h"
#include "host_sim/scope/decoder_events.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/trouble.h"

#include <math.h>
#include <string.h>

static const char *const identity_name[] = {
    [CLIENT_UNTOLD] = "untold", [CLIENT_SAME] = "same", [CLIENT_OTHER] = "other"};

double decoder_time(const struct decoder *d)
{
    return (double)d->client.latest.tick * d->scene.app.plant.tick_s;
}

/* A parameter or setting as it is now. */
static double parameter(const struct decoder *d, int index)
{
    double echoed = d->client.latest.parameter[index];
    if (!isnan(echoed))
        return echoed;
    return index >= SETTING_FIRST ? d->scene.setting[index - SETTING_FIRST] : d->scene.si[index];
}

static const struct model *model_of(const struct decoder *d)
{
    return d->scene.config.model;
}

/* ---- hello ---- */

/* A list of names, units and meanings. */
static void put_names(const struct decoder *d, struct json *j, const char *key, enum field_names list)
{
    struct named n;
    json_item(j, "'%r':[", key);
    for (unsigned i = 0; names_get(model_of(d), list, i, &n); i++)
        json_item(j, "{'name':%s,'unit':%s,'meaning':%s}", n.name, n.unit, n.meaning);
    json_put(j, "]");
}

static void put_parameters(const struct decoder *d, struct json *j)
{
    struct named n;
    json_item(j, "'parameters':[");
    for (unsigned i = 0; i < LATEST_PARAMETERS; i++)
        if (names_get(model_of(d), NAMES_PARAMETER, i, &n))
            json_item(j, "{'index':%u,'name':%s,'unit':%s,'meaning':%s,'value':%n}", (uint64_t)i, n.name,
                      n.unit, n.meaning, parameter(d, (int)i));
    json_put(j, "]");
}

static void put_columns(const struct decoder *d, struct json *j)
{
    const struct model *m = model_of(d);
    json_item(j, "'columns':['frame','t','closed'");
    for (int i = 0; i < DECODE_OUTPUTS; i++)
        json_item(j, "%s", i < m->n_outputs ? m->output_signal[i].name : "");
    for (int i = 0; i < m->n_inputs; i++)
        json_item(j, "'stream_%u'", (uint64_t)i);
    json_put(j, "]");
}

bool decoder_note_identity(struct decoder *d)
{
    char why[EXPLAIN_REASON] = "";
    enum client_identity is = client_identity(&d->client);
    if (is == CLIENT_OTHER)
        explain_identity(&d->client, why);
    if (is == d->sent.identity && !strcmp(why, d->sent.why))
        return false;
    d->sent.identity = is;
    memcpy(d->sent.why, why, sizeof why);
    d->sent.why_s = clock_now_s();
    return true;
}

void decoder_put_hello(const struct decoder *d, struct json *j)
{
    const struct app_config *c = &d->scene.config;
    double f0 = scene_resonance_Hz(&d->scene);
    json_item(j, "{'plant':%u,'name':%s,'model':%s,'bus':%s,'base_id':%u,'extended':%b", (uint64_t)d->number,
              d->name, c->model->name, d->bus, (uint64_t)c->base_id, c->extended);
    json_item(j, "'identity':%s,'why':%s", identity_name[d->sent.identity], d->sent.why);
    json_item(j, "'tick_s':%t,'substeps':%u,'frame_s':%t,'frame_rate_Hz':%n,'dilation':%n,'f0_Hz':%n",
              d->scene.app.plant.tick_s, (uint64_t)c->substeps, c->frame_s, 1.0 / c->frame_s, c->dilation,
              f0 > 0.0 ? f0 : (double)NAN);
    put_columns(d, j);
    put_names(d, j, "outputs", NAMES_OUTPUT);
    put_names(d, j, "inputs", NAMES_INPUT);
    put_parameters(d, j);
    put_names(d, j, "counters", NAMES_COUNTER);
    json_item(j, "'contacts':%u,'faults':[", (uint64_t)c->model->n_contacts);
    for (int i = 0; i < TROUBLE_FAULTS; i++)
        json_item(j, "%s", trouble_fault[i].name);
    json_put(j, "],'timing':%b,'commands':%b}", d->has_timing, d->has_commands);
}

/* ---- status ---- */

/* A plant of another version may have numbers without a name here. */
static const char *name_of(const struct decoder *d, enum field_names list, unsigned index)
{
    const char *name = names_text(model_of(d), list, index);
    return name ? name : "unknown";
}

void decoder_put_status(const struct decoder *d, struct json *j)
{
    const struct latest *l = &d->client.latest;
    const double *value = l->message[WIRE_STATUS].value;
    if (!l->count[WIRE_STATUS])
        return;
    json_put(j, "event: status\ndata: {'plant':%u,'t':%t,'frame':%u,'state':%s,'session':%u",
             (uint64_t)d->number, decoder_time(d), l->frame, name_of(d, NAMES_STATE, (unsigned)l->state),
             (uint64_t)l->session);
    json_put(j, ",'reaction':%s,'watch':%u,'faults':%u,'fault_names':[",
             name_of(d, NAMES_REACTION, (unsigned)l->reaction), (uint64_t)value[STATUS_WATCH],
             (uint64_t)l->faults);
    for (int i = 0; i < TROUBLE_FAULTS; i++)
        if (l->faults >> i & 1u)
            json_item(j, "%s", trouble_fault[i].name);
    json_put(j, "]}\n\n");
}

/* ---- values ---- */

struct table {
    const char *key;
    enum field_names list;
    int n;
    const double *now;
    double *sent; /* NULL: everything is news */
};

static bool is_news(const struct table *t, int i)
{
    return !isnan(t->now[i]) && !(t->sent && t->sent[i] == t->now[i]);
}

/* The news of a table as an object; nothing where there are none. */
static void put_table(const struct model *m, struct json *j, const struct table *t)
{
    struct named n;
    bool open = false;
    for (int i = 0; i < t->n; i++) {
        if (!is_news(t, i) || !names_get(m, t->list, (unsigned)i, &n))
            continue;
        if (!open)
            json_item(j, "'%r':{", t->key);
        open = true;
        json_item(j, "'%r':%n", n.name, t->now[i]);
        if (t->sent && !j->full)
            t->sent[i] = t->now[i];
    }
    if (open)
        json_put(j, "}");
}

static void put_drives(const struct decoder *d, struct json *j, struct decoder_sent *sent)
{
    const struct model *m = model_of(d);
    struct json before = *j;
    json_item(j, "'drives':{");
    size_t open = j->n;
    for (int i = 0; i < m->n_inputs; i++)
        put_table(m, j,
                  &(struct table){m->input_signal[i].name, NAMES_ARM, ARM_FIELDS, d->client.latest.drive[i],
                                  sent ? sent->drive[i] : NULL});
    if (j->n > open) {
        json_put(j, "}");
        return;
    }
    json_take_back(j, &before);
}

void decoder_put_values(const struct decoder *d, struct json *j, struct decoder_sent *sent)
{
    const struct latest *l = &d->client.latest;
    const struct table table[] = {
        {"health", NAMES_COUNTER, DIAG_COUNTERS, l->health, sent ? sent->health : NULL},
        {"ledger", NAMES_LEDGER, LATEST_LEDGER, l->ledger, sent ? sent->ledger : NULL},
        {"info", NAMES_INFO, INFO_ITEMS, l->info, sent ? sent->info : NULL},
        {"parameters", NAMES_PARAMETER, LATEST_PARAMETERS, l->parameter, sent ? sent->parameter : NULL},
    };
    struct json before = *j;
    json_put(j, "event: values\ndata: {'plant':%u,'t':%t", (uint64_t)d->number, decoder_time(d));
    size_t empty = j->n;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        put_table(model_of(d), j, &table[i]);
    put_drives(d, j, sent);
    if (j->n > empty) {
        json_put(j, "}\n\n");
        return;
    }
    json_take_back(j, &before);
}

/* ---- heads of lists ---- */

/* A setting as the number of something; 0 for an echo that says no number of anything. */
static unsigned setting(const struct decoder *d, int index)
{
    double value = parameter(d, SETTING_FIRST + index);
    return value >= 0.0 && value <= UINT16_MAX ? (unsigned)value : 0;
}

static void put_slots(const struct decoder *d, struct json *j)
{
    const struct model *m = model_of(d);
    json_put(j, "'window_s':%n,'slots':[", setting(d, SET_LOCKIN_FRAMES) * d->scene.config.frame_s);
    for (int i = 0; i < LOCKIN_SLOTS; i++) {
        struct named output = {"", "", ""};
        const char *input = names_text(m, NAMES_INPUT, setting(d, SET_LOCKIN_CHANNEL + i));
        (void)names_get(m, NAMES_OUTPUT, setting(d, SET_LOCKIN_OUTPUT + i), &output);
        json_item(j, "{'slot':%u,'input':%s,'output':%s,'unit':%s,'harmonic':%u}", (uint64_t)i,
                  input ? input : "", output.name, output.unit,
                  (uint64_t)setting(d, SET_LOCKIN_HARMONIC + i));
    }
    json_put(j, "],");
}

static void put_burst(const struct decoder *d, struct json *j)
{
    const double *health = d->client.latest.health;
    double tick = health[DIAG_CAPTURE_TICK];
    bool known = tick >= 0.0 && tick <= UINT32_MAX;
    uint64_t near = known ? listen_nearest(d->client.latest.tick, tick, 32) : 0;
    struct named n;
    json_put(j, "'burst':%u,'sample_s':%t,'trigger_t':%t,'pretrigger':%n,'samples':%u,'signals':[",
             (uint64_t)d->bursts, setting(d, SET_CAPTURE_EVERY_TICKS) * d->scene.app.plant.tick_s,
             known ? (double)near * d->scene.app.plant.tick_s : (double)NAN, health[DIAG_CAPTURE_PRETRIGGER],
             (uint64_t)setting(d, SET_CAPTURE_SAMPLES));
    for (unsigned i = 0; names_get(model_of(d), NAMES_OUTPUT, i, &n); i++)
        json_item(j, "{'signal':%u,'name':%s,'unit':%s}", (uint64_t)i, n.name, n.unit);
    json_put(j, "],");
}

void decoder_put_head(const struct decoder *d, enum event_list list, struct json *j)
{
    if (list == LIST_LOCKIN)
        put_slots(d, j);
    else if (list == LIST_BURST)
        put_burst(d, j);
}
