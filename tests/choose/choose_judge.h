/* choose_judge.h - a judge of certificates that shares nothing with choose's measurements, for
 * tests/choose/choose_scenes.c.
 *
 * It runs the full model by rk4 with steps of 0.005 rad of its fastest motion. Where that does not
 * converge to a tenth of the tolerance, it takes the method of choose's truth at other steps and
 * tolerance. It compares within the frames, where choose does not look, and not at their ends.
 * Chaotic scenes are judged by the statistics of another start. */
#ifndef TESTS_CHOOSE_JUDGE_H
#define TESTS_CHOOSE_JUDGE_H

#include "host_sim/choose/choose.h"

/* The observable once in each frame; free(value). */
struct choose_values {
    int n;
    double *value, loss;
    bool good;
};

/* Where in a frame, 0 to 1, its value is taken. */
double choose_judge_part(const struct scene *s, int frame);

/* A scene as it stands, by its own method and step. */
struct choose_values choose_judge_run(const struct scene *s);

/* The truth about a scene. */
struct choose_values choose_judge(const struct scene *s, bool statistics);

/* The error of a scene of this certificate's ladder. */
double choose_judge_error(const struct choose_certificate *c, const struct scene *s,
                          const struct choose_values *truth);

/* Does the watch of a certificate stay quiet in the certified
 * motion, run from the scene as choose --out writes it? */
bool choose_judge_quiet(const struct choose_certificate *c);

#endif
