/* fmu_values.c - variables by reference. A call is taken as a whole or not at all, and a value that a
 * variable has already changes nothing. */
#include "host_sim/fmu/fmu.h"

#include <math.h>
#include <string.h>
#include "models/math/elementary.h"

/* One call of fmi3SetFloat64 asks for this. */
struct wish {
    struct fmu_run run;
    double si[MODEL_PARAMETERS];
    int n, index[MODEL_PARAMETERS]; /* parameters that change, and to what */
    double value[MODEL_PARAMETERS];
    unsigned samples, drives; /* bit i: that of input i changes */
};

/* The plant before the call, for a call that is refused. */
struct before {
    struct plant plant;
    double scratch[METHOD_SCRATCH], si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
};

static bool same(double a, double b)
{
    return !(a < b) && !(a > b);
}

static fmi3Status check_counts(const struct fmu *f, const void *reference, size_t n, const void *value,
                               size_t n_values)
{
    if (n != n_values)
        return fmu_fail(f, "%zu references with %zu values; every variable of this FMU is one number", n,
                        n_values);
    if (n > 0 && (!reference || !value))
        return fmu_fail(f, "references or values are NULL");
    return fmi3OK;
}

/* ---- getting ---- */

static double value_of(struct fmu *f, const struct fmu_variable *v)
{
    switch (v->kind) {
    case FMU_INPUT:
        return f->run.sample[v->index];
    case FMU_OUTPUT:
        return contactplant_output(f->plant, v->index);
    case FMU_RESIDUAL:
        return contactplant_residual(f->plant);
    case FMU_PARAMETER:
        return contactplant_parameter(f->plant, v->index);
    case FMU_DRIVE:
        return f->run.drive[v->index][v->field];
    default:
        return f->run.last_s;
    }
}

/* The variable of this reference, which has this type; false after a line in the log. */
static bool find(struct fmu *f, uint32_t reference, enum fmu_type type, struct fmu_variable *v)
{
    if (!fmu_variable_find(f->plant, reference, v))
        (void)fmu_fail(f, "no variable has the value reference %u", (unsigned)reference);
    else if (v->type != type)
        (void)fmu_fail(f, "%s is a %s: get it with fmi3Get%s", v->name, fmu_type_name[v->type],
                       fmu_type_name[v->type]);
    else
        return true;
    return false;
}

fmi3Status FMI3(GetFloat64)(fmi3Instance instance, const fmi3ValueReference reference[], size_t n_references,
                            fmi3Float64 value[], size_t n_values)
{
    struct fmu *f = fmu_begin(instance, "fmi3GetFloat64", FMU_ANY);
    struct fmu_variable v;
    if (!f || check_counts(f, reference, n_references, value, n_values) != fmi3OK)
        return fmi3Error;
    for (size_t i = 0; i < n_values; i++) {
        if (!find(f, reference[i], FMU_FLOAT64, &v))
            return fmi3Error;
        value[i] = value_of(f, &v);
    }
    return fmi3OK;
}

fmi3Status FMI3(GetUInt64)(fmi3Instance instance, const fmi3ValueReference reference[], size_t n_references,
                           fmi3UInt64 value[], size_t n_values)
{
    struct fmu *f = fmu_begin(instance, "fmi3GetUInt64", FMU_ANY);
    struct fmu_variable v;
    if (!f || check_counts(f, reference, n_references, value, n_values) != fmi3OK)
        return fmi3Error;
    for (size_t i = 0; i < n_values; i++) {
        if (!find(f, reference[i], FMU_UINT64, &v))
            return fmi3Error;
        value[i] = contactplant_counter(f->plant, CONTACTPLANT_SWITCHES);
    }
    return fmi3OK;
}

fmi3Status FMI3(GetClock)(fmi3Instance instance, const fmi3ValueReference reference[], size_t n_references,
                          fmi3Clock value[])
{
    struct fmu *f = fmu_begin(instance, "fmi3GetClock", FMU_EVENT);
    struct fmu_variable v;
    if (!f)
        return fmi3Error;
    if (n_references > 0 && (!reference || !value))
        return fmu_fail(f, "references or values are NULL");
    for (size_t i = 0; i < n_references; i++) {
        if (!find(f, reference[i], FMU_CLOCK, &v))
            return fmi3Error;
        value[i] = f->run.contact;
    }
    return fmi3OK;
}

/* ---- setting ---- */

static fmi3Status wish_for(const struct fmu *f, struct wish *w, const struct fmu_variable *v, double value)
{
    if (!isfinite(value))
        return fmu_fail(f, "%s: the value is not finite", v->name);
    if (value < v->min || value > v->max)
        return fmu_fail(f, "%s=%g is out of range; give %g to %g %s", v->name, value, v->min, v->max,
                        v->unit);
    if (v->kind == FMU_INPUT)
        w->run.sample[v->index] = value;
    else if (v->kind == FMU_DRIVE)
        w->run.drive[v->index][v->field] = value;
    else if (v->kind == FMU_PARAMETER)
        w->si[v->index] = value;
    else
        return fmu_fail(f, "%s is computed and cannot be set; inputs and parameters can", v->name);
    return fmi3OK;
}

/* Finds what differs from now. A ramp is for later changes and is none by itself. */
static void compare(struct fmu *f, struct wish *w)
{
    w->n = 0;
    w->samples = w->drives = 0;
    for (int i = 0; i < contactplant_count(f->plant, CONTACTPLANT_PARAMETER); i++)
        if (!same(w->si[i], contactplant_parameter(f->plant, i))) {
            w->index[w->n] = i;
            w->value[w->n++] = w->si[i];
        }
    for (int i = 0; i < MODEL_INPUTS; i++) {
        w->samples |= same(w->run.sample[i], f->run.sample[i]) ? 0u : 1u << i;
        for (int k = FMU_AMPLITUDE; k < FMU_RAMP; k++)
            w->drives |= same(w->run.drive[i][k], f->run.drive[i][k]) ? 0u : 1u << i;
    }
}

static fmi3Status collect(struct fmu *f, struct wish *w, const fmi3ValueReference *reference,
                          const double *value, size_t n)
{
    struct fmu_variable v;
    w->run = f->run;
    for (int i = 0; i < contactplant_count(f->plant, CONTACTPLANT_PARAMETER); i++)
        w->si[i] = contactplant_parameter(f->plant, i);
    for (size_t i = 0; i < n; i++) {
        if (!fmu_variable_find(f->plant, reference[i], &v))
            return fmu_fail(f, "no variable has the value reference %u", (unsigned)reference[i]);
        if (wish_for(f, w, &v, value[i]) != fmi3OK)
            return fmi3Error;
    }
    compare(f, w);
    return fmi3OK;
}

static int set_drives(struct contactplant *p, const struct wish *w, bool at_once)
{
    int code = CONTACTPLANT_OK;
    for (int i = 0; i < MODEL_INPUTS && code == CONTACTPLANT_OK; i++) {
        const double *d = w->run.drive[i];
        if (w->drives & 1u << i)
            code = contactplant_set_drive(p, i, d[FMU_AMPLITUDE], d[FMU_FREQUENCY], d[FMU_PHASE],
                                          at_once ? 0.0 : d[FMU_RAMP]);
    }
    return code;
}

static int set_samples(struct contactplant *p, const struct wish *w, unsigned which)
{
    int code = CONTACTPLANT_OK;
    for (int i = 0; i < MODEL_INPUTS && code == CONTACTPLANT_OK; i++)
        if (which & 1u << i)
            code = contactplant_set_sample(p, i, w->run.sample[i], 0);
    return code;
}

/* The scene of an instance that has not begun gets these drives. */
static void give_drives(struct contactplant *p, const struct fmu_run *now, const struct wish *w)
{
    for (int i = 0; i < MODEL_INPUTS; i++) {
        struct harmonic *d = &p->scene.drive[i];
        d->amplitude = w->run.drive[i][FMU_AMPLITUDE];
        d->phase = w->run.drive[i][FMU_PHASE];
        if (!same(w->run.drive[i][FMU_FREQUENCY], now->drive[i][FMU_FREQUENCY]))
            d->omega = w->run.drive[i][FMU_FREQUENCY] * 2.0 * ELEMENTARY_PI * p->scene.config.dilation;
    }
}

/* Before the first step the numbers are those of the scene: its plant begins anew with them, at rest where
 * the scene says so, its drives sounding. */
static int begin_anew(struct fmu *f, const struct wish *w)
{
    struct contactplant *p = f->plant;
    for (int i = 0; i < w->n; i++)
        p->scene.si[w->index[i]] = w->value[i];
    int code = library_start(p, &p->error);
    if (code == CONTACTPLANT_OK)
        code = set_drives(p, w, true); /* for its checks */
    if (code != CONTACTPLANT_OK)
        return code;
    give_drives(p, &f->run, w);
    code = library_start(p, &p->error);
    unsigned samples = 0;
    for (int i = 0; i < MODEL_INPUTS; i++)
        samples |= same(w->run.sample[i], 0.0) ? 0u : 1u << i;
    return code == CONTACTPLANT_OK ? set_samples(p, w, samples) : code;
}

static int change(struct fmu *f, const struct wish *w)
{
    int code = contactplant_set_parameters(f->plant, w->n, w->index, w->value);
    if (code == CONTACTPLANT_OK)
        code = set_drives(f->plant, w, false);
    return code == CONTACTPLANT_OK ? set_samples(f->plant, w, w->samples) : code;
}

static void keep(const struct contactplant *p, struct before *b)
{
    b->plant = p->scene.app.plant;
    memcpy(b->scratch, p->scratch, sizeof b->scratch);
    memcpy(b->si, p->scene.si, sizeof b->si);
    memcpy(b->drive, p->scene.drive, sizeof b->drive);
}

static void give_back(struct contactplant *p, const struct before *b)
{
    p->scene.app.plant = b->plant;
    memcpy(p->scratch, b->scratch, sizeof b->scratch);
    memcpy(p->scene.si, b->si, sizeof b->si);
    memcpy(p->scene.drive, b->drive, sizeof b->drive);
}

fmi3Status FMI3(SetFloat64)(fmi3Instance instance, const fmi3ValueReference reference[], size_t n_references,
                            const fmi3Float64 value[], size_t n_values)
{
    struct fmu *f = fmu_begin(instance, "fmi3SetFloat64", FMU_BEFORE | FMU_RUNS);
    struct wish w;
    struct before b;
    if (!f || check_counts(f, reference, n_references, value, n_values) != fmi3OK ||
        collect(f, &w, reference, value, n_values) != fmi3OK)
        return fmi3Error;
    if (w.n == 0 && !w.drives && !w.samples) {
        f->run = w.run; /* a ramp may have changed */
        return fmi3OK;
    }
    keep(f->plant, &b);
    int code = f->run.mode & FMU_BEFORE ? begin_anew(f, &w) : change(f, &w);
    if (code == CONTACTPLANT_OK) {
        f->run = w.run;
        return fmi3OK;
    }
    give_back(f->plant, &b);
    return fmu_fail(f, "%s", contactplant_error(f->plant));
}
