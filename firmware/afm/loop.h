/* loop.h - the PI controller of an AFM's reference loops. */
#ifndef FIRMWARE_AFM_LOOP_H
#define FIRMWARE_AFM_LOOP_H

#include <stdbool.h>

/* u = kp e + ki (integral of e), within [min, max]; the integral stands while u is at a limit. */
struct loop {
    double kp, ki, min, max;
    double sum;   /* ki times the integral */
    bool limited; /* u was at a limit in the last sample */
};

/* The output after a sample of length dt with error e. */
double loop_run(struct loop *l, double e, double dt);

#endif
