/* cortex_m.h - the handlers of exceptions that the vectors of a Cortex-M name. */
#ifndef HAL_CORTEX_M_H
#define HAL_CORTEX_M_H

/* SysTick: it ends a sleep. */
void cortex_m_tick(void);

/* Every other exception: a fault, which restarts the board. */
void cortex_m_fault(void);

#endif
