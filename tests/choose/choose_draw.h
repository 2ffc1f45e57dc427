/* choose_draw.h - random scenes for tests/choose/choose_scenes.c: parameters over the ranges of the four plants, 30 to 500 time units,
 * slow drives of 0.2 to 1.8 times the eigenfrequency, some scenes with a fast drive or a kick; any of the first four outputs asked.
 *
 * DRAW_BY_FORCE: forces over three decades, tolerances 3e-4 to 0.05, two rigs to one rolling contact, tip and shaft. Beside
 * resonances of quality 5 to 100 the size of the motion is what comes of it.
 * DRAW_BY_MOTION: that size decides which model will do, so it is drawn: the compression that linear theory predicts over the static
 * one, or over the shaft's gap, log-uniform from 1e-3 to 3 (contact is lost, or a gap closes, at 1), and a kick as large; rig, tip
 * and shaft equally often; tolerances log-uniform from 1e-4, a scene's default, to 0.1, the most that may be asked. */
#ifndef TESTS_CHOOSE_DRAW_H
#define TESTS_CHOOSE_DRAW_H

#include <stdint.h>
#include "models/scenes/scenes.h"

enum choose_draw { DRAW_BY_FORCE, DRAW_BY_MOTION };

void choose_draw_seed(uint64_t seed);

/* The next scene; one that scene_check takes. */
void choose_draw(enum choose_draw draw, struct scene *s);

#endif
