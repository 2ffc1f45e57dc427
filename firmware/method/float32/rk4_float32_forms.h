/* rk4_float32_forms.h - the form of a model for rk4_float32. */
#ifndef FIRMWARE_RK4_FLOAT32_FORMS_H
#define FIRMWARE_RK4_FLOAT32_FORMS_H

#include "firmware/method/float32/rk4_float32.h"

/* NULL, or why no form fits this model. */
const char *rk4_float32_refuse_model(const struct model *m, const double *p);

/* The positions at rest, and the form without h. */
void rk4_float32_prepare_form(const struct model *m, const double *p, double *reference,
                              struct float32_form *form);

#endif
