/* view.c - see view.h. */
#include "host_sim/view/view.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include "host_sim/cli/clock.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/trouble.h"
#include "host_sim/replay/decode_signals.h"
#include "host_sim/version.h"

enum { VIEW_CONTRACT = 1, RUNS_TOLD = 1000, NUMBER_TEXT = 32, LONG_LOG = 100000000 };

static const double look_every_s = 0.5;

static const char *const mark_name[LOG_MARKS] = {
    [LOG_MARK_TOUCHDOWN] = "touchdown", [LOG_MARK_LIFTOFF] = "liftoff", [LOG_MARK_REFUSAL] = "refusal",
    [LOG_MARK_FAULT] = "fault",         [LOG_MARK_OVERRUN] = "overrun", [LOG_MARK_MISSING] = "missing",
    [LOG_MARK_SESSION] = "session",     [LOG_MARK_STATE] = "state",
};

/* ---- the query ---- */

/* The number of NAME=NUMBER in a query. */
static bool query_number(const char *query, const char *name, double *value)
{
    size_t n = strlen(name);
    for (const char *at = query; at; at = strchr(at, '&') ? strchr(at, '&') + 1 : NULL) {
        char text[NUMBER_TEXT];
        size_t length = strcspn(at, "&");
        if (strncmp(at, name, n) != 0 || at[n] != '=' || length - n - 1 >= sizeof text)
            continue;
        memcpy(text, at + n + 1, length - n - 1);
        text[length - n - 1] = '\0';
        return options_read_number(text, value);
    }
    return false;
}

/* A whole number of the query from 0 to most. */
static bool query_index(const char *query, const char *name, unsigned most, unsigned *value)
{
    double x;
    if (!query_number(query, name, &x) || !(x >= 0.0 && x <= most) || x != floor(x))
        return false;
    *value = (unsigned)x;
    return true;
}

static struct log_index *query_log(struct view *v, const char *query, unsigned *run)
{
    unsigned i, most = v->n_logs < VIEW_LOGS ? 0 : VIEW_LOGS;
    if (!query_index(query, "log", most, &i) || !query_index(query, "run", 1u << 30, run))
        return NULL;
    return i == VIEW_LOGS ? &v->apart : &v->log[i].index;
}

/* ---- what there is ---- */

static void put_runs(struct json *j, const struct log_index *x)
{
    size_t first, end, last = 0;
    json_item(j, "'runs':[");
    for (size_t i = 0; i < x->n_blocks && last < RUNS_TOLD; i = end, last++) {
        unsigned run = x->block[i]->run;
        (void)log_index_run(x, run, &first, &end);
        json_item(j, "{'run':%u,'from':%t,'to':%t}", (uint64_t)run, (double)x->block[i]->from * x->tick_s,
                  (double)x->block[end - 1]->to * x->tick_s);
    }
    json_put(j, "]");
}

static void put_states(struct json *j, const struct model *m)
{
    json_item(j, "'states':[");
    for (unsigned i = 0; names_text(m, NAMES_STATE, i); i++)
        json_item(j, "%s", names_text(m, NAMES_STATE, i));
    json_put(j, "],'faults':[");
    for (int i = 0; i < TROUBLE_FAULTS; i++)
        json_item(j, "%s", trouble_fault[i].name);
    json_put(j, "]");
}

static void put_signals(struct json *j, const struct model *m)
{
    char name[DECODE_NAME];
    json_item(j, "'signals':[");
    for (int i = 0; i < decode_signals(m); i++) {
        decode_name(m, i, name);
        json_item(j, "{'name':%s,'unit':%s}", name, decode_signal(m, i)->unit);
    }
    json_put(j, "]");
}

static void put_log(struct view *v, struct json *j)
{
    const struct model *m = v->scene.config.model;
    json_put(j, "{'contract':%u,'version':%s,'model':%s,'contacts':%u,'tick_s':%t,'frame_s':%t",
             (uint64_t)VIEW_CONTRACT, VERSION_TEXT, m->name, (uint64_t)m->n_contacts,
             v->scene.app.plant.tick_s, v->scene.config.frame_s);
    put_signals(j, m);
    put_states(j, m);
    json_item(j, "'logs':[");
    for (int i = 0; i < v->n_logs; i++) {
        const struct log_index *x = &v->log[i].index;
        json_item(j, "{'name':%s,'rows':%u,'missing':%u,'step_s':%t", v->log[i].path, x->rows,
                  x->walk.log.rows.missing,
                  x->step == UINT64_MAX ? (double)NAN : (double)x->step * x->tick_s);
        put_runs(j, x);
        json_item(j, "'lost':%s", v->log[i].lost ? v->log[i].lost : "");
        json_put(j, "}");
    }
    json_put(j, "],'follows':%b,'compared':%s,'part':%t", v->follows, v->course.text, v->part_s);
    json_item(j, "'allowed':[");
    for (int i = 0; i < decode_signals(m); i++)
        json_item(j, "%n", v->course.c.limit[i].tolerance);
    json_put(j, "]}");
}

/* ---- rows and marks ---- */

static void put_row(struct json *j, const struct model *m, const struct decode_row *r)
{
    json_item(j, "[%t,%u,%u", r->t_s, r->frame, r->tick);
    json_item(j, r->state >= 0 ? "%s" : "null",
              r->state >= 0 ? names_text(m, NAMES_STATE, (unsigned)r->state) : "");
    json_item(j, "%n", r->contact_known ? (double)r->closed : (double)NAN);
    json_item(j, "%u", (uint64_t)r->beyond);
    for (int i = 0; i < decode_signals(m); i++)
        json_item(j, "%n", r->value[i]);
    json_put(j, "]");
}

/* Text of what a mark says, for people. */
static void put_words(struct json *j, const struct model *m, const struct log_mark *k)
{
    const char *cause = names_text(m, NAMES_CAUSE, k->cause), *message = names_kind(k->what);
    const char *state = names_text(m, NAMES_STATE, k->what);
    switch (k->kind) {
    case LOG_MARK_REFUSAL:
        json_item(j, "'message':%s,'cause':%s", message ? message : "?", cause ? cause : "?");
        break;
    case LOG_MARK_STATE:
        json_item(j, "'state':%s", state ? state : "?");
        break;
    case LOG_MARK_TOUCHDOWN:
    case LOG_MARK_LIFTOFF:
        json_item(j, "'contact':%u,'speed':%n,'peak':%n", (uint64_t)k->what, k->speed, k->peak_force_N);
        break;
    case LOG_MARK_FAULT:
    case LOG_MARK_SESSION:
        json_item(j, "'what':%u", (uint64_t)k->what);
        break;
    default:
        json_item(j, "'n':%n", k->n);
    }
}

static void put_mark(struct json *j, const struct model *m, const struct log_mark *k)
{
    json_item(j, "{'t':%e,'kind':%s", k->t_s, mark_name[k->kind]);
    put_words(j, m, k);
    json_put(j, "}");
}

/* ---- a range ---- */

static void put_band(struct json *j, const struct log_range *r, int k, bool high)
{
    json_item(j, "[");
    for (int i = 0; i < r->n_columns; i++)
        json_item(j, "%n", high ? r->column[i].band[k].high : r->column[i].band[k].low);
    json_put(j, "]");
}

static void put_bands(struct json *j, const struct log_range *r, int n)
{
    json_item(j, "'bands':{");
    for (int k = 0; k < LOG_SIGNALS; k++) {
        bool any = false;
        for (int i = 0; i < r->n_columns && (k < n || k == LOG_SPEED); i++)
            any = any || !isnan(r->column[i].band[k].low);
        if (!any)
            continue;
        if (k == LOG_SPEED)
            json_item(j, "'speed':[");
        else
            json_item(j, "'%u':[", (uint64_t)k);
        put_band(j, r, k, false);
        put_band(j, r, k, true);
        json_put(j, "]");
    }
    json_put(j, "}");
}

/* A number of each column. */
enum lane { LANE_ROWS, LANE_CLOSED, LANE_STATE, LANE_SESSION, LANE_FAULTS, LANE_BEYOND, LANES };
static const char *const lane_name[LANES] = {"rows", "closed", "state", "session", "faults", "beyond"};

static double lane_of(const struct log_bin *b, int lane)
{
    const double value[LANES] = {
        [LANE_ROWS] = b->rows,
        [LANE_CLOSED] = b->known ? (double)b->closed / b->known : (double)NAN,
        [LANE_STATE] = b->state == LOG_NO_STATE ? (double)NAN : b->state,
        [LANE_SESSION] = b->session,
        [LANE_FAULTS] = b->faults,
        [LANE_BEYOND] = b->beyond,
    };
    return b->rows || lane == LANE_ROWS ? value[lane] : (double)NAN;
}

static void put_lanes(struct json *j, const struct log_range *r)
{
    for (int lane = 0; lane < LANES; lane++) {
        json_item(j, "'%r':[", lane_name[lane]);
        for (int i = 0; i < r->n_columns; i++)
            json_item(j, "%n", lane_of(&r->column[i].bin, lane));
        json_put(j, "]");
    }
}

/* For each kind the columns that have some, and how many. */
static void put_counts(struct json *j, const struct log_range *r)
{
    json_item(j, "'counts':{");
    for (int k = 0; k < LOG_MARKS; k++) {
        json_item(j, "'%r':[", mark_name[k]);
        for (int i = 0; i < r->n_columns; i++)
            if (r->column[i].bin.n[k])
                json_item(j, "[%u,%u]", (uint64_t)i, (uint64_t)r->column[i].bin.n[k]);
        json_put(j, "]");
    }
    json_put(j, "}");
}

static void put_range(struct json *j, const struct model *m, const struct log_range *r, double tick_s)
{
    json_put(j, "{'from':%t,'to':%t,'columns':%u,'size':%u", r->from * tick_s, r->to * tick_s,
             (uint64_t)r->n_columns, (uint64_t)r->size);
    put_bands(j, r, decode_signals(m));
    put_lanes(j, r);
    put_counts(j, r);
    if (r->has_rows && r->n_rows <= 2 * r->n_columns) {
        json_item(j, "'row':[");
        for (int i = 0; i < r->n_rows; i++)
            put_row(j, m, &r->row[i]);
        json_put(j, "]");
    }
    if (r->has_marks) {
        json_item(j, "'marks':[");
        for (int i = 0; i < r->n_marks; i++)
            put_mark(j, m, &r->mark[i]);
        json_put(j, "]");
    }
    json_put(j, "}");
}

/* ---- answers ---- */

static const char *answer_range(struct view *v, const char *query, struct json *j)
{
    struct log_range *r = &v->range;
    double from, to, pixels, tick_s = v->scene.app.plant.tick_s;
    const struct log_index *x = query_log(v, query, &r->run);
    if (!x || !query_number(query, "from", &from) || !query_number(query, "to", &to) || !(from < to) ||
        !query_number(query, "pixels", &pixels) || !(pixels >= 1.0 && pixels <= LOG_COLUMNS))
        return "write /range?log=0&run=0&from=0&to=1&pixels=800, with at most 1536 pixels";
    r->from = from / tick_s;
    r->to = to / tick_s;
    r->n_columns = (int)pixels;
    if (!log_range_read(x, r))
        return "this log has no such run, or cannot be read any more";
    put_range(j, v->scene.config.model, r, tick_s);
    return NULL;
}

static const char *answer_row(struct view *v, const char *query, struct json *j)
{
    struct decode_row row;
    unsigned run;
    double at;
    const struct log_index *x = query_log(v, query, &run);
    if (!x || !query_number(query, "at", &at))
        return "write /row?log=0&run=0&at=1.5";
    if (!log_range_row(x, run, at / x->tick_s + 1e-6, &row))
        return "this log has no such run, or cannot be read any more";
    put_row(j, v->scene.config.model, &row);
    return NULL;
}

static const char *answer_next(struct view *v, const char *query, struct json *j)
{
    struct log_mark m;
    unsigned run, back, kinds;
    double at;
    const struct log_index *x = query_log(v, query, &run);
    if (!x || !query_number(query, "at", &at) || !query_index(query, "back", 1, &back) ||
        !query_index(query, "kinds", (1u << LOG_MARKS) - 1, &kinds))
        return "write /next?log=0&run=0&at=1.5&back=0&kinds=7";
    if (log_range_mark(x, run, at, back, kinds, &m))
        put_mark(j, v->scene.config.model, &m);
    else
        json_put(j, "null");
    return NULL;
}

static const char *answer_log(struct view *v, const char *query, struct json *j)
{
    (void)query;
    put_log(v, j);
    return NULL;
}

static const struct {
    const char *target;
    const char *(*answer)(struct view *v, const char *query, struct json *j);
} targets[] = {{"/log", answer_log}, {"/range", answer_range}, {"/row", answer_row}, {"/next", answer_next}};

enum view_status view_answer(struct view *v, const char *target, const char *query, struct json *j,
                             const char **why)
{
    for (size_t i = 0; i < sizeof targets / sizeof targets[0]; i++)
        if (!strcmp(target, targets[i].target)) {
            *why = targets[i].answer(v, query, j);
            if (!*why && j->full)
                *why = "the answer is too long; ask for fewer pixels";
            return *why ? VIEW_BAD : VIEW_DONE;
        }
    return VIEW_UNKNOWN;
}

/* ---- opening ---- */

/* Which file stands there, and its size. False: none. */
static bool look_at(const struct view_log *l, uint64_t *file, uint64_t *bytes)
{
    struct stat s;
    bool there = stat(l->path, &s) == 0;
    *file = there ? (uint64_t)s.st_ino : 0;
    *bytes = there ? (uint64_t)s.st_size : 0;
    return there;
}

static int open_log(struct view *v, const struct options *o, int i)
{
    struct view_log *l = &v->log[i];
    const struct app *a = &v->scene.app;
    l->path = options_text(o, "open", i);
    if (look_at(l, &l->file, &l->bytes) && l->bytes > LONG_LOG)
        fprintf(stderr, "contactplant scope: reading %.1f GB of %s, twice\n", 1e-9 * (double)l->bytes,
                l->path);
    const char *why = log_index_open(&l->index, l->path, decode_interface(o, i), &a->scene, a->plant.tick_s);
    if (why)
        return options_failure(o->usage, "%s", why);
    v->n_logs++;
    if (!l->index.rows)
        return decode_no_rows(o, l->path);
    decode_log_tell(&l->index.walk.log, o->usage->name);
    return 0;
}

/* The first log's row less the second one's. */
static void take_pair(void *context, const struct decode_row *a, const struct decode_row *b)
{
    struct view *v = context;
    struct decode_row row = *a;
    row.contact_known = false;
    row.beyond = 0;
    for (int i = 0; i < DECODE_SIGNALS; i++)
        row.value[i] = a->value[i] - b->value[i];
    v->full = v->full || log_index_add(&v->apart, &row) != NULL;
}

static bool compare_more(struct view *v)
{
    compare_go_on(&v->course);
    v->full = v->full || log_index_end(&v->apart) != NULL;
    return !v->full;
}

/* How they are compared, before anything is read. */
static int set_compare(struct view *v, const struct options *o)
{
    struct compare_course *g = &v->course;
    const char *word[DECODE_SIGNALS];
    int n = options_count(o, "tolerance"), logs = options_count(o, "open");
    if (logs > VIEW_LOGS)
        return options_misuse(o->usage, "--open may be given once or twice");
    if (n && logs < VIEW_LOGS)
        return options_misuse(o->usage, "--tolerance is of two logs; give --open twice");
    if (n > DECODE_SIGNALS)
        return options_misuse(o->usage, "--tolerance may be given once for each signal");
    g->c = (struct compare){.scene = &v->scene, .end = UINT64_MAX, .part_s = &v->part_s};
    g->grow = v->follows;
    g->each = take_pair;
    g->context = v;
    for (int i = 0; i < logs; i++) {
        g->c.path[i] = options_text(o, "open", i);
        g->c.interface[i] = decode_interface(o, i);
    }
    for (int i = 0; i < n; i++)
        word[i] = options_text(o, "tolerance", i);
    return compare_allow(&g->c, o, word, n);
}

static int compare(struct view *v, const struct options *o)
{
    log_index_begin(&v->apart, v->scene.app.plant.tick_s);
    if (!compare_open(&v->course))
        return options_failure(o->usage, "%s", v->course.text);
    return compare_more(v) ? 0 : options_failure(o->usage, "out of memory");
}

int view_open(struct view *v, const struct options *o)
{
    int status = scene_open(&v->scene, o, 0, NULL);
    v->follows = options_given(o, "follow");
    v->part_s = (double)NAN;
    status = status ? status : set_compare(v, o);
    for (int i = 0; i < options_count(o, "open") && !status; i++)
        status = open_log(v, o, i);
    if (!status && v->n_logs == VIEW_LOGS)
        status = compare(v, o);
    return status;
}

/* ---- a log that grows ---- */

/* True where it has grown. */
static bool follow(struct view_log *l)
{
    uint64_t file = 0, bytes = 0;
    bool grown = false;
    if (!look_at(l, &file, &bytes))
        l->lost = "the file is gone";
    else if (file != l->file || bytes < l->bytes)
        l->lost = "the file was replaced; open it anew";
    else if ((grown = bytes > l->bytes))
        l->lost = log_index_more(&l->index);
    l->bytes = bytes;
    if (l->lost)
        fprintf(stderr, "contactplant scope: %s: %s\n", l->path, l->lost);
    return grown;
}

void view_turn(struct view *v)
{
    double now = clock_now_s();
    bool grown = false, lost = false;
    if (!v->follows || now < v->looked_s + look_every_s)
        return;
    for (int i = 0; i < v->n_logs; i++) {
        grown = (!v->log[i].lost && follow(&v->log[i])) || grown;
        lost = lost || v->log[i].lost;
    }
    if (grown && !lost && v->n_logs == VIEW_LOGS && !v->full && !compare_more(v))
        v->log[0].lost = "out of memory";
    v->looked_s = clock_now_s();
}

void view_close(struct view *v)
{
    for (int i = 0; i < v->n_logs; i++)
        log_index_close(&v->log[i].index);
    if (v->course.side[1].log.log.reader.file)
        compare_close(&v->course);
    log_index_close(&v->apart);
    scene_free(&v->scene);
}
