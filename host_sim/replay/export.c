/* export.c - contactplant export: recorded logs as pcapng. Every line is taken as it stands, those of others
 * too; a comment tells what a refusal, or a word of the recorder, means. */
#include "firmware/bus/wire_table.h"
#include "hal/posix/log_read.h"
#include "hal/posix/pcapng.h"
#include "host_sim/cli/names.h"
#include "host_sim/commands.h"
#include "host_sim/out/plural.h"
#include "host_sim/replay/decode_signals.h"
#include "host_sim/replay/plant_log.h"
#include "host_sim/version.h"

#include <string.h>
#include <unistd.h>

enum { LOGS = 2, COMMENT = 160, NAME = LOG_INTERFACE + 2 };

static const struct option export_options[] = {
    {"out", "FILE", "the packets (standard output, for a pipe into wireshark -k -i -)", OPTION_WRITES,
     .initial = NULL},
    {.name = NULL},
};

static const struct usage export_usage = {
    .name = "export",
    .words = "LOG [LOG]",
    .summary = "Writes recorded logs as pcapng: stamps in nanoseconds, the way of each frame, and a comment "
               "at each\n"
               "refusal. Frames of others are taken, too. Two logs become two interfaces, in order of time. "
               "decode,\n"
               "compare and replay read the file as they read a log.",
    .words_help = DECODE_LOG_WORDS,
    .examples = "  contactplant export run.log --out run.pcapng\n"
                "  contactplant export golden.log now.log --out both.pcapng\n"
                "  contactplant export run.log | wireshark -k -i -\n",
    .min_words = 1,
    .words_read = 2,
    .max_words = LOGS,
    .table = {export_options, decode_logs_options, scene_options},
};

struct source {
    struct plant_log log;
    int got; /* as plant_log_next, for: */
    struct log_line line;
    struct message message;
    uint64_t backwards; /* lines with an earlier stamp than the one before */
};

/* ---- a line ---- */

static void tell_refusal(const struct model *m, const struct message *reply, char text[COMMENT])
{
    const char *command = names_kind((unsigned)reply->value[REPLY_MESSAGE]);
    struct named cause;
    if (names_get(m, NAMES_CAUSE, (unsigned)reply->value[REPLY_CAUSE], &cause))
        snprintf(text, COMMENT, "refuses %s: %s, %s", command ? command : "a command", cause.name,
                 cause.meaning);
}

/* The text beside the packet, "" for none. */
static void comment_of(const struct model *m, const struct source *s, char text[COMMENT])
{
    const struct log_line *line = &s->line;
    const char *name;
    *text = 0;
    if (line->kind == LOG_DATA && line->fault)
        snprintf(text, COMMENT, "the plant reports faults 0x%02X of its bus", (unsigned)line->fault);
    else if (line->way == LOG_NO_ROOM && (name = names_kind(line->frame.id)) != NULL)
        snprintf(text, COMMENT, "%s was not sent: no room on the bus", name);
    else if (line->way == LOG_OVERRUN)
        snprintf(text, COMMENT, "%u frame periods were missed", (unsigned)line->missed);
    else if (line->way == LOG_BEGIN)
        snprintf(text, COMMENT, "here begins what a plant recorded");
    else if (line->way == LOG_TURN)
        snprintf(text, COMMENT, "the next frame went against its identifier");
    else if (s->message.kind == WIRE_REPLY && s->message.value[REPLY_CAUSE] != CAUSE_OK)
        tell_refusal(m, &s->message, text);
}

static void step(struct source *s)
{
    uint64_t before = s->line.time_us;
    s->got = plant_log_any(&s->log, &s->line, &s->message);
    s->backwards += s->got > 0 && s->line.time_us < before;
}

/* ---- the files ---- */

static int open_sources(struct source *s, int n, const struct options *o, const struct scene_app *scene)
{
    for (int i = 0; i < n; i++) {
        const char *why = plant_log_open(&s[i].log, o->word[i], decode_interface(o, i), &scene->app.scene);
        if (why) {
            while (i-- > 0)
                plant_log_close(&s[i].log);
            return options_failure(o->usage, "%s", why);
        }
        plant_log_tell_identity(&s[i].log, o->usage->name);
        step(&s[i]);
    }
    return 0;
}

/* The names of the interfaces: no two are equal. */
static void begin(FILE *f, struct source *s, int n)
{
    char name[LOGS][NAME];
    const char *names[LOGS];
    for (int i = 0; i < n; i++) {
        const char *of = *s[i].log.chosen ? s[i].log.chosen : s[i].line.interface;
        bool taken = i && !strcmp(of, names[0]);
        snprintf(name[i], NAME, "%.*s%s", LOG_INTERFACE - 1 - 2 * taken, of, taken ? "-2" : "");
        names[i] = name[i];
    }
    pcapng_begin(f, "contactplant " VERSION_TEXT, names, n);
}

/* The source of the earlier line, or NULL at the end of all. */
static struct source *earlier(struct source *s, int n)
{
    struct source *first = NULL;
    for (int i = 0; i < n; i++)
        if (s[i].got > 0 && (!first || s[i].line.time_us < first->line.time_us))
            first = &s[i];
    return first;
}

static int put_all(FILE *f, struct source *s, int n, const struct options *o, const struct model *m)
{
    struct source *now;
    char comment[COMMENT];
    begin(f, s, n);
    while ((now = earlier(s, n)) != NULL && !ferror(f)) {
        comment_of(m, now, comment);
        pcapng_put(f, (int)(now - s), now->line.time_us, now->line.way, &now->line.raw, comment);
        step(now);
    }
    for (int i = 0; i < n; i++)
        if (s[i].got < 0)
            return options_failure(o->usage, "%s", s[i].log.reader.reason);
    return 0;
}

static int write_all(struct source *s, int n, const struct options *o, const struct model *m)
{
    bool to_file = options_given(o, "out");
    if (!to_file && isatty(STDOUT_FILENO))
        return options_misuse(o->usage, "packets are no text for a terminal: give --out FILE, or a pipe");
    FILE *f = to_file ? options_create(o, "out") : stdout;
    if (!f)
        return STATUS_FAILED;
    int status = put_all(f, s, n, o, m), closed = options_close(o, "out", f, NULL);
    return status ? status : closed;
}

/* Every line was taken, so only those that could not be read are told. */
static void tell(const struct source *s, const char *command)
{
    const struct log_reader *r = &s->log.reader;
    uint64_t damaged = r->count[LOG_DAMAGED] + r->count[LOG_CUT];
    if (damaged)
        fprintf(stderr, "contactplant %s: %s: passed over %llu damaged line%s%s%s\n", command, r->path,
                (unsigned long long)damaged, plural((double)damaged), *r->damage ? "; the first is " : "",
                r->damage);
    if (r->elsewhere)
        fprintf(stderr, "contactplant %s: %s: passed over %llu line%s of other interfaces than %s\n", command,
                r->path, (unsigned long long)r->elsewhere, plural((double)r->elsewhere), s->log.chosen);
    if (s->backwards)
        fprintf(stderr, "contactplant %s: %s: time runs backwards %llu time%s; its stamps are kept\n",
                command, r->path, (unsigned long long)s->backwards, plural((double)s->backwards));
}

int cmd_export(int argc, char **argv)
{
    static struct scene_app scene;
    static struct source source[LOGS];
    struct options o;
    int status;
    if (!options_parse(&o, &export_usage, argc, argv, &status))
        return status;
    int n = o.n_words;
    status = scene_open(&scene, &o, OPTIONS_WORDS, NULL);
    if (!status && !(status = open_sources(source, n, &o, &scene))) {
        status = write_all(source, n, &o, scene.config.model);
        for (int i = 0; i < n; i++) {
            if (!status)
                tell(&source[i], o.usage->name);
            plant_log_close(&source[i].log);
        }
    }
    scene_free(&scene);
    return status;
}
