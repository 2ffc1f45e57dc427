/* auto.h - which method `auto` takes, and which it runs. */
#ifndef FIRMWARE_AUTO_H
#define FIRMWARE_AUTO_H

#include "firmware/method/method.h"

/* The method that auto_method picks under these drives (SI; NULL: silence). Where all refuse: the one that
 * would be best. `scale` is that of the model's `prepare`; it is not read without drives. */
const struct method *auto_choice(const struct model *m, const double *p, double h, double tol,
                                 const struct harmonic *drive, const struct scale *scale);

/* The method that auto_method runs now, read from its scratch memory. */
const struct method *auto_now(const double *scratch);

#endif
