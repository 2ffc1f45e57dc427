/* command.c - one frame of any command to an app in any state: its counter looked at, handled and answered.
 * The app's invariants are assumed before it; the counts that bound its arrays are shown to hold after it.
 *
 * Decoding gives what the proof of wire.c lets it give: any number in a float, any of its units in an
 * integer. The plant is the default rig with rk4. Whether it accepts a parameter set is unknown; one that it
 * has accepted it takes. */
#define plant_accepts plant_accepts_left_out
#define plant_change  plant_change_left_out
#include "firmware/plant/plant_change.c"
#include "firmware/plant/plant_change.h"
#undef plant_accepts
#undef plant_change
#define wire_decode wire_decode_proved_elsewhere
#include "firmware/bus/wire.c"
#include "firmware/bus/wire_table.h"
#undef wire_decode

#include "firmware/app/app.h"
#include "firmware/app/command.h"
#include "models/hertz_rig.h"
#include "tests/eva/seams.h"

const char *plant_accepts(const struct plant *pl, const double *si);
const char *plant_change(struct plant *pl, const double *si);
enum wire_status wire_decode(const struct wire_scene *s, const struct frame *f, struct message *m);

static uint32_t command_kind,
    command_index; /* kind of the frame that arrives, and its field 1 where that is an index */

const char *plant_accepts(const struct plant *pl, const double *si)
{
    (void)pl, (void)si;
    return eva_bool() ? "a reason" : NULL;
}

const char *plant_change(struct plant *pl, const double *si)
{
    (void)pl, (void)si;
    return NULL;
}

static double any_number(void)
{
    double x;
    eva_any(&x, sizeof x);
    return x;
}

enum wire_status wire_decode(const struct wire_scene *s, const struct frame *f, struct message *m)
{
    const struct message_layout *l = wire_layout(command_kind);
    (void)f;
    if (!l)
        return WIRE_BAD_KIND;
    *m = (struct message){.kind = (uint8_t)command_kind};
    m->counter = (uint8_t)eva_uint(0, WIRE_COUNTER_STATES - 1);
    for (int i = 0; i < l->n_fields; i++) {
        double max = (double)field_mask(&l->field[i]) * wire_factor(s, l->field[i].scale);
        bool code = l->field[i].kind == FIELD_SIGNED; /* only DAC has such fields */
        m->value[i] = l->field[i].kind == FIELD_FLOAT ? any_number()
                      : code                          ? eva_between(INT16_MIN, INT16_MAX)
                                                      : eva_between(0.0, max);
    }
    if (command_index != UINT32_MAX)
        m->value[1] = command_index;
    return (enum wire_status)Frama_C_interval(WIRE_OK, WIRE_BAD_KIND);
}

static struct app app;
static int waiting;

static int receive(void *context, struct frame *f)
{
    (void)context;
    *f = (struct frame){.id = app.scene.base_id};
    return waiting-- > 0;
}

static int transmit(void *context, const struct frame *f)
{
    (void)context, (void)f;
    return Frama_C_interval(0, 1);
}

static void flush(void *context)
{
    (void)context;
}

static uint32_t now_us(void *context)
{
    (void)context;
    return 0;
}

static const struct hal hal = {NULL, receive, transmit, flush, now_us, flush};

/* A plant with converters, whose settings change no stage. */
static void dac(struct plant *pl, const int16_t *code)
{
    (void)pl, (void)code;
}

static void change(struct stages *s, struct plant *pl, const double *setting)
{
    (void)s, (void)pl, (void)setting;
}

static const char *refuse(const struct model *m, double tick_s, const double *setting)
{
    (void)m, (void)tick_s, (void)setting;
    return eva_bool() ? "a reason" : NULL;
}

static const struct plant_stage_calls converters = {.refuse = refuse, .change = change, .dac = dac};

/* Settings and parameters inside their ranges: what setting_accepts and parameters_write let in. */
static void any_sets(void)
{
    any_settings(&app);
    for (int i = 0; i < SETTINGS; i++)
        app.mailbox.staged.value[SETTING_FIRST + i] = app.mailbox.committed.value[SETTING_FIRST + i] =
            app.setting[i];
    for (int i = 0; i < RIG_PARAMETERS; i++)
        app.mailbox.staged.value[i] = app.mailbox.committed.value[i] =
            eva_between(hertz_rig_parameters[i].min, hertz_rig_parameters[i].max);
    for (int i = 0; i < STAGED_VALUES / 32; i++)
        app.mailbox.staged.given[i] = app.mailbox.committed.given[i] = i == 1 ? 0 : (uint32_t)eva_word();
}

static void any_app(bool codes)
{
    any_sets();
    any_burst(&app);
    any_codes(&app, &converters, codes);
    app.state = (enum plant_state)Frama_C_interval(STATE_OFF, STATE_FAULT);
    app.frame = eva_word();
    app.echo_from = eva_word();
    app.heartbeat_frame = eva_word();
    app.step_left = eva_word();
    app.faults = (uint8_t)eva_word();
    app.enabled = eva_bool();
    app.session = (uint8_t)eva_uint(0, 15);
    app.jump = eva_uint(0, UINT16_MAX);
    app.away = eva_uint(0, UINT16_MAX);
    app.due = eva_uint(0, 101);
    app.plant.now.tick = eva_word();
    app.plant.now.fraction = eva_uint(0, TICK_FRACTIONS - 1);
    app.mailbox.n_fires = eva_uint(0, MAILBOX_FIRES);
    app.mailbox.n_samples = eva_uint(0, MAILBOX_SAMPLES);
    app.mailbox.commit_with_fire = eva_bool();
    for (int i = 0; i < STAGED_VALUES / 32; i++)
        app.telemetry.echo_pending[i] = i == 1 ? 0 : (uint32_t)eva_word();
    app.telemetry.n_tx = 0;
    for (int i = 0; i < MODEL_INPUTS; i++)
        app.mailbox.armed[i].given = (uint8_t)eva_word();
    for (int i = 0; i < WIRE_COMMANDS; i++)
        app.receiver[i] = (struct receiver){eva_bool(), (uint8_t)eva_uint(0, WIRE_COUNTER_STATES - 1)};
}

static void one(uint32_t kind, uint32_t index)
{
    any_app(kind == WIRE_DAC);
    command_kind = kind;
    command_index = index;
    waiting = 1;
    command_receive(&app);
    /*@ assert fires_fit: app.mailbox.n_fires <= MAILBOX_FIRES; */
    /*@ assert samples_fit: app.mailbox.n_samples <= MAILBOX_SAMPLES; */
    ASSERT(app.mailbox.staged.given[1] == 0 && app.mailbox.committed.given[1] == 0);
    ASSERT(seam_telemetry(&app));
    ASSERT(seam_signals(&app));
    ASSERT(seam_codes(&app));
}

/* ARM, PARAM_WRITE and PARAM_READ name by an index what their value is; each index by itself. */
static uint32_t indices(uint32_t kind)
{
    if (kind >= WIRE_ARM && kind < WIRE_ARM + MODEL_INPUTS)
        return ARM_FIELDS + 1;
    return kind == WIRE_PARAM_WRITE || kind == WIRE_PARAM_READ ? SETTING_FIRST + SETTINGS + 1 : 0;
}

int main(void)
{
    const struct app_config c = {.model = &hertz_rig,
                                 .method = &rk4,
                                 .frame_s = 1e-3,
                                 .substeps = 16,
                                 .dilation = 1.0,
                                 .base_id = 0x200};
    const char *why = app_init(&app, &c, &hal);
    if (why)
        return 1;
    /*@ loop unroll 20; */
    for (uint32_t kind = 0; kind < WIRE_COMMANDS; kind++)
        if (indices(kind) == 0)
            one(kind, UINT32_MAX);
        else
            /*@ loop unroll 200; */
            for (uint32_t index = 0; index < indices(kind); index++)
                one(kind, index);
    return 0;
}
