/* options_nearest.c - see options_nearest.h. */
#include "host_sim/cli/options_nearest.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { MISSPELT = 24, WORD = 64 };

/* Names are compared without regard to capitals. */
static bool same(char a, char b)
{
    return tolower((unsigned char)a) == tolower((unsigned char)b);
}

static bool begins(const char *name, const char *text, size_t n)
{
    size_t i = 0;
    while (i < n && name[i] && same(name[i], text[i]))
        i++;
    return i == n;
}

/* Letters to change, insert, delete or swap (optimal string alignment), for words shorter than MISSPELT. */
static int distance(const char *a, const char *b)
{
    int n = (int)strlen(a), m = (int)strlen(b), d[MISSPELT + 1][MISSPELT + 1];
    if (n > MISSPELT || m > MISSPELT)
        return MISSPELT;
    for (int i = 0; i <= n; i++) {
        for (int j = 0; j <= m; j++) {
            if (!i || !j) {
                d[i][j] = i + j;
                continue;
            }
            int best = d[i - 1][j - 1] + !same(a[i - 1], b[j - 1]);
            best = d[i - 1][j] + 1 < best ? d[i - 1][j] + 1 : best;
            best = d[i][j - 1] + 1 < best ? d[i][j - 1] + 1 : best;
            if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]) &&
                d[i - 2][j - 2] + 1 < best)
                best = d[i - 2][j - 2] + 1;
            d[i][j] = best;
        }
    }
    return d[n][m];
}

/* The first name that begins with the text; `whole`: with all of a word, so that the unit was left out. */
static const char *beginning(const char *text, const char *const *name, int n, bool whole)
{
    size_t length = strlen(text);
    for (int i = 0; i < n && length > 0; i++)
        if (begins(name[i], text, length) && (!whole || strchr("_-", name[i][length])))
            return name[i];
    return NULL;
}

/* The first name with the text as one of its words: contact_force for force. */
static const char *with_word(const char *text, const char *const *name, int n)
{
    size_t length = strlen(text);
    for (int i = 0; i < n && length > 0; i++)
        for (const char *at = strpbrk(name[i], "_.- "); at; at = strpbrk(at + 1, "_.- "))
            if (begins(at + 1, text, length) && !isalnum((unsigned char)at[1 + length]))
                return name[i];
    return NULL;
}

const char *options_nearest(const char *text, const char *const *name, int n)
{
    const char *forgotten = beginning(text, name, n, true), *nearest = NULL, *word;
    int best = 1 + (int)strlen(text) / 2; /* further away is no misspelling */
    for (int i = 0; i < n; i++) {
        int d = distance(text, name[i]);
        if (d < best)
            best = d, nearest = name[i];
    }
    if (nearest && best == 0)
        return nearest;
    if (forgotten)
        return forgotten;
    if (nearest && best == 1)
        return nearest;
    word = with_word(text, name, n);
    return word ? word : nearest ? nearest : beginning(text, name, n, false);
}

const char *options_advise_in(char *advice, size_t size, const char *text, size_t n_text,
                              const char *const *name, int n, const char *hint)
{
    char own[WORD];
    snprintf(own, sizeof own, "%.*s", n_text < WORD ? (int)n_text : WORD - 1, text);
    const char *nearest = options_nearest(own, name, n);
    if (nearest || hint) {
        snprintf(advice, size, "; %s%s%s", nearest ? "did you mean " : "", nearest ? nearest : hint,
                 nearest ? "?" : "");
        return advice;
    }
    size_t length = (size_t)snprintf(advice, size, "; there %s", n == 1 ? "is" : "are");
    for (int i = 0; i < n; i++) {
        bool more = i > 0, fits = length + strlen(name[i]) + sizeof ", , .." < size;
        length +=
            (size_t)snprintf(advice + length, size - length, "%s %s", more ? "," : "", fits ? name[i] : "..");
        if (!fits)
            break;
    }
    return advice;
}
