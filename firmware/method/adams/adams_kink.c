/* adams_kink.c - how far the rule of `adams` falls short at a contact switch.
 *
 * Each force has its share in the six ticks whose quintics go through it, and these shares add up to 1. So in
 * the end a rate has the plain sum of all forces, as far as they are smooth at both ends of the motion.
 * Behind a switch the sum of s^a falls short of the integral by the remainder of Euler and Maclaurin's
 * formula,
 *
 *     -zeta(-a, ahead),   zeta(q, x) = sum over k >= 0 of 1/(k + x)^q, continued to q < 1   (Hurwitz)
 *
 * The first force is taken by itself, and the formula begins behind it, with two of its end terms
 * (NIST Digital Library of Mathematical Functions, 25.11.28). */
#include "firmware/method/adams/adams_kink.h"

#include <math.h>

struct adams_remainder adams_remainder(double ahead)
{
    double x = ahead, z = 1.0 + x, root = sqrt(x), next = sqrt(z), inverse = 1.0 / next;
    double of_force = next * (z * (0.4 * z - 0.5) + 0.125) + (1.0 / 1920.0) * (inverse * inverse * inverse);
    double by_s = next * (z * (z * ((2.0 / 7.0) * z - 0.5) + 5.0 / 24.0)) - (1.0 / 384.0) * inverse;
    return (struct adams_remainder){of_force - x * root, by_s - (x * x) * root};
}
