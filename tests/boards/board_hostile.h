/* board_hostile.h - a board on a wire of our own: QEMU hands over its Ethernet frames in UDP packets (-nic
 * socket,udp=..). This end answers ARP, speaks as a peer, and sends frames that no good peer sends. */
#ifndef TESTS_BOARD_HOSTILE_H
#define TESTS_BOARD_HOSTILE_H

/* 127.0.0.1:`board` is the emulator's end, `ours` this one; the image has the addresses of
 * hal/ethernet/network.c. The program's exit status. */
int board_hostile(const char *board, const char *ours, const char *console, char **emulator);

#endif
