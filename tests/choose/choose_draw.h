/* choose_draw.h - random scenes for tests/choose/choose_scenes.c.
 *
 * Parameters cover the ranges of the four plants. A scene lasts 30 to 500 time units and has slow drives
 * of 0.2 to 1.8 times the eigenfrequency. Some have a fast drive or a kick. Any of the first four outputs
 * is asked for.
 *
 * DRAW_BY_FORCE draws forces over three decades and tolerances of 3e-4 to 0.05. It draws the rig twice as
 * often as rolling contact, tip and shaft. Resonances have a quality of 5 to 100; the size of the motion
 * follows from all this.
 *
 * DRAW_BY_MOTION draws the size of the motion, because it decides which model is good enough. The size is
 * the compression by linear theory, relative to the static one or to the shaft's gap. It is log-uniform
 * from 1e-3 to 3; at 1 contact is lost, or a gap closes. A kick is as large. Rig, tip and shaft come
 * equally often. Tolerances are log-uniform from 1e-4, a scene's default, to 0.1, the most that may be
 * asked. */
#ifndef TESTS_CHOOSE_DRAW_H
#define TESTS_CHOOSE_DRAW_H

#include <stdint.h>
#include "models/scenes/scenes.h"

enum choose_draw { DRAW_BY_FORCE, DRAW_BY_MOTION };

void choose_draw_seed(uint64_t seed);

/* The next scene; one that scene_check takes. */
void choose_draw(enum choose_draw draw, struct scene *s);

#endif
