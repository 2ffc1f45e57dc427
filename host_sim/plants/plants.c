/* plants.c - see plants.h. */
#include "firmware/bus/wire_table.h"
#include "firmware/plant/plant_report.h"
#include "host_sim/beside/beside.h"
#include "host_sim/plants/plants.h"
#include "host_sim/cli/trouble.h"
#include "host_sim/cli/names.h"
#include "host_sim/commands.h"
#include "host_sim/out/utf8.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { URGENT = WIRE_CONTROL + 1 }; /* FIRE, ENABLE and CONTROL: the lowest identifiers */

/* ---- the list ---- */

/* The scene of the next line that has one; `line` counts. False at the end of the file. */
static bool next_scene(FILE *f, char name[PLANTS_NAME], int *line)
{
    char text[PLANTS_NAME];
    while (fgets(text, sizeof text, f)) {
        char *begin = text + (*line ? 0 : utf8_mark(text, strlen(text)));
        begin += strspn(begin, " \t\r\n");
        ++*line;
        begin[strcspn(begin, "#\r\n")] = 0;
        size_t n = strlen(begin);
        while (n > 0 && strchr(" \t", begin[n - 1]))
            begin[--n] = 0;
        memcpy(name, begin, n + 1);
        if (n)
            return true;
    }
    return false;
}

/* Options that speak of one plant. */
static int check_options(const struct options *o)
{
    static const char *const single[] = {"log", "log-limit", "report", "scope", "json", "fail-on"};
    for (size_t i = 0; i < sizeof single / sizeof *single; i++)
        if (options_given(o, single[i]))
            return options_misuse(o->usage, "--%s is for one plant; take it or --plants away", single[i]);
    return o->n_words ? options_misuse(o->usage, "--plants names the scenes; take %s away", o->word[0]) : 0;
}

/* The plants of a bus have one period, and their identifiers follow each other. */
static bool join(const struct plants *p, int i, char *why)
{
    struct app_config *c = &p->one[i].scene.config;
    double period_s = p->one[0].scene.config.frame_s;
    uint32_t last = c->extended ? 0x1FFFFFFFu : 0x7FFu, n = (last - c->base_id + 1) / FRAME_IDS;
    c->base_id += (uint32_t)i * FRAME_IDS;
    if ((uint32_t)i >= n)
        snprintf(why, SCENE_REASON,
                 "identifiers are left for %u plants only; give --extended or a lower --base-id", n);
    else if (fabs(c->frame_s - period_s) > 1e-9 * period_s)
        snprintf(why, SCENE_REASON, "it has %g frames a second and the first plant %g; give --rate for all",
                 1.0 / c->frame_s, 1.0 / period_s);
    else
        return true;
    return false;
}

static int allocate(struct plants *p, int n, const struct options *o)
{
    p->one = calloc((size_t)n, sizeof *p->one);
    p->part = calloc((size_t)n, sizeof *p->part);
    p->n = p->one ? n : 0;
    return p->one && p->part ? 0 : options_failure(o->usage, "out of memory");
}

static int read_list(struct plants *p, FILE *f, const char *path, const struct options *o)
{
    char name[PLANTS_NAME], why[SCENE_REASON];
    int n = 0, line = 0;
    while (next_scene(f, name, &line))
        n++;
    if (n < 1 || n > PLANTS_MAX)
        return options_misuse(o->usage, "%s names %d scenes; give 1 to %d, one in each line", path, n,
                              PLANTS_MAX);
    int status = allocate(p, n, o);
    rewind(f);
    line = 0;
    for (int i = 0; i < n && !status && next_scene(f, p->one[i].name, &line); i++)
        if (!scene_from_name(&p->one[i].scene, o, p->one[i].name, why) || !join(p, i, why))
            status = options_misuse(o->usage, "%s:%d: %s: %s", path, line, p->one[i].name, why);
    return status;
}

int plants_read(struct plants *p, const struct options *o)
{
    const char *path = options_text(o, "plants", 0);
    if (!path) {
        int status = allocate(p, 1, o);
        return status ? status : scene_from_options(&p->one->scene, o, 0) ? 0 : STATUS_MISUSED;
    }
    int status = check_options(o);
    FILE *f = status ? NULL : fopen(path, "r");
    if (!f)
        return status ? status : options_misuse(o->usage, "cannot read %s: %s", path, strerror(errno));
    status = read_list(p, f, path, o);
    (void)fclose(f);
    return status;
}

int plants_start(struct plants *p, const struct hal *bus, const struct options *o)
{
    const struct app_config *c = &p->one[0].scene.config;
    char why[SCENE_REASON];
    share_init(&p->share, bus, p->part, (uint32_t)p->n, c->base_id, c->extended ? FRAME_EXTENDED : 0, URGENT);
    for (int i = 0; i < p->n; i++)
        if (!scene_start(&p->one[i].scene, p->n > 1 ? &p->part[i].hal : bus, why))
            return options_misuse(o->usage, "%s%s%s", p->one[i].name, *p->one[i].name ? ": " : "", why);
    return 0;
}

/* ---- frames ---- */

bool plants_due(const struct plants *p)
{
    bool due = false;
    for (int i = 0; i < p->n; i++)
        due = due || p->one[i].due > 0;
    return due;
}

void plants_begin(struct plants *p, uint32_t begun)
{
    for (int i = 0; i < p->n; i++) {
        struct plants_one *one = &p->one[i];
        bool waited = one->due == 0; /* one of the periods is that of its next frame, none missed */
        if (!waited || begun > 0)
            one->due = app_overrun(&one->scene.app, begun - waited);
    }
}

void plants_collect(struct plants *p)
{
    if (p->n > 1)
        share_collect(&p->share);
}

void plants_flush(struct plants *p)
{
    if (p->n > 1)
        share_flush(&p->share);
}

static bool go_together(const struct plants_one *a, const struct plants_one *b)
{
    const struct plant *one = &a->scene.app.plant, *other = &b->scene.app.plant;
    return a->due > 0 && b->due > 0 && one->model == other->model && one->method == other->method;
}

int plants_together(const struct plants *p, int i)
{
    int n = 1;
    while (n < SIDES && i + n < p->n && go_together(&p->one[i], &p->one[i + n]))
        n++;
    return n;
}

void plants_frames(struct plants *p, int i, int n)
{
    struct app *app[SIDES] = {NULL};
    if (p->one[i].due == 0)
        return;
    for (int k = 0; k < n; k++)
        app[k] = &p->one[i + k].scene.app;
    app_frames(app, (uint32_t)n, beside_bind);
    for (int k = 0; k < n; k++) {
        p->one[i + k].faults |= app[k]->faults;
        p->one[i + k].due--;
    }
}

/* ---- what they have done ---- */

static const char *state_of(const struct plants_one *one)
{
    return names_text(one->scene.config.model, NAMES_STATE, (unsigned)one->scene.app.state);
}

void plants_states(const struct plants *p, char *text, size_t size)
{
    int count[STATE_FAULT + 1] = {0};
    const char *name[STATE_FAULT + 1] = {NULL};
    size_t n = 0;
    for (int i = 0; i < p->n; i++) {
        count[p->one[i].scene.app.state]++;
        name[p->one[i].scene.app.state] = state_of(&p->one[i]);
    }
    *text = 0;
    for (int i = 0; i <= STATE_FAULT && n < size; i++)
        if (count[i])
            n += (size_t)snprintf(text + n, size - n, "%s%d %s", n ? ", " : "", count[i], name[i]);
}

void plants_report(const struct plants *p)
{
    for (int i = 0; i < p->n; i++) {
        const struct plants_one *one = &p->one[i];
        const struct app *a = &one->scene.app;
        char faults[TROUBLE_TEXT];
        trouble_note_faults(one->faults, faults);
        printf("0x%X %s: %s, plant time %.6f s, hash %016llx, faults %u%s, missed %u\n",
               one->scene.config.base_id, one->name, state_of(one), plant_time(&a->plant),
               (unsigned long long)plant_hash(&a->plant), one->faults, faults, a->count[DIAG_FRAMES_MISSED]);
    }
}

void plants_free(struct plants *p)
{
    for (int i = 0; i < p->n; i++)
        scene_free(&p->one[i].scene);
    free(p->one);
    free(p->part);
    *p = (struct plants){0};
}
