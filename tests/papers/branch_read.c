/* branch_read.c - see branch_read.h. */
#include "tests/papers/branch_read.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "models/models.h"
#include "tests/fixture/paper.h"

static const struct model *model_called(const char *name)
{
    for (int i = 0; i < MODELS; i++) {
        if (strcmp(model_table[i]->name, name) == 0)
            return model_table[i];
    }
    return NULL;
}

const char *branch_read(char *line, struct branch *b)
{
    char model[32], swept[32], *parameters = strchr(line, ':'), *critical;
    memset(b, 0, sizeof *b);
    if (!parameters || !(critical = strchr(parameters + 1, ':')) ||
        sscanf(line, "%31s %31s %lf %lf %lf %lf", model, swept, &b->from, &b->to, &b->step, &b->unit) != 6 ||
        !(b->model = model_called(model)))
        return NULL;
    *critical++ = '\0';
    paper_defaults(b->model, b->paper);
    for (char *word = strtok(parameters + 1, " "); word; word = strtok(NULL, " ")) {
        char *value = strchr(word, '=');
        if (!value)
            return NULL;
        *value++ = '\0';
        int i = paper_index(b->model, word);
        if (i < 0)
            return NULL;
        b->paper[i] = strtod(value, NULL);
    }
    b->swept = paper_index(b->model, swept);
    b->turn = strcmp(swept, "freq_hz") == 0 ? 1.0 : MOTION_TWO_PI;
    b->ticks = strcmp(swept, "freq_hz") != 0 ? 64 : b->from > 100.0 ? 16 : 192;
    return critical;
}
