/* can.h - the common code and contract of the drivers of CAN controllers: bit timing, identifiers of a plant,
 * error states, restart after bus-off. hal/posix/socketcan.h has the same contract on Linux.
 *
 * ERROR STATES. Going up from active to warning (an error counter at 96) or passive (128) is
 * HAL_ERROR_PASSIVE, once each. Bus-off (256) is HAL_BUS_OFF, once. A controller that is out of operation for
 * another reason, from the start or later, is HAL_DOWN, once. So a bus that is broken at power-on does not
 * keep the plant from starting. From bus-off or down on nothing is sent, and queued frames are dropped. After
 * restart_us the driver restarts the controller, which then waits for 128 times 11 recessive bits (ISO
 * 11898-1). restart_us 0 leaves it off for good, as `ip link` does without restart-ms.
 *
 * Frames come before the faults: a driver reports when nothing waits to be received. */
#ifndef HAL_CAN_H
#define HAL_CAN_H

#include <stdbool.h>
#include <stdint.h>
#include "hal/hal.h"

enum {
    CAN_TRIES = 100000, /* looks until a controller must have changed its mode: 11 bits of any usual rate */
    CAN_PASS_OVER = 64, /* foreign frames that one recv passes over: the deepest receive FIFO */
    CAN_PASSIVE_COUNT = 128
};

/* A bit is 1 + segment1 + segment2 quanta; it is sampled after 1 + segment1. */
struct can_timing {
    uint16_t prescaler; /* clock cycles of the controller in a time quantum */
    uint8_t segment1;   /* propagation and phase segment 1, quanta */
    uint8_t segment2;   /* phase segment 2, quanta */
    uint8_t jump;       /* synchronisation jump width, quanta */
};

struct can_config {
    struct can_timing timing;
    uint32_t base_id; /* first of the plant's identifiers, a multiple of FRAME_IDS */
    bool extended;
    uint32_t restart_us;               /* from bus-off to the restart; 0: stays off */
    uint32_t (*now_us)(void *context); /* becomes the hal's clock */
};

enum can_state { CAN_ACTIVE, CAN_WARNING, CAN_PASSIVE, CAN_OFF, CAN_DOWN };

/* Counters run since the driver's open. Read them freely; only the driver writes. */
struct can {
    struct can_config config;
    enum can_state state;
    uint32_t off_us;                         /* when it was seen to be off or down, or its last restart */
    uint8_t transmit_errors, receive_errors; /* the controller's counters when last looked at */
    uint32_t received, sent;
    uint32_t refused; /* sends without room, or off the bus: send returned 0 */
    uint32_t dropped; /* receive overruns: HAL_DROPPED each; the controller does not tell how many frames */
    uint32_t passed_over; /* frames through its filter that are not ours: remote, other identifiers */
    uint32_t passive, bus_off, down, restarted;
};

/* Limits of a controller's registers. */
struct can_limits {
    uint16_t prescaler_max, prescaler_step; /* step 2: even ones only */
    uint8_t segment1_max, segment2_max, jump_max;
};

/* Checks a configuration against a controller's limits. Returns NULL, with *c cleared and the
 * configuration copied; or what is wrong with it, and then *c is unchanged. */
const char *can_open(struct can *c, const struct can_config *config, const struct can_limits *limits);

/* True when the frame's identifier and format are the plant's. */
bool can_is_ours(const struct can *c, const struct frame *f);

/* Takes the controller's state as the driver has just read it, and whether frames were overrun. Counts,
 * and returns the fault bits to report: each worsening once. */
int can_see(struct can *c, enum can_state state, bool overrun);

/* True when the controller is off or down and its time to restart has come. */
bool can_restart_due(const struct can *c);

/* struct hal's healthy where no watchdog is started. */
void can_no_watchdog(void *context);

#endif
