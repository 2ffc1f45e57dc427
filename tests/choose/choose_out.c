/* choose_out.c - see choose_out.h. */
#include "tests/choose/choose_out.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "host_sim/choose/choose_print.h"
#include "host_sim/choose/choose_run.h"
#include "host_sim/commands.h"

enum { LINE = 1024, PATH = 64 };

/* The file of choose --out through simulate into rows. */
static bool simulate(const struct choose_certificate *c, const char *scene, const char *rows)
{
    char argument[PATH + 8];
    snprintf(argument, sizeof argument, "--out=%s", rows);
    char name[] = "simulate", path[PATH], *argv[] = {name, path, argument, NULL};
    snprintf(path, sizeof path, "%s", scene);
    FILE *f = fopen(scene, "w");
    if (!f)
        return false;
    choose_write(f, c);
    return !fclose(f) && cmd_simulate(3, argv) == STATUS_DONE;
}

static bool same(double simulated, double certified, double unit)
{
    if (unit > 1.0 || unit < 1.0)
        return fabs(simulated - certified * unit) <= 4.0 * DBL_EPSILON * fabs(simulated);
    return !(simulated < certified) && !(simulated > certified); /* a zero has no sign in a table */
}

/* A row for each frame's end, behind the header and the start. */
static int compare(const char *rows, const struct choose_record *r, double unit)
{
    char line[LINE];
    int i = -2, differ = 0;
    FILE *f = fopen(rows, "r");
    while (f && i < r->n && fgets(line, sizeof line, f)) {
        const char *last = strrchr(line, ',');
        if (i >= 0 && last)
            differ += !same(strtod(last + 1, NULL), r->value[r->looks * i + r->looks - 1], unit);
        i++;
    }
    if (f)
        fclose(f);
    return i == r->n ? differ : -1;
}

int choose_out_differs(const struct choose_certificate *c)
{
    char directory[] = "/tmp/contactplant_out_XXXXXX", scene[PATH], rows[PATH];
    const struct scene *s = &c->verdict[c->choice].attempt[c->method].scene;
    struct choose_record r;
    bool velocity = s->model->output_signal[(int)s->observable].quantity == QUANTITY_VELOCITY;
    if (!mkdtemp(directory))
        return -1;
    snprintf(scene, sizeof scene, "%s/scene.ini", directory);
    snprintf(rows, sizeof rows, "%s/rows.csv", directory);
    bool ran = !choose_run(s, NULL, 0.0, &r) && simulate(c, scene, rows);
    int differ = ran ? compare(rows, &r, velocity ? s->dilation : 1.0) : -1;
    choose_record_free(&r);
    unlink(scene);
    unlink(rows);
    rmdir(directory);
    return differ;
}
