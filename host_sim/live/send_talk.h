/* send_talk.h - contactplant send's knowledge of the plant, and waiting for its answers with heartbeats. */
#ifndef HOST_SIM_SEND_TALK_H
#define HOST_SIM_SEND_TALK_H

#include "host_sim/cli/options.h"
#include "host_sim/live/remote.h"

enum {
    SEND_TRIES = 3
}; /* the first try may repeat a counter of the session's owner, and is then not taken */

#define SEND_HEARTBEAT_S 0.01
#define SEND_LOOK_S      0.01 /* from look to look at what has come */
#define SEND_ANSWER_S    0.3  /* longest wait for an answer of a plant that is heard */
#define SEND_SILENCE_S   5.0  /* and of one that is not: it may wait for a processor */

struct sender {
    const struct options *o;
    struct remote remote;
    double next_beat_s;
    unsigned armed;         /* inputs armed on this command line */
    bool stopped;           /* its last command was stop: the session is over */
    bool answered, refused; /* the command that send_expect announced */
    /* burst being read */
    float *burst;
    uint32_t first, count;
};

const struct model *send_model(const struct sender *s);

/* Takes each message that the client gets; `context` is the sender. */
void send_take(void *context, const struct frame *f, const struct message *m);

/* As client_expect. */
void send_expect(struct sender *s, unsigned kind);

/* Waits for it, with heartbeats: true when it came. It is printed when it comes. */
bool send_wait(struct sender *s, double seconds);

/* As send_wait, as long as an answer can take. */
bool send_answer(struct sender *s);

/* Says that no answer came to `what`; the exit status. */
int send_no_answer(const struct sender *s, const char *what);

/* Asks the plant for a parameter or setting; NaN without an answer. */
double send_ask(struct sender *s, unsigned index);

#endif
