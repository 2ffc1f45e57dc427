/* scenes_table.c - the presets: three rigs to begin with, and a case of each figure, response curve or map of
 * the papers.
 *
 * Times in the papers' dimensionless scenes are in their own unit; dilation makes one of it a frame of 1 ms.
 * The papers' figures show steady motion, so `over` is long enough to reach it from rest. */
#include "models/scenes/scenes_table.h"

#include <stddef.h>
#include "models/afm_lever.h"
#include "models/reduced/afm_tip_reduced.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/rolling_contact.h"
#include "models/shaft_views.h"

/* Outputs that every model has. */
enum { VELOCITY = 1, PENETRATION, POSITION1 = 4 };

/* ---- Bichri, Belhaq & Perret-Liaudet 2011: xi 0.01, sigma 0.04, Omega 8 ---- */

#define BICHRI(which, slow, drive, amplitude)                                                                \
    {                                                                                                        \
        .model = &which, .method = "auto", .paper = true,                                                    \
        .value = {[RIG_PAPER_XI] = 0.01,                                                                     \
                  [RIG_PAPER_SIGMA] = 0.04,                                                                  \
                  [RIG_PAPER_OMEGA] = slow,                                                                  \
                  [RIG_PAPER_FAST_OMEGA] = 8.0,                                                              \
                  [drive] = amplitude},                                                                      \
        .observable = PENETRATION, .over = 600.0, .tolerance = 1e-4, .frame_s = 1e-3, .substeps = 64,        \
        .dilation = 1e-3, .cost_s = 1e-6                                                                     \
    }
#define FIG2(which) BICHRI(which, 0.98, RIG_PAPER_FORCE, 60.0)
#define FIG5(which) BICHRI(which, 0.99, RIG_PAPER_BASE, 8.0)
#define FIG8(which) BICHRI(which, 1.12, RIG_PAPER_STIFFNESS, 5.0)

/* ---- Kirrou & Belhaq 2013: beta 0.8, f 0.008, published sign ---- */

#define TIP_CASE(which, stiffness, damping, modulation, fast, force, slow, duration)                         \
    {                                                                                                        \
        .model = &which, .method = "auto", .paper = true,                                                    \
        .value = {[TIP_PAPER_BETA] = stiffness,  [TIP_PAPER_C] = damping, [TIP_PAPER_R] = modulation,        \
                  [TIP_PAPER_FAST_OMEGA] = fast, [TIP_PAPER_F] = force,   [TIP_PAPER_OMEGA] = slow,          \
                  [TIP_PAPER_SIGN] = 1.0},                                                                   \
        .observable = PENETRATION, .over = duration, .tolerance = 1e-4, .frame_s = 1e-3, .substeps = 64,     \
        .dilation = 1e-3, .cost_s = 1e-6                                                                     \
    }
#define KIRROU(which, damping, modulation, fast, slow, duration)                                             \
    TIP_CASE(which, 0.8, damping, modulation, fast, 0.008, slow, duration)
/* omega = w1(r) + sigma with the figure's sigma = 0.01 */
#define FIG16(which) KIRROU(which, 0.05, 0.2, 3.0, 0.45929, 300.0)

/* The silicon lever of section 3.3 with its published indentation, which only repulsion can have. */
#define LEVER                                                                                                \
    .model = &afm_tip, .method = "auto",                                                                     \
    .value = {[TIP_MASS] = 1.13e-11,       [TIP_LEVER_STIFFNESS] = 0.404,                                    \
              [TIP_DAMPING] = 4.2733e-8,   [TIP_CONTACT_STIFFNESS] = 1.57e7,                                 \
              [TIP_INDENTATION] = 2.6e-13, [TIP_SIGN] = -1.0},                                               \
    .observable = PENETRATION, .over = 5e-3, .tolerance = 1e-4, .frame_s = 1e-3, .substeps = 64,             \
    .dilation = 1e3, .cost_s = 1e-6

/* ---- levers of an AFM, over a polymer at room temperature ---- */

/* `pace`: steps in a period; frames of 64 steps. */
#define MICROSCOPE(f0, k, quality, modes, height, pace)                                                      \
    .model = &afm_lever, .method = "modal",                                                                  \
    .value = {[LEVER_F0] = f0,                                                                               \
              [LEVER_K] = k,                                                                                 \
              [LEVER_Q] = quality,                                                                           \
              [LEVER_TEMPERATURE] = 295.0,                                                                   \
              [LEVER_MODES] = modes,                                                                         \
              [LEVER_RADIUS] = 10e-9,                                                                        \
              [LEVER_HAMAKER] = 6.4e-20,                                                                     \
              [LEVER_HAMAKER_OUT] = 6.4e-20,                                                                 \
              [LEVER_A0] = 0.165e-9,                                                                         \
              [LEVER_RELEASE] = 10e-9,                                                                       \
              [LEVER_MODULUS] = 1e9,                                                                         \
              [LEVER_HEIGHT] = height,                                                                       \
              [LEVER_INDENTATION_MAX] = 5e-9,                                                                \
              [LEVER_RANGE] = 1e-6},                                                                         \
    .observable = LEVER_DEFLECTION, .over = 0.01, .tolerance = 1e-3, .frame_s = 1e-3, .substeps = 64,        \
    .dilation = (f0) * (pace) / 64e3, .cost_s = 1e-6

/* ---- Nayak 1972 ---- */

#define NAYAK(damping, waviness, frequency)                                                                  \
    .model = &rolling_contact, .method = "auto", .paper = true,                                              \
    .value =                                                                                                 \
        {[ROLLING_PAPER_ZETA] = damping, [ROLLING_PAPER_XI0] = waviness, [ROLLING_PAPER_OMEGA] = frequency}, \
    .observable = PENETRATION, .over = 300.0, .tolerance = 1e-4, .frame_s = 1e-3, .dilation = 1e-3,          \
    .cost_s = 1e-6

/* ---- the shaft: Table 1, 25 N on the middle mass ---- */

#define SHAFT_CASE(which, damper, middle, support3, gap1, gap3, gap_stiffness1, gap_stiffness3, force1,      \
                   force2, hz)                                                                               \
    .model = &which, .method = "auto",                                                                       \
    .paper = true, .value = {0.629,    1.258,   0.629,  damper, middle, damper,         8030.0,              \
                             support3, 79161.0, 0.1614, gap1,   gap3,   gap_stiffness1, gap_stiffness3,      \
                             force1,   force2,  0.0,    hz,     0.0},                                        \
    .observable = POSITION1, .over = 2.0, .tolerance = 1e-6, .dilation = 1.0, .cost_s = 2e-6
#define SHAFT_DATA(damper, middle, gap_stiffness, hz)                                                        \
    SHAFT_CASE(shaft_bearing, damper, middle, 8030.0, GAP, GAP, gap_stiffness, gap_stiffness, 0.0, 25.0, hz)
/* the supports, gaps and gap springs that the maps vary, with the nominal damper */
#define SHAFT_MAP(support3, gap1, gap3, gap_stiffness1, gap_stiffness3, hz)                                  \
    SHAFT_CASE(shaft_bearing, 4.0, 4.0, support3, gap1, gap3, gap_stiffness1, gap_stiffness3, 0.0, 25.0, hz)
#define GAP        2.54e-4
#define SLOW_FRAME .frame_s = 1e-3, .substeps = 64
#define FAST_FRAME .frame_s = 1e-4, .substeps = 8 /* 14 frames in a period of 700 Hz */
#define HARD       3.502e7
#define MIDDLE     1.4e6
#define SOFT       2.626e4

const struct preset scenes_table[SCENES] = {
    {"rig",
     "6.5 kg on a steel contact of 230 Hz, shaken below its resonance",
     {.model = &hertz_rig,
      .method = "auto",
      .value =
          {[RIG_MASS] = 6.5, [RIG_CONTACT_STIFFNESS] = 3.4e9, [RIG_PRELOAD] = 64.0, [RIG_DAMPING] = 188.0},
      .drive = {[RIG_FORCE] = {.amplitude = 20.0, .frequency_Hz = 150.0}},
      .observable = PENETRATION,
      .over = 2.0,
      .tolerance = 1e-4,
      SLOW_FRAME,
      .dilation = 1.0,
      .cost_s = 1e-6}},
    {"tip",
     "silicon AFM lever on a repulsive sample, 1000 times slower on the bus",
     {LEVER, .drive = {[TIP_FORCE] = {.amplitude = 1e-14, .frequency_Hz = 1.5e5}}}},
    {"shaft",
     "shaft in two soft bearings with clearance, shaken near its resonance",
     {.model = &shaft_bearing,
      .method = "auto",
      .value = {0.629, 1.258, 0.629, 4.0, 4.0, 4.0, 8030.0, 8030.0, 79161.0, 0.1614, 2.54e-4, 2.54e-4, SOFT,
                SOFT},
      .drive = {[1] = {.amplitude = 10.0, .frequency_Hz = 24.0}},
      .observable = PENETRATION,
      .over = 2.0,
      .tolerance = 1e-6,
      SLOW_FRAME,
      .dilation = 1.0,
      .cost_s = 2e-6}},
    {"soft",
     "AFM lever of 13 kHz, 0.2 N/m, Q 30, near a polymer: force curves",
     {MICROSCOPE(13e3, 0.2, 30.0, 1.0, 20e-9, 96.0)}},
    {"seed",
     "AFM lever of 30.09 kHz, 0.404 N/m, Q 50, pressed on, stiffness modulated",
     {MICROSCOPE(30.09e3, 0.404, 50.0, 2.0, -10e-9, 96.0),
      .drive = {[LEVER_STIFFNESS] = {.amplitude = 0.2, .frequency_Hz = 300e3}}}},
    {"tapping",
     "AFM lever of 70 kHz, 2 N/m, Q 400, tapping: 20 nm free, 14 nm high",
     {MICROSCOPE(70e3, 2.0, 400.0, 1.0, 14e-9, 64.0),
      .drive = {[LEVER_FORCE] = {.amplitude = 1e-10, .frequency_Hz = 70e3}}}},
    {"stiff",
     "AFM lever of 300 kHz, 40 N/m, Q 450, tapping: 10 nm free, 8 nm high",
     {MICROSCOPE(300e3, 40.0, 450.0, 1.0, 8e-9, 64.0),
      .drive = {[LEVER_FORCE] = {.amplitude = 8.888888888888889e-10, .frequency_Hz = 300e3}}}},

    {"bbp-fig2-force", "Bichri et al. 2011 fig. 2, fast force 60, the single-sided contact", FIG2(hertz_rig)},
    {"bbp-fig2-force-cubic", "Bichri et al. 2011 fig. 2, the full motion q of eq. 3", FIG2(hertz_rig_cubic)},
    {"bbp-fig2-force-slow", "Bichri et al. 2011 fig. 2, the slow motion of eq. 9", FIG2(hertz_rig_averaged)},
    {"bbp-fig3", "Bichri et al. 2011 fig. 3, without the fast force",
     BICHRI(hertz_rig, 0.95, RIG_PAPER_FORCE, 0.0)},
    {"bbp-fig5-base", "Bichri et al. 2011 fig. 5, fast base motion 8, the single-sided contact",
     FIG5(hertz_rig)},
    {"bbp-fig5-base-cubic", "Bichri et al. 2011 fig. 5, the full motion q of eq. 21", FIG5(hertz_rig_cubic)},
    {"bbp-fig5-base-slow", "Bichri et al. 2011 fig. 5, the slow motion of eq. 22", FIG5(hertz_rig_averaged)},
    {"bbp-fig6", "Bichri et al. 2011 fig. 6, fast base motion 5",
     BICHRI(hertz_rig, 0.8, RIG_PAPER_BASE, 5.0)},
    {"bbp-fig8-stiff", "Bichri et al. 2011 fig. 8, fast stiffness 5, the single-sided contact",
     FIG8(hertz_rig)},
    {"bbp-fig8-stiff-cubic", "Bichri et al. 2011 fig. 8, the full motion q of eq. 27", FIG8(hertz_rig_cubic)},
    {"bbp-fig8-stiff-slow", "Bichri et al. 2011 fig. 8, the slow motion of eq. 30", FIG8(hertz_rig_averaged)},
    {"bbp-fig9", "Bichri et al. 2011 fig. 9, fast stiffness 4",
     BICHRI(hertz_rig, 1.05, RIG_PAPER_STIFFNESS, 4.0)},

    {"kb-fig2", "Kirrou & Belhaq 2013 fig. 2, f 0.004, no modulation",
     TIP_CASE(afm_tip, 0.8, 0.02, 0.0, 1.0, 0.004, 0.4472, 300.0)},
    {"kb-fig3", "Kirrou & Belhaq 2013 fig. 3, beta 0.7, no modulation",
     TIP_CASE(afm_tip, 0.7, 0.02, 0.0, 1.0, 0.008, 0.5477, 300.0)},
    {"kb-fig4", "Kirrou & Belhaq 2013 fig. 4, r 0.05, Omega 1, below the jump",
     KIRROU(afm_tip, 0.02, 0.05, 1.0, 0.41, 300.0)},
    {"kb-fig5", "Kirrou & Belhaq 2013 fig. 5, r 0.4, Omega 2", KIRROU(afm_tip, 0.02, 0.4, 2.0, 0.465, 300.0)},
    {"kb-fig6", "Kirrou & Belhaq 2013 fig. 6, r 0.5, Omega 2", KIRROU(afm_tip, 0.02, 0.5, 2.0, 0.475, 300.0)},
    {"kb-fig16", "Kirrou & Belhaq 2013 fig. 16, Omega 3, the Hertzian contact", FIG16(afm_tip)},
    {"kb-fig16-cubic", "Kirrou & Belhaq 2013 fig. 16, the full motion u of eq. 3", FIG16(afm_tip_cubic)},
    {"kb-fig16-slow", "Kirrou & Belhaq 2013 fig. 16, the slow motion z of eq. 5", FIG16(afm_tip_averaged)},
    {"kb-fig7", "Kirrou & Belhaq 2013 fig. 7 at its peak for r 0.2, Omega 1: escapes",
     KIRROU(afm_tip, 0.02, 0.2, 1.0, 0.38024, 300.0)},
    {"kb-fig7-slow", "Kirrou & Belhaq 2013 fig. 7 at its peak for r 0.2, Omega 1, as averaged",
     KIRROU(afm_tip_averaged, 0.02, 0.2, 1.0, 0.38024, 300.0)},
    {"kb-fig8", "Kirrou & Belhaq 2013 fig. 8, r 0.1, Omega 1", KIRROU(afm_tip, 0.02, 0.1, 1.0, 0.45, 300.0)},
    {"kb-fig13", "Kirrou & Belhaq 2013 fig. 13, r 0.4, Omega 0.6: escapes",
     KIRROU(afm_tip, 0.02, 0.4, 0.6, 0.545, 300.0)},
    {"kb-fig13-slow", "Kirrou & Belhaq 2013 fig. 13, r 0.4, Omega 0.6, as averaged",
     KIRROU(afm_tip_averaged, 0.02, 0.4, 0.6, 0.545, 300.0)},
    {"kb-fig14", "Kirrou & Belhaq 2013 fig. 14, beta 0.95, r 0.4, Omega 1: escapes",
     TIP_CASE(afm_tip, 0.95, 0.02, 0.4, 1.0, 0.008, 0.356, 300.0)},
    {"kb-fig14-slow", "Kirrou & Belhaq 2013 fig. 14, beta 0.95, r 0.4, Omega 1, as averaged",
     TIP_CASE(afm_tip_averaged, 0.95, 0.02, 0.4, 1.0, 0.008, 0.356, 300.0)},

    {"nayak-fig3",
     "Nayak 1972 figs 3, 5, free and undamped at the limit of contact: grazes",
     {NAYAK(0.0, 0.0, 1.0), .substeps = 64, .started = true, .start = {1.842016, 0.0}}},
    {"nayak-fig6",
     "Nayak 1972 figs 6, 11, waviness 0.9 at the upward jump",
     {NAYAK(0.05, 0.9, 0.67), .substeps = 64}},
    {"nayak-fig7", "Nayak 1972 fig. 7, waviness 0.5", {NAYAK(0.05, 0.5, 0.8), .substeps = 64}},
    {"nayak-fig10",
     "Nayak 1972 fig. 10, xi0/zeta 8.6 at the downward jump",
     {NAYAK(0.05, 0.43, 0.66), .substeps = 64}},
    {"nayak-fig12",
     "Nayak 1972 section 6, the case of fig. 12 above resonance: subharmonic",
     {NAYAK(0.05, 0.9, 1.2), .substeps = 64}},
    {"nayak-fig13",
     "Nayak 1972 fig. 13, zeta 0.1, waviness 0.3 beyond loss of contact",
     {NAYAK(0.1, 0.3, 0.9), .substeps = 64}},
    {"nayak-random",
     "Nayak 1972 section 5, broadband f with Phi/zeta 0.1",
     {NAYAK(0.05, 0.0, 1.0), .substeps = 50,
      .drive = {[ROLLING_FORCE] = {.noise = 0.841, .noise_hold = 0.1, .noise_seed = 7}}}},

    {"shaft-fig6",
     "shaft paper fig. 6, linear, half of support 3, force in the middle",
     {SHAFT_CASE(shaft_bearing_linear, 4.0, 4.0, 4015.0, GAP, GAP, HARD, HARD, 0.0, 25.0, 20.0), SLOW_FRAME}},
    {"shaft-fig7",
     "shaft paper fig. 7, linear, half of support 3, force on bearing 1",
     {SHAFT_CASE(shaft_bearing_linear, 4.0, 4.0, 4015.0, GAP, GAP, HARD, HARD, 25.0, 0.0, 20.0), SLOW_FRAME}},
    {"shaft-fig8", "shaft paper fig. 8, 25 N, 60 Hz", {SHAFT_DATA(4.0, 4.0, HARD, 60.0), SLOW_FRAME}},
    {"shaft-fig9", "shaft paper fig. 9, 25 Hz: chaotic", {SHAFT_DATA(4.0, 4.0, HARD, 25.0), SLOW_FRAME}},
    {"shaft-fig9-80",
     "shaft paper fig. 9, 80 Hz, started on the chaotic branch",
     {SHAFT_DATA(4.0, 4.0, HARD, 80.0), SLOW_FRAME, .started = true,
      .start = {0.0, 0.0, 0.0, 0.4, 0.4, 0.4}}},
    {"shaft-fig9-700",
     "shaft paper fig. 9, 700 Hz: chaotic",
     {SHAFT_DATA(4.0, 4.0, HARD, 700.0), FAST_FRAME}},
    {"shaft-fig10",
     "shaft paper fig. 10, gaps of 1 mm",
     {SHAFT_MAP(8030.0, 1e-3, 1e-3, HARD, HARD, 20.0), SLOW_FRAME}},
    {"shaft-fig11",
     "shaft paper fig. 11, gap springs of 1e5 N/m",
     {SHAFT_DATA(4.0, 4.0, 1e5, 30.0), SLOW_FRAME}},
    {"shaft-fig12", "shaft paper fig. 12, soft, at the peak", {SHAFT_DATA(4.0, 4.0, SOFT, 28.9), SLOW_FRAME}},
    {"shaft-fig13-12",
     "shaft paper fig. 13, soft, broken symmetry near 12 Hz",
     {SHAFT_DATA(4.0, 4.0, SOFT, 12.47), SLOW_FRAME}},
    {"shaft-fig13-18",
     "shaft paper fig. 13, soft, broken symmetry near 18 Hz",
     {SHAFT_DATA(4.0, 4.0, SOFT, 18.49), SLOW_FRAME}},
    {"shaft-fig14",
     "shaft paper figs 14, 15, middle stiffness, below the turning point",
     {SHAFT_DATA(4.0, 4.0, MIDDLE, 700.0), FAST_FRAME}},
    {"shaft-fig16-687",
     "shaft paper fig. 16a, middle stiffness, 687 Hz",
     {SHAFT_DATA(4.0, 4.0, MIDDLE, 687.0), FAST_FRAME}},
    {"shaft-fig16-705",
     "shaft paper fig. 16b, middle stiffness, 705 Hz",
     {SHAFT_DATA(4.0, 4.0, MIDDLE, 705.0), FAST_FRAME}},
    {"shaft-fig17",
     "shaft paper fig. 17, damper 184, below the jump",
     {SHAFT_DATA(184.0, 184.0, HARD, 25.0), SLOW_FRAME}},
    {"shaft-fig18-15",
     "shaft paper fig. 18, damper 139 to ground, 15 Hz",
     {SHAFT_DATA(139.0, 139.0, HARD, 15.0), SLOW_FRAME}},
    {"shaft-fig18-25",
     "shaft paper fig. 18, damper 139 to ground, 25 Hz",
     {SHAFT_DATA(139.0, 139.0, HARD, 25.0), SLOW_FRAME}},
    {"shaft-fig18-15p",
     "shaft paper fig. 18, proportional damping 139, 15 Hz",
     {SHAFT_DATA(139.0, 278.0, HARD, 15.0), SLOW_FRAME}},
    {"shaft-fig18-25p",
     "shaft paper fig. 18, proportional damping 139, 25 Hz",
     {SHAFT_DATA(139.0, 278.0, HARD, 25.0), SLOW_FRAME}},
    {"shaft-fig19", "shaft paper fig. 19, 5 Hz: chatter", {SHAFT_DATA(139.0, 139.0, HARD, 5.0), SLOW_FRAME}},
    {"shaft-fig20",
     "shaft paper fig. 20, soft, half of support 3",
     {SHAFT_MAP(4015.0, GAP, GAP, SOFT, SOFT, 28.0), SLOW_FRAME}},
    {"shaft-fig22",
     "shaft paper fig. 22, gap 3 of 1 mm",
     {SHAFT_MAP(8030.0, GAP, 1e-3, HARD, HARD, 21.0), SLOW_FRAME}},
    {"shaft-fig23",
     "shaft paper fig. 23, gap spring 3 of 1e6 N/m",
     {SHAFT_MAP(8030.0, GAP, GAP, HARD, 1e6, 100.0), SLOW_FRAME}},
};
