/* command.h - from the bus to the mailbox: every frame that arrives is checked, refused with a cause or taken. */
#ifndef FIRMWARE_COMMAND_H
#define FIRMWARE_COMMAND_H

struct app;

/* Takes what the hal has, at most APP_RECV_BUDGET frames. */
void command_receive(struct app *a);

#endif
