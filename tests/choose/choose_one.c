/* choose_one.c - one run of a preset as contactplant choose makes it, for tests/choose/test_choose_cost.sh to
 * count: choose_one PRESET MODEL METHOD SUBSTEPS TOLERANCE. Prints the steps that it took inside
 * choose_one_steps. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/app/plant_scene.h"
#include "firmware/plant/plant_change.h"
#include "host_sim/choose/choose.h"
#include "host_sim/choose/choose_ladder.h"
#include "host_sim/choose/choose_run.h"

static struct plant plant;
static double scratch[METHOD_SCRATCH];

__attribute__((noinline)) static bool choose_one_steps(uint64_t n)
{
    return plant_run(&plant, n);
}

/* The preset's candidate with this model. */
static bool find(const char *preset, const char *model, struct scene *s)
{
    struct choose_candidate candidate[CHOOSE_CANDIDATES];
    int n = choose_ladder(&scenes_find(preset)->scene, candidate);
    for (int i = 0; i < n; i++) {
        *s = candidate[i].scene;
        if (!strcmp(s->model->name, model))
            return true;
    }
    return false;
}

int main(int argc, char **argv)
{
    struct scene s;
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    if (argc != 6 || !scenes_find(argv[1]) || !find(argv[1], argv[2], &s))
        return 2;
    s.substeps = (uint32_t)atof(argv[4]);
    scenes_resolve(&s, si, drive);
    const struct plant_config c = {.model = s.model,
                                   .si = si,
                                   .method = method_find(argv[3]),
                                   .tick_s = s.frame_s / s.substeps,
                                   .dilation = s.dilation,
                                   .tol = atof(argv[5]),
                                   .scratch = scratch};
    const char *why = plant_init(&plant, &c);
    if (why)
        return 1;
    plant_scene_begin(&plant, &s, si, drive);
    double steps = choose_frames(&s) * s.substeps;
    printf("%.0f\n", steps);
    return !choose_one_steps((uint64_t)steps);
}
