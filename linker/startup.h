/* startup.h - from a stack to main() on any processor; each one's own file does what comes before: the
 * FPU, the fence under the stack, vectors. */
#ifndef LINKER_STARTUP_H
#define LINKER_STARTUP_H

/* Paints the stack, fills data, clears bss, runs main and stops with what it returns. Does not return. */
void startup(void);

#endif
