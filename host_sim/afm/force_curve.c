/* force_curve.c - see force_curve.h. */
#include "host_sim/afm/force_curve.h"

#include <stdint.h>
#include "host_sim/out/json.h"
#include "host_sim/version.h"

void force_curve_write(FILE *f, const struct force_curve *c)
{
    struct json j;
    json_begin_file(&j, f);
    fprintf(f, "# contactplant %s\n# BEGIN METADATA\n", VERSION_TEXT);
    json_put(&j, "# {\n#   'duration': %n,\n#   'feedback mode': 'contact',\n", (double)c->n * c->step_s);
    json_put(&j, "#   'imaging mode': 'force-distance',\n#   'point count': %u,\n", (uint64_t)c->n);
    json_put(&j, "#   'session id': 'contactplant',\n#   'software': 'contactplant',\n");
    json_put(&j, "#   'software version': %s,\n#   'speed approach': %n,\n#   'speed retract': %n,\n",
             VERSION_TEXT, c->speed, c->speed);
    json_put(&j, "#   'spring constant': %n,\n#   'z range': %n\n# }\n", c->stiffness, c->z_range);
    fprintf(f, "# END METADATA\n"
               "# force\theight (measured)\theight (piezo)\tindex\tsegment\ttime\ttip position\n");
    for (size_t i = 0; i < c->n; i++) {
        double base = c->base[i], deflection = c->deflection[i];
        fprintf(f, "%.8g\t%.8g\t%.8g\t%zu\t%s\t%.8g\t%.8g\n", c->stiffness * deflection, base, base, i,
                i >= c->n / 2 ? "True" : "False", c->begin_s + (double)i * c->step_s, base + deflection);
    }
}
