/* shell.c - see shell.h. */
#include "host_sim/cli/shell.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%";

/* The length of the first word; 0 where an operator makes the line more than one command. */
static size_t first_word(const char *line)
{
    struct quotes at = {0, false};
    size_t n = 0, i = 0;
    for (; line[i]; i++) {
        if (!quotes_protect(&at) && strchr(";&|(){}!`\n", line[i]))
            return 0;
        if (!n && !quotes_protect(&at) && strchr(" \t", line[i]))
            n = i;
        quotes_pass(&at, line[i]);
    }
    return n ? n : i;
}

/* A folder, as that of the word ".", can be entered, but not run. */
static bool can_run(const char *file)
{
    struct stat s;
    return !stat(file, &s) && S_ISREG(s.st_mode) && access(file, X_OK) == 0;
}

static bool is_in_path(const char *word, size_t n)
{
    char file[PATH_MAX];
    const char *path = getenv("PATH");
    for (path = path ? path : ""; *path; path += strspn(path, ":")) {
        size_t length = strcspn(path, ":");
        snprintf(file, sizeof file, "%.*s/%.*s", (int)length, path, (int)n, word);
        if (can_run(file))
            return true;
        path += length;
    }
    return false;
}

bool shell_is_program(const char *line)
{
    size_t n = first_word(line);
    if (!n || memchr(line, '=', n))
        return false;
    return memchr(line, '/', n) || is_in_path(line, n);
}

/* The text between single quotes. */
static void put_single(FILE *f, const char *text)
{
    for (; *text; text++)
        fputs(*text == '\'' ? "'\\''" : (char[]){*text, 0}, f);
}

static void put_double(FILE *f, const char *text)
{
    for (; *text; text++) {
        if (strchr("\"\\$`", *text))
            fputc('\\', f);
        fputc(*text, f);
    }
}

void shell_put(FILE *f, struct quotes at, const char *text)
{
    if (at.quote == '"') {
        put_double(f, text);
    } else if (at.quote) {
        put_single(f, text);
    } else if (*text && !text[strspn(text, plain)]) {
        fputs(text, f);
    } else {
        fputc('\'', f);
        put_single(f, text);
        fputc('\'', f);
    }
}

void shell_put_word(FILE *f, const char *word)
{
    fputc(' ', f);
    shell_put(f, (struct quotes){0, false}, word);
}
