/* command.h - from the bus to the mailbox: every frame that arrives is checked, refused with a cause or
 * taken. */
#ifndef FIRMWARE_COMMAND_H
#define FIRMWARE_COMMAND_H

struct app;

/* Takes what the hal has, at most APP_RECV_BUDGET frames; the rest waits for the next plant frame. Each
 * command is taken as a whole, or refused with a cause, a counter and a REPLY, and then it changes
 * nothing. A frame that is no valid command is only counted. Fault bits of the hal are counted; a bus that
 * is off or down also latches FAULT_BUS and drops the frames that wait to be sent. If APP_RECV_BUDGET is
 * reached twice in a row there is a flood, and nothing may wait behind it. Then up to APP_LOOK_AHEAD
 * further frames are read. The first STOP and the first ENABLE that fits are taken; all others are dropped
 * and counted. So no frame from before a STOP that overtook it acts after it. */
void command_receive(struct app *a);

#endif
