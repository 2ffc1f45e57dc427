/* cortex_r.h - the handler of exceptions that the vectors of a Cortex-R5 name. */
#ifndef HAL_CORTEX_R_H
#define HAL_CORTEX_R_H

/* Any exception: a fault, which restarts the board. */
void cortex_r_fault(void);

#endif
