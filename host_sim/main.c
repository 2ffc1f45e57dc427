/* main.c - contactplant SUBCOMMAND: picks the subcommand. */
#include "host_sim/commands.h"
#include "host_sim/cli/options.h"

#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const struct command {
    const char *name, *meaning;
    int (*run)(int argc, char **argv);
} command[] = {
    {"run", "run a plant in real time on a bus", cmd_run},
    {"demo", "show plant and controller for ten seconds, and draw a picture", cmd_demo},
    {"send", "send commands to a plant and print its answers", cmd_send},
    {"monitor", "print the messages of a plant, by name and unit", cmd_monitor},
    {"control", "run a controller that keeps contact: an example to copy", cmd_control},
    {"simulate", "run a plant offline, as fast as possible, and write a CSV", cmd_simulate},
    {"approach", "move the base of an AFM lever to the sample and back: a force curve", cmd_approach},
    {"choose", "find the cheapest model, method and step that keep a scene's tolerance", cmd_choose},
    {"sweep", "draw response curves: step a number of a scene up and down, and locate jumps", cmd_sweep},
    {"basin", "find the attractors of a plant, and the share of starts that lead to each", cmd_basin},
    {"stability",
     "map over two numbers where plant and method are stable: Floquet tongues, energy, contact switches",
     cmd_stability},
    {"random", "compute statistics under noise: densities, crossing rates, contact loss, beside closed forms",
     cmd_random},
    {"replay", "run a recorded log through the plant and compare every byte of its messages", cmd_replay},
    {"selftest", "measure numbers whose exact value is known", cmd_selftest},
    {"list", "print models, scenes, parameters, settings, methods and messages", cmd_list},
    {"scene", "print a scene as a file to edit, or check a file", cmd_scene},
    {"dbc", "print the .dbc of a scene", cmd_dbc},
};

enum { COMMANDS = sizeof command / sizeof command[0] };

static int help(void)
{
    printf("usage: contactplant SUBCOMMAND [ARGUMENTS]\n\n"
           "Computes a test rig whose contacts make and break, in real time. Controllers speak with it over "
           "CAN or\n"
           "UDP.\n\n"
           "subcommands:\n");
    for (int i = 0; i < COMMANDS; i++)
        printf("  %-10s %s\n", command[i].name, command[i].meaning);
    printf("\ncontactplant SUBCOMMAND --help explains each one, with examples.\n\n"
           "examples:\n"
           "  contactplant demo                   see it work\n"
           "  contactplant simulate rig           a preset scene, offline; contactplant list scenes\n"
           "  contactplant run                    a plant at udp:20000 ...\n"
           "  contactplant control                ... and in another terminal its controller\n"
           "  contactplant monitor                ... and in a third one its messages\n");
    return fflush(stdout) ? STATUS_FAILED : STATUS_DONE;
}

static int unknown(const char *name)
{
    const char *names[COMMANDS];
    for (int i = 0; i < COMMANDS; i++)
        names[i] = command[i].name;
    const char *nearest = options_nearest(name, names, COMMANDS);
    if (nearest)
        fprintf(stderr, "contactplant: unknown subcommand \"%s\"; did you mean %s? see contactplant --help\n",
                name, nearest);
    else
        fprintf(stderr, "contactplant: unknown subcommand \"%s\"; see contactplant --help\n", name);
    return STATUS_MISUSED;
}

/* A standard stream that was closed stays what it was: nothing to read, and writing fails. Else the next file that is opened, a log
 * say, would get its number and be written into. */
static bool keep_standard_streams(void)
{
    bool kept = true;
    for (int fd = 0; fd <= 2; fd++)
        if (fcntl(fd, F_GETFD) == -1)
            kept = open("/dev/null", O_RDONLY) == fd && kept;
    return kept;
}

int main(int argc, char **argv)
{
    if (!keep_standard_streams())
        return STATUS_FAILED; /* there is nobody to tell */
    signal(SIGXFSZ, SIG_IGN); /* a file at its limit (ulimit -f) is a write that fails, and is told as such */
    if (argc < 2) {
        fprintf(stderr, "contactplant: a subcommand is missing; see contactplant --help\n");
        return STATUS_MISUSED;
    }
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h") || !strcmp(argv[1], "help"))
        return help();
    for (int i = 0; i < COMMANDS; i++)
        if (!strcmp(argv[1], command[i].name))
            return command[i].run(argc - 1, argv + 1);
    return unknown(argv[1]);
}
