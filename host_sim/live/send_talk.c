/* send_talk.c - see send_talk.h. */
#include "firmware/bus/wire_table.h"
#include "host_sim/live/send_talk.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/names.h"

#include <math.h>
#include <stdio.h>

const struct model *send_model(const struct sender *s)
{
    return s->remote.scene.config.model;
}

void send_take(void *context, const struct frame *f, const struct message *m)
{
    struct sender *s = context;
    (void)f;
    const struct client_reply *r = &s->remote.client.reply;
    if (r->came && !s->answered) {
        struct named n = {"?", "", ""};
        (void)names_get(send_model(s), NAMES_CAUSE, (unsigned)r->cause, &n);
        s->answered = true;
        s->refused = r->cause != CAUSE_OK;
        bool burst = s->burst && !s->refused; /* it is the answer */
        if (r->kind != WIRE_ENABLE && !burst)
            printf("%s: %s%s%s%s\n", names_kind(r->kind), s->refused ? "refused, " : "", n.name,
                   s->refused ? ": " : "", s->refused ? n.meaning : "");
    }
    if (m->kind == WIRE_CAPTURE_DATA && s->burst) {
        uint32_t sample = (uint32_t)m->value[CAPTURE_DATA_SAMPLE] - s->first;
        unsigned n = (unsigned)send_model(s)->n_outputs, signal = (unsigned)m->value[CAPTURE_DATA_SIGNAL];
        if (sample < s->count && signal < n)
            s->burst[sample * n + signal] = (float)m->value[CAPTURE_DATA_VALUE];
    }
}

static bool is_answered(const struct client *c, const void *argument)
{
    struct sender *s = c->heard_context;
    double now = clock_now_s();
    (void)argument;
    if (now >= s->next_beat_s) {
        client_enable(&s->remote.client, true);
        s->next_beat_s = now + SEND_HEARTBEAT_S;
    }
    return s->answered;
}

bool send_wait(struct sender *s, double seconds)
{
    return client_wait(&s->remote.client, is_answered, NULL, seconds);
}

bool send_answer(struct sender *s)
{
    const struct latest *l = &s->remote.client.latest;
    uint64_t next = l->frame + 2; /* the frame after the one that is at work has taken the command */
    double end = clock_now_s() + SEND_SILENCE_S;
    bool answered = send_wait(s, SEND_ANSWER_S);
    while (!answered && l->frame < next && clock_now_s() < end && !clock_interrupted())
        answered = send_wait(s, SEND_ANSWER_S);
    return answered;
}

void send_expect(struct sender *s, unsigned kind)
{
    client_expect(&s->remote.client, kind);
    s->answered = false;
    s->refused = false;
}

int send_no_answer(const struct sender *s, const char *what)
{
    return options_failure(s->o->usage, "no answer to %s; is the plant still running?", what);
}

/* Asks for one index until its echo comes; NaN without an answer. */
double send_ask(struct sender *s, unsigned index)
{
    double *known = &s->remote.client.latest.parameter[index];
    *known = (double)NAN;
    for (int i = 0; i < SEND_TRIES && isnan(*known); i++) {
        double end = clock_now_s() + SEND_ANSWER_S;
        send_expect(s, WIRE_PARAM_READ);
        client_read(&s->remote.client, index);
        while (isnan(*known) && !s->refused && clock_now_s() < end)
            (void)send_wait(s, SEND_LOOK_S);
    }
    return *known;
}
