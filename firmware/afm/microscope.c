/* microscope.c - see microscope.h. */
#include "firmware/afm/microscope.h"

#include <string.h>
#include "firmware/plant/plant.h"
#include "models/math/elementary.h"

/* Rest over a surface of height `below`, in the coordinates of z = -below. */
static const char *rest(struct microscope *m, const double *si)
{
    double lower[LEVER_PARAMETERS], p[MODEL_DERIVED];
    struct scale scale;
    int which;
    memcpy(lower, si, sizeof lower);
    lower[LEVER_HEIGHT] -= m->below;
    const char *why = plant_check(&afm_lever, lower, &which);
    if (why)
        return why;
    afm_lever.prepare(lower, p, &scale);
    afm_lever.rest(p, m->x);
    for (int i = 0; i < (int)si[LEVER_MODES]; i++)
        m->x[i] -= beam_modes[i].base * m->below / m->length_m;
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
        m->segment.length = c->tick_s / scale.time_s;
        why = modal.refuse(&afm_lever, m->p[i], m->segment.length, 0.0);
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
    m->material = surface_material(s, 0.0, 0.0);
    m->below = m->patch_from = m->patch_to = surface_height(s, 0.0, 0.0);
    for (int i = 0; i < MICROSCOPE_TONES; i++)
        m->tone[i].cosine = m->tone[i].turn_c = 1.0;
    m->step = modal.bind(&afm_lever);
    m->segment.active = 1u << LEVER_FORCE | 1u << LEVER_Z;
    m->segment.at[2][LEVER_Z].value = -m->below / m->length_m;
    /* The material with two branches of adhesion, where there is one, says that they are kept. */
    bool second = c->second && c->second[LEVER_HAMAKER_OUT] > c->second[LEVER_HAMAKER];
    modal.prepare(&afm_lever, m->p[second], m->segment.length, 0.0, m->scratch);
    return rest(m, c->si);
}

void microscope_tune(struct microscope *m, int i_tone, double frequency_Hz)
{
    struct tone *t = &m->tone[i_tone];
    t->step = turns_of(frequency_Hz * m->tick_s);
    cos_sin_turns(t->step, &t->turn_c, &t->turn_s);
}

/* ---- one sample ---- */

/* The tones as they are at tick `k` of the sample, model units. Their phasors turn from tick to tick and come
 * anew from the integer phase at the end of the sample. */
static double tones_at(struct microscope *m, uint32_t k)
{
    double sum = 0.0;
    for (int i = 0; i < MICROSCOPE_TONES; i++) {
        struct tone *t = &m->tone[i];
        double c = t->cosine, s = t->sine;
        if (t->step == 0)
            continue;
        if (k > 0) {
            t->cosine = c * t->turn_c - s * t->turn_s;
            t->sine = c * t->turn_s + s * t->turn_c;
        }
        sum += t->force_N * t->cosine;
    }
    return sum / m->force_N;
}

static void finish_tones(struct microscope *m)
{
    for (int i = 0; i < MICROSCOPE_TONES; i++) {
        struct tone *t = &m->tone[i];
        t->phase += m->ticks * t->step;
        if (t->step != 0)
            cos_sin_turns(t->phase, &t->cosine, &t->sine);
    }
}

/* The surface over the tick that begins. */
static void move_surface(struct microscope *m, double x, double y)
{
    uint32_t part = (uint32_t)(m->tick % MICROSCOPE_PATCH);
    if (part == 0) {
        m->patch_from = m->patch_to;
        m->patch_to = surface_height(&m->surface, x, y);
        m->material = surface_material(&m->surface, x, y);
        modal_change_sample(m->scratch);
    }
    m->below = m->patch_from + (m->patch_to - m->patch_from) * ((part + 1.0) / MICROSCOPE_PATCH);
}

static double stage(const struct microscope_stage *s, double value)
{
    return s->run ? s->run(s->who, value) : value;
}

static void note_crash(struct microscope *m, double force, const struct microscope_in *in)
{
    if (m->crash_N <= 0.0 || force <= m->crash_N)
        return;
    if (m->n_crashes == 0 || m->tick - m->crash_last > MICROSCOPE_APART) {
        m->n_crashes++;
        m->crash = (struct crash){m->tick, 0.0, in->x_m, in->y_m};
    }
    m->crash_last = m->tick;
    if (force > m->crash.peak_N)
        m->crash.peak_N = force;
}

/* One tick with the base on its way to z. The rate of the
 * base is that of z alone: the surface moves no mass. */
static bool run_tick(struct microscope *m, double z, double force)
{
    struct segment *e = &m->segment;
    struct crossing unused;
    double rate = (z - m->z_m) / (m->length_m * e->length), end = (z - m->below) / m->length_m;
    e->at[0][LEVER_Z].value = e->at[2][LEVER_Z].value;
    e->at[2][LEVER_Z].value = end;
    e->at[1][LEVER_Z].value = 0.5 * (e->at[0][LEVER_Z].value + end);
    e->at[0][LEVER_Z].rate = e->at[2][LEVER_Z].rate = rate;
    e->at[2][LEVER_FORCE].value = force;
    e->instant = m->tick << 16;
    m->z_m = z;
    m->tick++;
    return m->step(&afm_lever, m->p[m->material], m->scratch, e, REGIME_ANY, m->x, &unused) == STEP_END;
}

static void read(struct microscope *m, double *truth)
{
    double out[MODEL_OUTPUTS];
    afm_lever.output(m->p[m->material], m->segment.at[2], m->x, out);
    *truth = out[LEVER_DEFLECTION] * m->length_m;
}

/* Tick `k` of the sample, from 1 on. */
static bool run_one(struct microscope *m, const struct microscope_in *in, uint32_t k,
                    struct microscope_out *out)
{
    double held = in->force_N / m->force_N, *force = &m->segment.at[0][LEVER_FORCE].value;
    double z = m->command_m + (in->z_m - m->command_m) * k / m->ticks;
    *force = held + tones_at(m, 0);
    move_surface(m, in->x_m, in->y_m);
    if (!run_tick(m, stage(&m->piezo, z), held + tones_at(m, k)))
        return false;
    double pushed = modal.books(m->scratch)->force * m->force_N;
    note_crash(m, pushed, in);
    out->peak_N = pushed > out->peak_N ? pushed : out->peak_N;
    if (m->sensor.run) {
        read(m, &out->truth_m);
        m->sensed_m = m->sensor.run(m->sensor.who, out->truth_m);
    }
    return true;
}

bool microscope_run(struct microscope *m, const struct microscope_in *in, struct microscope_out *out)
{
    out->peak_N = 0.0;
    for (uint32_t k = 1; k <= m->ticks && !m->failed; k++)
        m->failed = !run_one(m, in, k, out);
    if (m->failed)
        return false;
    finish_tones(m);
    read(m, &out->truth_m);
    m->command_m = in->z_m;
    out->deflection_m = m->sensor.run ? m->sensed_m : out->truth_m;
    out->z_m = m->z_m;
    out->surface_m = m->below;
    return true;
}
