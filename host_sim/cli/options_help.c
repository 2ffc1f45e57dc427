/* options_help.c - see options_help.h. */
#include "host_sim/cli/options_help.h"

#include <stdio.h>
#include <string.h>

enum { COLUMN = 30 };

typedef void print_one(const char *name, const char *argument, const char *meaning);

static void each_option(const struct usage *u, print_one *print)
{
    for (int t = 0; t < OPTIONS_TABLES && u->table[t]; t++)
        for (const struct option *p = u->table[t]; p->name; p++)
            print(p->name, p->argument, p->meaning);
    print("help", NULL, "print this and exit");
}

static void print_option(const char *name, const char *argument, const char *meaning)
{
    int n = printf("  --%s%s%s", name, argument ? " " : "", argument ? argument : "");
    printf("%*s%s\n", n < COLUMN - 1 ? COLUMN - n : 2, "", meaning);
}

static void print_help(const struct usage *u)
{
    printf("usage: contactplant %s%s%s [OPTIONS]\n\n%s\n", u->name, *u->words ? " " : "", u->words,
           u->summary);
    if (u->words_help)
        printf("\n%s", u->words_help);
    printf("\noptions:\n");
    each_option(u, print_option);
    printf("\nexamples:\n%s", u->examples);
}

void options_print_roff(const char *text)
{
    bool begins = true; /* a line: no request may */
    for (; *text; begins = *text++ == '\n') {
        if (begins && (*text == '.' || *text == '\''))
            fputs("\\&", stdout);
        if (*text == '\\')
            fputs("\\e", stdout);
        else if (*text == '-')
            fputs("\\-", stdout);
        else
            putchar(*text);
    }
}

static void print_roff_option(const char *name, const char *argument, const char *meaning)
{
    printf(".TP\n\\fB\\-\\-");
    options_print_roff(name);
    printf("\\fR");
    if (argument) {
        printf(" \\fI");
        options_print_roff(argument);
        printf("\\fR");
    }
    putchar('\n');
    options_print_roff(meaning);
    putchar('\n');
}

/* Lines as they are. */
static void print_roff_lines(const char *text)
{
    size_t length = strlen(text);
    printf(".PP\n.nf\n");
    options_print_roff(text);
    printf("%s.fi\n", length > 0 && text[length - 1] == '\n' ? "" : "\n");
}

static void print_man(const struct usage *u)
{
    printf(".SS contactplant ");
    options_print_roff(u->name);
    printf(" ");
    options_print_roff(u->words);
    printf(" [OPTIONS]\n");
    options_print_roff(u->summary);
    putchar('\n');
    if (u->words_help)
        print_roff_lines(u->words_help);
    each_option(u, print_roff_option);
    print_roff_lines(u->examples);
}

static void print_word(const char *name, const char *argument, const char *meaning)
{
    (void)argument, (void)meaning;
    printf(" --%s", name);
}

/* A scene, or the words in small letters that may stand there. */
static void print_own_words(const char *words)
{
    if (strstr(words, "SCENE"))
        printf(" $scenes");
    for (size_t n; *words; words += n ? n : 1) {
        n = strspn(words, "abcdefghijklmnopqrstuvwxyz");
        if (n > 1)
            printf(" %.*s", (int)n, words);
    }
}

/* A case of a shell for an option whose placeholder is a list: model|si. */
static void print_values(const char *name, const char *argument, const char *meaning)
{
    (void)meaning;
    if (!argument || !strchr(argument, '|') || argument[strspn(argument, "abcdefghijklmnopqrstuvwxyz_|")])
        return;
    printf("    --%s) words=\"", name);
    for (; *argument; argument++)
        putchar(*argument == '|' ? ' ' : *argument);
    printf("\" ;;\n");
}

bool options_help(const struct usage *u, const char *word)
{
    if (!strcmp(word, "--help") || !strcmp(word, "-h"))
        print_help(u);
    else if (!strcmp(word, "--help=man"))
        print_man(u);
    else if (!strcmp(word, "--help=words")) {
        print_own_words(u->words);
        each_option(u, print_word);
    } else if (!strcmp(word, "--help=values"))
        each_option(u, print_values);
    else
        return false;
    return true;
}
