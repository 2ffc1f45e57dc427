/* shell.c - see shell.h. */
#include "host_sim/cli/shell.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%";

void shell_pass(struct shell_place *p, char c)
{
    if (p->escaped)
        p->escaped = false;
    else if (c == '\\' && p->quote != '\'')
        p->escaped = true;
    else if (p->quote)
        p->quote = c == p->quote ? 0 : p->quote;
    else if (c == '\'' || c == '"')
        p->quote = c;
}

bool shell_is_protected(const struct shell_place *p)
{
    return p->quote || p->escaped;
}

/* The length of the first word; 0 where an operator makes the line more than one command. */
static size_t first_word(const char *line)
{
    struct shell_place at = {0, false};
    size_t n = 0, i = 0;
    for (; line[i]; i++) {
        if (!shell_is_protected(&at) && strchr(";&|(){}!`\n", line[i]))
            return 0;
        if (!n && !shell_is_protected(&at) && strchr(" \t", line[i]))
            n = i;
        shell_pass(&at, line[i]);
    }
    return n ? n : i;
}

static bool is_in_path(const char *word, size_t n)
{
    char file[PATH_MAX];
    const char *path = getenv("PATH");
    for (path = path ? path : ""; *path; path += strspn(path, ":")) {
        size_t length = strcspn(path, ":");
        snprintf(file, sizeof file, "%.*s/%.*s", (int)length, path, (int)n, word);
        if (access(file, X_OK) == 0)
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

void shell_put(FILE *f, struct shell_place at, const char *text)
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
    shell_put(f, (struct shell_place){0, false}, word);
}
