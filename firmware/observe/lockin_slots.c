/* lockin_slots.c - see lockin_slots.h. */
#include "firmware/observe/lockin_slots.h"

#include <math.h>
#include <string.h>
#include "models/lanes.h"
#include "models/math/elementary.h"

void lockin_slots_change(struct lockin_slots *l, const double *setting, uint32_t frame_ticks)
{
    lockin_begin(&l->window, (uint32_t)setting[SET_LOCKIN_FRAMES] * frame_ticks);
    for (int i = 0; i < LOCKIN_SLOTS; i++) {
        l->slot[i].harmonic = (uint8_t)setting[SET_LOCKIN_HARMONIC + i];
        l->slot[i].drive = (uint8_t)setting[SET_LOCKIN_CHANNEL + i];
        l->slot[i].output = (uint8_t)setting[SET_LOCKIN_OUTPUT + i];
        l->slot[i].first = (uint8_t)i;
        for (int k = i - 1; k >= 0; k--)
            if (l->slot[k].output == l->slot[i].output)
                l->slot[i].first = (uint8_t)k;
    }
}

/* ---- a tick ---- */

/* Outputs now, in model units, and the results of stages, SI. */
ALWAYS_INLINE void read_outputs(const struct plant *pl, double output[MODEL_OUTPUTS + PLANT_STAGES])
{
    if (pl->staged)
        memcpy(&output[MODEL_OUTPUTS], pl->stage_calls->results(pl->stages), PLANT_STAGES * sizeof *output);
    pl->model->output(pl->p, pl->segment.at[2], pl->x, output);
}

void lockin_slots_tick(void *frame, const struct plant *pl)
{
    const struct lockin_frame *f = frame;
    double output[MODEL_OUTPUTS + PLANT_STAGES], weighted[LOCKIN_SLOTS] = {0.0};
    double weight = lockin_weight(&f->slots->window);
    read_outputs(pl, output);
    for (int k = 0; k < f->n_outputs; k++) {
        struct lockin_output *sums = f->output[k].sums;
        double y = weight * (output[f->output[k].number] - sums->reference);
        weighted[k] = y;
        sums->mean += y;
        for (int j = 0; j < f->output[k].n_drives; j++)
            lockin_add(&sums->drive[j], 1, y, f->drive[j].drive->cosine, f->drive[j].drive->sine);
    }
    for (int h = 0; h < f->n_harmonics; h++)
        lockin_add(f->harmonic[h].sum, f->harmonic[h].harmonic, weighted[f->harmonic[h].output],
                   f->harmonic[h].drive->cosine, f->harmonic[h].drive->sine);
}

/* Sums over n ticks at a harmonic of drive i, each in the order of the ticks. */
static void add_ticks(struct lockin_sum *sum, uint32_t harmonic, const double *weighted,
                      const struct phasor (*phasor)[MODEL_INPUTS], int i, uint32_t n)
{
    struct lockin_sum s = *sum;
#if TICK_LANES > 1 /* lockin_add with both parts side by side: the same bits */
    real_lanes both = {s.re, -s.im};
    for (uint32_t k = 0; k < n && harmonic == 1; k++)
        both += weighted[k] * *(const lanes_in_memory *)(const void *)&phasor[k][i];
    s = (struct lockin_sum){both[0], -both[1]};
#endif
    for (uint32_t k = 0; k < n && (TICK_LANES == 1 || harmonic > 1); k++)
        lockin_add(&s, harmonic, weighted[k], phasor[k][i].cosine, phasor[k][i].sine);
    *sum = s;
}

void lockin_slots_ticks(void *frame, const struct plant *pl, const struct method_block *b, uint32_t from,
                        uint32_t n)
{
    const struct lockin_frame *f = frame;
    double output[MODEL_OUTPUTS + PLANT_STAGES], weighted[LOCKIN_SLOTS][BLOCK_TICKS] = {{0.0}};
    const struct phasor(*phasor)[MODEL_INPUTS] = &b->phasor[from + 1];
    if (pl->staged)
        memcpy(&output[MODEL_OUTPUTS], pl->stage_calls->results(pl->stages), PLANT_STAGES * sizeof *output);
    for (uint32_t k = 0; k < n; k++) {
        double weight = lockin_weight(&f->slots->window);
        pl->model->output(pl->p, b->at[2 * (from + k + 1)], b->x[from + k + 1], output);
        for (int i = 0; i < f->n_outputs; i++)
            weighted[i][k] = weight * (output[f->output[i].number] - f->output[i].sums->reference);
    }
    for (int i = 0; i < f->n_outputs; i++) {
        struct lockin_output *sums = f->output[i].sums;
        for (uint32_t k = 0; k < n; k++)
            sums->mean += weighted[i][k];
        for (int j = 0; j < f->output[i].n_drives; j++)
            add_ticks(&sums->drive[j], 1, weighted[i], phasor, f->drive[j].number, n);
    }
    for (int h = 0; h < f->n_harmonics; h++)
        add_ticks(f->harmonic[h].sum, f->harmonic[h].harmonic, weighted[f->harmonic[h].output], phasor,
                  f->harmonic[h].number, n);
}

/* ---- the begin of a frame ---- */

static bool sounds(const struct drive *d)
{
    return d->amplitude != 0.0 || d->ramp_left > 0;
}

static void begin_window(struct lockin_slots *l, const struct plant *pl)
{
    double output[MODEL_OUTPUTS + PLANT_STAGES] = {0.0};
    read_outputs(pl, output);
    lockin_begin(&l->window, l->window.n_ticks);
    memset(l->output, 0, sizeof l->output);
    memset(l->turns, 0, sizeof l->turns);
    for (int i = 0; i < LOCKIN_SLOTS; i++) {
        l->output[i].reference = output[l->slot[i].output];
        l->slot[i].sum = (struct lockin_sum){0.0, 0.0};
    }
}

/* A slot whose drive sounds, or a mean. */
static bool measures(const struct lockin_slots *l, int i)
{
    return l->slot[i].harmonic == 0 || (l->sounding >> l->slot[i].drive & 1u);
}

/* Adds the output of slot i; returns its place. */
static int list_output(struct lockin_frame *f, int i)
{
    struct lockin_slots *l = f->slots;
    f->output[f->n_outputs].sums = &l->output[l->slot[i].first];
    f->output[f->n_outputs].number = l->slot[i].output;
    return f->n_outputs++;
}

static void list_harmonic(struct lockin_frame *f, const struct plant *pl, int i, int output)
{
    struct lockin_slots *l = f->slots;
    f->harmonic[f->n_harmonics].sum = &l->slot[i].sum;
    f->harmonic[f->n_harmonics].drive = &pl->drive[l->slot[i].drive];
    f->harmonic[f->n_harmonics].number = l->slot[i].drive;
    f->harmonic[f->n_harmonics].harmonic = l->slot[i].harmonic;
    f->harmonic[f->n_harmonics++].output = output;
}

/* Lists the sums of slot i. place: of the output of each first slot, -1 before it is listed. */
static void list_slot(struct lockin_frame *f, const struct plant *pl, int i, int place[LOCKIN_SLOTS])
{
    const struct lockin_slots *l = f->slots;
    int output = place[l->slot[i].first];
    if (output < 0)
        output = list_output(f, i);
    place[l->slot[i].first] = output;
    f->n_slots++;
    if (l->slot[i].harmonic > 0)
        f->output[output].n_drives = f->n_drives;
    if (l->slot[i].harmonic > 1)
        list_harmonic(f, pl, i, output);
}

/* Lists every output, drive and harmonic; places that stay empty hold the first one. */
static void list_all(struct lockin_frame *f, struct lockin_slots *l, const struct plant *pl)
{
    int place[LOCKIN_SLOTS];
    *f = (struct lockin_frame){.slots = l};
    for (int i = 0; i < LOCKIN_SLOTS; i++) {
        f->output[i].sums = &l->output[0];
        f->drive[i].drive = &pl->drive[0];
        f->harmonic[i].sum = &l->slot[0].sum;
        f->harmonic[i].drive = &pl->drive[0];
        place[i] = -1;
    }
    for (int i = 0; i < MODEL_INPUTS; i++) {
        if (!(l->sounding >> i & 1u))
            continue;
        f->drive[f->n_drives].drive = &pl->drive[i];
        f->drive[f->n_drives++].number = i;
    }
    for (int i = 0; i < LOCKIN_SLOTS; i++)
        if (measures(l, i))
            list_slot(f, pl, i, place);
}

void lockin_slots_begin_frame(struct lockin_slots *l, const struct plant *pl, uint32_t ticks,
                              struct lockin_frame *f)
{
    unsigned sounding = 0;
    f->slots = l;
    f->n_slots = 0;
    if (l->window.n_ticks == 0)
        return;
    for (int i = 0; i < pl->model->n_inputs; i++)
        sounding |= (unsigned)sounds(&pl->drive[i]) << i;
    bool anew = l->window.i_tick == 0 || l->window.i_tick % ticks != 0 || sounding != l->sounding;
    l->sounding = sounding;
    list_all(f, l, pl);
    if (f->n_slots == 0)
        l->window.i_tick = 0;
    else if (anew)
        begin_window(l, pl);
    for (int i = 0; i < f->n_drives; i++)
        l->turns[i] += drive_turns_per_tick(f->drive[i].drive) * ticks;
}

/* ---- the end of a window ---- */

/* The wave of a listed drive at harmonic n over the window: its mean frequency, and its phase from that now.
 */
static struct lockin_tone tone_of(const struct lockin_frame *f, int k, uint32_t n)
{
    const struct drive *d = f->drive[k].drive;
    double ticks = f->slots->window.n_ticks, rate = f->slots->turns[k] / ticks;
    uint64_t middle = d->carrier + d->offset - turns_of(0.5 * rate * (ticks - 1.0));
    return (struct lockin_tone){rate * n, middle * n, {0.0, 0.0}};
}

/* The tone of a slot stands last, behind those that may leak into it. */
static int list_tones(const struct lockin_frame *f, int i, struct lockin_tone *tone)
{
    const struct lockin_slots *l = f->slots;
    const struct lockin_sum *sum = l->output[l->slot[i].first].drive;
    uint32_t harmonic = l->slot[i].harmonic;
    int own = 0, n = 0;
    for (int k = 0; k < f->n_drives; k++)
        own = f->drive[k].number == l->slot[i].drive ? k : own;
    struct lockin_tone last = tone_of(f, own, harmonic);
    last.sum = harmonic == 1 ? sum[own] : l->slot[i].sum;
    for (int k = 0; k < f->n_drives; k++) {
        tone[n] = tone_of(f, k, 1);
        tone[n].sum = sum[k];
        n += (k != own || harmonic > 1) && !lockin_equal(&l->window, &tone[n], &last);
    }
    tone[n] = last;
    return n + 1;
}

static void end_slot(const struct lockin_frame *f, const struct plant *pl, int i)
{
    struct lockin_slots *l = f->slots;
    struct lockin_result *r = &l->slot[i].result;
    const struct lockin_output *sums = &l->output[l->slot[i].first];
    struct lockin_tone tone[LOCKIN_TONES];
    struct lockin_sum z = {(double)NAN, (double)NAN};
    enum lockin_verdict verdict = LOCKIN_TOLD;
    int output = l->slot[i].output;
    double unit = 1.0;
    if (output < MODEL_OUTPUTS)
        unit = scale_of(&pl->scale, pl->model->output_signal[output].quantity);
    if (l->slot[i].harmonic == 0)
        z = (struct lockin_sum){sums->reference + sums->mean / l->window.weight, 0.0};
    else
        verdict = lockin_fit(&l->window, tone, list_tones(f, i, tone), sums->mean, &z);
    l->n_short += verdict == LOCKIN_SHORT;
    l->n_close += verdict == LOCKIN_CLOSE;
    r->number++;
    lockin_polar(&z, unit, &r->amplitude, &r->phase);
    if (verdict != LOCKIN_TOLD)
        r->phase = (double)NAN;
}

void lockin_slots_end_frame(const struct lockin_frame *f, const struct plant *pl)
{
    struct lockin_slots *l = f->slots;
    if (f->n_slots == 0 || l->window.i_tick < l->window.n_ticks)
        return;
    for (int i = 0; i < LOCKIN_SLOTS; i++)
        if (measures(l, i))
            end_slot(f, pl, i);
    l->window.i_tick = 0;
}
