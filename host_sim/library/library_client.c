/* library_client.c - a controller's client over the caller's transport: host_sim/live/client.c with errors
 * and checks. */
#include "host_sim/library/library.h"

#include <math.h>
#include <string.h>
#include "firmware/bus/wire_table.h"
#include "host_sim/cli/names.h"
#include "host_sim/library/library_bus.h"
#include "host_sim/library/library_plant.h"
#include "host_sim/live/explain.h"

STATIC_ASSERT(sizeof(struct contactplant_client) <= CONTACTPLANT_CLIENT_SIZE, client_fits_its_promised_size);
STATIC_ASSERT((int)CONTACTPLANT_START == CONTROL_START && (int)CONTACTPLANT_STOP == CONTROL_STOP &&
                  (int)CONTACTPLANT_PAUSE == CONTROL_PAUSE && (int)CONTACTPLANT_STEP == CONTROL_STEP &&
                  (int)CONTACTPLANT_RUN_UNTIL == CONTROL_RUN_UNTIL &&
                  (int)CONTACTPLANT_RESET == CONTROL_RESET,
              operations_of_the_wire);
STATIC_ASSERT((int)CONTACTPLANT_STATE_OFF == STATE_OFF && (int)CONTACTPLANT_STATE_READY == STATE_READY &&
                  (int)CONTACTPLANT_STATE_RUNNING == STATE_RUNNING &&
                  (int)CONTACTPLANT_STATE_PAUSED == STATE_PAUSED &&
                  (int)CONTACTPLANT_STATE_STOPPED == STATE_STOPPED &&
                  (int)CONTACTPLANT_STATE_FROZEN == STATE_FROZEN &&
                  (int)CONTACTPLANT_STATE_FAULT == STATE_FAULT,
              states_of_the_wire);

static const uint64_t client_magic = 0x6E65696C63637063u;

/* A wait that takes no time counts as this, so that waits end. */
static const double shortest_wait_s = 1e-6;

static bool is_client(const struct contactplant_client *c)
{
    return c && (uintptr_t)c % CONTACTPLANT_ALIGN == 0 && c->magic == client_magic;
}

size_t contactplant_client_size(void)
{
    return sizeof(struct contactplant_client);
}

const char *contactplant_client_error(const struct contactplant_client *c)
{
    return is_client(c) ? c->error.text : "not a client: give what contactplant_client_open has returned";
}

struct contactplant *contactplant_client_plant(struct contactplant_client *c)
{
    return is_client(c) ? &c->plant : NULL;
}

/* ---- the transport as the client's hal and waiter ---- */

static void flush(struct contactplant_client *c)
{
    if (c->is_unsent && c->transport.flush)
        c->transport.flush(c->transport.context);
    c->is_unsent = false;
}

static int hal_receive(void *context, struct frame *f)
{
    struct contactplant_client *c = context;
    struct contactplant_frame frame;
    flush(c);
    int got = c->transport.receive(c->transport.context, &frame);
    if (got <= 0)
        return got ? -HAL_DROPPED : 0;
    return library_frame_in(&frame, f) ? 1 : -HAL_FOREIGN;
}

static int hal_send(void *context, const struct frame *f)
{
    struct contactplant_client *c = context;
    struct contactplant_frame frame;
    library_frame_out(f, &frame);
    c->is_unsent = true;
    return c->transport.send(c->transport.context, &frame) == 1;
}

/* Commands go out together, when the client listens again. */
static void hal_flush(void *context)
{
    (void)context;
}

static double waiter_now_s(void *context)
{
    const struct contactplant_client *c = context;
    return c->waited_s;
}

static bool waiter_is_interrupted(void *context)
{
    const struct contactplant_client *c = context;
    return c->is_ended;
}

static void waiter_rest(void *context, double seconds)
{
    struct contactplant_client *c = context;
    double waited = c->transport.wait(c->transport.context, seconds);
    c->is_ended = c->is_ended || waited < 0.0;
    c->waited_s += waited > shortest_wait_s ? waited : shortest_wait_s;
}

static bool transport_is_whole(const struct contactplant_transport *t)
{
    return t && t->receive && t->send && t->wait;
}

struct contactplant_client *contactplant_client_open(void *memory, size_t size, const char *scene,
                                                     const struct contactplant_transport *transport,
                                                     struct contactplant_error *error)
{
    struct contactplant_client *c = memory;
    if (error)
        *error = (struct contactplant_error){.code = CONTACTPLANT_OK};
    if (!library_memory_fits(memory, size, sizeof *c, error))
        return NULL;
    if (!scene || !transport_is_whole(transport)) {
        (void)library_fail(error, CONTACTPLANT_BAD_VALUE,
                           "scene, transport, receive, send or wait is NULL; give all of them");
        return NULL;
    }
    memset(c, 0, sizeof *c);
    c->transport = *transport;
    c->hal = (struct hal){.context = c, .recv = hal_receive, .send = hal_send, .flush = hal_flush};
    c->waiter = (struct client_waiter){c, waiter_now_s, waiter_is_interrupted, waiter_rest};
    /* as on the bus, for its identity; then alone, for the caller, where the scene has a plant alone */
    if (library_open(&c->plant, scene, true, sizeof c->plant, error) != CONTACTPLANT_OK)
        return NULL;
    client_begin(&c->client, &c->hal, &c->plant.scene.app.scene, &c->waiter);
    if (library_open(&c->plant, scene, false, sizeof c->plant, NULL) != CONTACTPLANT_OK)
        (void)library_open(&c->plant, scene, true, sizeof c->plant, NULL); /* it has just been taken */
    c->magic = client_magic;
    return c;
}

/* ---- commands ---- */

static int sent(struct contactplant_client *c, bool good)
{
    return good ? CONTACTPLANT_OK
                : library_fail(&c->error, CONTACTPLANT_FULL,
                               "the transport had no room for the command; send it again later");
}

static int check_input(struct contactplant_client *c, int input)
{
    if (!is_client(c))
        return CONTACTPLANT_BAD_HANDLE;
    if (library_is_input(&c->plant, input))
        return CONTACTPLANT_OK;
    c->error = c->plant.error;
    return c->error.code;
}

int contactplant_client_heartbeat(struct contactplant_client *c)
{
    return is_client(c) ? sent(c, client_enable(&c->client, true)) : CONTACTPLANT_BAD_HANDLE;
}

int contactplant_client_control(struct contactplant_client *c, enum contactplant_operation operation,
                                uint64_t argument)
{
    if (!is_client(c))
        return CONTACTPLANT_BAD_HANDLE;
    if (operation < CONTACTPLANT_START || operation > CONTACTPLANT_RESET)
        return library_fail(&c->error, CONTACTPLANT_BAD_VALUE, "no such operation: %d", (int)operation);
    bool counts = operation == CONTACTPLANT_STEP || operation == CONTACTPLANT_RUN_UNTIL;
    return sent(c, client_control(&c->client, (enum control_operation)operation,
                                  counts ? argument : c->client.latest.frame));
}

int contactplant_client_arm(struct contactplant_client *c, int input, double amplitude, double frequency_Hz,
                            double phase_rad, double ramp_s)
{
    int code = check_input(c, input);
    return code == CONTACTPLANT_OK
               ? sent(c, client_arm(&c->client, input, amplitude, frequency_Hz, phase_rad, ramp_s))
               : code;
}

int contactplant_client_fire(struct contactplant_client *c, unsigned inputs, uint64_t tick, double fraction)
{
    if (!is_client(c))
        return CONTACTPLANT_BAD_HANDLE;
    if (!(fraction >= 0.0 && fraction < 1.0))
        return library_fail(&c->error, CONTACTPLANT_BAD_VALUE,
                            "the fraction of a tick is 0 or more, below 1");
    int n = c->plant.scene.config.model->n_inputs;
    if (!inputs || inputs >> n)
        return library_fail(&c->error, CONTACTPLANT_BAD_INDEX,
                            "inputs to fire are bits: %s has inputs 0 to %d",
                            c->plant.scene.config.model->name, n - 1);
    return sent(c, client_fire(&c->client, inputs, false, tick, fraction));
}

int contactplant_client_stream(struct contactplant_client *c, int input, uint64_t frame, double value)
{
    int code = check_input(c, input);
    return code == CONTACTPLANT_OK ? sent(c, client_stream(&c->client, input, frame, value)) : code;
}

static int check_parameter(struct contactplant_client *c, int index)
{
    if (scene_parameter(c->plant.scene.config.model, index))
        return CONTACTPLANT_OK;
    return library_fail(&c->error, CONTACTPLANT_BAD_INDEX, "no parameter or setting %d", index);
}

int contactplant_client_set_parameters(struct contactplant_client *c, int n, const int *index,
                                       const double *value)
{
    unsigned wire[STAGED_VALUES];
    if (!is_client(c))
        return CONTACTPLANT_BAD_HANDLE;
    if (n < 1 || n > STAGED_VALUES || !index || !value)
        return library_fail(&c->error, CONTACTPLANT_BAD_VALUE, "give 1 to %d parameters", STAGED_VALUES);
    for (int i = 0; i < n; i++) {
        if (check_parameter(c, index[i]) != CONTACTPLANT_OK)
            return c->error.code;
        wire[i] = (unsigned)index[i];
    }
    return sent(c, client_set(&c->client, n, wire, value, COMMIT_NOW));
}

/* ---- waiting ---- */

static int timeout(struct contactplant_client *c, const char *what)
{
    const char *state =
        names_text(c->plant.scene.config.model, NAMES_STATE, (unsigned)c->client.latest.state);
    return library_fail(&c->error, CONTACTPLANT_TIMEOUT, "waited in vain for %s%s; the plant is %s", what,
                        c->is_ended ? ", until the transport ended it" : "",
                        c->client.latest.count[WIRE_STATUS] ? state : "silent");
}

/* A wait begins, which the transport may end. */
static int begin_wait(struct contactplant_client *c, double seconds)
{
    if (!is_client(c))
        return CONTACTPLANT_BAD_HANDLE;
    if (isnan(seconds))
        return library_fail(&c->error, CONTACTPLANT_BAD_VALUE, "the seconds to wait are not a number");
    c->is_ended = false;
    return CONTACTPLANT_OK;
}

int contactplant_client_begin(struct contactplant_client *c, double seconds)
{
    char why[EXPLAIN_REASON];
    int code = begin_wait(c, seconds);
    if (code != CONTACTPLANT_OK)
        return code;
    if (client_open(&c->client, false, seconds))
        return CONTACTPLANT_OK;
    if (!c->client.latest.count[WIRE_STATUS])
        return timeout(c, "a plant");
    explain_no_session(&c->client, why);
    return library_fail(&c->error, CONTACTPLANT_REFUSED, "%s", why);
}

int contactplant_client_end(struct contactplant_client *c, double seconds)
{
    int code = begin_wait(c, seconds);
    if (code != CONTACTPLANT_OK)
        return code;
    return client_close(&c->client, seconds) ? CONTACTPLANT_OK : timeout(c, "the end of the session");
}

int contactplant_client_poll(struct contactplant_client *c)
{
    return is_client(c) ? client_poll(&c->client) : 0;
}

static uint64_t replies(const struct client *c)
{
    uint64_t n = 0;
    for (int i = 0; i < CAUSES; i++)
        n += c->latest.reply[i];
    return n;
}

static bool has_replies(const struct client *c, const void *argument)
{
    return replies(c) >= *(const uint64_t *)argument;
}

int contactplant_client_wait(struct contactplant_client *c, enum contactplant_wait what, uint64_t value,
                             double seconds)
{
    int code = begin_wait(c, seconds);
    if (code != CONTACTPLANT_OK)
        return code;
    switch (what) {
    case CONTACTPLANT_WAIT_ALIVE:
        return client_wait_alive(&c->client, seconds) ? CONTACTPLANT_OK : timeout(c, "a plant");
    case CONTACTPLANT_WAIT_STATE:
        return client_wait_state(&c->client, (enum plant_state)value, seconds) ? CONTACTPLANT_OK
                                                                               : timeout(c, "a state");
    case CONTACTPLANT_WAIT_TICK:
        return client_wait_tick(&c->client, value, seconds) ? CONTACTPLANT_OK : timeout(c, "a tick");
    case CONTACTPLANT_WAIT_CONTACT:
        return client_wait_contact(&c->client, value, seconds) ? CONTACTPLANT_OK : timeout(c, "CONTACT");
    case CONTACTPLANT_WAIT_REPLY:
        return client_wait(&c->client, has_replies, &value, seconds) ? CONTACTPLANT_OK
                                                                     : timeout(c, "a reply");
    default:
        return library_fail(&c->error, CONTACTPLANT_BAD_VALUE,
                            "cannot wait for %d: take one of enum contactplant_wait", (int)what);
    }
}

static bool is_told(const struct client *c, const void *argument)
{
    return !isnan(c->latest.parameter[*(const int *)argument]);
}

double contactplant_client_parameter(struct contactplant_client *c, int index, double seconds)
{
    if (begin_wait(c, seconds) != CONTACTPLANT_OK || check_parameter(c, index) != CONTACTPLANT_OK)
        return (double)NAN;
    c->client.latest.parameter[index] = (double)NAN;
    if (sent(c, client_read(&c->client, (unsigned)index)) != CONTACTPLANT_OK)
        return (double)NAN;
    if (!client_wait(&c->client, is_told, &index, seconds))
        (void)timeout(c, "a parameter");
    return c->client.latest.parameter[index];
}

int contactplant_client_latest(struct contactplant_client *c, struct contactplant_latest *latest, size_t size)
{
    if (!is_client(c))
        return CONTACTPLANT_BAD_HANDLE;
    if (!latest)
        return library_fail(&c->error, CONTACTPLANT_BAD_VALUE, "contactplant_client_latest: latest is NULL");
    const struct latest *l = &c->client.latest;
    struct contactplant_latest all = {.frame = l->frame,
                                      .tick = l->tick,
                                      .contact_tick = l->contact_tick,
                                      .state = (int32_t)l->state,
                                      .session =
                                          client_in_session(&c->client) && l->session == c->client.session,
                                      .faults = l->faults,
                                      .in_contact = l->in_contact,
                                      .displacement_m = l->displacement_m,
                                      .velocity_m_per_s = l->velocity_m_per_s,
                                      .penetration_m = l->penetration_m,
                                      .force_N = l->force_N,
                                      .contact_loss = l->contact_loss,
                                      .touchdowns = l->touchdowns,
                                      .liftoffs = l->liftoffs,
                                      .accepted = l->reply[CAUSE_OK],
                                      .refused = replies(&c->client) - l->reply[CAUSE_OK],
                                      .refused_late = l->reply[CAUSE_LATE],
                                      .unsent = c->client.unsent,
                                      .bad = c->client.bad};
    memcpy(all.lockin, l->lockin_amplitude, sizeof all.lockin);
    memcpy(all.lockin_phase_rad, l->lockin_phase, sizeof all.lockin_phase_rad);
    memcpy(latest, &all, size < sizeof all ? size : sizeof all);
    return CONTACTPLANT_OK;
}
