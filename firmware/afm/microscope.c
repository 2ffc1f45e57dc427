/* microscope.c - see microscope.h. */
#include "firmware/afm/microscope.h"

#include <float.h>
#include <string.h>
#include "firmware/method/modal_run.h"
#include "firmware/plant/plant.h"
#include "firmware/plant/plant_change.h"
#include "models/math/elementary.h"

/* Rest where it begins, in the coordinates of the base. The lever must fit over the origin at z = 0;
 * elsewhere the sample bends it as far as it must. */
static const char *rest(struct microscope *m, const struct microscope_config *c)
{
    double lower[LEVER_PARAMETERS], p[MODEL_DERIVED], base_m = m->z_m - m->below;
    struct scale scale;
    int which;
    memcpy(lower, c->si, sizeof lower);
    lower[LEVER_HEIGHT] = c->si[LEVER_HEIGHT] - surface_height(&m->surface, 0.0, 0.0);
    const char *why = plant_check(&afm_lever, lower, &which);
    if (why)
        return why;
    lower[LEVER_HEIGHT] = c->si[LEVER_HEIGHT] + base_m;
    afm_lever.prepare(lower, p, &scale);
    afm_lever.rest(p, m->x);
    for (int i = 0; i < (int)c->si[LEVER_MODES]; i++)
        m->x[i] += beam_modes[i].base * base_m / m->length_m;
    return NULL;
}

/* The numbers of both materials. NULL, or the reason of a refusal. */
static const char *prepare(struct microscope *m, const struct microscope_config *c)
{
    struct scale scale;
    int which;
    for (int i = 0; i < 2; i++) {
        const double *si = i && c->second ? c->second : c->si;
        const char *why = plant_check(&afm_lever, si, &which);
        if (why)
            return why;
        afm_lever.prepare(si, m->p[i], &scale);
        m->length = c->tick_s / scale.time_s;
        why = modal.refuse(&afm_lever, m->p[i], m->length, 0.0);
        if (why)
            return why;
    }
    m->length_m = scale.length_m;
    m->force_N = scale.force_N;
    return NULL;
}

const char *microscope_init(struct microscope *m, const struct microscope_config *c, const struct surface *s)
{
    memset(m, 0, sizeof *m);
    ASSERT(modal.n_scratch(&afm_lever) <= MICROSCOPE_SCRATCH);
    ASSERT(c->ticks >= 1 && c->ticks <= MICROSCOPE_TICKS_MAX);
    const char *why = prepare(m, c);
    if (why)
        return why;
    m->tick_s = c->tick_s;
    m->ticks = c->ticks;
    m->crash_N = c->crash_N;
    m->piezo = c->piezo;
    m->sensor = c->sensor;
    m->surface = *s;
    m->material = surface_material(s, c->at.x_m, c->at.y_m);
    m->below = m->patch_from = m->patch_to = surface_height(s, c->at.x_m, c->at.y_m);
    m->command_m = c->at.z_m;
    m->z_m = c->z_m;
    for (int i = 0; i < MICROSCOPE_TONES; i++)
        m->tone[i].cosine = m->tone[i].turn_c = 1.0;
    m->base.value = (m->z_m - m->below) / m->length_m;
    /* The material with two branches of adhesion, where there is one, says that they are kept. */
    bool second = c->second && c->second[LEVER_HAMAKER_OUT] > c->second[LEVER_HAMAKER];
    modal.prepare(&afm_lever, m->p[second], m->length, 0.0, m->scratch);
    modal_change_sample(&afm_lever, m->p[m->material], m->scratch);
    return rest(m, c);
}

void microscope_tune(struct microscope *m, int i_tone, double frequency_Hz)
{
    struct tone *t = &m->tone[i_tone];
    t->step = turns_of(frequency_Hz * m->tick_s);
    cos_sin_turns(t->step, &t->turn_c, &t->turn_s);
}

/* ---- one sample ---- */

/* Ticks that are commanded ahead of the lever. */
enum { AHEAD = 16 };

/* A tone at the begin and after each of n ticks, beside what there is. Its phasor turns from tick to tick. */
static void add_tone(struct tone *t, uint32_t n, const double *there, double *f)
{
    double cosine = t->cosine, sine = t->sine, turn_c = t->turn_c, turn_s = t->turn_s, force = t->force_N;
    f[0] = there[0] + force * cosine;
    for (uint32_t k = 1; k <= n; k++) {
        double c = cosine;
        cosine = c * turn_c - sine * turn_s;
        sine = c * turn_s + sine * turn_c;
        f[k] = there[k] + force * cosine;
    }
    t->cosine = cosine;
    t->sine = sine;
}

/* The forces at the begin and after each of n ticks, model units. */
static void forces(struct microscope *m, double held_N, uint32_t n, double *f)
{
    static const double none[AHEAD + 1] = {0.0};
    const double *there = none;
    double unit = m->force_N, held = held_N / unit;
    for (int i = 0; i < MICROSCOPE_TONES; i++) {
        if (m->tone[i].step == 0)
            continue;
        add_tone(&m->tone[i], n, there, f);
        there = f;
    }
    for (uint32_t k = 0; k <= n; k++)
        f[k] = held + there[k] / unit;
}

/* The phasors come anew from the integer phase at the end of the sample. */
static void finish_tones(struct microscope *m)
{
    for (int i = 0; i < MICROSCOPE_TONES; i++) {
        struct tone *t = &m->tone[i];
        t->phase += m->ticks * t->step;
        if (t->step != 0)
            cos_sin_turns(t->phase, &t->cosine, &t->sine);
    }
}

/* The surface from here on; between two of them it is a straight line. */
static void begin_patch(struct microscope *m, double x, double y)
{
    int material = surface_material(&m->surface, x, y);
    m->patch_from = m->patch_to;
    m->patch_to = surface_height(&m->surface, x, y);
    if (material == m->material)
        return;
    m->material = material;
    modal_change_sample(&afm_lever, m->p[material], m->scratch);
}

/* The surface below n ticks from now on, within a patch. */
static void surfaces(struct microscope *m, uint32_t n, double *below)
{
    double from = m->patch_from, way = m->patch_to - from, part = (double)(m->tick % MICROSCOPE_PATCH);
    for (uint32_t k = 0; k < n; k++)
        below[k] = from + way * ((part + (k + 1.0)) / MICROSCOPE_PATCH);
    m->below = below[n - 1];
}

/* The base in n ticks from tick `done` of the sample on, on its way to z. */
static void bases(struct microscope *m, double z_m, uint32_t done, uint32_t n, double *z)
{
    double from = m->command_m, way = z_m - from, ticks = m->ticks;
    for (uint32_t k = 0; k < n; k++)
        z[k] = from + way * (done + k + 1) / ticks;
    if (m->piezo.run)
        m->piezo.run(m->piezo.who, z, n);
}

/* n ticks from tick `done` of the sample on, within a patch. The rate of the base is that of z alone: the
 * surface moves no mass. */
static void command(struct microscope *m, const struct microscope_in *in, uint32_t done, uint32_t n,
                    struct modal_tick *tick)
{
    double f[AHEAD + 1], z[AHEAD], below[AHEAD], length_m = m->length_m, last = m->z_m;
    double unit = length_m * m->length;
    struct input base = m->base;
    forces(m, in->force_N, n, f);
    bases(m, in->z_m, done, n, z);
    surfaces(m, n, below);
    for (uint32_t k = 0; k < n; k++) {
        double begin = base.value;
        base = (struct input){(z[k] - below[k]) / length_m, (z[k] - last) / unit};
        tick[k] = (struct modal_tick){{f[k], f[k + 1]}, {begin, base.value}, base.rate, 0.0};
        last = z[k];
    }
    m->base = base;
    m->z_m = last;
}

/* A contact force above crash_N in the tick that has ended. */
static void note_crash(struct microscope *m, uint64_t tick, double force, const struct microscope_in *in)
{
    if (m->n_crashes == 0 || tick - m->crash_last > MICROSCOPE_APART) {
        m->n_crashes++;
        m->crash = (struct crash){tick, 0.0, in->x_m, in->y_m};
    }
    m->crash_last = tick;
    if (force > m->crash.peak_N)
        m->crash.peak_N = force;
}

static void note_forces(struct microscope *m, const struct modal_tick *tick, uint32_t n,
                        const struct microscope_in *in, struct microscope_out *out)
{
    double unit = m->force_N, crash = m->crash_N > 0.0 ? m->crash_N : DBL_MAX, peak = out->peak_N;
    for (uint32_t k = 0; k < n; k++) {
        double pushed = tick[k].peak * unit;
        peak = pushed > peak ? pushed : peak;
        if (pushed > crash)
            note_crash(m, m->tick + k + 1, pushed, in);
    }
    m->tick += n;
    out->peak_N = peak;
}

static double deflection(const struct microscope *m)
{
    return afm_lever_deflection(m->p[m->material], &m->base, m->x) * m->length_m;
}

/* The next ticks of the sample, of which so many are done; returns their number, or 0. A sensor sees each. */
static uint32_t run_some(struct microscope *m, const struct microscope_in *in, uint32_t done,
                         struct microscope_out *out)
{
    struct modal_tick tick[AHEAD];
    uint32_t n = m->ticks - done, part = (uint32_t)(m->tick % MICROSCOPE_PATCH);
    uint32_t most = m->sensor.run ? 1 : AHEAD;
    if (part == 0)
        begin_patch(m, in->x_m, in->y_m);
    most = most < MICROSCOPE_PATCH - part ? most : MICROSCOPE_PATCH - part;
    n = n < most ? n : most;
    command(m, in, done, n, tick);
    if (!modal_run(&afm_lever, m->p[m->material], m->scratch, tick, n, m->tick, m->x))
        return 0;
    note_forces(m, tick, n, in, out);
    if (m->sensor.run) {
        m->sensed_m = deflection(m);
        m->sensor.run(m->sensor.who, &m->sensed_m, 1);
    }
    return n;
}

bool microscope_run(struct microscope *m, const struct microscope_in *in, struct microscope_out *out)
{
    uint32_t some;
    out->peak_N = 0.0;
    for (uint32_t done = 0; done < m->ticks && !m->failed; done += some) {
        some = run_some(m, in, done, out);
        m->failed = some == 0;
    }
    if (m->failed)
        return false;
    finish_tones(m);
    out->truth_m = deflection(m);
    m->command_m = in->z_m;
    out->deflection_m = m->sensor.run ? m->sensed_m : out->truth_m;
    out->z_m = m->z_m;
    out->surface_m = m->below;
    return true;
}
