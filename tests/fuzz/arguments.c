/* arguments.c - the command line: options, numbers, units
 * and fault lists; taken or refused, never out of bounds. */
#include "firmware/bus/settings.h"
#include "hal/link/loopback.h"
#include "host_sim/cli/options.h"
#include "host_sim/cli/unit.h"
#include "host_sim/live/action.h"
#include "host_sim/live/fault_list.h"
#include "models/hertz_rig.h"
#include "tests/fuzz/fuzz.h"

#include <math.h>
#include <string.h>

enum { ARGUMENTS = 128, BYTES = 4096 };

static const struct option own[] = {
    {"set", "NAME=VALUE", "", OPTION_TEXT, .many = true},
    {"rate", "HZ", "", OPTION_NUMBER, 1e-3, 1e6, .initial = "1000"},
    {"substeps", "N", "", OPTION_INTEGER, 1, 4096, .initial = "64"},
    {.name = "force", .meaning = ""},
    {.name = NULL},
};
static const struct usage usage = {
    .name = "fuzz", .words = "[SCENE]", .summary = "", .examples = "", .max_words = 3, .table = {own}};

/* The input's lines as arguments. */
static void read_options(char *text)
{
    char *argv[ARGUMENTS] = {text};
    struct options o;
    int argc = 1, status = -1;
    for (char *at = strtok(text, "\n"); at && argc < ARGUMENTS; at = strtok(NULL, "\n"))
        argv[argc++] = at;
    if (!options_parse(&o, &usage, argc, argv, &status)) {
        MUST(status == 0 || status == 2);
        return;
    }
    double rate = options_number(&o, "rate"), substeps = options_number(&o, "substeps");
    MUST(rate >= 1e-3 && rate <= 1e6);
    MUST(substeps >= 1.0 && substeps <= 4096.0 && substeps == floor(substeps));
    MUST(o.n_words >= 0 && o.n_words <= 3);
}

/* The words of every verb, for a plant. */
static void read_actions(const char *text)
{
    static struct action a;
    char why[SCENE_REASON];
    for (int verb = 0; verb < ACTION_VERBS; verb++) {
        bool good =
            action_read(&hertz_rig, (enum action_verb)verb, (struct word){text, strlen(text)}, &a, why);
        MUST(good == !*why && memchr(why, 0, sizeof why) && memchr(a.text, 0, sizeof a.text));
        MUST(a.n >= 0 && a.n <= ACTION_SETS && a.input >= 0 && a.input < hertz_rig.n_inputs);
        for (int i = 0; good && i < a.n; i++)
            MUST(a.set[i].index < SETTING_FIRST + SETTINGS && isfinite(a.set[i].value));
    }
}

static void read_values(const char *text)
{
    static const char *const unit[] = {"kg", "N/m^1.5", "N s/m", "m", "1", "", "Hz", "rad"};
    static struct loopback_bus wires;
    static struct faults faults;
    char why[FAULT_LIST_REASON], reason[UNIT_REASON], again[UNIT_TEXT];
    double value, back;
    for (size_t i = 0; i < sizeof unit / sizeof unit[0]; i++) {
        if (!unit_read(text, strlen(text), unit[i], &value, reason))
            continue;
        MUST(isfinite(value));
        unit_write(value, unit[i], again);
        MUST(unit_read(again, strlen(again), unit[i], &back, reason) && back == value);
    }
    loopback_init(&wires, 2, 8);
    faults.n_rules = 0;
    if (!fault_list_read(&faults, text, 1e-3, why))
        MUST(why[0] && strlen(why) < sizeof why);
    MUST(faults.n_rules <= FAULTS_RULES);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char text[BYTES];
    size_t n = size < BYTES - 1 ? size : BYTES - 1;
    memcpy(text, data, n);
    text[n] = '\0';
    if (!freopen("/dev/null", "w", stdout)) /* --help is long */
        return 0;
    read_values(text);
    read_actions(text);
    read_options(text);
    return 0;
}
