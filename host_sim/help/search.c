/* search.c - see search.h. */
#include "host_sim/help/search.h"

#include "host_sim/cli/paragraph.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool has_all(const char *text, const char *const *word, int n)
{
    for (int i = 0; i < n; i++)
        if (!strcasestr(text, word[i]))
            return false;
    return true;
}

/* The line goes on in the next one: neither ends a paragraph or is a row, a heading or code. */
static bool goes_on(const char *line, const char *next)
{
    return *line && *next && !strchr("|#", *line) && !strchr("|#-", *next) && strncmp(next, "    ", 4) &&
           strncmp(next, "```", 3);
}

/* A heading's text into heading[PAGES_LINE], where the line is one. */
static void take_heading(const char *line, char *heading)
{
    size_t n = strspn(line, "#");
    if (n > 0 && line[n] == ' ')
        snprintf(heading, PAGES_LINE, "%s", line + n + 1);
}

/* Ends the line at `at` and returns the next one. */
static char *cut(char *at)
{
    char *end = strchrnul(at, '\n');
    char *next = *end ? end + 1 : end;
    *end = '\0';
    return next;
}

int search_page(const struct pages *p, int page, const char *const *word, int n_words)
{
    char heading[PAGES_LINE] = "", both[2 * PAGES_LINE];
    char *text = pages_read(p, page), *line = text;
    int found = 0;
    bool fenced = false, told = false;
    if (!text)
        return -1;
    for (char *next = cut(line), *after; *line || *next; line = next, next = after) {
        after = *next ? cut(next) : next;
        fenced ^= !strncmp(line, "```", 3);
        if (!fenced)
            take_heading(line, heading);
        bool alone = has_all(line, word, n_words), joined = !told && !fenced && goes_on(line, next);
        snprintf(both, sizeof both, "%.*s%s%.*s", PAGES_LINE - 1, line, joined && !alone ? " " : "",
                 PAGES_LINE - 1, joined && !alone ? next : "");
        told = alone || (joined && has_all(both, word, n_words) && !has_all(next, word, n_words));
        if (told)
            found += printf("%s: %s: %s\n", p->name[page], heading, both + strspn(both, " ")) > 0;
    }
    free(text);
    return found;
}

/* The cells of a row without the bars; false for a line that is none. */
static bool cut_row(char *line, char **message, char **advice)
{
    char *end = strncmp(line, "| ", 2) ? NULL : strstr(line + 2, " | ");
    if (!end)
        return false;
    *end = '\0';
    *message = line + 2;
    *advice = end + 3;
    (*advice)[strcspn(*advice, "|")] = '\0';
    return true;
}

int search_messages(const struct pages *p, int page, const char *text, const char *const *word, int n_words)
{
    char *all = pages_read(p, page), *end = all ? all + strlen(all) : NULL, *message, *advice;
    int found = 0;
    for (char *line = all, *next; line && line < end; line = next) {
        next = cut(line);
        if (!cut_row(line, &message, &advice) ||
            (!strcasestr(text, message) && !has_all(message, word, n_words)))
            continue;
        printf("%s\n", message);
        paragraph_print(stdout, 2, "", "-> %s", advice);
        found++;
    }
    free(all);
    return found;
}
