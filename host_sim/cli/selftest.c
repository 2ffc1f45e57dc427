/* selftest.c - the self-test of this program: every check with its numbers. */
#include "firmware/app/selftest.h"

#include <stdio.h>
#include <stdlib.h>
#include "host_sim/commands.h"
#include "host_sim/cli/options.h"
#include "host_sim/cli/selftest.h"
#include "models/models.h"

static const struct usage selftest_usage = {
    .name = "selftest",
    .words = "",
    .summary =
        "Measures numbers whose exact value is known, with every method, as a board does at power-on. Exits\n"
        "with 1 when one is outside its tolerance.",
    .examples = "  contactplant selftest\n",
};

struct memory {
    struct plant plant;
    double scratch[METHOD_SCRATCH];
};

static struct selftest_parts parts_in(struct memory *m)
{
    return (struct selftest_parts){.model = model_table,
                                   .n_models = MODELS,
                                   .method = method_table,
                                   .n_methods = METHODS,
                                   .plant = &m->plant,
                                   .scratch = m->scratch,
                                   .n_scratch = METHOD_SCRATCH};
}

bool selftest_of_host(struct selftest_result *r)
{
    struct memory *m = malloc(sizeof *m);
    if (!m)
        return false;
    struct selftest_parts parts = parts_in(m);
    selftest_run(&parts, r);
    free(m);
    return true;
}

/* 1 when it failed. */
static int print_check(const struct selftest_check *c, const struct selftest_parts *parts)
{
    double value;
    if (!selftest_measure(c, parts, &value))
        return 1; /* everything is in this program */
    double error = selftest_error(c, value);
    bool good = error <= c->tolerance;
    printf("%-4s  %-24s %-16s %22.15g %22.15g %9.1e %9.1e  %s\n", good ? "ok" : "FAIL", c->name,
           c->model ? c->model : "-", value, c->expected, error, c->tolerance, c->meaning);
    return !good;
}

int cmd_selftest(int argc, char **argv)
{
    struct options o;
    int status, failed = 0;
    if (!options_parse(&o, &selftest_usage, argc, argv, &status))
        return status;
    struct memory *m = malloc(sizeof *m);
    if (!m)
        return options_failure(&selftest_usage, "out of memory");
    struct selftest_parts parts = parts_in(m);
    printf("      %-24s %-16s %22s %22s %9s %9s\n", "check", "model", "measured", "exact", "error",
           "tolerance");
    for (int i = 0; i < SELFTEST_CHECKS; i++)
        failed += print_check(&selftest_table[i], &parts);
    free(m);
    printf("%d checks, %d failed\n", SELFTEST_CHECKS, failed);
    return failed ? STATUS_FAILED : STATUS_DONE;
}
