/* names.c - lists of names; those of parameters, settings, counters and signals come from their own
 * tables. */
#include "host_sim/cli/names.h"

#include <string.h>
#include "firmware/bus/diag.h"
#include "firmware/app/selftest.h"
#include "firmware/bus/settings.h"
#include "firmware/bus/wire_table.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static const struct named operation[] = {
    [CONTROL_START] = {"start", "", "plant time runs, RUNNING"},
    [CONTROL_STOP] = {"stop", "", "drives to zero at once, session over, STOPPED"},
    [CONTROL_PAUSE] = {"pause", "", "plant time stands, PAUSED"},
    [CONTROL_STEP] = {"step", "", "runs ARGUMENT frames, then PAUSED"},
    [CONTROL_RUN_UNTIL] = {"run_until", "", "runs to tick ARGUMENT, then PAUSED"},
    [CONTROL_RESET] = {"reset", "", "state to rest, faults cleared, READY"},
};
static const struct named capture[] = {
    [CAPTURE_STOP] = {"stop", "", "forgets the burst"},
    [CAPTURE_ARM] = {"arm", "", "arms with the settings capture_*"},
    [CAPTURE_TRIGGER] = {"trigger", "", "triggers now"},
    [CAPTURE_READ] = {"read", "", "sends COUNT samples from FIRST"},
};
static const struct named arm[] = {
    [ARM_AMPLITUDE] = {"amplitude", "", "amplitude of the harmonic drive, in the unit of its input"},
    [ARM_FREQUENCY] = {"frequency", "Hz", "frequency of the harmonic drive"},
    [ARM_PHASE] = {"phase", "rad", "phase of the harmonic drive"},
    [ARM_RAMP] = {"ramp", "s", "length of the change, at least one tick"},
    [ARM_NOISE] = {"noise", "", "standard deviation of the noise, in the unit of its input"},
    [ARM_NOISE_HOLD] = {"noise_hold", "tick", "ticks from one value of the noise to the next, 1 to 65535"},
    [ARM_NOISE_SEED] = {"noise_seed", "", "seed of the noise, 0 to 16777215"},
};
static const struct named when[] = {
    [COMMIT_NOW] = {"now", "", "at the start of the next frame"},
    [COMMIT_WITH_FIRE] = {"with_fire", "", "with the next FIRE whose PARAMETERS is on"},
};
static const struct named state[] = {
    [STATE_OFF] = {"off", "", "no session"},
    [STATE_READY] = {"ready", "", "session open, plant time stands"},
    [STATE_RUNNING] = {"running", "", "plant time runs"},
    [STATE_PAUSED] = {"paused", "", "plant time stands, steps are possible"},
    [STATE_STOPPED] = {"stopped", "", "plant time stands, drives at zero"},
    [STATE_FROZEN] = {"frozen", "", "plant time stands after a time-out, state and drives kept"},
    [STATE_FAULT] = {"fault", "", "plant time stands after a fault, needs a reset"},
};
static const struct named reaction[] = {
    [REACTION_HOLD] = {"hold", "", "drives go on as they are"},
    [REACTION_RAMP] = {"ramp", "", "drives go to zero within reaction_ramp_s"},
    [REACTION_ZERO] = {"zero", "", "drives go to zero within one tick"},
    [REACTION_FREEZE] = {"freeze", "", "plant time stands"},
    [REACTION_NONE] = {"none", "", "heartbeats come"},
    [REACTION_STOP] = {"stop", "", "a command has ended the session"},
};
static const struct named cause[] = {
    [CAUSE_OK] = {"ok", "", "taken"},
    [CAUSE_RANGE] = {"range", "", "a value outside its range or not finite"},
    [CAUSE_LATE] = {"late", "", "the instant named has passed"},
    [CAUSE_STALE] = {"stale", "", "the frame named is too old, or the instant beyond the horizon"},
    [CAUSE_SESSION] = {"session", "", "not the session in force"},
    [CAUSE_STATE] = {"state", "", "not possible in this state"},
    [CAUSE_FULL] = {"full", "", "no room to wait in, or no memory for the burst"},
    [CAUSE_INCOMPLETE] = {"incomplete", "", "nothing armed, or count or CRC of the set differ"},
    [CAUSE_UNKNOWN] = {"unknown", "", "no such operation, index or field"},
    [CAUSE_SELF_TEST] = {"self_test", "", "the power-on self-test failed, SELF_TEST says where"},
};
static const struct named ledger[] = {
    [LEDGER_STORED] = {"stored", "J", "energy in the plant now"},
    [LEDGER_DAMPING] = {"damping", "J", "lost in the dampers since the ledger began"},
    [LEDGER_RESIDUAL] = {"residual", "J", "energy that does not balance: the error of the integration"},
    [LEDGER_CHANGE] = {"change", "J", "brought in by parameter changes"},
    [LEDGER_WORK] = {"work_0", "J", "delivered by input 0"},
    [LEDGER_WORK + 1] = {"work_1", "J", "delivered by input 1"},
    [LEDGER_WORK + 2] = {"work_2", "J", "delivered by input 2"},
    [LEDGER_WORK + 3] = {"work_3", "J", "delivered by input 3"},
};
static const struct named info[] = {
    [INFO_VERSION] = {"version", "", "version of this protocol"},
    [INFO_FRAME_RATE_HZ] = {"frame_rate_Hz", "Hz", "frames per bus second"},
    [INFO_SUBSTEPS] = {"substeps", "", "ticks per frame"},
    [INFO_F0_REAL_HZ] = {"f0_real_Hz", "Hz", "contact eigenfrequency of the real rig"},
    [INFO_DILATION] = {"dilation", "1", "bus seconds per real second"},
    [INFO_F0_BUS_HZ] = {"f0_bus_Hz", "Hz", "contact eigenfrequency as the bus sees it"},
    [INFO_PROMOTED] = {"promoted", "", "1: the watch tripped and the plant has climbed to the full model"},
    [INFO_IDENTITY] = {"identity", "", "check of all that gives frames their meaning, section 8"},
    [INFO_MODEL] = {"model", "", "check of the name of the model that the plant began with"},
    [INFO_LSB + 0] = {"lsb_displacement", "m", "one unit of DISPLACEMENT"},
    [INFO_LSB + 1] = {"lsb_velocity", "m/s", "one unit of VELOCITY and SPEED"},
    [INFO_LSB + 2] = {"lsb_penetration", "m", "one unit of PENETRATION"},
    [INFO_LSB + 3] = {"lsb_force", "N", "one unit of FORCE and PEAK_FORCE"},
    [INFO_SETTINGS] = {"settings", "", "check of settings 81 to 98 as they were at the start"},
};
static const struct named on_off[] = {{"off", "", ""}, {"on", "", ""}};
static const struct named touch[] = {{"lift_off", "", "the contact opens"},
                                     {"touchdown", "", "the contact closes"}};

static const struct named verdict[] = {
    [SELF_TEST_ABSENT] = {"absent", "", "its model or method is not in this image"},
    [SELF_TEST_PASSED] = {"passed", "", "error within tolerance"},
    [SELF_TEST_FAILED] = {"failed", "", "no session can be opened"},
};

struct list {
    const struct named *entry;
    size_t n;
};

static const struct list lists[] = {
    [NAMES_OPERATION] = {operation, COUNT(operation)},
    [NAMES_CAPTURE] = {capture, COUNT(capture)},
    [NAMES_ARM] = {arm, COUNT(arm)},
    [NAMES_WHEN] = {when, COUNT(when)},
    [NAMES_STATE] = {state, COUNT(state)},
    [NAMES_REACTION] = {reaction, COUNT(reaction)},
    [NAMES_CAUSE] = {cause, COUNT(cause)},
    [NAMES_LEDGER] = {ledger, COUNT(ledger)},
    [NAMES_INFO] = {info, COUNT(info)},
    [NAMES_ON_OFF] = {on_off, COUNT(on_off)},
    [NAMES_TOUCH] = {touch, COUNT(touch)},
    [NAMES_VERDICT] = {verdict, COUNT(verdict)},
};

static const char *const stream[MODEL_INPUTS] = {"STREAM_0", "STREAM_1", "STREAM_2", "STREAM_3"};
static const char *const arm_of[MODEL_INPUTS] = {"ARM_0", "ARM_1", "ARM_2", "ARM_3"};
static const char *const stream_echo[MODEL_INPUTS] = {"STREAM_ECHO_0", "STREAM_ECHO_1", "STREAM_ECHO_2",
                                                      "STREAM_ECHO_3"};

const char *names_kind(unsigned kind)
{
    const struct message_layout *l = wire_layout(kind);

    if (l == NULL)
        return NULL;
    if (!wire_is_of_input(l))
        return l->name;
    return (l->kind == WIRE_STREAM ? stream : l->kind == WIRE_ARM ? arm_of : stream_echo)[kind - l->kind];
}

int names_find_kind(const char *name)
{
    for (unsigned kind = 0; kind < WIRE_KINDS; kind++) {
        const char *candidate = names_kind(kind);
        if (candidate != NULL && strcmp(candidate, name) == 0)
            return (int)kind;
    }
    return -1;
}

static bool get_parameter(const struct model *m, unsigned index, struct named *n)
{
    const struct parameter *p = NULL;

    if (index < (unsigned)m->n_parameters)
        p = &m->parameter[index];
    else if (index >= SETTING_FIRST && index < SETTING_FIRST + SETTINGS)
        p = &setting_table[index - SETTING_FIRST];
    if (p != NULL)
        *n = (struct named){p->name, p->unit, p->meaning};
    return p != NULL;
}

static bool get_signal(const struct signal *s, int n_signals, unsigned index, struct named *n)
{
    if (index >= (unsigned)n_signals)
        return false;
    *n = (struct named){s[index].name, s[index].unit, s[index].meaning};
    return true;
}

static bool get_listed(const struct model *m, enum field_names list, unsigned index, struct named *n)
{
    const struct list *l = &lists[list];

    if (index >= l->n || l->entry[index].name == NULL)
        return false;
    if (list == NAMES_LEDGER && index >= (unsigned)(LEDGER_WORK + m->n_inputs))
        return false;
    *n = l->entry[index];
    return true;
}

bool names_get(const struct model *m, enum field_names list, unsigned index, struct named *n)
{
    const struct signal *s;

    switch (list) {
    case NAMES_NONE:
        return false;
    case NAMES_PARAMETER:
        return get_parameter(m, index, n);
    case NAMES_INPUT:
        return get_signal(m->input_signal, m->n_inputs, index, n);
    case NAMES_OUTPUT:
        return get_signal(m->output_signal, m->n_outputs, index, n);
    case NAMES_OBSERVABLE:
        s = index < NAMES_INDICES ? model_observable(m, (int)index) : NULL;
        return s && get_signal(s, 1, 0, n);
    case NAMES_COUNTER:
        if (index < DIAG_COUNTERS)
            *n = (struct named){diag_name[index].name, diag_name[index].unit, diag_name[index].meaning};
        return index < DIAG_COUNTERS;
    case NAMES_SELF_TEST:
        if (index < SELFTEST_CHECKS)
            *n = (struct named){selftest_table[index].name, "1", selftest_table[index].meaning};
        return index < SELFTEST_CHECKS;
    case NAMES_MESSAGE:
        if (index >= WIRE_COMMANDS || names_kind(index) == NULL)
            return false;
        *n = (struct named){names_kind(index), "", wire_layout(index)->meaning};
        return true;
    default:
        return get_listed(m, list, index, n);
    }
}

const char *names_text(const struct model *m, enum field_names list, unsigned index)
{
    struct named n;

    return names_get(m, list, index, &n) ? n.name : NULL;
}

int names_find(const struct model *m, enum field_names list, const char *name)
{
    for (unsigned i = 0; i < NAMES_INDICES; i++) {
        const char *candidate = names_text(m, list, i);
        if (candidate != NULL && strcmp(candidate, name) == 0)
            return (int)i;
    }
    return -1;
}

int names_multiplexer(const struct message_layout *l)
{
    if (strcmp(l->field[l->n_fields - 1].name, "VALUE") != 0)
        return -1;
    for (int i = 0; i < l->n_fields; i++)
        if (l->field[i].names != NAMES_NONE && l->field[i].names != NAMES_INPUT)
            return i;
    return -1;
}

/* A field's value as an index; whatever is none becomes one that no list has. */
static unsigned index_of(double value)
{
    return value >= 0.0 && value < NAMES_INDICES ? (unsigned)value : NAMES_INDICES;
}

static const char *input_unit(const struct model *m, unsigned channel)
{
    return channel < (unsigned)m->n_inputs ? m->input_signal[channel].unit : "";
}

/* The fields of a drive that have the unit of its input. */
static bool of_input(double arm_field)
{
    return arm_field == ARM_AMPLITUDE || arm_field == ARM_NOISE;
}

const char *names_unit(const struct model *m, const struct message *msg, int field)
{
    const struct message_layout *l = wire_layout(msg->kind);
    int by = names_multiplexer(l);
    struct named n;

    if ((l->kind == WIRE_STREAM && field == STREAM_SAMPLE) ||
        (l->kind == WIRE_STREAM_ECHO && field == STREAM_ECHO_SAMPLE))
        return input_unit(m, (unsigned)(msg->kind - l->kind));
    if (by < 0 || field != l->n_fields - 1)
        return l->field[field].unit;
    if (!names_get(m, l->field[by].names, index_of(msg->value[by]), &n))
        return "";
    if (l->kind == WIRE_ARM && of_input(msg->value[ARM_FIELD]))
        return input_unit(m, msg->kind - WIRE_ARM);
    if (l->kind == WIRE_DRIVE_ECHO && of_input(msg->value[DRIVE_ECHO_FIELD]))
        return input_unit(m, index_of(msg->value[DRIVE_ECHO_CHANNEL]));
    return n.unit;
}
