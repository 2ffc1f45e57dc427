/* page_send.h - scope --control: commands from the page, each run by contactplant send as a process of its
 * own.
 *
 * So words, refusals and session are those of send. A plant has one command at a time: a later one ends the
 * one before, as does a browser that leaves. */
#ifndef HOST_SIM_PAGE_SEND_H
#define HOST_SIM_PAGE_SEND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>
#include "host_sim/cli/options.h"
#include "host_sim/scope/http.h"

enum { PAGE_SEND_PLANTS = 8, PAGE_SEND_NAME = 1024 };

struct page_send_plant {
    const struct options *o; /* the scope's: they describe the plant */
    char scene[PAGE_SEND_NAME], bus[PAGE_SEND_NAME], peer[PAGE_SEND_NAME]; /* for send; peer "": none */
    bool is_beside; /* it runs here, so --peer of the options are its own peers */
    char base_id[16];
    char line[HTTP_BODY + 1]; /* the command */
    bool waits;               /* it is not at work yet */
    uint32_t number;          /* commands so far */
    pid_t pid;                /* 0: none is at work */
    int status;               /* from the one that has ended last */
    int words;                /* its words come here; -1: none do */
    double until_s;           /* when its time to end is over; 0: it need not end */
};

/* All zero: no command is taken. */
struct page_send {
    char token[HTTP_TOKEN];
    int n_plants;
    struct page_send_plant plant[PAGE_SEND_PLANTS];
};

/* Makes the token: from now on commands are taken. False: the kernel gives no random numbers. */
bool page_send_open(struct page_send *c);

/* One plant more: its scene and first identifier, our bus as --bus says it, and over UDP the plant's
 * HOST:PORT (NULL: the plant itself is at `bus`). */
void page_send_add(struct page_send *c, const struct options *o, const char *scene, uint32_t base_id,
                   const char *bus, const char *peer);

/* Starts what waits, and notes what has ended. */
void page_send_turn(struct page_send *c);

/* A command of n bytes for plant i, which is at work soon: its number. 0: *why says what is wrong with it. */
uint32_t page_send_begin(struct page_send *c, int i, const char *line, size_t n, const char **why);

/* The words of command `number` of plant i since the last time, at most `room` bytes. *over: it has ended,
 * and all of it has been heard. */
size_t page_send_read(struct page_send *c, int i, uint32_t number, char *text, size_t room, bool *over);

/* Nobody listens to this command any more. */
void page_send_leave(struct page_send *c, int i, uint32_t number);

/* Ends whatever is at work. */
void page_send_close(struct page_send *c);

#endif
