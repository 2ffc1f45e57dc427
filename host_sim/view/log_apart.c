/* log_apart.c - see log_apart.h. */
#include "host_sim/view/log_apart.h"

struct side {
    struct log_walk walk;
    struct decode_row row;
    int got; /* as decode_log_next */
};

static void begin(struct side *s, const struct log_index *x)
{
    s->walk = x->walk;
    s->walk.mark = NULL;
    s->got = log_walk_go(&s->walk, &x->block[0]->place) ? log_walk_next(&s->walk, &s->row) : -1;
}

/* Which row is of an earlier time: below 0 that of a, above 0 that of b, 0 neither. */
static int order(const struct decode_row *a, const struct decode_row *b)
{
    if (a->run != b->run)
        return a->run < b->run ? -1 : 1;
    return (a->tick > b->tick) - (a->tick < b->tick);
}

static struct decode_row difference(const struct decode_row *a, const struct decode_row *b)
{
    struct decode_row row = *a;
    row.contact_known = false;
    row.beyond = 0;
    for (int i = 0; i < DECODE_SIGNALS; i++)
        row.value[i] = a->value[i] - b->value[i];
    return row;
}

const char *log_apart(struct log_index *x, const struct log_index *a, const struct log_index *b)
{
    static struct side first, second;
    const char *why = log_index_begin(x, a->tick_s);
    begin(&first, a);
    begin(&second, b);
    while (!why && first.got > 0 && second.got > 0) {
        int before = order(&first.row, &second.row);
        if (!before) {
            struct decode_row row = difference(&first.row, &second.row);
            why = log_index_add(x, &row);
        }
        if (before <= 0)
            first.got = log_walk_next(&first.walk, &first.row);
        if (before >= 0)
            second.got = log_walk_next(&second.walk, &second.row);
    }
    return why ? why : log_index_end(x);
}
