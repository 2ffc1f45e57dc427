/* test_scan_part.c - a scan that was cut off is taken up by the same command alone: each number of its
 * surface counts. */
#include "host_sim/afm/scan_part.h"
#include "tests/unit/test.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static const int16_t heights[] = {1, 2, 3, 4, 5, 6, 7, 8};
static const struct usage usage = {.name = "scan"};
static struct afm_bench kept, other;

static void describe(struct afm_bench *b, int16_t *count, struct surface_grid grid)
{
    *b = (struct afm_bench){.usage = &usage, .tick_s = 1e-6, .count = count, .grid = grid};
    b->number[STATION_PIXELS] = 2.0;
    b->number[STATION_LINES] = 1.0;
}

TEST(scan_of_another_surface_is_not_taken_up)
{
    static const struct surface_grid same = {heights, 2, 4, 1e-6, 2e-6, 1e-12};
    static const struct {
        const char *name;
        struct surface_grid grid;
        bool taken;
    } surfaces[] = {{"the same", {heights, 2, 4, 1e-6, 2e-6, 1e-12}, true},
                    {"twice as high", {heights, 2, 4, 1e-6, 2e-6, 2e-12}, false},
                    {"twice as wide", {heights, 2, 4, 2e-6, 2e-6, 1e-12}, false},
                    {"twice as long", {heights, 2, 4, 1e-6, 4e-6, 1e-12}, false},
                    {"other lines", {heights, 4, 2, 1e-6, 2e-6, 1e-12}, false}};
    static struct scan_part p;
    static struct scan_image m;
    int16_t count[8];
    char folder[] = "/tmp/contactplant_scan_XXXXXX";
    for (int i = 0; i < 8; i++)
        count[i] = heights[i];
    check_true("folder", mkdtemp(folder) != NULL);
    describe(&kept, count, same);
    check_true("image", scan_alloc(&m, kept.number));
    check_int("opened", scan_part_open(&p, &kept, folder), 0);
    check_int("written", scan_part_write(&p, &kept, &m), 0);
    for (size_t i = 0; i < sizeof surfaces / sizeof surfaces[0]; i++) {
        bool found = false;
        describe(&other, count, surfaces[i].grid);
        int status = scan_part_read(&p, &other, &m, &found);
        printf("      a surface, %s\n", surfaces[i].name);
        check_int("is taken up", status == 0 && found, surfaces[i].taken);
    }
    scan_part_end(&p);
    scan_free(&m);
    (void)rmdir(folder);
}
