/* test_maps_identity.c - every option of every map says whether it belongs to the number of a run. */
#include "host_sim/maps/basin/basin.h"
#include "host_sim/maps/basin/basin_read.h"
#include "host_sim/maps/random/random.h"
#include "host_sim/maps/random/random_read.h"
#include "host_sim/maps/stability/stability.h"
#include "host_sim/maps/stability/stability_read.h"
#include "host_sim/maps/sweep/sweep.h"
#include "host_sim/maps/sweep/sweep_read.h"
#include "tests/unit/test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORDS = 12, TEXT = 200 };

static struct sweep a_sweep;
static struct stability a_stability;
static struct random_runs a_random;
static struct basin a_basin;

static int read_sweep(void)
{
    return sweep_read(&a_sweep);
}

static int read_stability(void)
{
    return stability_read(&a_stability);
}

static int read_random(void)
{
    return random_read(&a_random);
}

static int read_basin(void)
{
    return basin_read(&a_basin);
}

static const struct map {
    const struct usage *usage;
    const char *scene;
    int (*read)(void);
    struct maps *m;
} map[] = {
    {&sweep_usage, "rig", read_sweep, &a_sweep.m},
    {&stability_usage, "hertz_rig", read_stability, &a_stability.m},
    {&random_usage, "nayak-random", read_random, &a_random.m},
    {&basin_usage, "shaft-fig16-705", read_basin, &a_basin.m},
};
enum { MAPS = sizeof map / sizeof map[0] };

static void clear(void)
{
    for (int i = 0; i < MAPS; i++)
        free(map[i].m->identity);
    free(a_sweep.scratch);
    free(a_random.scratch);
    basin_starts_free(&a_basin.starts);
    memset(&a_sweep, 0, sizeof a_sweep);
    memset(&a_stability, 0, sizeof a_stability);
    memset(&a_random, 0, sizeof a_random);
    memset(&a_basin, 0, sizeof a_basin);
}

/* The run's number with these options, each with its value behind an equal sign, or 0. */
static unsigned run_of(const struct map *m, const char *more)
{
    char text[TEXT], *argv[WORDS];
    int argc = 0, status;
    clear();
    snprintf(text, sizeof text, "%s %s %s", m->usage->name, m->scene, more);
    for (char *word = strtok(text, " "); word && argc < WORDS; word = strtok(NULL, " "))
        argv[argc++] = word;
    if (!options_parse(&m->m->o, m->usage, argc, argv, &status) || m->read() != 0)
        return 0;
    return jobs_run_number(m->m->identity);
}

/* Options with a value, another one, and the first one spelled otherwise (NULL: it has one spelling). */
static const struct sample {
    const char *map, *first, *other, *same;
} samples[] = {
    {"sweep", "--sweep=force.frequency=100:200:5", "--sweep=force.frequency=100:200:6",
     "--sweep=force.frequency=0.1kHz:200Hz:5"},
    {"sweep", "--family=mass=5:6:2", "--family=mass=5:7:2", "--family=mass_kg=5kg:6kg:2"},
    {"sweep", "--settle=300", "--settle=301", "--settle=3e2"},
    {"sweep", "--measure=12", "--measure=16", ""},
    {"sweep", "--harmonics=1,2,3", "--harmonics=1,2", ""},
    {"sweep", "--bracket=1e-4", "--bracket=1e-5", ""},
    {"sweep", "--method=taylor", "--method=rk4", NULL},
    {"sweep", "--method=taylor --tol=1e-10", "--method=taylor --tol=1e-11", "--method=taylor --tol=0.1e-9"},
    {"sweep", "--set=mass=5kg", "--set=mass=6kg", "--set=mass=5000g"},
    {"stability", "--map=floquet", "--map=contact", ""},
    {"stability", "--x=stiffness.frequency=100:200:5", "--x=stiffness.frequency=100:201:5",
     "--x=stiffness.frequency=100Hz:200Hz:5"},
    {"stability", "--y=stiffness.amplitude=0.1:0.5:5", "--y=stiffness.amplitude=0.1:0.5:5:log", NULL},
    {"stability", "--step=0.1ms", "--step=0.2ms", "--step=100us"},
    {"stability", "--map=contact --periods=50", "--map=contact --periods=60", "--map=contact"},
    {"stability", "--method=taylor", "--method=rk4", NULL},
    {"stability", "--method=taylor --tol=1e-10", "--method=taylor --tol=1e-11", NULL},
    {"stability", "--set=damping=0.5", "--set=damping=0.6", NULL},
    {"random", "--range=-1:1 --seeds=100", "--range=-1:1 --seeds=101", "--range=-1:1"},
    {"random", "--range=-1:1 --over=100", "--range=-1:1 --over=101", "--range=-1.0:1 --over=1e2"},
    {"random", "--range=-1:1 --settle=100", "--range=-1:1 --settle=101", "--range=-1:1 --settle=1e2"},
    {"random", "--range=-1:1", "--range=-1:2", "--range=-1.0:1.0"},
    {"random", "--range=-1:1 --bins=60", "--range=-1:1 --bins=61", "--range=-1:1"},
    {"random", "--range=-1:1 --observable=displacement", "--range=-1:1 --observable=velocity", NULL},
    {"random", "--range=-1:1 --method=taylor", "--range=-1:1 --method=rk4", NULL},
    {"random", "--range=-1:1 --method=taylor --tol=1e-10", "--range=-1:1 --method=taylor --tol=1e-9", NULL},
    {"random", "--range=-1:1 --set=zeta=0.1", "--range=-1:1 --set=zeta=0.2", NULL},
    {"basin", "--starts=1000", "--starts=999", ""},
    {"basin", "--seed=1", "--seed=2", ""},
    {"basin", "--box=x1=0um:10um", "--box=x1=0um:11um", "--box=x1=0:10um"},
    {"basin", "--periods=20000", "--periods=10000", ""},
    {"basin", "--method=exact", "--method=rk4", NULL},
    {"basin", "--steps=512", "--steps=1024", "--steps=0x200"},
};
enum { SAMPLES = sizeof samples / sizeof samples[0] };

/* A sample of this option of this map, or -1. */
static int sample_of(const char *command, const char *option)
{
    char text[TEXT];
    snprintf(text, sizeof text, "--%s=", option);
    for (int i = 0; i < SAMPLES; i++)
        if (!strcmp(samples[i].map, command) && strstr(samples[i].other, text))
            return i;
    return -1;
}

/* Only files that the command writes or reads, and how its work is shared, may be left out of the identity.
 */
static bool may_be_outside(const struct option *row)
{
    return row->kind == OPTION_WRITES || row->kind == OPTION_READS || !strcmp(row->name, "shard") ||
           !strcmp(row->name, "cores");
}

TEST(maps_every_option_says_whether_it_is_in_the_identity)
{
    int rows = 0;
    for (int i = 0; i < MAPS; i++)
        for (int k = 0; k < OPTIONS_TABLES && map[i].usage->table[k]; k++)
            for (const struct option *row = map[i].usage->table[k]; row->name; row++, rows++) {
                bool outside = row->identity == IDENTITY_OUTSIDE;
                printf("      %s --%s\n", map[i].usage->name, row->name);
                check_true("says it", row->identity != IDENTITY_UNSAID);
                check_true("is outside only where it cannot change a row", outside == may_be_outside(row));
                check_true("has a sample here", outside || sample_of(map[i].usage->name, row->name) >= 0);
            }
    check_above("options", rows, 40);
}

static const struct map *map_of(const char *name)
{
    for (int i = 0; i < MAPS; i++)
        if (!strcmp(map[i].usage->name, name))
            return &map[i];
    return NULL;
}

TEST(maps_identity_follows_each_value)
{
    for (int i = 0; i < SAMPLES; i++) {
        const struct sample *s = &samples[i];
        const struct map *m = map_of(s->map);
        unsigned first = run_of(m, s->first), other = run_of(m, s->other);
        printf("      %s %s: %08x, %s: %08x\n", s->map, s->first, first, s->other, other);
        check_true("both are read", first && other);
        check_true("another value is another run", first != other);
        if (s->same)
            check_int("the same value, spelled otherwise or by default", run_of(m, s->same), first);
    }
    clear();
}
