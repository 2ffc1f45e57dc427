/* demo.c - ten seconds that show what the plant does: plant and controller as two processes on the loopback
 * interface, a record of all traffic, a table, a picture and a paragraph. */
#include "host_sim/afm/afm_demo.h"
#include "host_sim/demo/demo_picture.h"
#include "host_sim/demo/demo_report.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/files.h"
#include "host_sim/commands.h"
#include "host_sim/cli/options.h"
#include "host_sim/live/client_host.h"
#include "host_sim/scene/scene.h"
#include "host_sim/scope/scope_child.h"

#include <arpa/inet.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TRIES = 3 /* on a machine too busy for a controller */, COMMAND = 4 * DEMO_PATH };
static const double patience_s = 5.0; /* for the plant to say where its scope is, and to end */
static const double look_s = 0.01;

static const struct option demo_options[] = {
    {"out", "DIR", "directory of the files (build/demo)", OPTION_FOLDER, .initial = "build/demo"},
    {"report", "FILE", "a page with summary and charts, which opens in a browser without a network",
     OPTION_WRITES, .initial = NULL},
    {.name = NULL},
};

static const struct usage demo_usage = {
    .name = "demo",
    .words = "[afm]",
    .summary =
        "Shows the plant at work for ten seconds. It starts the plant as a process of its own on the\n"
        "loopback interface and plays its controller. It drives the plant until contact is lost, keeps\n"
        "contact by a sampled force, disturbs it with a fast base drive, and falls silent to show the\n"
        "time-out. It writes demo.svg, demo.csv, bus.log (all traffic, candump format) and plant.txt into "
        "DIR,\n"
        "build/demo below the folder where you are.\n"
        "demo afm shows the virtual microscope instead, in one picture, DIR/afm.svg: a force curve, heat, a "
        "line\n"
        "over a grating, and images of a grating with a disc that takes energy.",
    .examples = "  contactplant demo\n"
                "  contactplant demo --out /tmp/demo\n"
                "  contactplant demo --scope            in a browser, too\n"
                "  contactplant demo afm\n",
    .max_words = 1,
    .table = {demo_options, scope_options},
};

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

/* Two UDP ports of the loopback interface that are free now. */
static bool free_ports(int port[2], char *why)
{
    struct sockaddr_in address = {.sin_family = AF_INET};
    socklen_t size = sizeof address;
    int fd[2];
    bool good = true;
    for (int i = 0; i < 2; i++) { /* both at once, or they would be one and the same */
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        address.sin_port = 0;
        fd[i] = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
        good = good && fd[i] >= 0 && !bind(fd[i], (struct sockaddr *)&address, sizeof address) &&
               !getsockname(fd[i], (struct sockaddr *)&address, &size);
        port[i] = ntohs(address.sin_port);
    }
    if (!good)
        snprintf(why, DEMO_REASON, "no free UDP port on 127.0.0.1: %s", strerror(errno));
    for (int i = 0; i < 2; i++)
        if (fd[i] >= 0)
            close(fd[i]);
    return good;
}

/* The plant's line about its scope, once it has said it; nothing where it ends before that. */
static void print_scope(struct demo *d)
{
    double end = clock_now_s() + patience_s;
    const char *at = NULL;
    while (child_look(&d->child) && !(at = strstr(d->child.line, "the scope is at ")) && clock_now_s() < end)
        clock_sleep_s(look_s);
    if (at)
        printf("%s\n", at);
    fflush(stdout);
}

/* A word more, as a shell takes it. */
static void add_word(char command[COMMAND], const char *word)
{
    size_t n = strlen(command);
    n += (size_t)snprintf(command + n, COMMAND - n, " '");
    for (; *word && n + 8 < COMMAND; word++)
        n += (size_t)snprintf(command + n, COMMAND - n, *word == '\'' ? "'\\''" : "%c", *word);
    snprintf(command + n, COMMAND - n, "'");
}

/* The plant's process: this program. Its words go into the file. */
static bool start_plant(struct demo *d, const char *out, const char *bus, const char *peer, const char *scope)
{
    char command[COMMAND] = "", program[DEMO_PATH] = "", log[DEMO_PATH + 16], words[DEMO_PATH + 16];
    ssize_t n = readlink("/proc/self/exe", program, sizeof program - 1);
    program[n > 0 ? n : 0] = '\0';
    path_of(log, out, "bus.log");
    path_of(words, out, "plant.txt");
    /* the duration is a bound for the case that this process dies */
    const char *const word[] = {program, "run", "hertz_rig", "--realtime", "--duration", "30",
                                "--bus", bus,   "--peer",    peer,         "--log",      log};
    for (size_t i = 0; i < sizeof word / sizeof word[0]; i++)
        add_word(command, word[i]);
    if (scope) {
        add_word(command, "--scope");
        add_word(command, "--http");
        add_word(command, scope);
    }
    d->words = files_create(words);
    if (d->words)
        return child_start(&d->child, command, ".", d->words, d->why);
    snprintf(d->why, DEMO_REASON, "cannot write %.400s: %s", words, strerror(errno));
    return false;
}

/* The plant's process and our end of the bus. */
static bool connect_plant(struct demo *d, const struct options *o, const char *out)
{
    char bus[32], peer[32];
    const char *plant = peer, *http = options_text(o, "http", 0);
    const char *scope = !options_given(o, "scope") ? NULL : http ? http : SCOPE_AT;
    struct wire_scene identity;
    int port[2];
    if (!identify(&identity, d->why) || !free_ports(port, d->why))
        return false;
    snprintf(bus, sizeof bus, "udp:%d", port[0]);
    snprintf(peer, sizeof peer, "127.0.0.1:%d", port[1]);
    if (!start_plant(d, out, bus, peer, scope))
        return false;
    if (scope)
        print_scope(d);
    snprintf(bus, sizeof bus, "udp:%d", port[1]);
    snprintf(peer, sizeof peer, "127.0.0.1:%d", port[0]);
    if (!bus_open(&d->bus, bus, &plant, 1, &identity, d->why))
        return false;
    client_init(&d->client, &d->bus.hal, &identity);
    return true;
}

/* Asks the plant to end and waits; true when it ended well. */
static bool end_plant(struct demo *d, char *why)
{
    struct child *c = &d->child;
    double end = clock_now_s() + patience_s;
    char how[CHILD_REASON];
    child_ask(c);
    while (child_look(c) && clock_now_s() < end)
        clock_sleep_s(look_s);
    bool killed = c->pid && !c->ended, good = c->ended && WIFEXITED(c->status) && !WEXITSTATUS(c->status);
    child_end(c);
    child_describe(c, how);
    if (d->words)
        (void)fclose(d->words);
    if (killed)
        snprintf(why, DEMO_REASON, "the plant did not end within %.0f s of being asked and was killed",
                 patience_s);
    else
        snprintf(why, DEMO_REASON, "the plant %s", how);
    return good;
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
    d->child.output = -1;
    d->tty = isatty(STDOUT_FILENO) != 0;
    demo_record_init(&d->record);
    if (!connect_plant(d, o, out))
        d->end = DEMO_FAILED;
    else
        demo_converse(d);
    bus_close(&d->bus);
    if (d->tty)
        printf("\n");
    note(d, end_plant(d, why), why);
    path_of(path, out, "demo.csv");
    note(d, demo_write_csv(&d->record, path, why), why);
    path_of(path, out, "demo.svg");
    note(d, demo_write_picture(&d->record, path, why), why);
}

static int conclude(const struct demo *d, const char *out)
{
    if (d->end == DEMO_DONE) {
        demo_print_summary(d);
        printf("files: %s/demo.svg (look at it), demo.csv, bus.log, plant.txt\n", out);
        return STATUS_DONE;
    }
    if (d->end == DEMO_INTERRUPTED)
        return options_failure(&demo_usage, "interrupted; the files in %s hold what there was until then",
                               out);
    return options_failure(&demo_usage, "%s; the plant's last words: %s; %s holds what there was until then",
                           d->why, d->child.line, out);
}

int cmd_demo(int argc, char **argv)
{
    struct options o;
    int status;
    if (!options_parse(&o, &demo_usage, argc, argv, &status))
        return status;
    const char *out = options_text(&o, "out", 0);
    if (options_given(&o, "http") && !options_given(&o, "scope"))
        return options_misuse(&demo_usage, "--http needs --scope");
    bool microscope = o.n_words > 0;
    if (microscope && strcmp(o.word[0], "afm"))
        return options_misuse(&demo_usage, "nothing called \"%s\"; write afm, or nothing", o.word[0]);
    if (microscope && (options_given(&o, "report") || options_given(&o, "scope")))
        return options_misuse(&demo_usage, "demo afm makes one picture; take --report and --scope away");
    static const char *const files[] = {"demo.svg", "demo.csv", "bus.log", "plant.txt", NULL},
                             *const picture[] = {"afm.svg", NULL};
    if ((status = options_check_folder(&o, "out", microscope ? picture : files)))
        return status;
    if (!files_make_folder(out))
        return options_failure(&demo_usage, "cannot make the directory %s: %s", out, strerror(errno));
    if (microscope)
        return afm_demo(&o, out);
    struct demo *d = calloc(1, sizeof *d);
    if (!d)
        return options_failure(&demo_usage, "out of memory");
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
        status = options_failure(&demo_usage, "--report %s cannot be written: %s", report, bad);
    free(d);
    return status;
}
