/* scene.c - a scene file: refused with a line that names a
 * place, or taken, printed and read back to the last bit. */
#include "host_sim/scene/scene_file.h"
#include "host_sim/scene/scene_print.h"
#include "tests/fuzz/fuzz.h"

#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct scene s, again, untouched;
    char why[SCENE_FILE_REASON] = "", *text = NULL;
    size_t n = 0;
    memset(&s, 0, sizeof s);
    memset(&again, 0, sizeof again);
    memset(&untouched, 0, sizeof untouched);
    if (!scene_file_parse("my.ini", (const char *)data, size, &s, why)) {
        MUST(!strncmp(why, "my.ini", 6) && !strchr(why, '\n') && strlen(why) < sizeof why);
        MUST(!memcmp(&s, &untouched, sizeof s));
        return 0;
    }
    FILE *out = open_memstream(&text, &n);
    MUST(out);
    scene_print(out, "again", &s);
    MUST(!fclose(out));
    if (!scene_file_parse("again.ini", text, n, &again, why)) {
        fprintf(stderr, "%s\n%s\n", why, text);
        MUST(!"what was printed is read back");
    }
    MUST(s.model == again.model && !strcmp(s.method, again.method) && s.paper == again.paper);
    MUST(!memcmp(s.value, again.value, sizeof s.value) && !memcmp(s.start, again.start, sizeof s.start));
    MUST(!memcmp(s.drive, again.drive, sizeof s.drive));
    MUST(s.observable == again.observable && s.over == again.over && s.tolerance == again.tolerance);
    MUST(s.frame_s == again.frame_s && s.substeps == again.substeps && s.dilation == again.dilation);
    MUST(s.cost_s == again.cost_s);
    free(text);
    return 0;
}
