/* sja1000.h - the NXP SJA1000 CAN controller in PeliCAN mode, polled (data sheet of 4 January 2000, chapter
 * 6.4). hal/can/can.h says what errors and bus-off do.
 *
 * The controller has one transmit buffer and 64 bytes of receive FIFO, four frames of eight bytes and half
 * another: too little for a plant that speaks once a millisecond. The driver keeps SJA1000_WAITING frames
 * each way beside it and moves them in sja1000_service, which every call of the hal does first. Between two
 * frames of the plant the owner calls it when the controller's interrupt is pending, for each frame that came
 * or went. So the bus never waits for the plant.
 *
 * The acceptance filter works in two ways. For 11-bit identifiers: dual filter, both set to the base, with
 * the remote bit. For 29-bit ones a dual filter compares 16 bits only, so there it is one filter of all 29
 * and the remote bit. It does not compare the format: the driver does, and counts what it passes over. */
#ifndef HAL_SJA1000_H
#define HAL_SJA1000_H

#include "hal/can/can.h"
#include "hal/device/registers.h"

enum { SJA1000_WAITING = 64 };

struct sja1000_config {
    struct can_config can; /* the prescaler counts oscillator cycles and is even */
    uint8_t output;        /* OCR: how the board wires TX0 and TX1 */
};

struct sja1000_queue {
    struct frame frame[SJA1000_WAITING];
    uint32_t first, n;
};

struct sja1000 {
    struct hal hal; /* give this to the app */
    struct registers registers;
    struct can can;
    uint8_t output;
    struct sja1000_queue in, out;
};

/* Resets and starts the controller. Prescaler 2..128 and even, segment1 1..16, segment2 1..8, jump 1..4.
 * Frames that came or went raise the controller's interrupt. Returns NULL, or what is wrong. *d must stay
 * where it is. */
const char *sja1000_open(struct sja1000 *d, struct registers registers, const struct sja1000_config *c);

/* Moves frames from the controller into the queue and from the queue into the controller, and lowers the
 * interrupt. */
void sja1000_service(struct sja1000 *d);

#endif
