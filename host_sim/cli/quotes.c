/* quotes.c - see quotes.h. */
#include "host_sim/cli/quotes.h"

void quotes_pass(struct quotes *p, char c)
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

bool quotes_protect(const struct quotes *p)
{
    return p->quote || p->escaped;
}
