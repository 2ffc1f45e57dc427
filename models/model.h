/* model.h - the interface of every model: a plant as constant data and pure functions.
 *
 * A model works in its own normalised units; struct scale has their SI values. Its functions have no state,
 * allocate nothing and cannot fail: the caller has checked the SI parameters against the table of ranges and
 * with `check`. The arrays p, u, x belong to the caller and have the lengths MODEL_DERIVED, n_inputs,
 * n_states. `rhs` and `gap` cost 10 to 60 floating point operations, `prepare` and `check` up to some
 * thousands.
 *
 *     double si[MODEL_PARAMETERS], p[MODEL_DERIVED], x[MODEL_STATES], x_dot[MODEL_STATES];
 *     struct input u[MODEL_INPUTS] = {{0.0, 0.0}};
 *     struct scale scale;
 *     for (int i = 0; i < hertz_rig.n_parameters; i++)
 *         si[i] = hertz_rig.parameter[i].initial;
 *     if (!hertz_rig.check(si)) {
 *         hertz_rig.prepare(si, p, &scale);
 *         hertz_rig.rest(p, x);
 *         u[RIG_FORCE].value = 5.0 / scale.force_N; // 5 N
 *         hertz_rig.rhs(p, u, x, x_dot);            // x_dot[1] * scale.length_m / scale.time_s^2 is in m/s^2
 *     }
 *
 * docs/reference/models.md has the equations with their sources. */
#ifndef MODELS_MODEL_H
#define MODELS_MODEL_H

#include <stdbool.h>
#include <stdint.h>

enum {
    MODEL_STATES = 10,       /* the AFM lever: four modes and the branch of its adhesion, with rates */
    MODEL_LINEAR_STATES = 6, /* enough for each model with a linear view: the 3-DOF shaft */
    MODEL_MODES = 4,         /* beam modes of a lever */
    MODEL_INPUTS = 4,        /* slow force, fast force, base, stiffness */
    MODEL_CONTACTS = 4,      /* two bearings with two sides each; two bits on the wire */
    MODEL_PARAMETERS = 64,   /* SI parameters of one model: the wire indices below SETTING_FIRST */
    MODEL_DERIVED = 35,      /* numbers prepared once from the SI parameters */
    MODEL_OUTPUTS = 12,      /* six pairs on the wire */
    /* Numbers of the observables beside outputs and states (model_observable). */
    MODEL_DRIVE_FREQUENCY = 12,
    MODEL_TIME = 13,
    MODEL_CHANGES = 14,
    MODEL_EIGENFREQUENCY = 15
};

/* The kind of a number, which tells how model units become SI (scale_of). A frequency is angular in model
 * units and in Hz in SI. */
enum quantity {
    QUANTITY_RATIO,
    QUANTITY_LENGTH,
    QUANTITY_VELOCITY,
    QUANTITY_FORCE,
    QUANTITY_FREQUENCY,
    QUANTITY_TIME
};

/* One model unit of each kind, in SI. With a time dilation D, time_s is D times that of the real plant: the
 * bus sees a slow rig with real lengths, forces and energies. */
struct scale {
    double length_m;
    double time_s;
    double force_N;
    double energy_J;
};

/* A number that the plant takes or gives. */
struct signal {
    const char *name; /* on the wire and in CSV headers */
    const char *unit; /* SI */
    const char *meaning;
    enum quantity quantity; /* model units to SI */
    const char *paper_name; /* a state's symbol in the source paper */
};

/* A number that a user may set: the source of checks, help and documents. */
struct parameter {
    const char *name;
    const char *unit;
    double min, max, initial; /* inclusive range and default */
    const char *meaning;
};

/* An input, or a gap, at one instant. */
struct input {
    double value; /* model units */
    double rate;  /* its time derivative, per model time */
};

/* Rates and powers at one instant, for the energy ledger; model units. */
struct flow {
    double x_dot[MODEL_STATES];
    double work[MODEL_INPUTS]; /* power that each input delivers to the plant */
    double damping;            /* power lost in the dampers, >= 0 */
    double force;              /* contact force, the largest of all contacts */
};

/* The harmonic excitation that a paper's parameters describe; SI, omega in rad/s. */
struct harmonic {
    double amplitude, omega, phase; /* amplitude * cos(omega t + phase) */
};

/* The view for `exact`: x_dot = a x + b u + b_rate u_dot + c while no contact switches. */
struct linear {
    double a[MODEL_LINEAR_STATES][MODEL_LINEAR_STATES];
    double b[MODEL_LINEAR_STATES][MODEL_INPUTS], b_rate[MODEL_LINEAR_STATES][MODEL_INPUTS];
    double c[MODEL_LINEAR_STATES];
};

/* The view for `taylor` and `rk4_float32` of a model with one Hertzian contact. In the coordinate
 *   eta = side x[0] + origin + sum shift_i u_i
 * the motion is
 *   eta'' = constant + sum (force_i u_i + shift_i u_i'' + drag_i u_i') - damping eta' - stiffness eta
 *           - hertz (1 + sum modulation_i u_i) eta_+^{3/2},
 * with x[1] = x[0]'; the contact is closed where eta > 0. */
struct hertz_form {
    double side, origin; /* side: 1 or -1 */
    double constant, damping, stiffness, hertz;
    double shift[MODEL_INPUTS], force[MODEL_INPUTS], drag[MODEL_INPUTS], modulation[MODEL_INPUTS];
};

/* The view for the same methods of a model with one degree of freedom, a cubic restoring force and no
 * contact:
 *   x'' = sum_k (constant_k + sum_i modulation_ki u_i + rate_ki u_i') x^k - damping x',  k = 0..3,
 * with x[1] = x[0]'. */
struct polynomial_form {
    double damping;
    double constant[4], modulation[4][MODEL_INPUTS], rate[4][MODEL_INPUTS];
};

/* The force between a tip and a sample (models/tip_law.h). */
struct tip_law {
    double attraction; /* H R/6, on the way in */
    double out;        /* the way out has this share more; 0: one branch */
    double a0;         /* gap at which contact begins */
    double hertz, viscous;
    double rest; /* flexibility of the spring before the tip */
};

/* The view for `modal` of a lever: modes q_n of equal mass 1 under one force F at the tip,
 *   q_n'' + damping_n q_n' + omega_n^2 q_n = F + sum of the forces u_i - participation_n z'' + heat,
 * z being the input `base`. The state is y_n = q_n + participation_n z for n = 0..MODEL_MODES - 1, the branch
 * of the adhesion, and the rates of all these. The gap is height + z + sum q_n. */
struct modal_form {
    int n_modes;
    double omega[MODEL_MODES], damping[MODEL_MODES], participation[MODEL_MODES];
    unsigned forces;     /* bit i: input i is a force on the tip */
    int base, stiffness; /* inputs: the base, and the modulation of the contact */
    double height;
    double near;     /* below this gap the force is steep; 0: permanent contact */
    double stiffest; /* the largest slope of F over the gap that the method must bear */
    double heat;     /* standard deviation of each q_n' in thermal equilibrium; 0: no heat */
    uint64_t seed;   /* numbers the sequence of the heat */
    bool latched;    /* the adhesion has two branches */
    struct tip_law law;
};

struct model {
    const char *name;
    const char *title; /* one line: what it is and where its equation stands */
    int n_states, n_inputs, n_outputs, n_contacts, n_parameters, n_paper;
    const struct signal *state_signal, *input_signal;
    /* The first four are displacement, velocity, penetration and contact force: the bus sends them in every
     * frame. */
    const struct signal *output_signal;
    const int *contact_side; /* [n_contacts], 1 or -1: the side of its body that contact i touches */
    const struct parameter *parameter; /* [n_parameters], SI */
    const struct parameter *paper;     /* [n_paper], the paper's own set */

    /* NULL, or why these SI parameters, each inside its range, make no sense together. */
    const char *(*check)(const double *si);
    /* Makes of SI parameters the numbers p that the functions below take, and the scale (dilation 1). */
    void (*prepare)(const double *si, double *p, struct scale *scale);
    /* Makes of the paper's parameters the SI parameters and the harmonic drives in SI. A dimensionless set
     * gets a scale of 1, so that SI and model units are the same numbers. */
    void (*from_paper)(const double *paper, double *si, struct harmonic *drive);
    /* The state in the paper's symbols and normalisation (state_signal[].paper_name), and back. */
    void (*paper_state)(const double *p, const struct input *u, const double *x, double *paper);
    void (*state_from_paper)(const double *p, const struct input *u, const double *paper, double *x);
    /* The static equilibrium without drives. */
    void (*rest)(const double *p, double *x);
    /* Angular eigenfrequency of the closed contact at rest, per model time; the fastest of several. The step
     * guard and reports use it. */
    double (*eigenfrequency)(const double *p);

    /* x_dot = f(x, u), valid in every regime: a contact force is zero where its gap is open. The second half
     * of the states are the rates of the first. */
    void (*rhs)(const double *p, const struct input *u, const double *x, double *x_dot);
    /* One gap per contact, with its rate: negative while closed, positive while open. */
    void (*gap)(const double *p, const struct input *u, const double *x, struct input *gap);
    /* Powers for the ledger: d(energy)/dt = sum(work) - damping at constant parameters. */
    void (*flow)(const double *p, const struct input *u, const double *x, struct flow *flow);
    /* Stored energy: kinetic, contact at its unmodulated stiffness, preload. */
    double (*energy)(const double *p, const struct input *u, const double *x);
    /* Outputs in the order of the output table; a flag is 0 or 1. */
    void (*output)(const double *p, const struct input *u, const double *x, double *output);

    /* Views for methods that know more than rhs; NULL where the model has none. */
    /* The linear system of this regime (bit i: contact i is closed). False for contacts that cannot be closed
     * together. */
    bool (*linear)(const double *p, unsigned regime, struct linear *l);
    void (*hertz_form)(const double *p, struct hertz_form *f);
    void (*polynomial_form)(const double *p, struct polynomial_form *f);
    void (*modal_form)(const double *p, struct modal_form *f);
    /* Beside modal_form: the branch of the adhesion that follows at this gap and rate. *loss: the stored
     * energy that a change of branch turns into heat, else 0. */
    double (*tip_branch)(const double *p, double branch, double gap, double rate, double *loss);

    /* The full model that this reduced model approximates; NULL for a full model. A reduced model has the
     * full one's scale, inputs, first outputs and SI parameters; its own parameters stand behind those. */
    const struct model *full;
    /* The full model's state where this reduced model's is x; NULL where x does not determine it. */
    void (*climb)(const double *p, const double *x, double *full_x);
};

/* Two names are the same. */
bool model_same_name(const char *a, const char *b);

/* Observable i, which a monitor may watch; NULL when there is none of this number.
 *   0 .. n_outputs - 1      the outputs
 *   from n_outputs on       the states whose name no output has, in their order
 *   MODEL_DRIVE_FREQUENCY   the highest of the harmonic drives that sound, 0 in silence
 *   MODEL_TIME              time of the plant since tick 0
 *   MODEL_CHANGES           commands since then that changed drives, parameters or state
 *   MODEL_EIGENFREQUENCY    changed by parameters only */
const struct signal *model_observable(const struct model *m, int i);

/* The number of the state that observable i is, or -1 where it is no state. */
int model_observable_state(const struct model *m, int i);

/* NULL, or why a plant of the reduced model `from` cannot continue as one of model `to`. */
const char *model_climb_refused(const struct model *from, const struct model *to);

/* `gap` of a model without contacts: writes nothing. */
static inline void model_no_gap(const double *p, const struct input *u, const double *x, struct input *gap)
{
    (void)p, (void)u, (void)x, (void)gap;
}

/* SI value of one model unit of this quantity: 1 for a ratio, Hz for an angular frequency of 1. */
double scale_of(const struct scale *s, enum quantity q);

#endif
