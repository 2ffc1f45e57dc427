/* fmu_variables.h - the variables of an FMU: what modelDescription.xml lists and what an importer sets and
 * gets by reference. All of them follow from the tables of the scene's model. */
#ifndef HOST_SIM_FMU_VARIABLES_H
#define HOST_SIM_FMU_VARIABLES_H

#include "host_sim/library/library.h"

enum fmu_kind {
    FMU_TIME,
    FMU_INPUT, /* a sampled command, as contactplant_set_sample takes it */
    FMU_OUTPUT,
    FMU_SWITCHES, /* contact switches so far, a whole number */
    FMU_RESIDUAL, /* error of the energy balance */
    FMU_PARAMETER,
    FMU_DRIVE,   /* amplitude, frequency, phase and ramp of each input's harmonic drive */
    FMU_CONTACT, /* the clock that ticks at a touchdown */
    FMU_KINDS
};

/* The types that variables have here. */
enum fmu_type { FMU_FLOAT64, FMU_UINT64, FMU_CLOCK };
extern const char *const fmu_type_name[];

/* Fields of a drive, in the order of their references. */
enum { FMU_AMPLITUDE, FMU_FREQUENCY, FMU_PHASE, FMU_RAMP, FMU_DRIVE_FIELDS };

enum { FMU_NAME = 64, FMU_MEANING = 256, FMU_TOKEN = 40, FMU_REFERENCES = 256 };

/* The text of the scene, in the FMU's resources. */
#define FMU_SCENE_FILE "scene.ini"

struct fmu_variable {
    enum fmu_kind kind;
    enum fmu_type type;
    int index;           /* that input, output or parameter */
    int field;           /* a drive's */
    uint32_t reference;  /* FMU_REFERENCES for each kind */
    char name[FMU_NAME]; /* a drive's: drive.force.amplitude */
    char meaning[FMU_MEANING];
    const char *unit;
    double min, max; /* infinite where there is none */
};

/* The variable of this reference; false when there is none. */
bool fmu_variable_find(struct contactplant *p, uint32_t reference, struct fmu_variable *v);

/* Number i in the order of modelDescription.xml; false when there are no more. */
bool fmu_variable(struct contactplant *p, int i, struct fmu_variable *v);

/* Field of the drive of an input as its scene begins. */
double fmu_drive_begin(const struct contactplant *p, int input, int field);

/* By this modelDescription.xml and the FMU of one scene know each other: a check of the scene's text and
 * this version. */
void fmu_token(const char *scene, char token[FMU_TOKEN]);

#endif
