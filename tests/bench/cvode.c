/* cvode.c - SUNDIALS CVODE: Adams with fixed-point iteration, BDF with dense Newton; contacts ignored, or
 * located by its root finding and the integration started anew with the regime locked. Its outputs are
 * interpolated. */
#include "tests/bench/bench.h"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_config.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

struct context {
    const struct problem *b;
    struct equation e;
    SUNContext sun;
    void *cvode;
    N_Vector y;
    SUNMatrix matrix;
    SUNLinearSolver linear;
    SUNNonlinearSolver fixed_point;
    bool roots;
};

static int rhs(realtype t, N_Vector y, N_Vector dy, void *context)
{
    struct context *c = context;
    if (c->e.n == 2)
        equation_hertz(&c->e, t, N_VGetArrayPointer(y), N_VGetArrayPointer(dy));
    else
        equation_shaft(&c->e, t, N_VGetArrayPointer(y), N_VGetArrayPointer(dy));
    return 0;
}

static int overlaps(realtype t, N_Vector y, realtype *g, void *context)
{
    struct context *c = context;
    double rate;
    (void)t;
    for (int i = 0; i < c->e.n_contacts; i++)
        g[i] = equation_overlap(&c->e, N_VGetArrayPointer(y), i, &rate);
    return 0;
}

static int jacobian_hertz(realtype t, N_Vector y, N_Vector f, SUNMatrix j, void *context, N_Vector a,
                          N_Vector b, N_Vector d)
{
    const struct equation *e = &((struct context *)context)->e;
    double eta = N_VGetArrayPointer(y)[0];
    bool closed = e->locked ? e->closed & 1u : eta > 0.0;
    double stiffness = e->w2 != 0.0 ? e->b * (1.0 + e->r * equation_cosine(e->w2 * t)) : e->b;
    (void)f, (void)a, (void)b, (void)d;
    SM_ELEMENT_D(j, 0, 1) = 1.0;
    SM_ELEMENT_D(j, 1, 0) = -e->k - (closed ? 1.5 * stiffness * sqrt(fabs(eta)) : 0.0);
    SM_ELEMENT_D(j, 1, 1) = -e->c;
    return 0;
}

static int jacobian_shaft(realtype t, N_Vector y, N_Vector f, SUNMatrix j, void *context, N_Vector a,
                          N_Vector b, N_Vector d)
{
    const struct equation *e = &((struct context *)context)->e;
    const double *x = N_VGetArrayPointer(y), bend[3] = {1.0, -2.0, 1.0};
    unsigned closed = e->locked ? e->closed : equation_regime(e, x);
    (void)t, (void)f, (void)a, (void)b, (void)d;
    for (int i = 0; i < 3; i++) {
        unsigned touching = i == 1 ? 0 : (closed >> i) & 3u;
        for (int k = 0; k < 3; k++)
            SM_ELEMENT_D(j, 3 + i, k) = -bend[i] * bend[k] / e->mass[i];
        SM_ELEMENT_D(j, 3 + i, i) -= (e->support[i] + (touching ? e->spring : 0.0)) / e->mass[i];
        SM_ELEMENT_D(j, i, 3 + i) = 1.0;
        SM_ELEMENT_D(j, 3 + i, 3 + i) = -e->damper[i] / e->mass[i];
    }
    return 0;
}

/* To t1, the regime turned at each root. */
static bool advance(struct context *c, double t1)
{
    realtype t;
    int found[EQUATION_CONTACTS], status;
    while ((status = CVode(c->cvode, t1, c->y, &t, CV_NORMAL)) == CV_ROOT_RETURN) {
        CVodeGetRootInfo(c->cvode, found);
        for (int i = 0; i < c->e.n_contacts; i++) {
            if (found[i] != 0)
                c->e.closed = found[i] > 0 ? c->e.closed | 1u << i : c->e.closed & ~(1u << i);
        }
        CVodeReInit(c->cvode, t, c->y);
    }
    return status >= 0;
}

static void run(void *context, double (*out)[EQUATION_STATES])
{
    struct context *c = context;
    const struct problem *b = c->b;
    double *y = N_VGetArrayPointer(c->y);
    size_t size = (size_t)b->eq.n * sizeof *y;
    bool good = true;
    memcpy(y, b->y0, size);
    c->e.locked = c->roots;
    c->e.closed = equation_regime(&c->e, y);
    CVodeReInit(c->cvode, 0.0, c->y);
    for (int k = 0; k < b->n_out; k++) {
        for (int j = 0; j < b->holds && good; j++) {
            if (b->held) {
                c->e.held = b->held[k * b->holds + j];
                CVodeReInit(c->cvode, b->interval * (k + (double)j / b->holds), c->y);
            }
            good = advance(c, b->interval * (k + (double)(j + 1) / b->holds));
        }
        memcpy(out[k], y, size);
        out[k][0] = good ? out[k][0] : (double)NAN;
    }
}

static void release(void *context)
{
    struct context *c = context;
    CVodeFree(&c->cvode);
    N_VDestroy(c->y);
    if (c->fixed_point)
        SUNNonlinSolFree(c->fixed_point);
    if (c->linear) {
        SUNLinSolFree(c->linear);
        SUNMatDestroy(c->matrix);
    }
    SUNContext_Free(&c->sun);
    free(c);
}

static void quiet(int code, const char *module, const char *function, char *text, void *context)
{
    (void)code, (void)module, (void)function, (void)text, (void)context;
}

static void set_solver(struct context *c, bool adams)
{
    sunindextype n = c->e.n;
    if (adams) {
        c->fixed_point = SUNNonlinSol_FixedPoint(c->y, 0, c->sun);
        CVodeSetNonlinearSolver(c->cvode, c->fixed_point);
        return;
    }
    c->matrix = SUNDenseMatrix(n, n, c->sun);
    c->linear = SUNLinSol_Dense(c->y, c->matrix, c->sun);
    CVodeSetLinearSolver(c->cvode, c->linear, c->matrix);
    CVodeSetJacFn(c->cvode, n == 2 ? jacobian_hertz : jacobian_shaft);
}

static void add(struct bench *b, double tol, bool adams, bool roots, bool relative)
{
    struct context *c = bench_alloc(sizeof *c);
    char setting[64];
    strcpy(setting, adams ? "Adams" : "BDF");
    strcat(setting, roots ? ", roots, reinit" : ", no roots");
    strcat(setting, relative ? "" : ", absolute only");
    c->b = &b->problem;
    c->e = b->problem.eq;
    c->roots = roots;
    SUNContext_Create(NULL, &c->sun);
    c->y = N_VNew_Serial(c->e.n, c->sun);
    memcpy(N_VGetArrayPointer(c->y), b->problem.y0, (size_t)c->e.n * sizeof(double));
    c->cvode = CVodeCreate(adams ? CV_ADAMS : CV_BDF, c->sun);
    CVodeInit(c->cvode, rhs, 0.0, c->y);
    CVodeSetErrHandlerFn(c->cvode, quiet, NULL);
    CVodeSetUserData(c->cvode, c);
    CVodeSStolerances(c->cvode, relative ? tol : 0.0, tol);
    CVodeSetMaxNumSteps(c->cvode, 1000000);
    set_solver(c, adams);
    if (roots)
        CVodeRootInit(c->cvode, c->e.n_contacts, overlaps);
    struct entry *e = bench_add(b, "CVODE", setting, tol);
    e->run = run;
    e->release = release;
    e->context = c;
}

void cvode_add(struct bench *b)
{
    for (int i = 0; i < BENCH_TOLERANCES; i += 2) {
        for (int way = 0; way < 8; way++)
            add(b, bench_tolerance(i), way & 1, way & 2, way & 4);
    }
}

const char *cvode_version_text(void)
{
    return "SUNDIALS " SUNDIALS_VERSION;
}
