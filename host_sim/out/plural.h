/* plural.h - the letter that a count adds to the word beside it. */
#ifndef HOST_SIM_PLURAL_H
#define HOST_SIM_PLURAL_H

/* Behind a noun: 1 row, 2 rows. */
static inline const char *plural(double n)
{
    return n == 1.0 ? "" : "s";
}

/* Behind its verb: 1 row agrees, 2 rows agree. */
static inline const char *singular(double n)
{
    return n == 1.0 ? "s" : "";
}

#endif
