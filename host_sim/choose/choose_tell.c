/* choose_tell.c - the texts of a certificate, and the progress that a long search shows. */
#include "host_sim/choose/choose_steps.h"

#include <stdarg.h>
#include "host_sim/cli/clock.h"

static const double patience_s = 2.0;

void choose_say(char text[CHOOSE_TEXT], const char *format, ...)
{
    va_list a;
    va_start(a, format);
    vsnprintf(text, CHOOSE_TEXT, format, a);
    va_end(a);
}

void choose_tell(const struct search *o, const char *what, const struct scene *s)
{
    if (o->progress && clock_now_s() - o->begin_s > patience_s)
        fprintf(o->progress, "contactplant choose: %s %s by %s, %u substeps\n", what, s->model->name,
                s->method, s->substeps);
}
