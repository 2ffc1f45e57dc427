/* adams_kink.h - how far the rule of `adams` falls short at a contact switch. */
#ifndef FIRMWARE_METHOD_ADAMS_KINK_H
#define FIRMWARE_METHOD_ADAMS_KINK_H

/* The integral of s^1.5, and of s^2.5, less what the rule makes of their values at the ends of ticks. The
 * distance s from a switch is in ticks, on the side of contact. `ahead`, 0 to 1, is the way from the switch
 * to the first such end there. Relative error 5e-3. */
struct adams_remainder {
    double of_force;      /* s^1.5, */
    double of_force_by_s; /* s^2.5 */
};

struct adams_remainder adams_remainder(double ahead);

#endif
