/* choose_tell.c - see choose_tell.h. */
#include "host_sim/choose/choose_tell.h"

#include <stdarg.h>
#include "host_sim/cli/clock.h"
#include "models/math/elementary.h"
#include "models/scenes/scenes_range.h"

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

/* Each fact once, for the scene or for all holds of a sweep. */
int choose_warnings(const struct choose_certificate *c, const char *warning[CHOOSE_WARNINGS])
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    const char *text;
    int n = 0;
    scenes_resolve(&c->scene, si, drive);
    for (int hold = 0; hold < c->sweep.Hz.n || hold == 0; hold++) {
        if (c->sweep.Hz.n > 0)
            drive[c->sweep.input].omega = 2.0 * ELEMENTARY_PI * range_value(&c->sweep.Hz, hold);
        for (int i = 0; (text = scenes_warning(c->scene.model, si, drive, i)) != NULL; i++) {
            int k = 0;
            while (k < n && warning[k] != text)
                k++;
            if (k == n && n < CHOOSE_WARNINGS)
                warning[n++] = text;
        }
    }
    return n;
}
