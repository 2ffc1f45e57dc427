/* log_record.c - see log_record.h. */
#include "host_sim/fit/data/log_record.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/fit/data/log_drives.h"
#include "host_sim/listen/decode_rows.h"
#include "host_sim/out/plural.h"
#include "host_sim/replay/plant_log.h"
#include "host_sim/scene/scene.h"

enum {
    LOG_ROWS = 20000, /* frames of a part */
    LOG_LEAST = 32,
    LOG_TICKS = 8000,    /* plant ticks in a fit's run through the record */
    LOG_FINE = 40,       /* ticks in a period of the contact */
    LOG_ROWS_LEAST = 400 /* though they are more ticks */
};

/* Why a part is no record: the later ones are nearer to one. */
enum flaw { FLAW_SHORT, FLAW_SILENT, FLAW_UNKNOWN, FLAW_NOISE, FLAW_TWO, FLAW_GAPS, FLAWS };

struct part {
    uint64_t first; /* plant frame of row 0 */
    int n;
    double y[DECODE_OUTPUTS][LOG_ROWS];
    double u[MODEL_INPUTS][LOG_ROWS]; /* the sample in the frame before a row; NaN: not told */
    unsigned beyond[LOG_ROWS];        /* bit i: output i was beyond the bus's range */
    unsigned streamed;                /* bit i: samples of input i came */
};

struct reading {
    struct scene_app app;
    struct plant_log log;
    struct decode rows;
    struct log_drives drives;
    struct part part;
    int rows_most;
    int values; /* in the record so far */
    uint64_t first_tick, beyond;
    enum flaw flaw;
    struct record record;
};

/* ---- parts ---- */

static void begin_part(struct reading *g)
{
    g->part.n = 0;
    g->part.streamed = 0;
    for (int i = 0; i < MODEL_INPUTS; i++)
        for (int k = 0; k < LOG_ROWS; k++)
            g->part.u[i][k] = (double)NAN;
}

static void take_row(struct reading *g, const struct decode_row *row)
{
    struct part *p = &g->part;
    uint32_t substeps = g->app.config.substeps;
    uint64_t frame = row->tick / substeps;
    if (row->tick % substeps || row->tick < g->drives.settled_tick)
        return;
    if (!p->n)
        p->first = frame;
    if (frame < p->first + (uint64_t)p->n || frame - p->first >= (uint64_t)g->rows_most)
        return;
    int at = (int)(frame - p->first);
    for (; p->n <= at; p->n++) {
        p->beyond[p->n] = p->n == at ? row->beyond : 0;
        for (int i = 0; i < DECODE_OUTPUTS; i++)
            p->y[i][p->n] = p->n == at ? row->value[i] : (double)NAN;
    }
}

/* A sample that acts in this plant frame. */
static void take_sample(struct reading *g, int input, double frame, double value)
{
    struct part *p = &g->part;
    uint64_t now = g->rows.row.tick / g->app.config.substeps, at = listen_nearest(now, frame, 16) + 1;
    p->streamed |= 1u << input;
    if (p->n && at >= p->first && at - p->first < LOG_ROWS)
        p->u[input][at - p->first] = value;
}

/* The longest run of samples that are told: its first row, and *n. */
static int longest_run(const double *u, int rows, int *n)
{
    int first = 0, best = 0;
    *n = 0;
    for (int i = 0; i <= rows; i++) {
        if (i < rows && !isnan(u[i]))
            continue;
        if (i - first > *n) {
            *n = i - first;
            best = first;
        }
        first = i + 1;
    }
    return best;
}

static bool sounds(const struct reading *g, int input)
{
    double largest = fabs(g->drives.tone[input].value[ARM_AMPLITUDE]);
    for (int i = 0; i < g->part.n && (g->part.streamed >> input & 1u); i++)
        largest = fmax(largest, isnan(g->part.u[input][i]) ? 0.0 : fabs(g->part.u[input][i]));
    return largest > 0.0;
}

/* The one input that is driven, or why it is none. */
static enum flaw find_input(const struct reading *g, int *input)
{
    int n = 0;
    for (int i = 0; i < g->app.config.model->n_inputs; i++) {
        if (!log_drives_knows(&g->drives, i))
            return FLAW_UNKNOWN;
        if (g->drives.tone[i].value[ARM_NOISE] > 0.0)
            return FLAW_NOISE;
        n += sounds(g, i);
        *input = sounds(g, i) ? i : *input;
    }
    return n == 0 ? (g->drives.echoes ? FLAW_SILENT : FLAW_UNKNOWN) : n > 1 ? FLAW_TWO : FLAWS;
}

/* Rows first to first + n of the part become the record, if they have more values than it. */
static void keep(struct reading *g, int input, int first, int n)
{
    struct record *r = &g->record;
    const struct part *p = &g->part;
    const struct log_tone *tone = &g->drives.tone[input];
    uint32_t substeps = g->app.config.substeps;
    int output = 0;
    while (output + 1 < DECODE_OUTPUTS && record_count(p->y[output] + first, n) < LOG_LEAST)
        output++;
    int values = record_count(p->y[output] + first, n);
    if (values < LOG_LEAST || values <= g->values)
        return;
    double dilation = g->app.config.dilation;
    bool velocity = g->app.config.model->output_signal[output].quantity == QUANTITY_VELOCITY;
    g->values = values;
    g->first_tick = (p->first + (uint64_t)first) * substeps;
    g->beyond = 0;
    r->n = n;
    r->input = input;
    r->output = output;
    r->step_s = substeps * g->drives.tick_s / dilation;
    r->floor = g->app.app.scene.lsb[output] / sqrt(12.0);
    r->jumps = g->app.setting[SET_STREAM_LINEAR + input] == 0.0;
    for (int i = 0; i < n; i++) {
        r->y[i] = p->y[output][first + i] * (velocity ? dilation : 1.0);
        r->u[i] = p->streamed >> input & 1u ? p->u[input][first + i] : 0.0;
        g->beyond += p->beyond[first + i] >> output & 1u;
    }
    double phase = log_drives_phase(&g->drives, input, g->first_tick);
    r->tone = (struct record_tone){.amplitude = tone->value[ARM_AMPLITUDE],
                                   .frequency_Hz = tone->value[ARM_FREQUENCY] * dilation,
                                   .phase_rad = isnan(phase) ? 0.0 : phase,
                                   .phase_known = !isnan(phase)};
}

/* The part ends here, and its drive was as told up to this tick. */
static void end_part(struct reading *g, uint64_t holds_tick)
{
    struct part *p = &g->part;
    while (p->n && p->first + (uint64_t)p->n - 1 > holds_tick / g->app.config.substeps)
        p->n--;
    int input = 0, first = 0, n = p->n;
    enum flaw flaw = n < LOG_LEAST ? FLAW_SHORT : find_input(g, &input);
    if (flaw == FLAWS && (p->streamed >> input & 1u)) {
        first = longest_run(p->u[input], p->n, &n);
        flaw = n < LOG_LEAST ? FLAW_GAPS : flaw;
    }
    if (flaw == FLAWS)
        keep(g, input, first, n);
    g->flaw = flaw > g->flaw ? flaw : g->flaw;
    begin_part(g);
}

static void take(struct reading *g, const struct message *m)
{
    struct decode_row row;
    unsigned run = g->rows.row.run;
    struct log_drives before = g->drives, now;
    bool ends = log_drives_take(&g->drives, m, g->rows.row.tick);
    if (m->kind >= WIRE_STREAM && m->kind < WIRE_STREAM + MODEL_INPUTS)
        take_sample(g, m->kind - WIRE_STREAM, m->value[STREAM_FRAME], m->value[STREAM_SAMPLE]);
    if (m->kind >= WIRE_STREAM_ECHO && m->kind < WIRE_STREAM_ECHO + MODEL_INPUTS)
        take_sample(g, m->kind - WIRE_STREAM_ECHO, m->value[STREAM_ECHO_FRAME], m->value[STREAM_ECHO_SAMPLE]);
    if (decode_take(&g->rows, m, &row))
        take_row(g, &row);
    if (ends || g->rows.row.run != run) {
        now = g->drives;
        g->drives = before; /* the part is judged by the drive that acted in it */
        end_part(g, ends ? now.holds_tick : UINT64_MAX);
        g->drives = now;
    }
    if (g->rows.row.run != run)
        log_drives_begin(&g->drives, g->app.app.plant.tick_s);
}

/* ---- the log ---- */

static int start_plant(struct reading *g, const struct options *o)
{
    char why[SCENE_REASON];
    if (scene_init(&g->app, o->word[0], why) && scene_take_identifiers(&g->app, o, why) &&
        scene_start(&g->app, NULL, why))
        return 0;
    return options_misuse(o->usage, "%s", why);
}

/* So many rows that a fit takes a short time. */
static int find_rows_most(const struct reading *g)
{
    double frame_s = g->app.config.frame_s, periods = scene_resonance_Hz(&g->app) * frame_s;
    double rows = LOG_TICKS / fmax(1.0, ceil(LOG_FINE * periods));
    return (int)fmin(fmax(rows, LOG_ROWS_LEAST), LOG_ROWS);
}

static int refuse(const struct options *o, const struct reading *g)
{
    static const char *const why[FLAWS + 1] = {
        [FLAW_SHORT] = "no part of 32 frames in which the plant runs and its drive does not change",
        [FLAW_SILENT] = "nothing drives the plant",
        [FLAW_UNKNOWN] = "the drive is not told: record until DRIVE_ECHO has told all of it, some seconds",
        [FLAW_NOISE] = "a drive has noise, which the log does not tell; silence it",
        [FLAW_TWO] = "two inputs are driven; drive one",
        [FLAW_GAPS] = "too many samples of STREAM are missing",
        [FLAWS] = "fewer than 32 values of a motion while the drive does not change",
    };
    if (!g->rows.begun)
        return options_misuse(o->usage, "%s has no SYNC of this plant; is its --base-id another one?",
                              g->log.reader.path);
    return options_misuse(o->usage, "%s: %s", g->log.reader.path, why[g->flaw]);
}

/* On stderr: the rows that were taken, and what was left out. */
static void tell(const struct options *o, const struct reading *g)
{
    const struct record *r = &g->record;
    const char *command = o->usage->name, *name = g->app.config.model->output_signal[r->output].name;
    plant_log_tell(&g->log, command);
    decode_tell_missing(&g->rows, command, r->path);
    if (!g->drives.echoes)
        fprintf(stderr, "contactplant %s: %s has no DRIVE_ECHO: its drive is taken to be STREAM alone\n",
                command, r->path);
    if (g->beyond)
        fprintf(stderr, "contactplant %s: %s: %llu value%s of %s beyond the bus's range: left out\n", command,
                r->path, (unsigned long long)g->beyond, plural((double)g->beyond), name);
    fprintf(stderr, "contactplant %s: %s: %d frames from %.6g s on, %d values of %s, driven by %s\n", command,
            r->path, r->n, (double)g->first_tick * g->drives.tick_s, g->values, name,
            g->app.config.model->input_signal[r->input].name);
}

static int read_rows(const struct options *o, struct reading *g)
{
    struct decode_row last;
    struct log_line line;
    struct message m;
    int got;
    decode_begin(&g->rows, &g->app.app.scene, g->app.app.plant.tick_s);
    log_drives_begin(&g->drives, g->app.app.plant.tick_s);
    begin_part(g);
    while ((got = plant_log_next(&g->log, &line, &m)) > 0)
        if (m.kind != WIRE_KINDS)
            take(g, &m);
    if (got < 0)
        return options_misuse(o->usage, "%s", g->log.reader.reason);
    decode_end(&g->rows, &last);
    if (g->rows.begun)
        take_row(g, &last);
    end_part(g, UINT64_MAX);
    if (!g->values)
        return refuse(o, g);
    g->record.size = record_deviation(g->record.y, g->record.n);
    if (!(g->record.size > 0.0))
        return options_misuse(o->usage, "%s: nothing moves in this log", g->log.reader.path);
    tell(o, g);
    return 0;
}

/* The CRC-32 of the file goes on. A pipe was read before, and has none. */
static void add_crc(const char *path, uint32_t *crc)
{
    uint8_t block[4096];
    FILE *f = fopen(path, "rb");
    for (size_t n; f && (n = fread(block, 1, sizeof block, f)) > 0;)
        *crc = wire_crc32(*crc, block, (int)n);
    if (f)
        (void)fclose(f);
}

int log_record_read(const struct options *o, const char *path, uint32_t *crc, struct records *all)
{
    if (all->n == RECORDS)
        return options_misuse(o->usage, "%s: more than %d records; give fewer", path, RECORDS);
    struct reading *g = calloc(1, sizeof *g);
    double *y = calloc(LOG_ROWS, sizeof *y), *u = calloc(LOG_ROWS, sizeof *u);
    int status = g && y && u ? 0 : options_failure(o->usage, "out of memory");
    if (!status) {
        g->record = (struct record){.path = path, .y = y, .u = u};
        status = start_plant(g, o);
    }
    if (!status) {
        const char *why = plant_log_open(&g->log, path, options_text(o, "interface", 0), &g->app.app.scene);
        g->rows_most = find_rows_most(g);
        status = why ? options_misuse(o->usage, "%s", why) : read_rows(o, g);
        if (!why)
            plant_log_close(&g->log);
        add_crc(path, crc);
    }
    all->record[all->n++] = g ? g->record : (struct record){.y = y, .u = u};
    if (g)
        scene_free(&g->app);
    free(g);
    return status;
}
