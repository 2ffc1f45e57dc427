/* batch_rk4.c - set-up of a batch, its drives and its intervals; see batch_rk4.h. */
#include "host_sim/batch/batch_rk4.h"

#include <math.h>
#include <string.h>
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/rolling_contact.h"

enum { GROUP = 16 }; /* blocks: 60 kB */

static int blocks(const struct batch_rk4 *b)
{
    return (b->n + BATCH_BLOCK - 1) / BATCH_BLOCK;
}

size_t batch_rk4_bytes(int n)
{
    return (size_t)((n + BATCH_BLOCK - 1) / BATCH_BLOCK) * sizeof(struct batch_rk4_block);
}

static struct batch_rk4_kernel widest(void)
{
#ifdef BATCH_AVX2
    if (__builtin_cpu_supports("avx2"))
        return batch_rk4_avx2;
#endif
    return batch_rk4_plain;
}

/* Radians a tick, as the drive itself has it once it sounds. */
static double omega_tick(struct drive d)
{
    struct input u[3];
    struct wave w;
    drive_segment(&d, TICK_FRACTIONS, 1.0, &w, &u[0], &u[1], &u[2]);
    return d.omega_tick;
}

static const struct model *const model_of[FORMS] = {
    [FORM_RIG] = &hertz_rig, [FORM_ROLLING] = &rolling_contact, [FORM_TIP] = &afm_tip};

const char *batch_rk4_init(struct batch_rk4 *b, int n, const struct model *m,
                           const struct drive_setting *drive, void *memory)
{
    int form = 0;
    while (form < FORMS && model_of[form] != m)
        form++;
    if (form == FORMS)
        return "batch_rk4 takes models with one Hertzian contact only: rig, rolling contact, tip";
    for (int i = 0; i < m->n_inputs; i++) {
        if (!(drive[i].turns_per_tick >= 0.0 && drive[i].turns_per_tick * DRIVE_TICKS_MIN <= 1.0))
            return "step too coarse: " DRIVE_TICKS_TOO_FEW "a drive (more steps an interval)";
    }
    *b = (struct batch_rk4){
        .n = n, .model = m, .form = (enum batch_rk4_form)form, .kernel = widest(), .block = memory};
    memset(memory, 0, batch_rk4_bytes(n));
    for (int i = 0; i < m->n_inputs; i++) {
        struct drive_setting s = drive[i];
        s.amplitude = 1.0;
        drive_init(&b->drive[i]);
        drive_start(&b->drive[i], &s);
    }
    b->base_omega = b->form == FORM_RIG ? omega_tick(b->drive[RIG_BASE]) : 0.0;
    for (int k = 0; k < blocks(b); k++)
        memset(b->block[k].good, -1, sizeof b->block[k].good);
    return NULL;
}

const char *batch_rk4_set(struct batch_rk4 *b, int i, const struct batch_rk4_lane *lane)
{
    struct batch_rk4_block *k = &b->block[i / BATCH_BLOCK];
    int at = i % BATCH_BLOCK;
    const char *why = lane->step > 0.0 ? rk4.refuse(b->model, lane->p, lane->step, 0.0)
                                       : "the step of a trajectory must be above 0";
    for (int j = 0; j < b->model->n_inputs && !why; j++) {
        if (!(fabs(lane->amplitude[j]) <= DRIVE_LIMIT))
            why = "an amplitude is beyond 1e9";
    }
    if (why)
        return why;
    k->p[0][at] = lane->p[0];
    if (b->form == FORM_TIP)
        k->p[TIP_P_HERTZ][at] = lane->p[TIP_P_HERTZ];
    for (int j = 0; j < b->model->n_inputs; j++) {
        k->scale[j][at] = lane->amplitude[j];
        b->active |= (unsigned)(lane->amplitude[j] != 0.0) << j;
    }
    if (b->form == FORM_RIG)
        k->scale[BATCH_BASE_RATE][at] = -lane->amplitude[RIG_BASE] * (b->base_omega * (1.0 / lane->step));
    k->step[at] = lane->step;
    for (int j = 0; j < 2; j++)
        k->x[j][at] = k->end[j][at] = lane->x[j];
    k->largest[at] = 0.0;
    k->good[at] = -1;
    k->intervals[at] = 0;
    return NULL;
}

void batch_rk4_state(const struct batch_rk4 *b, int i, double *x)
{
    for (int j = 0; j < 2; j++)
        x[j] = b->block[i / BATCH_BLOCK].end[j][i % BATCH_BLOCK];
}

int64_t batch_rk4_intervals(const struct batch_rk4 *b, int i)
{
    return b->block[i / BATCH_BLOCK].intervals[i % BATCH_BLOCK];
}

bool batch_rk4_good(const struct batch_rk4 *b, int i)
{
    return b->block[i / BATCH_BLOCK].good[i % BATCH_BLOCK] != 0;
}

/* ---- running ---- */

static enum batch_rk4_pattern pattern_of(const struct batch_rk4 *b)
{
    if (b->form == FORM_TIP)
        return PATTERN_TIP;
    if (b->active <= 1u)
        return PATTERN_FORCE;
    if (b->form == FORM_ROLLING)
        return PATTERN_ROLLING;
    if (b->active <= (1u << RIG_FORCE | 1u << RIG_FAST_FORCE))
        return PATTERN_FORCES;
    return b->active & (1u << RIG_FAST_FORCE | 1u << RIG_STIFFNESS) ? PATTERN_RIG : PATTERN_BASE;
}

/* The phasors of the table's steps of one input; sine: NULL, or for those of its rate. */
static void turn(struct drive *d, int steps, double *cosine, double *sine)
{
    struct input u[3];
    struct wave w;
    for (int at = 0; at < 2 * steps; at += 2) {
        drive_segment(d, TICK_FRACTIONS, 1.0, &w, &u[0], &u[1], &u[2]);
        double c = w.cosine, s = w.sine;
        drive_rotate(&c, &s, d->half_cosine, d->half_sine);
        cosine[at] = w.cosine;
        cosine[at + 1] = c;
        cosine[at + 2] = d->cosine;
        if (!sine)
            continue;
        sine[at] = w.sine;
        sine[at + 1] = s;
        sine[at + 2] = d->sine;
    }
}

/* The next steps, at most `steps`, and no further than to where a phasor is taken from its integer again.
 * Inside such a run a step begins with the very phasors with which the one before ended. */
static void make_table(struct batch_rk4 *b, int steps, struct batch_rk4_table *t)
{
    t->steps = steps < PHASOR_RESYNC_TICKS ? steps : PHASOR_RESYNC_TICKS;
    for (int i = 0; i < b->model->n_inputs; i++) {
        const struct drive *d = &b->drive[i];
        bool runs_on = d->phasor_valid || d->phasor_kept;
        if ((b->active >> i) & 1u && runs_on && d->resync_left > 0 && (int)d->resync_left < t->steps)
            t->steps = (int)d->resync_left;
    }
    for (int i = 0; i < b->model->n_inputs; i++) {
        bool base = b->form == FORM_RIG && i == RIG_BASE;
        if ((b->active >> i) & 1u)
            turn(&b->drive[i], t->steps, t->at[i], base ? t->at[BATCH_BASE_RATE] : NULL);
    }
}

/* Some neighbours: they stay in a fast cache over all intervals. */
struct group {
    struct batch_rk4_block *block;
    int blocks, n;
};

static void run_interval(struct batch_rk4 *b, const struct group *g, int steps, struct batch_rk4_table *t)
{
    enum batch_rk4_pattern pattern = pattern_of(b);
    for (int done = 0; done < steps; done += t->steps) {
        make_table(b, steps - done, t);
        for (int k = 0; k < g->blocks; k++)
            b->kernel.steps(&g->block[k], pattern, t);
    }
}

static void end_interval(const struct batch_rk4 *b, const struct group *g, double *samples)
{
    for (int k = 0; k < g->blocks; k++)
        b->kernel.end(&g->block[k], g->n - k * BATCH_BLOCK, samples ? samples + k * BATCH_BLOCK : NULL, b->n);
}

const char *batch_rk4(struct batch_rk4 *b, int steps, int intervals, double *samples)
{
    struct batch_rk4_table table = {.steps = 0}; /* silent inputs stay zero */
    struct drive begin[MODEL_INPUTS];
    if (steps < 1 || intervals < 0)
        return "batch_rk4 needs at least one step an interval, and no negative number of intervals";
    memcpy(begin, b->drive, sizeof begin);
    for (int first = 0; first < blocks(b); first += GROUP) {
        int left = blocks(b) - first, done = first * BATCH_BLOCK;
        struct group g = {&b->block[first], left < GROUP ? left : GROUP, b->n - done};
        memcpy(b->drive, begin, sizeof begin);
        for (int j = 0; j < intervals; j++) {
            run_interval(b, &g, steps, &table);
            end_interval(b, &g, samples ? samples + 2 * (size_t)j * (size_t)b->n + done : NULL);
        }
    }
    return NULL;
}
