/* list.c - everything that has a name, from the tables that the plant itself uses; and the .dbc of a
 * scene. */
#include "firmware/bus/wire_table.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/commands.h"
#include "firmware/afm/codes.h"
#include "firmware/afm/station.h"
#include "host_sim/database/dbc.h"
#include "host_sim/database/dissector.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/options.h"
#include "host_sim/scene/scene.h"
#include "host_sim/scene/scene_print.h"
#include "host_sim/test/metric.h"
#include "firmware/afm/afm_plant.h"
#include "host_sim/test/test_afm.h"
#include "models/models.h"
#include "models/scenes/scenes_table.h"

#include <stdio.h>
#include <string.h>

static const struct usage list_usage = {
    .name = "list",
    .words = "[models|scenes|papers|settings|microscope|methods|messages|counters|metrics]",
    .summary =
        "Prints all names: models with their parameters, inputs and outputs, scenes, scenes of papers,\n"
        "settings, numbers of the microscope, methods, messages with their fields, counters, and the\n"
        "metrics of tests. A word picks one of these lists.",
    .examples = "  contactplant list\n"
                "  contactplant list models\n"
                "  contactplant list messages\n",
    .max_words = 1,
};

static const struct usage dbc_usage = {
    .name = "dbc",
    .words = "[SCENE]",
    .summary =
        "Prints the .dbc of a scene: every message, with the scales that follow from its parameters, rate\n"
        "and dilation. Give the SCENE and options that contactplant run got.",
    .words_help = SCENE_WORDS_HELP,
    .examples = "  contactplant dbc > contactplant.dbc\n"
                "  contactplant dbc --base-id 0x240 --dilation 100 --set preload_N=100 > rig2.dbc\n",
    .max_words = 1,
    .table = {scene_options},
};

static const struct usage dissector_usage = {
    .name = "dissector",
    .words = "[SCENE]",
    .summary =
        "Prints a dissector for Wireshark: the messages of a plant by name and unit, with checksum, missing\n"
        "frames, refusals, and each answer beside its command; and the packets of cannelloni on UDP ports\n"
        "20000 to 20003. Give the SCENE and options that contactplant run got. Put the file into the folder\n"
        "~/.local/lib/wireshark/plugins, or name it by -X lua_script:FILE.",
    .words_help = SCENE_WORDS_HELP,
    .examples = "  contactplant dissector > contactplant.lua\n"
                "  contactplant export run.log --out run.pcapng\n"
                "  tshark -X lua_script:contactplant.lua -r run.pcapng -Y \"contactplant.cause != 0\"\n",
    .max_words = 1,
    .table = {scene_options},
};

static const struct usage scene_usage = {
    .name = "scene",
    .words = "SCENE",
    .summary =
        "Prints a scene as a file to edit: every key with its value, unit, range and meaning. A file is\n"
        "checked, too. Warns if the scene is in a range that its source paper left.",
    .words_help = "SCENE is a model, a preset (contactplant list scenes) or a file (docs/guide/scenes.md).\n",
    .examples = "  contactplant scene rig > my.ini\n"
                "  contactplant scene my.ini\n"
                "  contactplant simulate my.ini --out run.csv\n",
    .min_words = 1,
    .max_words = 1,
};

static void print_parameters(const struct parameter *p, int n)
{
    printf("    %-24s %-9s %12s %12s %12s  %s\n", "name", "unit", "min", "max", "default", "meaning");
    for (int i = 0; i < n; i++)
        printf("    %-24s %-9s %12.6g %12.6g %12.6g  %s\n", p[i].name, *p[i].unit ? p[i].unit : "-", p[i].min,
               p[i].max, p[i].initial, p[i].meaning);
}

static void print_signals(const char *title, const struct signal *s, int n)
{
    printf("  %s\n", title);
    for (int i = 0; i < n; i++)
        printf("    %-24s %-9s %s\n", s[i].name, s[i].unit, s[i].meaning);
}

static void list_models(void)
{
    for (int i = 0; i < MODELS; i++) {
        const struct model *m = model_table[i];
        printf("model %s: %s\n  parameters (--set, SI)\n", m->name, m->title);
        print_parameters(m->parameter, m->n_parameters);
        if (m->paper) {
            printf("  parameters of the paper (simulate --units model)\n");
            print_parameters(m->paper, m->n_paper);
        }
        print_signals("inputs (--drive, --noise, arm, stream)", m->input_signal, m->n_inputs);
        print_signals("states", m->state_signal, m->n_states);
        print_signals("outputs", m->output_signal, m->n_outputs);
    }
}

static void print_scenes(int begin, int end)
{
    for (int i = begin; i < end; i++)
        printf("    %-22s %s\n", scenes_table[i].name, scenes_table[i].title);
}

static void list_scenes(void)
{
    printf("scenes to begin with (run, simulate; scene prints one)\n");
    print_scenes(0, SCENES_OWN);
    printf("%d more are figures of papers: contactplant list papers\n", SCENES - SCENES_OWN);
}

static void list_papers(void)
{
    printf("scenes that are figures of papers (run, simulate; scene prints one)\n");
    print_scenes(SCENES_OWN, SCENES);
}

static void list_settings(void)
{
    printf("settings (--setting, send set)\n");
    print_parameters(setting_table, SETTINGS);
}

static void list_microscope(void)
{
    printf("numbers of the microscope (scan and thermal --set, contactplant_afm_set, test)\n");
    print_parameters(station_number, STATION_NUMBERS);
    printf("  of its converters (contactplant_afm_set; run microscope takes all but xy_m_per_V)\n");
    print_parameters(codes_number, CODES_NUMBERS);
    print_signals("signals of a test", test_afm_view.output_signal, test_afm_view.n_outputs);
    printf("  parameters as a plant (run microscope): those of afm_lever, the numbers above, and\n");
    print_parameters(&afm_plant.parameter[AFM_PLANT_SCAN], AFM_PLANT_DITHER_GAIN - AFM_PLANT_SCAN);
    print_signals("inputs as a plant", afm_plant.input_signal, afm_plant.n_inputs);
    print_signals("outputs as a plant", afm_plant.output_signal, afm_plant.n_outputs);
}

static void list_methods(void)
{
    printf("methods (--method)\n");
    for (int i = 0; i < METHODS; i++)
        printf("    %-13s order %d  %s\n", method_table[i]->name, method_table[i]->order,
               method_table[i]->title);
}

static void list_messages(void)
{
    printf("messages (offset from --base-id, bits of the frame, see docs/reference/message_tables.md)\n");
    for (unsigned kind = 0; kind < WIRE_KINDS; kind++) {
        const struct message_layout *l = wire_layout(kind);
        if (!l)
            continue;
        printf("  0x%02X %-14s %s, %s\n", kind, names_kind(kind),
               l->command ? "to the plant" : "from the plant", l->meaning);
        for (int i = 0; i < l->n_fields; i++)
            printf("         %-14s bits %2u..%2u  %-5s %s\n", l->field[i].name, l->field[i].start,
                   l->field[i].start + l->field[i].bits - 1u, l->field[i].unit, l->field[i].meaning);
    }
}

static void list_counters(void)
{
    printf("counters (HEALTH)\n");
    for (int i = 0; i < DIAG_COUNTERS; i++)
        printf("    %-20s %-9s %s\n", diag_name[i].name, diag_name[i].unit, diag_name[i].meaning);
}

static void list_metrics(void)
{
    static const char *const of[] = {"contacts, by located switches: METRIC",
                                     "a signal at each tick: SIGNAL.METRIC, or SIGNAL alone at every instant",
                                     "the signal of target =: METRIC", "the controller: METRIC",
                                     "the run: METRIC"};
    printf("metrics (test: expect METRIC OP VALUE); SIGNAL is an output, command_INPUT, drive_frequency or\n"
           "eigenfrequency, U its unit\n");
    for (int i = 0; i < METRICS; i++) {
        const struct metric *m = &metric_table[i];
        if (i == 0 || m->of != m[-1].of)
            printf("  of %s\n", of[m->of]);
        printf("    %-14s %-9s %s\n", m->name, *m->unit ? m->unit : "-", m->meaning);
    }
}

static const struct {
    const char *name;
    void (*print)(void);
} part[] = {{"models", list_models},     {"scenes", list_scenes},         {"papers", list_papers},
            {"settings", list_settings}, {"microscope", list_microscope}, {"methods", list_methods},
            {"messages", list_messages}, {"counters", list_counters},     {"metrics", list_metrics}};

enum { PARTS = sizeof part / sizeof part[0] };

static int no_part(const char *text)
{
    const char *name[PARTS];
    for (int i = 0; i < PARTS; i++)
        name[i] = part[i].name;
    return options_misuse(&list_usage, "nothing called \"%s\"%s", text,
                          options_advise(text, strlen(text), name, PARTS, NULL));
}

int cmd_list(int argc, char **argv)
{
    struct options o;
    int status, printed = 0;
    if (!options_parse(&o, &list_usage, argc, argv, &status))
        return status;
    for (int i = 0; i < PARTS; i++)
        if (!o.n_words || !strcmp(o.word[0], part[i].name)) {
            part[i].print();
            printed++;
        }
    if (!printed)
        return no_part(o.word[0]);
    return STATUS_DONE;
}

int cmd_scene(int argc, char **argv)
{
    struct options o;
    struct scene s;
    struct harmonic drive[MODEL_INPUTS];
    double si[MODEL_PARAMETERS];
    char why[SCENE_REASON];
    int status;
    if (!options_parse(&o, &scene_usage, argc, argv, &status))
        return status;
    enum scene_origin origin = scene_load(o.word[0], &s, why);
    if (origin == SCENE_OF_NOTHING)
        return options_misuse(&scene_usage, "%s", why);
    scenes_resolve(&s, si, drive);
    scene_print(stdout, origin == SCENE_OF_PRESET ? scenes_find(o.word[0])->title : s.model->title, &s);
    scene_load_warn("scene", s.model, si, drive);
    return STATUS_DONE;
}

/* A table of the bus of a scene. */
static int print_bus(const struct usage *u, int argc, char **argv,
                     void (*print)(FILE *out, const struct bus_scene *s))
{
    struct options o;
    struct scene_app s = {.scratch = NULL};
    int status;
    if (!options_parse(&o, u, argc, argv, &status))
        return status;
    status = scene_open(&s, &o, 0, NULL);
    if (!status)
        print(stdout, &(struct bus_scene){.model = s.config.model,
                                          .wire = s.app.scene,
                                          .f0_Hz = scene_resonance_Hz(&s) * s.config.dilation});
    scene_free(&s);
    return status;
}

int cmd_dbc(int argc, char **argv)
{
    return print_bus(&dbc_usage, argc, argv, dbc_print);
}

int cmd_dissector(int argc, char **argv)
{
    return print_bus(&dissector_usage, argc, argv, dissector_print);
}
