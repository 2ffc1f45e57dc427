/* mathieu.c - see mathieu.h. */
#include "tests/mathieu.h"

#include <math.h>
#include <stddef.h>
#include "firmware/plant.h"
#include "models/polynomial.h"
#include "tests/test.h"

#define TWO_PI 6.283185307179586477

enum { DAMPING, STIFFNESS, PARAMETERS };

static const struct signal states[2] = {{"x", "m", "position", QUANTITY_LENGTH, "x"},
                                        {"v", "m/s", "velocity", QUANTITY_VELOCITY, "v"}};
static const struct signal inputs[1] = {{"k1", "1", "stiffness less k0", QUANTITY_RATIO, NULL}};
static const struct parameter parameters[PARAMETERS] = {{"c", "1", 0.0, 1e6, 0.02, "damping"},
                                                        {"k0", "1", 1e-6, 1e6, 1.0, "stiffness"}};

static const char *check(const double *si)
{
    (void)si;
    return NULL;
}

static void prepare(const double *si, double *p, struct scale *scale)
{
    polynomial_clear(p);
    p[POLYNOMIAL_DAMPING] = si[DAMPING];
    p[POLYNOMIAL_C + 1] = -si[STIFFNESS];
    p[POLYNOMIAL_M + 1] = -1.0;
    p[POLYNOMIAL_EIGENFREQUENCY] = sqrt(si[STIFFNESS]);
    *scale = (struct scale){1.0, 1.0, 1.0, 1.0};
}

/* The rungs' own equations, modulated as no linear rung is. */
static const struct model oscillator = {
    .name = "mathieu",
    .n_states = 2,
    .n_inputs = 1,
    .n_outputs = POLYNOMIAL_OUTPUTS,
    .n_parameters = PARAMETERS,
    .state_signal = states,
    .input_signal = inputs,
    .output_signal = polynomial_outputs,
    .parameter = parameters,
    .rhs = polynomial_rhs_1,
    .flow = polynomial_flow_1,
    .polynomial_form = polynomial_view,
    .gap = model_no_gap,
    .check = check,
    .prepare = prepare,
    .eigenfrequency = polynomial_eigenfrequency,
    .rest = polynomial_rest,
    .energy = polynomial_energy,
    .output = polynomial_output_1,
};

void mathieu_map(const struct mathieu *m, const struct method *method, double tol, int n, double map[2][2])
{
    static double work[METHOD_WORK];
    static struct plant pl;
    const double si[PARAMETERS] = {m->damping, m->k0};
    struct plant_config c = {.model = &oscillator,
                             .si = si,
                             .method = method,
                             .tick_s = TWO_PI / m->omega / n,
                             .dilation = 1.0,
                             .tol = tol,
                             .force = true,
                             .work = work};
    for (int j = 0; j < 2; j++) {
        const char *why = plant_init(&pl, &c);
        if (why)
            check_string("plant_init", why, "no refusal");
        plant_drive_start(&pl, 0, m->k1, m->omega / TWO_PI, 0.0);
        plant_set_state(&pl, (const double[2]){1.0 - j, j});
        if (!plant_run(&pl, (uint64_t)n))
            check_true("the plant stays finite", 0);
        map[0][j] = pl.x[0];
        map[1][j] = pl.x[1];
    }
}

static double slope(const void *context, double t, double x)
{
    const struct mathieu *m = context;
    (void)x;
    return -m->k0 - m->k1 * cos(m->omega * t);
}

static double force(const void *context, double t, double x)
{
    return slope(context, t, x) * x;
}

void mathieu_classical(const struct mathieu *m, classical_step *step, int n, double map[2][2])
{
    struct classical c = {force, slope, m->damping, m};
    double h = TWO_PI / m->omega / n;
    for (int j = 0; j < 2; j++) {
        struct classical_state s = {1.0 - j, j, 0.0};
        classical_begin(&c, 0.0, &s);
        for (int i = 0; i < n; i++)
            step(&c, i * h, h, &s);
        map[0][j] = s.x;
        map[1][j] = s.v;
    }
}

void mathieu_multipliers(double map[2][2], double complex mu[2])
{
    double half = 0.5 * (map[0][0] + map[1][1]), det = map[0][0] * map[1][1] - map[0][1] * map[1][0];
    double complex root = csqrt(half * half - det);
    mu[0] = half < 0.0 ? half - root : half + root;
    mu[1] = half < 0.0 ? half + root : half - root;
    if (cimag(mu[0]) < 0.0)
        mu[0] = conj(mu[0]), mu[1] = conj(mu[1]);
}
