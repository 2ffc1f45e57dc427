/* scope_logs.c - see scope_logs.h. */
#include "host_sim/scope/scope_logs.h"
#include "host_sim/cli/clock.h"
#include "host_sim/commands.h"
#include "host_sim/scope/hub.h"
#include "host_sim/scope/scope_child.h"
#include "host_sim/view/view.h"

#include <stdlib.h>

static enum http_status ask(void *context, const struct http_request *r, struct json *j, const char **why)
{
    switch (view_answer(context, r->target, r->query, j, why)) {
    case VIEW_DONE:
        return HTTP_OK;
    case VIEW_BAD:
        return HTTP_BAD;
    default:
        return HTTP_NOT_FOUND;
    }
}

/* A log is no plant: what belongs to one cannot be had. */
static int check_options(const struct options *o)
{
    static const char *const of_plants[] = {"bus", "peer", "control", "log"};
    for (size_t i = 0; i < sizeof of_plants / sizeof of_plants[0]; i++)
        if (options_given(o, of_plants[i]))
            return options_misuse(
                o->usage, "--open shows a log, and --%s is for a plant; leave one of them out", of_plants[i]);
    return o->n_words > 1 ? options_misuse(o->usage, "with --open there is one SCENE, that of the logs") : 0;
}

static int serve(struct hub *h, struct view *v, const struct options *o)
{
    const char *at = options_text(o, "http", 0);
    double duration = options_number(o, "duration");
    h->server.site.ask = ask;
    h->server.site.context = v;
    int status = hub_open(h, o, at ? at : SCOPE_AT);
    clock_catch_signals();
    double end = clock_now_s() + duration;
    while (!status && !clock_interrupted() && !(duration > 0.0 && clock_now_s() >= end)) {
        view_turn(v);
        hub_turn(h);
    }
    return status;
}

int scope_logs(const struct options *o)
{
    struct view *v = calloc(1, sizeof *v);
    struct hub *h = calloc(1, sizeof *h);
    int status = v && h ? check_options(o) : options_failure(o->usage, "out of memory");
    if (!status) {
        h->server.socket = -1;
        status = view_open(v, o);
        status = status ? status : serve(h, v, o);
        hub_close(h, "the scope has ended");
        view_close(v);
    }
    free(h);
    free(v);
    return status;
}
