/* stability.h - maps of where a plant, or a method with its step, is stable: over two numbers of a scene.
 *
 * floquet: the larger Floquet |multiplier| of the contact at rest under a modulated stiffness, of the plant and of the method
 * with the scene's step (stability_floquet.h). contact: the scene's motion from its start by the method with its step,
 * without the step guard, beside the same by the method that auto takes, to 1e-11 and with a fifth of a radian a step at most:
 * energy made or lost, and contact switches missed or made up.
 *
 * A row of cells, one value of y, is a job of jobs.h and each cell of a contact map a piece of it. */
#ifndef HOST_SIM_STABILITY_H
#define HOST_SIM_STABILITY_H

#include "host_sim/maps/maps.h"

/* |multiplier| and energy over the plant's up to which a cell is stable and keeps its energy. */
#define STABILITY_UNIT   (1.0 + 1e-9)
#define STABILITY_ENERGY 0.05

enum stability_map { STABILITY_FLOQUET, STABILITY_CONTACT };

struct stability {
    struct maps m; /* its step is that of --step: frames of one step, undilated */
    enum stability_map map;
    struct scene_range x, y;
    int periods; /* of the contact, for the contact map */
};

/* The columns of a row, behind y and x. */
enum { FLOQUET_RATIO = 2, FLOQUET_STEPS, FLOQUET_PLANT, FLOQUET_METHOD, FLOQUET_COLUMNS };
enum {
    CONTACT_STEP = 2, /* times the contact's eigenfrequency */
    CONTACT_SWITCHES,
    CONTACT_OF_METHOD,
    CONTACT_ENERGY, /* highest stored energy in the second half, over the plant's; infinite: the motion escaped */
    CONTACT_COLUMNS
};

/* The command line into *s. 0, or the exit status after a line. */
int stability_read(struct stability *s);

/* One cell, cell[FLOQUET_COLUMNS or CONTACT_COLUMNS], the first two are given. NULL, or why there is none. */
const char *stability_floquet_cell(const struct stability *s, const struct scene *scene, double *cell);
const char *stability_contact_cell(const struct stability *s, const struct scene *scene, double *cell);

/* The picture of the rows in --out. 0, or the exit status after a line. */
int stability_chart(const struct stability *s);

#endif
