/* ledger_rules.c - rules for the energy ledger: their errors, and work for callgrind to count.
 *
 *   ledger_rules                prints "scene rule ticks error" of each rule over ticks of five lengths
 *   ledger_rules SCENE LENGTH   lets each rule run once over one of these motions, both counted from 0;
 * prints "function scene rule ticks ticks_in_all", function being what callgrind counts
 *
 * The error is that of the drive's work or of the loss, the larger one at the worst end of a period, over the
 * energy that flows in a period. The reference is Simpson's rule over 2048 ticks in a period, 8192 of the
 * shaft. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "tests/bench/ledger/rules.h"

enum { GRIDS = 5, FINER = 16 };
static const char *const room[RECORD_SCENES] = {"rig", "rig", "tip", "shaft"};

/* Books at the end of each period. */
static void run(const struct record *r, rule_function *rule, struct books at[RECORD_PERIODS])
{
    struct books b = {{0.0, 0.0}, {0.0, 0.0}, 0.0, 0.0};
    for (int i = 0; i < RECORD_PERIODS; i++) {
        rule(r, r->period[i], r->period[i + 1], &b);
        at[i] = b;
    }
}

static double error_of(const struct books *a, const struct books *truth)
{
    double worst = 0.0;
    for (int i = 0; i < RECORD_PERIODS; i++) {
        worst = fmax(worst, fabs(sum_of(&a[i].work) - sum_of(&truth[i].work)));
        worst = fmax(worst, fabs(sum_of(&a[i].damping) - sum_of(&truth[i].damping)));
    }
    return worst * RECORD_PERIODS / truth[RECORD_PERIODS - 1].gross;
}

static void print_errors(int scene)
{
    struct books truth[RECORD_PERIODS], at[RECORD_PERIODS];
    const struct record *r = record_run(scene, FINER * record_ticks(scene), true);
    run(r, rule_table[0].function[scene], truth);
    for (int k = 0; k < GRIDS; k++) {
        r = record_run(scene, record_ticks(scene) * (1 << k) / 2, false);
        rules_prepare(r);
        for (int i = 0; i < RULES; i++) {
            if (!rule_table[i].function[scene])
                continue;
            run(r, rule_table[i].function[scene], at);
            printf("%s %s %d %.3g\n", r->name, rule_table[i].name, r->ticks, error_of(at, truth));
        }
    }
}

static void run_once(int scene, int length)
{
    struct books at[RECORD_PERIODS];
    const struct record *r = record_run(scene, record_ticks(scene) * (1 << length) / 2, false);
    rules_prepare(r);
    for (int i = 0; i < RULES; i++) {
        if (!rule_table[i].function[scene] || rule_table[i].uncounted)
            continue;
        run(r, rule_table[i].function[scene], at);
        printf("rule_%s_%s %s %s %d %d\n", rule_table[i].name, room[scene], r->name, rule_table[i].name,
               r->ticks, RECORD_PERIODS * r->ticks);
    }
}

int main(int argc, char **argv)
{
    int scene = argc == 3 ? atoi(argv[1]) : -1, length = argc == 3 ? atoi(argv[2]) : -1;
    if (argc == 3 && scene >= 0 && scene < RECORD_SCENES && length >= 0 && length < GRIDS)
        run_once(scene, length);
    for (int i = 0; argc == 1 && i < RECORD_SCENES; i++)
        print_errors(i);
    return 0;
}
