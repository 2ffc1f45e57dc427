/* startup.c - from a stack to main() on any processor; see startup.h. */
#include "linker/startup.h"

#include <stdint.h>
#include "hal/board/board.h"

enum { PAINT_MARGIN = 64 /* words: what startup itself uses */ };

/* From the linker script. */
extern uint32_t data_load[], data_begin[], data_end[], bss_begin[], bss_end[];

int main(void);

__attribute__((noinline)) void startup(void)
{
    board_stack_paint((const uint32_t *)__builtin_frame_address(0) - PAINT_MARGIN);
    const uint32_t *from = data_load;
    for (uint32_t *p = data_begin; p < data_end; p++)
        *p = *from++;
    for (uint32_t *p = bss_begin; p < bss_end; p++)
        *p = 0;
    board_stop(main());
}
