/* method.c - the table of methods; see method.h. */
#include "firmware/method/method.h"

#include "models/text.h"

const struct method *const method_table[METHODS] = {&rk4,         &taylor,        &exact, &auto_method,
                                                    &rk4_float32, &rk4_unlocated, &modal, &adams};

const struct method *method_find(const char *name)
{
    for (int i = 0; i < METHODS; i++) {
        if (text_equal(name, method_table[i]->name))
            return method_table[i];
    }
    return NULL;
}
