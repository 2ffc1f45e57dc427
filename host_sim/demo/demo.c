/* demo.c - ten seconds that show what the plant does: plant and controller as two processes on the loopback
 * interface, a record of all traffic, a table, a picture and a paragraph. */
#include "host_sim/afm/afm_demo.h"
#include "host_sim/demo/demo.h"
#include "host_sim/cli/clock.h"
#include "host_sim/commands.h"
#include "host_sim/cli/options.h"
#include "host_sim/scene/scene.h"
#include "host_sim/scope/scope.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { TRIES = 3 }; /* on a machine too busy for a controller */
static const double scope_patience_s = 5.0, scope_look_s = 0.01;

static const struct option own[] = {
    {"out", "DIR", "directory of the files (build/demo)", OPTION_TEXT, .initial = "build/demo"},
    {"report", "FILE", "a page with summary and charts, which opens in a browser without a network",
     OPTION_TEXT, .initial = NULL},
    {.name = NULL},
};

static const struct usage usage = {
    .name = "demo",
    .words = "[afm]",
    .summary =
        "Shows the plant at work for ten seconds. It starts the plant as a process of its own on the\n"
        "loopback interface and plays its controller. It drives the plant until contact is lost, keeps\n"
        "contact by a sampled force, disturbs it with a fast base drive, and falls silent to show the\n"
        "time-out. It writes demo.svg, demo.csv, bus.log (all traffic, candump format) and plant.txt.\n"
        "demo afm shows the virtual microscope instead, in one picture, afm.svg: a force curve, heat, a "
        "line\n"
        "over a grating, and images of a grating with a disc that takes energy.",
    .examples = "  contactplant demo\n"
                "  contactplant demo --out /tmp/demo\n"
                "  contactplant demo --scope            in a browser, too\n"
                "  contactplant demo afm\n",
    .max_words = 1,
    .table = {own, scope_options},
};

/* Every directory of the path; false with errno. */
static bool make_directories(const char *path)
{
    char part[DEMO_PATH];
    if ((size_t)snprintf(part, sizeof part, "%s", path) >= sizeof part) {
        errno = ENAMETOOLONG;
        return false;
    }
    for (char *p = part + 1; *p; p++) {
        if (*p != '/')
            continue;
        *p = '\0';
        if (mkdir(part, 0777) && errno != EEXIST)
            return false;
        *p = '/';
    }
    return !mkdir(part, 0777) || errno == EEXIST;
}

static void path_of(char *path, const char *directory, const char *name)
{
    snprintf(path, DEMO_PATH + 16, "%s/%s", directory, name);
}

/* Who the plant is on the bus: the default scene, as `contactplant run` makes it. */
static bool identify(struct wire_scene *identity, char *why)
{
    struct scene_app *s = calloc(1, sizeof *s);
    bool good = s && scene_init(s, NULL, why) && scene_start(s, NULL, why);
    if (!s)
        snprintf(why, DEMO_REASON, "out of memory");
    if (good)
        *identity = s->app.scene;
    if (s)
        scene_free(s);
    free(s);
    return good;
}

/* The plant's line about its scope, once it has said it; nothing where it ends before that. */
static void print_scope(struct demo *d, const char *words)
{
    double end = clock_now_s() + scope_patience_s;
    char line[DEMO_REASON];
    bool found = false;
    while (!found && clock_now_s() < end && demo_child_runs(&d->child)) {
        FILE *f = fopen(words, "r");
        while (f && !found && fgets(line, sizeof line, f))
            found = strstr(line, "the scope is at ") && strchr(line, '\n');
        if (f)
            fclose(f);
        clock_sleep_s(scope_look_s);
    }
    if (found)
        printf("%s", strstr(line, "the scope is at "));
    fflush(stdout);
}

/* The plant's process and our end of the bus. */
static bool connect_plant(struct demo *d, const struct options *o, const char *out)
{
    /* the duration is a bound for the case that this process dies */
    char word[][16] = {"contactplant", "run",    "hertz_rig", "--realtime", "--duration", "30",
                       "--bus",        "--peer", "--log",     "--scope",    "--http"};
    char bus[32], peer[32], log[DEMO_PATH + 16], words[DEMO_PATH + 16], at[DEMO_PATH];
    bool shown = options_given(o, "scope"); /* else the command ends before these words */
    char *const argv[] = {word[0],
                          word[1],
                          word[2],
                          word[3],
                          word[4],
                          word[5],
                          word[6],
                          bus,
                          word[7],
                          peer,
                          word[8],
                          log,
                          shown ? word[9] : NULL,
                          word[10],
                          at,
                          NULL};
    const char *plant = peer, *http = options_text(o, "http", 0);
    struct wire_scene identity;
    int port[2];
    if (!identify(&identity, d->why) || !demo_free_ports(port, d->why))
        return false;
    path_of(log, out, "bus.log");
    path_of(words, out, "plant.txt");
    snprintf(bus, sizeof bus, "udp:%d", port[0]);
    snprintf(peer, sizeof peer, "127.0.0.1:%d", port[1]);
    snprintf(at, sizeof at, "%s", http ? http : SCOPE_AT);
    if (!demo_child_start(&d->child, argv, words, d->why))
        return false;
    if (shown)
        print_scope(d, words);
    snprintf(bus, sizeof bus, "udp:%d", port[1]);
    snprintf(peer, sizeof peer, "127.0.0.1:%d", port[0]);
    if (!bus_open(&d->bus, bus, &plant, 1, &identity, d->why))
        return false;
    client_init(&d->client, &d->bus.hal, &identity);
    return true;
}

/* After a step of the end: the first failure is the one to tell. */
static void note(struct demo *d, bool good, const char *why)
{
    if (good || d->end != DEMO_DONE)
        return;
    snprintf(d->why, sizeof d->why, "%s", why);
    d->end = DEMO_FAILED;
}

/* One whole demonstration; the files are written whatever came of it. */
static void attempt(struct demo *d, const struct options *o, const char *out)
{
    char path[DEMO_PATH + 16], why[DEMO_REASON];
    memset(d, 0, sizeof *d);
    d->tty = isatty(STDOUT_FILENO) != 0;
    demo_record_init(&d->record);
    if (!connect_plant(d, o, out))
        d->end = DEMO_FAILED;
    else
        demo_converse(d);
    bus_close(&d->bus);
    if (d->tty)
        printf("\n");
    note(d, demo_child_end(&d->child, why), why);
    path_of(path, out, "demo.csv");
    note(d, demo_write_csv(&d->record, path, why), why);
    path_of(path, out, "demo.svg");
    note(d, demo_write_picture(&d->record, path, why), why);
}

/* The last line that the plant's process printed; empty when there is none. */
static void last_words(char *words, const char *out)
{
    char path[DEMO_PATH + 16], line[DEMO_REASON];
    path_of(path, out, "plant.txt");
    FILE *f = fopen(path, "r");
    *words = '\0';
    while (f && fgets(line, sizeof line, f)) {
        line[strcspn(line, "\n")] = '\0';
        snprintf(words, DEMO_REASON, "%s", line);
    }
    if (f)
        fclose(f);
}

static int conclude(const struct demo *d, const char *out)
{
    if (d->end == DEMO_DONE) {
        demo_print_summary(d);
        printf("files: %s/demo.svg (look at it), demo.csv, bus.log, plant.txt\n", out);
        return STATUS_DONE;
    }
    if (d->end == DEMO_INTERRUPTED)
        return options_failure(&usage, "interrupted; the files in %s hold what there was until then", out);
    char words[DEMO_REASON];
    last_words(words, out);
    return options_failure(&usage, "%s\n  the plant's last words: %s\n  %s holds what there was until then",
                           d->why, words, out);
}

int cmd_demo(int argc, char **argv)
{
    struct options o;
    int status;
    if (!options_parse(&o, &usage, argc, argv, &status))
        return status;
    const char *out = options_text(&o, "out", 0);
    if (options_given(&o, "http") && !options_given(&o, "scope"))
        return options_misuse(&usage, "--http needs --scope");
    bool microscope = o.n_words > 0;
    if (microscope && strcmp(o.word[0], "afm"))
        return options_misuse(&usage, "nothing called \"%s\"; write afm, or nothing", o.word[0]);
    if (!make_directories(out))
        return options_failure(&usage, "cannot make the directory %s: %s", out, strerror(errno));
    if (microscope)
        return afm_demo(&o, out);
    struct demo *d = calloc(1, sizeof *d);
    if (!d)
        return options_failure(&usage, "out of memory");
    clock_catch_signals();
    attempt(d, &o, out);
    for (int i = 1; i < TRIES && d->end == DEMO_BUSY; i++) {
        fprintf(stderr, "contactplant demo: %s; once more from the start\n", d->why);
        attempt(d, &o, out);
    }
    status = conclude(d, out);
    const char *report = options_text(&o, "report", 0),
               *bad = report ? demo_write_html(d, report, argc, argv) : NULL;
    if (bad)
        status = options_failure(&usage, "--report %s cannot be written: %s", report, bad);
    free(d);
    return status;
}
