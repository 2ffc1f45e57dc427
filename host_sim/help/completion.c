/* completion.c - see completion.h. */
#include "host_sim/help/completion.h"
#include "firmware/bus/settings.h"
#include "firmware/method/method.h"
#include "host_sim/help/advice.h"
#include "host_sim/scene/scene_name.h"
#include "models/scenes/scenes_table.h"

#include <stdbool.h>
#include <stdio.h>

/* Every model's entries of a list, each name once. */
static void print_all(enum field_names list, const char *end)
{
    struct named n;
    for (int m = 0; m < SCENE_MODELS; m++)
        for (unsigned i = 0;
             names_get(scene_model(m), list, i, &n) && (list != NAMES_PARAMETER || i < SETTING_FIRST); i++) {
            bool again = false;
            for (int before = 0; before < m; before++)
                again = again || names_find(scene_model(before), list, n.name) >= 0;
            if (!again)
                printf(" %s%s", n.name, end);
        }
}

/* Parameters by the scene, which is the second word of most lines. */
static void print_parameters(void)
{
    printf("    --set) compopt -o nospace 2>/dev/null; case ${COMP_WORDS[2]} in\n");
    for (int m = 0; m < SCENE_MODELS; m++) {
        const struct model *model = scene_model(m);
        printf("        %s", model->name);
        for (int i = 0; i < SCENES; i++)
            if (scenes_table[i].scene.model == model)
                printf("|%s", scenes_table[i].name);
        printf(") words=\"");
        for (int i = 0; i < model->n_parameters; i++)
            printf(" %s=", model->parameter[i].name);
        printf("\" ;;\n");
    }
    printf("        *) words=\"");
    print_all(NAMES_PARAMETER, "=");
    printf("\" ;;\n        esac ;;\n");
}

void completion_print_names(void)
{
    printf("    local scenes=\"");
    for (int i = 0; i < SCENE_MODELS; i++)
        printf("%s ", scene_model(i)->name);
    for (int i = 0; i < SCENES; i++)
        printf("%s ", scenes_table[i].name);
    printf("\"\n    case ${COMP_WORDS[COMP_CWORD-1]} in\n    --method) words=\"");
    for (int i = 0; i < METHODS; i++)
        printf(" %s", method_table[i]->name);
    printf("\" ;;\n    --model) words=$scenes ;;\n");
    print_parameters();
    printf("    --setting) compopt -o nospace 2>/dev/null; words=\"");
    for (int i = 0; i < SETTINGS; i++)
        printf(" %s=", setting_table[i].name);
    printf("\" ;;\n    --drive|--noise) compopt -o nospace 2>/dev/null; words=\"");
    print_all(NAMES_INPUT, "=");
    printf("\" ;;\n    --observable) words=\"");
    print_all(NAMES_OUTPUT, "");
    printf("\" ;;\n    --errors) words=\"");
    for (int i = 0; advice_name(i); i++)
        printf(" %s", advice_name(i));
    printf("\" ;;\n    help|man) words=$(\"${COMP_WORDS[0]}\" help 2>/dev/null | sed -n '/^pages (/,$s/^  "
           "\\([^ ]*\\) .*/\\1/p')\n"
           "        words=\"$words --help --search --errors\" ;;\n");
}
