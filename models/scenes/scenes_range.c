/* scenes_range.c - warnings where the source papers leave their own range; docs/reference/models.md explains
 * them.
 *
 * Each rule is an inequality on the plant and its drives, in the paper's numbers. */
#include "models/scenes/scenes_range.h"

#include <math.h>
#include <stddef.h>
#include "models/reduced/afm_tip_reduced.h"
#include "models/math/elementary.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/rolling_contact.h"
#include "models/scenes/scenes.h"
#include "models/shaft_views.h"

/* Averaging needs a fast frequency of at least this times every slow one. */
static const double fast_enough = 3.0;

/* A paper's amplitudes and frequencies; 0 where the scene has none. */
struct facts {
    const struct model *model;
    double force, base, stiffness; /* amplitudes of the fast drive */
    double fast, slow;             /* frequencies; slow: the fastest slow one */
    double damping, waviness;
    double static_gaps; /* static deflection under the forces, over the gap */
    double gap_stiffness, hz;
    double beta, indentation_m;
    bool attracts;
};

/* ---- Hertz rig: Bichri, Belhaq & Perret-Liaudet 2011 ---- */

/* An averaged model: its state is the slow motion, which does not determine that of the full model. */
static bool is_averaged(const struct model *m)
{
    return m->full && !m->climb;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

static double frequency(const struct harmonic *d, double time_s)
{
    return d->amplitude != 0.0 ? d->omega * time_s : 0.0;
}

static void rig_facts(const double *si, const struct harmonic *drive, struct facts *f)
{
    double p[MODEL_DERIVED], T;
    struct scale s;
    hertz_rig_prepare(si, p, &s);
    T = s.time_s;
    f->slow = larger(1.0, frequency(&drive[RIG_FORCE], T));
    if (is_averaged(f->model)) {
        f->force = fabs(si[RIG_FAST_FORCE_N]) / s.force_N;
        f->base = 1.5 * fabs(si[RIG_FAST_BASE_M]) / s.length_m;
        f->stiffness = fabs(si[RIG_FAST_STIFFNESS]);
        f->fast = f->force + f->base + f->stiffness > 0.0 ? 2.0 * ELEMENTARY_PI * si[RIG_FAST_HZ] * T : 0.0;
        return;
    }
    f->force = fabs(drive[RIG_FAST_FORCE].amplitude) / s.force_N;
    f->base = 1.5 * fabs(drive[RIG_BASE].amplitude) / s.length_m;
    f->stiffness = fabs(drive[RIG_STIFFNESS].amplitude);
    f->fast = larger(larger(frequency(&drive[RIG_FAST_FORCE], T), frequency(&drive[RIG_BASE], T)),
                     frequency(&drive[RIG_STIFFNESS], T));
}

/* The mass cannot follow a fast base, whose amplitude beyond 3/2 (zs) opens the contact in each cycle. */
static bool base_opens(const struct facts *f)
{
    return f->base > 1.5 && f->fast >= fast_enough;
}

/* The fast motion, a/W^2, takes up half of the way to contact loss; the slow one at resonance has the
 * rest. */
static bool force_opens(const struct facts *f)
{
    return f->fast >= fast_enough && f->force > 0.75 * f->fast * f->fast;
}

static bool stiffness_negative(const struct facts *f)
{
    return f->stiffness > 1.0;
}

static bool averaged_not_fast(const struct facts *f)
{
    return is_averaged(f->model) && f->fast > 0.0 && f->fast < fast_enough * f->slow;
}

/* ---- AFM tip: Kirrou & Belhaq 2013 ---- */

static void tip_facts(const double *si, const struct harmonic *drive, struct facts *f)
{
    double p[MODEL_DERIVED];
    struct scale s;
    afm_tip_prepare(si, p, &s);
    bool averaged = is_averaged(f->model);
    f->attracts = si[TIP_SIGN] > 0.0;
    f->beta = 1.5 * fabs(p[TIP_P_HERTZ]);
    f->indentation_m = si[TIP_INDENTATION];
    f->slow = larger(sqrt(1.0 + 1.5 * p[TIP_P_HERTZ]), frequency(&drive[TIP_FORCE], s.time_s));
    f->stiffness = fabs(averaged ? si[TIP_FAST_STIFFNESS] : drive[TIP_STIFFNESS].amplitude);
    f->fast =
        averaged ? 2.0 * ELEMENTARY_PI * si[TIP_FAST_HZ] * s.time_s : drive[TIP_STIFFNESS].omega * s.time_s;
}

static bool tip_not_fast(const struct facts *f)
{
    return f->attracts && f->stiffness > 0.0 && f->fast < fast_enough * f->slow;
}

static bool tip_contact_lost(const struct facts *f)
{
    return f->stiffness > 1.0;
}

/* Around the two critical values of the published case. */
static bool tip_critical(const struct facts *f)
{
    return is_averaged(f->model) && f->attracts && f->stiffness >= 0.6 && f->stiffness <= 0.8;
}

/* For scenes in SI: in the paper's own numbers the indentation is 1. */
static bool tip_no_indentation(const struct facts *f)
{
    return f->beta >= 1.0 && f->indentation_m < 1e-12;
}

/* ---- rolling contact: Nayak 1972 ---- */

static void rolling_facts(const double *si, const struct harmonic *drive, struct facts *f)
{
    double p[MODEL_DERIVED];
    struct scale s;
    hertz_rig_prepare(si, p, &s);
    f->damping = 0.5 * p[ROLLING_P_TWO_ZETA];
    f->waviness = fabs(drive[ROLLING_WAVINESS].amplitude) / s.length_m;
    f->slow = drive[ROLLING_WAVINESS].omega * s.time_s;
}

/* The figures 10 to 13 are of waviness 0.3 to 3. */
static bool no_jumps(const struct facts *f)
{
    return f->waviness >= 0.3 && f->damping > 0.105;
}

static bool upward_jump(const struct facts *f)
{
    return f->waviness >= 0.5 && f->slow > 0.6 && f->slow < 0.72;
}

static bool in_antiphase(const struct facts *f)
{
    return f->waviness > 0.0 && f->slow < 0.5;
}

/* ---- shaft ---- */

static void shaft_facts(const double *si, const struct harmonic *drive, struct facts *f)
{
    double force = 0.0, gap = si[SHAFT_G1] < si[SHAFT_G3] ? si[SHAFT_G1] : si[SHAFT_G3];
    for (int i = 0; i < SHAFT_INPUTS; i++) {
        force += fabs(drive[i].amplitude);
        f->hz = larger(f->hz, drive[i].amplitude != 0.0 ? drive[i].omega / (2.0 * ELEMENTARY_PI) : 0.0);
    }
    f->damping = larger(si[SHAFT_C1], si[SHAFT_C3]);
    f->gap_stiffness = larger(si[SHAFT_KG1], si[SHAFT_KG3]);
    f->static_gaps = force / (2.0 * (si[SHAFT_KS1] + si[SHAFT_KS3]) * gap); /* translation */
}

/* Ten times the paper's damper and more calms the motion down (its fig. 17). */
static bool chaotic(const struct facts *f)
{
    return f->model->n_contacts > 0 && f->gap_stiffness >= 1e7 && f->static_gaps > 1.0 && f->damping < 40.0;
}

static bool second_mode(const struct facts *f)
{
    return !f->model->full && f->gap_stiffness < 1e5 && f->hz > 34.0 && f->hz < 48.0;
}

static bool linear_impacts(const struct facts *f)
{
    return f->model->n_contacts == 0 && f->static_gaps > 1.0 && f->hz < 36.27;
}

static bool bending(const struct facts *f)
{
    return f->gap_stiffness >= 1e7 && f->hz > 1150.0 && f->hz < 1220.0;
}

/* Under a symmetric force; other modes than the first do not get it. */
static bool superharmonic(const struct facts *f)
{
    static const double hz[3] = {18.0, 8.0, 6.0};
    bool near = false;
    for (int i = 0; i < 3; i++)
        near |= fabs(f->hz - hz[i]) <= 0.06 * hz[i];
    return f->model->n_states == 2 && f->static_gaps > 1.0 && near;
}

/* ---- the table ---- */

static const struct {
    const struct model *family; /* the rule is for this full model and its reduced ones */
    bool (*holds)(const struct facts *f);
    const char *text;
} rule[] = {
    {&hertz_rig, base_opens,
     "Bichri, Belhaq & Perret-Liaudet 2011 leave their range: a fast base motion above 3/2 opens the "
     "single-sided contact in every cycle (at 5 and 8 more than half of the time, resonance near 0.7, not "
     "0.95); their eq. 21 keeps only what is linear in the base"},
    {&hertz_rig, force_opens,
     "Bichri, Belhaq & Perret-Liaudet 2011 leave their range: the fast force moves the mass by more than "
     "half of the way to contact loss; at 60, 8 the contact is lost 5.8 % of the time"},
    {&hertz_rig, stiffness_negative,
     "Bichri, Belhaq & Perret-Liaudet 2011 leave their range: a stiffness amplitude above 1 makes the "
     "contact's stiffness negative in part of each cycle (over 40 % at 4 and 5), though the motion stays "
     "stable"},
    {&hertz_rig, averaged_not_fast,
     "Bichri, Belhaq & Perret-Liaudet 2011 leave their range: averaging needs a fast frequency of at least 3 "
     "times every slow one"},
    {&afm_tip, tip_not_fast,
     "Kirrou & Belhaq 2013 leave their range: this modulation is below 3 times the slow frequency; at beta "
     "0.8, Omega 1 the linear part is unstable from r = 0.12 on (tongue at 2 sqrt(1 - beta)) and the tip "
     "escapes from rest at r = 0.2 to 0.5"},
    {&afm_tip, tip_contact_lost,
     "Kirrou & Belhaq 2013 leave their range: r above 1 makes the contact's stiffness negative in part of "
     "each cycle"},
    {&afm_tip, tip_critical,
     "Kirrou & Belhaq 2013: the critical r 0.665 and 0.770 are exact for this averaged equation only; the "
     "peak's frequency rises with r, and the \"change of shift direction\" is its detuning from w1(r)"},
    {&afm_tip, tip_no_indentation,
     "Kirrou & Belhaq 2013 leave their range in section 3.3: an indentation below 1 pm (theirs is 0.26 pm) "
     "is far below an atom, and beta from 1 on (29.7 there) has no stable rest with the published sign, only "
     "with repulsion"},
    {&rolling_contact, no_jumps,
     "Nayak 1972 leaves his range: \"no jumps for zeta above 0.105\" is a value of one-term harmonic "
     "balance; exactly, folds persist to larger damping"},
    {&rolling_contact, upward_jump,
     "Nayak 1972 leaves his range: the upward jump at 0.66 to 0.67 is a value of one-term harmonic balance; "
     "for waviness 0.9 it is at 0.696"},
    {&rolling_contact, in_antiphase,
     "Nayak 1972 errs in conclusion (vi): at low frequency compression and waviness are in antiphase"},
    {&shaft_bearing, chaotic,
     "the shaft-bearing paper's hard gap springs under a force beyond the gap: chaotic; compare statistics, "
     "never trajectories"},
    {&shaft_bearing, second_mode,
     "the shaft-bearing paper errs: with soft gap springs the second closed-gap mode is at 41.3 Hz, not 36 "
     "Hz"},
    {&shaft_bearing, linear_impacts,
     "the shaft-bearing paper's force exceeds the gap statically: below 36.27 Hz the shaft impacts, which "
     "this linear model does not see"},
    {&shaft_bearing, bending,
     "the shaft-bearing paper errs in Table 2: the closed-gap bending mode is at 1187.8 Hz, not 1,180 Hz"},
    {&shaft_bearing, superharmonic,
     "the shaft-bearing paper leaves its linear theory: beside contact the second mode drives superharmonics "
     "near 18, 8 and 6 Hz, which this model of one mode does not see"},
};

enum { RULES = sizeof rule / sizeof rule[0] };

static const struct {
    const struct model *family;
    void (*read)(const double *si, const struct harmonic *drive, struct facts *f);
} reader[] = {
    {&hertz_rig, rig_facts},
    {&afm_tip, tip_facts},
    {&rolling_contact, rolling_facts},
    {&shaft_bearing, shaft_facts},
};

enum { READERS = sizeof reader / sizeof reader[0] };

const char *scenes_warning(const struct model *m, const double *si, const struct harmonic *drive, int i)
{
    const struct model *family = m->full ? m->full : m;
    struct facts f = {.model = m};
    for (int k = 0; k < READERS; k++) {
        if (reader[k].family == family)
            reader[k].read(si, drive, &f);
    }
    for (int k = 0; k < RULES; k++) {
        if (rule[k].family == family && rule[k].holds(&f) && i-- == 0)
            return rule[k].text;
    }
    return NULL;
}
