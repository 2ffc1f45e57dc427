/* mps2_counter.c - the counter of the FPGA's I/O block
 * on Arm MPS2 and MPS2+ boards (Arm DAI 0386 and 0500). */
#include "hal/board/board.h"

/* From the linker script. */
extern volatile uint32_t fpga_io[];

enum { FPGA_COUNTER = 0x18 / 4 /* its prescaler comes up at 0: a count a cycle */ };

uint32_t board_count(void)
{
    return fpga_io[FPGA_COUNTER];
}
