/* main.c - contactplant SUBCOMMAND: picks the subcommand. */
#include "host_sim/cli/options_help.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/commands.h"
#include "host_sim/help/completion.h"
#include "host_sim/help/help.h"
#include "host_sim/cli/options.h"
#include "host_sim/library/contactplant.h"
#include "host_sim/out/plain.h"

#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include "firmware/bus/wire_table.h"

#define PAGES                                                                                                \
    "Pages (docs/..) are printed by contactplant help PAGE, and searched by contactplant help\n--search "    \
    "WORDS. They lie in the source, and in share/doc/contactplant of an installation.\n"

static int cmd_man(int argc, char **argv);
static int cmd_completion(int argc, char **argv);
static int cmd_version(int argc, char **argv);

/* The groups of --help: each says what somebody wants. The subcommands stand in this order. */
enum group { WANT_REPLACE, WANT_CONTROLLER, WANT_LOOK, WANT_MAPS, WANT_MICROSCOPE, WANT_EMBED, WANT_PRINT };
static const char *const want[] = {
    [WANT_REPLACE] = "replace a rig",
    [WANT_CONTROLLER] = "test a controller",
    [WANT_LOOK] = "look at what a plant does",
    [WANT_MAPS] = "draw maps of a plant",
    [WANT_MICROSCOPE] = "use the virtual microscope",
    [WANT_EMBED] = "put a plant into other programs",
    [WANT_PRINT] = "print what there is",
};

static const struct command {
    enum group group;
    const char *name, *meaning;
    int (*run)(int argc, char **argv);
} command[] = {
    {WANT_REPLACE, "scene", "print a scene as a file to edit, or check a file", cmd_scene},
    {WANT_REPLACE, "fit", "find the numbers of a scene from measurements of the rig", cmd_fit},
    {WANT_REPLACE, "choose", "find the cheapest model, method and step that keep a scene's tolerance",
     cmd_choose},
    {WANT_REPLACE, "run", "run a plant in real time on a bus", cmd_run},
    {WANT_REPLACE, "simulate", "run a plant offline, as fast as possible, and write a CSV", cmd_simulate},
    {WANT_CONTROLLER, "test", "test a controller: run the cases of a test file and judge them", cmd_test},
    {WANT_CONTROLLER, "control", "run a controller that keeps contact: an example to copy", cmd_control},
    {WANT_CONTROLLER, "send", "send commands to a plant and print its answers", cmd_send},
    {WANT_CONTROLLER, "replay", "run a recorded log through the plant and compare every byte of its messages",
     cmd_replay},
    {WANT_LOOK, "demo", "show plant and controller for ten seconds, and draw a picture", cmd_demo},
    {WANT_LOOK, "scope", "show plants in a browser while they run", cmd_scope},
    {WANT_LOOK, "monitor", "print the messages of a plant, by name and unit", cmd_monitor},
    {WANT_LOOK, "decode", "print a recorded log as a table, in SI units", cmd_decode},
    {WANT_LOOK, "compare", "tell where two recorded logs part", cmd_compare},
    {WANT_LOOK, "export", "write recorded logs as pcapng, for Wireshark", cmd_export},
    {WANT_MAPS, "sweep", "draw response curves: step a number of a scene up and down, and locate jumps",
     cmd_sweep},
    {WANT_MAPS, "basin", "find the attractors of a plant, and the share of starts that lead to each",
     cmd_basin},
    {WANT_MAPS, "stability",
     "map over two numbers where plant and method are stable: Floquet tongues, energy, contact switches",
     cmd_stability},
    {WANT_MAPS, "random",
     "compute statistics under noise: densities, crossing rates, contact loss, beside closed forms",
     cmd_random},
    {WANT_MAPS, "merge", "join the shares of a map, or of a test's report, that several machines computed",
     cmd_merge},
    {WANT_MICROSCOPE, "scan", "scan a surface with a virtual AFM: images of trace and retrace", cmd_scan},
    {WANT_MICROSCOPE, "approach", "move the base of an AFM lever to the sample and back: a force curve",
     cmd_approach},
    {WANT_MICROSCOPE, "thermal",
     "measure the thermal motion of an AFM lever: spectrum, fit, calibrated stiffness", cmd_thermal},
    {WANT_EMBED, "fmu", "write a scene as an FMU, for co-simulation by FMI 3.0", cmd_fmu},
    {WANT_EMBED, "dbc", "print the .dbc of a scene", cmd_dbc},
    {WANT_EMBED, "dissector", "print the dissector of a scene for Wireshark", cmd_dissector},
    {WANT_PRINT, "list", "print models, scenes, parameters, settings, methods and messages", cmd_list},
    {WANT_PRINT, "selftest", "measure numbers whose exact value is known", cmd_selftest},
    {WANT_PRINT, "help", "print a page of the guides, search them, or say what to do about an error",
     cmd_help},
    {WANT_PRINT, "man", "print the manual page", cmd_man},
    {WANT_PRINT, "completion", "print the completion of these words for bash", cmd_completion},
    {WANT_PRINT, "version", "print the version, the protocol and the library's ABI", cmd_version},
};

enum { COMMANDS = sizeof command / sizeof command[0], NAME_SIZE = 32 };

static const struct command *find_command(const char *name)
{
    for (int i = 0; i < COMMANDS; i++)
        if (!strcmp(name, command[i].name))
            return &command[i];
    return NULL;
}

static int help(bool pages_too)
{
    printf("usage: contactplant SUBCOMMAND [ARGUMENTS]\n\n"
           "Computes a test rig whose contacts make and break, in real time. Controllers speak with it over "
           "CAN or\n"
           "UDP.\n\n"
           "subcommands:\n");
    for (int i = 0; i < COMMANDS; i++) {
        if (!i || command[i].group != command[i - 1].group)
            printf("%s:\n", want[command[i].group]);
        printf("  %-10s %s\n", command[i].name, command[i].meaning);
    }
    printf("\ncontactplant SUBCOMMAND --help explains each one, with examples. An output that is an input, "
           "or another\n"
           "output, is refused before anything is done.\n" PAGES "\n"
           "examples:\n"
           "  contactplant demo                   see it work\n"
           "  contactplant simulate rig           a preset scene, offline; contactplant list scenes\n"
           "  contactplant run                    a plant at udp:20000 ...\n"
           "  contactplant control                ... and in another terminal its controller\n"
           "  contactplant monitor                ... and in a third one its messages\n");
    if (pages_too) {
        putchar('\n');
        (void)cmd_help(1, (char *[]){(char[]){"help"}, NULL});
    }
    return STATUS_DONE;
}

/* ---- what is printed from the tables of all subcommands ---- */

/* Every subcommand's own tables, in the form that `how` asks for (options_help). */
static void each_usage(const char *how, const char *before, const char *after)
{
    for (int i = 0; i < COMMANDS; i++) {
        char name[NAME_SIZE], word[NAME_SIZE];
        char *argv[] = {name, word, NULL};
        snprintf(name, sizeof name, "%s", command[i].name);
        snprintf(word, sizeof word, "%s", how);
        printf(before, command[i].name);
        (void)command[i].run(2, argv);
        fputs(after, stdout);
    }
}

static int cmd_man(int argc, char **argv)
{
    static const struct usage usage = {
        .name = "man",
        .words = "[PAGE]",
        .summary = "Prints the manual page contactplant(1), made from the tables of all subcommands, or a "
                   "page of the\n"
                   "docs as contactplant-PAGE(7). make install has those of all guides.",
        .words_help = "PAGE is a name as contactplant help has it.\n",
        .examples = "  contactplant man | man -l -\n"
                    "  contactplant man protocol | man -l -\n",
        .max_words = 1};
    struct options o;
    int status;
    if (!options_parse(&o, &usage, argc, argv, &status))
        return status;
    if (o.n_words)
        return help_print_manual(o.usage, o.word[0]);
    printf(".TH CONTACTPLANT 1 \"\" \"contactplant %s\" \"User Commands\"\n"
           ".SH NAME\ncontactplant \\- a real\\-time plant for hardware\\-in\\-the\\-loop rigs\n"
           ".SH SYNOPSIS\n.B contactplant\nSUBCOMMAND [ARGUMENTS]\n.SH DESCRIPTION\n",
           contactplant_version());
    options_print_roff(
        "A program in the place of a vibrating test rig: mechanical systems whose contact makes and breaks,\n"
        "computed in real time. A controller excites the plant over CAN or UDP and reads motion, contact "
        "force\n"
        "and contact events. The library libcontactplant puts it into programs: contactplant.h is its "
        "manual.\n");
    printf(".SH SUBCOMMANDS\n");
    each_usage("--help=man", "", "");
    printf(".SH FILES\n" PAGES);
    printf(".SH EXIT STATUS\n0 done, 1 failed, 2 misused: standard error says what to do. 3: the motion of\n"
           "simulate has escaped, or the bench of test had an error.\n");
    return STATUS_DONE;
}

static int cmd_completion(int argc, char **argv)
{
    static const struct usage usage = {
        .name = "completion",
        .words = "",
        .summary = "Prints the completion of subcommands, scenes, options and their names for bash.",
        .examples = "  contactplant completion >~/.local/share/bash-completion/completions/contactplant\n"};
    struct options o;
    int status;
    if (!options_parse(&o, &usage, argc, argv, &status))
        return status;
    printf("# bash completion of contactplant %s\n_contactplant()\n{\n    local words=\n",
           contactplant_version());
    completion_print_names();
    each_usage("--help=values", "", "");
    printf("    esac\n");
    printf("    [ -n \"$words\" ] || case $COMP_CWORD in\n    1) words=\"--help --version");
    for (int i = 0; i < COMMANDS; i++)
        printf(" %s", command[i].name);
    printf("\" ;;\n    *) case ${COMP_WORDS[1]} in\n");
    each_usage("--help=words", "        %s) words=\"", "\" ;;\n");
    printf("        esac ;;\n    esac\n    COMPREPLY=($(compgen -W \"$words\" -- "
           "\"${COMP_WORDS[COMP_CWORD]}\"))\n}\n"
           "complete -o default -F _contactplant contactplant\n");
    return STATUS_DONE;
}

static int cmd_version(int argc, char **argv)
{
    static const struct usage usage = {.name = "version",
                                       .words = "",
                                       .summary = "Prints the version, the protocol and the library's ABI.",
                                       .examples = "  contactplant version\n"};
    struct options o;
    int status;
    if (!options_parse(&o, &usage, argc, argv, &status))
        return status;
    printf("contactplant %s, protocol %d, ABI %d\n", contactplant_version(), contactplant_protocol(),
           contactplant_abi());
    return STATUS_DONE;
}

static int unknown(const char *name)
{
    const char *names[COMMANDS];
    for (int i = 0; i < COMMANDS; i++)
        names[i] = command[i].name;
    const char *nearest = options_nearest(name, names, COMMANDS);
    fputs("contactplant: unknown subcommand \"", stderr);
    plain_put(stderr, name);
    fprintf(stderr, "\"%s%s%s see contactplant --help\n", nearest ? "; did you mean " : ";",
            nearest ? nearest : "", nearest ? "?" : "");
    return STATUS_MISUSED;
}

/* A standard stream that was closed stays what it was: nothing to read, and writing fails. Else the next
 * file that is opened, a log say, would get its number and be written into. */
static bool keep_standard_streams(void)
{
    bool kept = true;
    for (int fd = 0; fd <= 2; fd++)
        if (fcntl(fd, F_GETFD) == -1)
            kept = open("/dev/null", O_RDONLY) == fd && kept;
    return kept;
}

/* A plant works on its bus: who reads what it prints decides nothing. */
static int finish(const struct command *c, int status)
{
    return c->run == cmd_run ? status : options_finish(c->name, status);
}

int main(int argc, char **argv)
{
    if (!keep_standard_streams())
        return STATUS_FAILED; /* there is nobody to tell */
    signal(SIGXFSZ, SIG_IGN); /* a file at its limit (ulimit -f) is a write that fails, and is told as such */
    signal(SIGPIPE, SIG_IGN); /* a pipe that nobody reads any more too, and options_finish knows it */
    if (argc < 2) {
        fprintf(stderr, "contactplant: a subcommand is missing; see contactplant --help\n");
        return STATUS_MISUSED;
    }
    if (!strcmp(argv[1], "--version"))
        return options_finish("--version", cmd_version(1, argv + 1));
    bool asks = !strcmp(argv[1], "help");
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h") || (asks && argc == 2))
        return options_finish("--help", help(asks));
    if (asks && argc == 3 && find_command(argv[2]) && !help_has_page(argv[2]))
        return options_finish("help",
                              find_command(argv[2])->run(2, (char *[]){argv[2], (char[]){"--help"}, NULL}));
    const struct command *c = find_command(argv[1]);
    return c ? finish(c, c->run(argc - 1, argv + 1)) : unknown(argv[1]);
}
