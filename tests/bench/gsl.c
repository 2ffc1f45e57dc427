/* gsl.c - the GNU Scientific Library: rk8pd through its
 * driver, and with contacts located by shortened steps. */
#include "tests/bench/bench.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gsl/gsl_version.h>
#include <stdlib.h>
#include <string.h>

struct context {
    const struct problem *b;
    struct equation e;
    gsl_odeiv2_system system;
    gsl_odeiv2_driver *driver;
    bool events;
};

static int rhs_hertz(double t, const double *y, double *dy, void *e)
{
    equation_hertz(e, t, y, dy);
    return GSL_SUCCESS;
}

static int rhs_shaft(double t, const double *y, double *dy, void *e)
{
    equation_shaft(e, t, y, dy);
    return GSL_SUCCESS;
}

/* The contact whose overlap disagrees with the regime, or -1. */
static int switched(const struct equation *e, const double *y)
{
    double rate;
    for (int i = 0; i < e->n_contacts; i++) {
        if ((equation_overlap(e, y, i, &rate) > 0.0) != (bool)((e->closed >> i) & 1u))
            return i;
    }
    return -1;
}

/* Newton on steps of another length from (t, y0); returns the length, y is the state there. */
static double shorten(struct context *c, int which, double t, const double *y0, double length, double *y)
{
    double rate, error[EQUATION_STATES], lo = 0.0, hi = length;
    bool closed = (c->e.closed >> which) & 1u;
    for (int k = 0; k < 20; k++) {
        double overlap = equation_overlap(&c->e, y, which, &rate);
        *((overlap > 0.0) != closed ? &hi : &lo) = length;
        double next = length - overlap / rate;
        if (!(next >= lo && next <= hi))
            next = 0.5 * (lo + hi);
        bool end = fabs(next - length) < 1e-13 * hi;
        length = next;
        memcpy(y, y0, EQUATION_STATES * sizeof *y);
        gsl_odeiv2_step_apply(c->driver->s, t, length, y, error, NULL, NULL, &c->system);
        if (end)
            break;
    }
    return length;
}

static int advance_events(struct context *c, double *t, double t1, double *y)
{
    double before[EQUATION_STATES];
    while (*t < t1) {
        double t0 = *t;
        memcpy(before, y, sizeof before);
        int status = gsl_odeiv2_evolve_apply(c->driver->e, c->driver->c, c->driver->s, &c->system, t, t1,
                                             &c->driver->h, y);
        int which = switched(&c->e, y);
        if (status != GSL_SUCCESS)
            return status;
        if (which < 0)
            continue;
        *t = t0 + shorten(c, which, t0, before, *t - t0, y);
        c->e.closed ^= 1u << which;
        gsl_odeiv2_evolve_reset(c->driver->e);
        gsl_odeiv2_step_reset(c->driver->s);
    }
    return GSL_SUCCESS;
}

static void run(void *context, double (*out)[EQUATION_STATES])
{
    struct context *c = context;
    const struct problem *b = c->b;
    double y[EQUATION_STATES], t = 0.0;
    memcpy(y, b->y0, sizeof y);
    c->e.locked = c->events;
    c->e.closed = equation_regime(&c->e, y);
    gsl_odeiv2_driver_reset_hstart(c->driver, 1e-2);
    for (int k = 0; k < b->n_out; k++) {
        for (int j = 0; j < b->holds; j++) {
            double t1 = b->interval * (k + (double)(j + 1) / b->holds);
            if (b->held) {
                c->e.held = b->held[k * b->holds + j];
                gsl_odeiv2_driver_reset(c->driver); /* keeps the step size */
            }
            int status =
                c->events ? advance_events(c, &t, t1, y) : gsl_odeiv2_driver_apply(c->driver, &t, t1, y);
            if (status != GSL_SUCCESS)
                y[0] = (double)NAN;
        }
        memcpy(out[k], y, sizeof y);
    }
}

static void release(void *context)
{
    struct context *c = context;
    gsl_odeiv2_driver_free(c->driver);
    free(c);
}

static void add(struct bench *b, double tol, bool relative, bool events)
{
    const struct problem *p = &b->problem;
    struct context *c = bench_alloc(sizeof *c);
    char setting[64];
    strcpy(setting, events ? "events" : "driver");
    strcat(setting, relative ? "" : ", absolute only");
    c->b = p;
    c->e = p->eq;
    c->events = events;
    c->system = (gsl_odeiv2_system){p->eq.n == 6 ? rhs_shaft : rhs_hertz, NULL, (size_t)p->eq.n, &c->e};
    c->driver =
        gsl_odeiv2_driver_alloc_y_new(&c->system, gsl_odeiv2_step_rk8pd, 1e-2, tol, relative ? tol : 0.0);
    struct entry *e = bench_add(b, "GSL rk8pd", setting, tol);
    e->run = run;
    e->release = release;
    e->context = c;
}

void gsl_add(struct bench *b)
{
    gsl_set_error_handler_off();
    for (int i = 0; i < BENCH_TOLERANCES; i++) {
        for (int way = 0; way < 4; way++)
            add(b, bench_tolerance(i), way & 1, way & 2);
    }
}

const char *gsl_version_text(void)
{
    return "GSL " GSL_VERSION;
}
