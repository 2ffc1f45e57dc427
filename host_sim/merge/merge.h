/* merge.h - the parts of one result, which several machines have computed. */
#ifndef HOST_SIM_MERGE_H
#define HOST_SIM_MERGE_H

#include "host_sim/maps/share.h"
#include "host_sim/merge/lines.h"

enum part_kind { PART_MAP, PART_JUNIT, PART_JSON, PART_KINDS };

struct part {
    const char *path;
    enum part_kind kind;
    bool is_share; /* else it is a report of a whole command, and share has nothing */
    struct share_told share;
    bool cut; /* its end is missing */
};

enum { MERGE_SUMMARY = 96 };

struct merge {
    const struct options *o;
    struct part *part; /* [n], shares in their order */
    int n;
    FILE *out;
    char summary[MERGE_SUMMARY]; /* how much that is, in words */
};

/* Says what is wrong with this line of a part; returns the exit status. */
static inline int merge_refuse(const struct merge *m, const struct part *p, const struct lines *l,
                               const char *why)
{
    return options_misuse(m->o->usage, "%s:%ld: %s", p->path, l->number, why);
}

#endif
