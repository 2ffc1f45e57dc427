/* send_verbs.h - the commands of contactplant send: each goes to the plant, and its answer is printed. */
#ifndef HOST_SIM_SEND_VERBS_H
#define HOST_SIM_SEND_VERBS_H

#include "host_sim/live/action.h"
#include "host_sim/live/send_talk.h"

enum { SEND_WORDS = 80 /* on one command line */ };

/* The verbs that it has: bits 1 << enum action_verb. */
extern const unsigned send_verbs;

/* 0, or the exit status after a line: what no model can tell, before anything is sent. */
int send_check(const struct sender *s, const struct action *a);

/* Sends it and waits. 0, or the exit status after a line. */
int send_run(struct sender *s, const struct action *a);

#endif
