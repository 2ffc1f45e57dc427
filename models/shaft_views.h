/* shaft_views.h - members of struct model that the models of the shaft share; for models/ only. */
#ifndef MODELS_SHAFT_VIEWS_H
#define MODELS_SHAFT_VIEWS_H

#include "models/shaft_bearing.h"

/* The paper's parameters: the SI ones, then the drive. */
enum {
    SHAFT_PAPER_P1 = SHAFT_PARAMETERS,
    SHAFT_PAPER_HZ = SHAFT_PAPER_P1 + 3,
    SHAFT_PAPER_PHI,
    SHAFT_PAPER,
    SHAFT_PAPER_MODE = SHAFT_PAPER,
    SHAFT_MODE_PAPER
};

/* Rows of the parameter tables with the paper's defaults: its Table 1. */
#define SHAFT_ROWS(m1, m2, m3, c1, c2, c3, ks1, ks3, kappa, L, g1, g3, kg1, kg3)                             \
    {m1, "kg", 1e-9, 1e6, 0.629, "mass at bearing 1"}, {m2, "kg", 1e-9, 1e6, 1.258, "middle mass"},          \
        {m3, "kg", 1e-9, 1e6, 0.629, "mass at bearing 3"},                                                   \
        {c1, "N s/m", 0.0, 1e6, 4.0, "viscous damping of mass 1"},                                           \
        {c2, "N s/m", 0.0, 1e6, 4.0, "viscous damping of mass 2; twice c1 in the second damping model"},     \
        {c3, "N s/m", 0.0, 1e6, 4.0, "viscous damping of mass 3"},                                           \
        {ks1, "N/m", 0.0, 1e12, 8030.0, "half the support stiffness at bearing 1"},                          \
        {ks3, "N/m", 0.0, 1e12, 8030.0, "half the support stiffness at bearing 3"},                          \
        {kappa, "N m/rad", 1e-9, 1e12, 79161.0, "flexural stiffness of the shaft"},                          \
        {L, "m", 1e-6, 1e3, 0.1614, "length of half the shaft"},                                             \
        {g1, "m", 1e-12, 1.0, 2.54e-4, "radial gap of bearing 1"},                                           \
        {g3, "m", 1e-12, 1.0, 2.54e-4, "radial gap of bearing 3"},                                           \
        {kg1, "N/m", 0.0, 1e15, 3.502e7, "gap spring of bearing 1"},                                         \
    {                                                                                                        \
        kg3, "N/m", 0.0, 1e15, 3.502e7, "gap spring of bearing 3"                                            \
    }
#define SHAFT_SI_ROWS                                                                                        \
    SHAFT_ROWS("mass1_kg", "mass2_kg", "mass3_kg", "damping1_N_s_per_m", "damping2_N_s_per_m",               \
               "damping3_N_s_per_m", "support1_N_per_m", "support3_N_per_m", "flexure_N_m_per_rad",          \
               "length_m", "gap1_m", "gap3_m", "gap_stiffness1_N_per_m", "gap_stiffness3_N_per_m")
#define SHAFT_PAPER_ROWS                                                                                     \
    SHAFT_ROWS("m1", "m2", "m3", "c1", "c2", "c3", "ks1", "ks3", "kappa", "L", "g1", "g3", "kg1", "kg3"),    \
        {"p1", "N", -1e12, 1e12, 0.0, "force amplitude on mass 1"},                                          \
        {"p2", "N", -1e12, 1e12, 25.0, "force amplitude on mass 2"},                                         \
        {"p3", "N", -1e12, 1e12, 0.0, "force amplitude on mass 3"},                                          \
        {"freq_hz", "Hz", 0.0, 1e9, 25.0, "frequency of the forces"},                                        \
    {                                                                                                        \
        "phi", "rad", -1e3, 1e3, 0.0, "phase of the forces"                                                  \
    }

extern const struct signal shaft_inputs[SHAFT_INPUTS], shaft_outputs[SHAFT_OUTPUTS];
extern const int shaft_sides[SHAFT_CONTACTS];

void shaft_prepare(const double *si, double *p, struct scale *scale);
const char *shaft_check(const double *si);
void shaft_from_paper(const double *paper, double *si, struct harmonic *drive);
double shaft_eigenfrequency(const double *p);
double shaft_energy(const double *p, const struct input *u, const double *x);
void shaft_output(const double *p, const struct input *u, const double *x, double *output);
bool shaft_linear(const double *p, unsigned regime, struct linear *l);

/* Members of struct model that all models of the shaft share. */
#define SHAFT_SAME                                                                                           \
    .n_inputs = SHAFT_INPUTS, .n_outputs = SHAFT_OUTPUTS, .input_signal = shaft_inputs,                      \
    .output_signal = shaft_outputs, .eigenfrequency = shaft_eigenfrequency

/* shape[k][i]: motion of mass i in mode k of the open shaft, eigenfrequencies ascending, any norm. */
void shaft_open_modes(const double *p, double shape[3][3]);

#endif
