/* maps_run.c - see maps_run.h. */
#include "tests/maps_run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "tests/test.h"

enum { ARGUMENTS = 24, PATH = 64 };

static void write_file(const char *path, const char *text)
{
    FILE *f = fopen(path, "w");
    if (f) {
        fputs(text, f);
        fclose(f);
    }
}

int maps_run(int (*command)(int argc, char **argv), const char *scene, const char *arguments, int columns,
             struct maps_table *t)
{
    char directory[] = "/tmp/contactplant_maps_XXXXXX", file[PATH], out[PATH], option[PATH + 8], text[512];
    char name[] = "test", *argv[ARGUMENTS] = {name, file, option};
    int argc = 3;
    check_true("a directory of its own", mkdtemp(directory) != NULL);
    snprintf(file, sizeof file, "%s/scene.ini", directory);
    snprintf(out, sizeof out, "%s/out.csv", directory);
    snprintf(option, sizeof option, "--out=%s", out);
    snprintf(text, sizeof text, "%s", arguments);
    write_file(file, scene);
    for (char *c = strtok(text, " "); c && argc < ARGUMENTS; c = strtok(NULL, " "))
        argv[argc++] = c;
    int status = command(argc, argv);
    *t = (struct maps_table){.n = 0};
    if (status == 0)
        check_true("its rows can be read", maps_read(t, columns, out));
    unlink(out);
    unlink(file);
    rmdir(directory);
    return status;
}
