/* costs.c - writes host_sim/choose/choose_counts.h, the costs by which contactplant choose ranks:
 * instructions from tests/data/instructions.txt (gcc) and tests/data/board_instructions.txt, and how many
 * long series `taylor` begins in a tick, which it runs to see. `make costs` runs it from the project's top
 * folder, and `make check` compares. */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/choose/choose_cost.h"
#include "tests/bench/cost/work_models.h"

enum { LINE = 256 };

/* The first number behind the words `board name` or `name`; the program ends without it. */
static double count_of(const char *board, const char *name)
{
    const char *path = *board ? "tests/data/board_instructions.txt" : "tests/data/instructions.txt";
    char line[LINE], key[LINE];
    double value = -1.0;
    snprintf(key, sizeof key, "%s%s%s ", board, *board ? " " : "", name);
    FILE *f = fopen(path, "r");
    while (f && fgets(line, sizeof line, f))
        if (!strncmp(line, key, strlen(key)))
            sscanf(line + strlen(key), "%lf", &value);
    if (f)
        fclose(f);
    if (value < 0.0) {
        fprintf(stderr, "costs: %s has no count of %s; run from the project's top folder\n", path, key);
        exit(1);
    }
    return value;
}

/* Long series begun in a tick. */
static double series_of(int i)
{
    const char *fault = work_models_setup(i);
    double begin = work_models_series();
    for (int k = 0; k < WORK_CALLS; k += work_models_ticks(i))
        work_model[i].once();
    if (fault || !work_models_good()) {
        fprintf(stderr, "costs: %s is not what it should be\n", work_model[i].name);
        exit(1);
    }
    return (work_models_series() - begin) / WORK_CALLS;
}

static enum choose_count column_of(const struct work_kind *k)
{
    if (k->period == COARSE)
        return COUNT_COARSE;
    if (k->period == SHORT || k->period == SHORT_TIP)
        return COUNT_SHORT;
    for (int i = 0; i < CHOOSE_METHODS; i++)
        if (choose_method[i] == k->method)
            return (enum choose_count)i;
    return COUNTS;
}

static bool moves(const struct work_kind *k)
{
    return k->model->input_signal[k->input].quantity != QUANTITY_FORCE;
}

/* A model with forces only, or with an input that moves the contact. */
static void put_row(const struct model *m, bool moved)
{
    double count[COUNTS] = {0.0}, series[2] = {0.0};
    bool any = false;
    for (int i = 0; i < WORK_MODELS; i++) {
        const struct work_kind *k = &work_kind[i];
        if (k->model != m || moves(k) != moved || k->period > FINE)
            continue;
        enum choose_count column = column_of(k);
        any = true;
        count[column] = count_of("", work_model[i].name);
        if (column == COUNT_TAYLOR || column == COUNT_COARSE)
            series[column == COUNT_COARSE] = series_of(i);
    }
    if (!any)
        return;
    printf("    {&%s, %d, {", m->name, moved);
    for (int i = 0; i < COUNTS; i++)
        printf("%s%.0f", i ? ", " : "", count[i]);
    printf("}, {%.4f, %.4f}},\n", series[0], series[1]);
}

int main(void)
{
    printf("/* choose_counts.h - instructions as counted, and long series a tick. Made by `make costs`: do "
           "not edit. */\n"
           "/* One line a model, see struct choose_counts. */\n/* clang-format off */\n"
           "static const struct choose_counts counts[] = {\n");
    for (int i = 0; i < WORK_MODELS; i++) {
        int first = 0;
        while (work_kind[first].model != work_kind[i].model)
            first++;
        for (int moved = 0; moved < 2 && first == i; moved++)
            put_row(work_kind[i].model, moved);
    }
    printf("};\n\n/* The rig's tick, enum choose_extra. */\nstatic const double extra[EXTRAS] = {");
    for (int i = 0; i < EXTRAS; i++)
        printf("%s%.0f", i ? ", " : "", count_of("", choose_extra_name[i]));
    printf("};\n\n/* Each machine's, enum choose_piece. */\n"
           "static const double pieces[CHOOSE_MACHINES][CHOOSE_PIECES] = {\n");
    for (int i = 0; i < CHOOSE_MACHINES; i++) {
        printf("    {");
        for (int k = 0; k < CHOOSE_PIECES; k++)
            printf("%s%.0f", k ? ", " : "", count_of(i ? choose_machine[i].name : "", choose_piece_name[k]));
        printf("}, /* %s */\n", choose_machine[i].name);
    }
    printf("};\n/* clang-format on */\n");
    return 0;
}
