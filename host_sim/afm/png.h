/* png.h - grey pictures of 8 bits as PNG, without compression. */
#ifndef HOST_SIM_PNG_H
#define HOST_SIM_PNG_H

#include <stddef.h>
#include <stdio.h>

/* Lines of `width` grey values, top first; width at most 65534. `about`: what is seen, ASCII, or NULL. The
 * file's errors are told by files_finish. */
void png_write(FILE *f, const unsigned char *grey, size_t width, size_t height, const char *about);

#endif
