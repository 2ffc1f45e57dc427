/* telemetry.c - one report of an app in any state that the seams allow. Each message has a kind that is
 * telemetry's, each index exists, each number fits its type, and seam_telemetry holds again. Then the
 * sending: frames that wait fit their slots. `wire` has the numbers of a message, `capture` the burst. */
#define telemetry_send      telemetry_send_itself
#define telemetry_send_kept telemetry_send_kept_itself
#define telemetry_waits     telemetry_waits_itself
#define telemetry_drop_kept telemetry_drop_kept_itself
#define telemetry_reply     telemetry_reply_itself
#include "firmware/app/telemetry_send.c"
#include "firmware/app/telemetry_send.h"
#undef telemetry_send
#undef telemetry_send_kept
#undef telemetry_waits
#undef telemetry_drop_kept
#undef telemetry_reply

#include "firmware/bus/wire_table.h"
#include "models/shaft_bearing.h"
#include "tests/eva/any_plant.h"
#include "tests/eva/seams.h"

void telemetry_send(struct telemetry *t, const struct app *a, const struct message *m);
void telemetry_send_kept(struct telemetry *t, const struct app *a);
bool telemetry_waits(const struct telemetry *t, const struct app *a, unsigned kind);

static struct app app;
static float memory[1];

/* ---- the report ---- */

void telemetry_send(struct telemetry *t, const struct app *a, const struct message *m)
{
    (void)t, (void)a;
    ASSERT(m->kind >= WIRE_COMMANDS && m->kind < WIRE_KINDS && wire_layout(m->kind));
}

void telemetry_send_kept(struct telemetry *t, const struct app *a)
{
    (void)a;
    t->n_tx = eva_uint(0, TELEMETRY_SLOTS);
}

bool telemetry_waits(const struct telemetry *t, const struct app *a, unsigned kind)
{
    (void)t, (void)a;
    ASSERT(kind >= WIRE_COMMANDS && kind < WIRE_KINDS);
    return eva_bool();
}

bool capture_next(const struct capture *c, struct capture_reading *r, const float *floats, uint32_t *signal,
                  uint32_t *sample, float *value)
{
    ASSERT(c == &app.capture && r == &app.telemetry.reading && floats == memory && seam_burst(&app));
    *signal = eva_uint(0, MODEL_OUTPUTS - 1);
    *sample = eva_uint(0, UINT16_MAX);
    eva_any(value, sizeof *value);
    return eva_bool();
}

static void any_telemetry(struct telemetry *t, uint32_t n_inputs)
{
    eva_any(t, sizeof *t);
    t->n_tx = eva_uint(0, TELEMETRY_SLOTS);
    t->echo_next = eva_uint(0, n_inputs * ARM_FIELDS + INFO_ITEMS - 1);
    t->ledger_next = eva_uint(0, LEDGER_WORK + n_inputs - 1);
    t->health_next = eva_uint(0, DIAG_COUNTERS - 1);
    t->info_pending = eva_uint(0, (1u << INFO_ITEMS) - 1);
    t->selftest_pending = (uint16_t)eva_uint(0, (1u << SELFTEST_CHECKS) - 1);
    t->echo_pending[1] = 0;
}

static void dac(struct plant *to_move, const int16_t *code)
{
    (void)to_move, (void)code;
}

static const struct plant_stage_calls converters = {.dac = dac};

/* Bits that wait are told from the lowest on: each by itself. */
static void report(const struct model *m, uint32_t info, uint32_t selftest, bool codes)
{
    any_plant(m);
    eva_any(&app, sizeof app);
    app.plant = pl;
    app.config.model = m;
    app.config.capture = memory;
    any_codes(&app, &converters, codes);
    any_settings(&app);
    any_burst(&app);
    any_telemetry(&app.telemetry, (uint32_t)m->n_inputs);
    app.telemetry.info_pending = info;
    app.telemetry.selftest_pending = (uint16_t)selftest;
    app.state = (enum plant_state)Frama_C_interval(STATE_OFF, STATE_FAULT);
    app.reaction = (enum reaction)Frama_C_interval(0, 7);
    app.enabled = eva_bool();
    app.watch.tripped = eva_bool();
    app.sensor.newest = eva_uint(0, SENSOR_RING - 1);
    app.scene.extended = eva_bool();
    telemetry_report(&app.telemetry, &app, eva_uint(0, UINT32_MAX));
    ASSERT(seam_telemetry(&app));
    telemetry_greet(&app.telemetry, &app);
    ASSERT(seam_telemetry(&app));
}

/* ---- the slots ---- */

static int transmit(void *context, const struct frame *f)
{
    (void)context, (void)f;
    return Frama_C_interval(0, 1);
}

static const struct hal hal = {.send = transmit};

void wire_encode(const struct wire_scene *s, const struct message *m, struct frame *f)
{
    eva_any(f, sizeof *f);
    f->id = s->base_id + m->kind;
}

/* So many frames wait, each of a kind of its own: which kind stands where makes no difference. */
static void any_slots(uint32_t n)
{
    app.telemetry.n_tx = n;
    for (uint32_t i = 0; i < TELEMETRY_SLOTS; i++)
        app.telemetry.tx[i].id = app.scene.base_id + WIRE_COMMANDS + i;
}

/* One more, of the kind of the one at place k, or of a new one. */
static void put(uint32_t n, uint32_t k)
{
    const struct message m = {.kind = (uint8_t)(WIRE_COMMANDS + k)};
    any_slots(n);
    telemetry_send_itself(&app.telemetry, &app, &m);
    ASSERT(app.telemetry.n_tx <= TELEMETRY_SLOTS);
}

static void slots(uint32_t n)
{
    /*@ loop unroll 64; */
    for (uint32_t k = 0; k <= n && k < TELEMETRY_SLOTS; k++)
        put(n, k);
    any_slots(n);
    (void)telemetry_waits_itself(&app.telemetry, &app, WIRE_COMMANDS + n);
    telemetry_send_kept_itself(&app.telemetry, &app);
    ASSERT(app.telemetry.n_tx <= TELEMETRY_SLOTS);
    telemetry_drop_kept_itself(&app.telemetry);
}

int main(void)
{
    /*@ loop unroll 14; */
    for (int i = 0; i < MODELS; i++)
        report(model_table[i], 0, 0, false);
    /*@ loop unroll 32; */
    for (unsigned i = 0; i < INFO_ITEMS; i++)
        report(&shaft_bearing, 1u << i, 0, false);
    /*@ loop unroll 32; */
    for (unsigned i = 0; i < SELFTEST_CHECKS; i++)
        report(&shaft_bearing, 0, 1u << i, false);
    report(&shaft_bearing, 0, 0, true);
    app.hal = &hal;
    app.scene.base_id = 0x200;
    /*@ loop unroll 64; */
    for (uint32_t n = 0; n <= TELEMETRY_SLOTS; n++)
        slots(n);
    return 0;
}
