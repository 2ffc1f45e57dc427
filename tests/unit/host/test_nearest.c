/* test_nearest.c - the name that was meant, and what a refusal ends with; the right answers are a reader's.
 */
#include "host_sim/cli/options.h"
#include "host_sim/cli/options_nearest.h"
#include "tests/unit/test.h"

#include <string.h>

static const char *const signals[] = {"penetration",    "displacement", "contact_force", "force.amplitude",
                                      "mass_kg",        "f0_Hz",        "rk4",           "rk4_float32",
                                      "bbp-fig2-force", "bbp-fig3"};
enum { SIGNALS = sizeof signals / sizeof signals[0] };

static const struct {
    const char *text, *meant; /* NULL: nothing is near */
} meant_table[] = {
    {"RK4", "rk4"},
    {"Penetration", "penetration"},
    {"DISPLACMENT", "displacement"},
    {"force", "contact_force"},
    {"Force", "contact_force"},
    {"amplitude", "force.amplitude"},
    {"mass", "mass_kg"},
    {"MASS", "mass_kg"},
    {"f0", "f0_Hz"},
    {"bbp-fig2", "bbp-fig2-force"},
    {"rk5", "rk4"},
    {"penetratoin", "penetration"},
    {"disp", "displacement"},
    {"orce", NULL},
    {"xyz", NULL},
    {"", NULL},
};

TEST(nearest_name)
{
    for (size_t i = 0; i < sizeof meant_table / sizeof meant_table[0]; i++) {
        const char *got = options_nearest(meant_table[i].text, signals, SIGNALS);
        check_string(meant_table[i].text, got ? got : "none",
                     meant_table[i].meant ? meant_table[i].meant : "none");
    }
}

TEST(nearest_advice)
{
    static const char *const few[] = {"udp", "can"};
    check_string("near", options_advise("UDPX", 3, few, 2, "see --help"), "; did you mean udp?");
    check_string("a hint", options_advise("file", 4, few, 2, "see --help"), "; see --help");
    check_string("all", options_advise("file", 4, few, 2, NULL), "; there are udp, can");
    check_string("one", options_advise("file", 4, few, 1, NULL), "; there is udp");
    const char *many[60];
    for (int i = 0; i < 60; i++)
        many[i] = "displacement";
    const char *text = options_advise("file", 4, many, 60, NULL);
    check_is("a list that is too long, letters", strlen(text), <, (size_t)OPTIONS_ADVICE);
    check_string("ends after a whole name", strstr(text, "..") - 14, "displacement, ..");
}
