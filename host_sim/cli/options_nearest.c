/* options_nearest.c - the name that was meant; see options.h. It prints nothing, and the library uses it,
 * too. */
#include "host_sim/cli/options.h"

#include <string.h>

enum { MISSPELT = 24 };

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
            int best = d[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            best = d[i - 1][j] + 1 < best ? d[i - 1][j] + 1 : best;
            best = d[i][j - 1] + 1 < best ? d[i][j - 1] + 1 : best;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] && d[i - 2][j - 2] + 1 < best)
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
        if (!strncmp(name[i], text, length) && (!whole || name[i][length] == '_'))
            return name[i];
    return NULL;
}

const char *options_nearest(const char *text, const char *const *name, int n)
{
    const char *forgotten = beginning(text, name, n, true), *nearest = NULL;
    int best = 1 + (int)strlen(text) / 2; /* further away is no misspelling */
    if (forgotten)
        return forgotten;
    for (int i = 0; i < n; i++) {
        int d = distance(text, name[i]);
        if (d < best)
            best = d, nearest = name[i];
    }
    return nearest ? nearest : beginning(text, name, n, false);
}
