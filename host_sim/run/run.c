/* run.c - plants in real time on a bus: absolute pacing, the overrun policy, and a report at the end. */
#include "firmware/app/account.h"
#include "firmware/app/session.h"
#include "firmware/bus/wire_table.h"
#include "firmware/plant/plant_report.h"
#include "host_sim/live/bus.h"
#include "host_sim/cli/clock.h"
#include "host_sim/commands.h"
#include "host_sim/live/fault_list.h"
#include "host_sim/live/lockstep.h"
#include "host_sim/run/run_outcome.h"
#include "host_sim/plants/plants.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/trouble.h"
#include "host_sim/cli/options.h"
#include "host_sim/scene/scene.h"
#include "host_sim/scope/scope_child.h"
#include "host_sim/cli/selftest.h"

#include <errno.h>
#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum {
    PRIORITY = 80, /* above ordinary threaded interrupts (50), below the kernel's own watchdogs (99) */
    STACK_BYTES = 256 * 1024,   /* touched before the loop, so that no page is missing in it */
    SPREAD_BINS = 100000,       /* bins of 0.1 us: up to 10 ms, beyond that only the maximum counts */
    FRAMES_MISSED_MAX = 1 << 30 /* most frames that one overrun may report */
};

static const struct option run_options[] = {
    {"plants", "FILE", "many plants on one bus: a scene in each line; see above", OPTION_READS,
     .initial = NULL},
    {"duration", "S", "seconds to run (0: until Ctrl-C)", OPTION_NUMBER, 0.0, 1e9, .initial = "0"},
    {"overrun", "catch_up|skip|freeze|stop",
     "handling of missed frames: catch_up, skip, freeze or stop (catch_up)", OPTION_TEXT, .initial = NULL},
    {.name = "realtime",
     .meaning = "lock memory, use SCHED_FIFO if granted, and poll for the last 100 us of a frame"},
    {"cpu", "N", "stay on this processor", OPTION_INTEGER, 0.0, 1023.0, .initial = NULL},
    {"log", "FILE", "record all traffic as a candump log, for contactplant replay", OPTION_WRITES,
     .initial = NULL},
    {"report", "FILE", "with --log: a page with its charts, which opens in a browser without a network",
     OPTION_WRITES, .initial = NULL},
    {"log-limit", "MB", "end the log after this many megabytes, with a whole frame (0: never)", OPTION_NUMBER,
     0.0, 1e9, .initial = "0"},
    SCOPE_CONTROL,
    {"faults", "LIST", "a bad link: frames lost, late, repeated, damaged; see above", OPTION_TEXT,
     .initial = NULL},
    {"faults-seed", "N", "seed of --faults; another seed hits other frames (1)", OPTION_INTEGER, 0.0,
     4294967295.0, .initial = "1"},
    {.name = "status", .meaning = "print a line on stderr every second"},
    {.name = "promote", .meaning = "climb to the full model of [watch] promote when the scene's watch trips"},
    {.name = NULL},
};

static const struct usage run_usage = {
    .name = "run",
    .words = "[SCENE]",
    .summary =
        "Runs a plant in real time on a bus. A controller enables it, starts it and keeps it alive; see\n"
        "contactplant control and docs/reference/protocol.md. It ends after --duration, with Ctrl-C, or "
        "when\n"
        "its terminal closes. Its files are complete then, and it prints how well it kept time. With\n"
        "--lockstep there is no clock: a bus frame begins when the controller has said its word, so that\n"
        "runs are equal to the byte; see docs/guide/lockstep.md.",
    .words_help = SCENE_WORDS_HELP "A scene's drives sound as soon as plant time runs. A reset brings the "
                                   "plant to rest and silences them.\n" PLANTS_HELP FAULT_LIST_HELP,
    .examples =
        "  contactplant run                                   a plant at udp:20000 for the default "
        "controller\n"
        "  contactplant run rig                               a preset with drives, start and deadline\n"
        "  contactplant run my.ini --substeps 128\n"
        "  contactplant run my.ini --promote                  climbs when its [watch] trips\n"
        "  contactplant run --realtime --cpu 1 --status --duration 60 --log run.log\n"
        "  contactplant run --duration 60 --json run.json --fail-on missed,late,fault     for CI\n"
        "  contactplant run --set preload_N=100 --setting timeout_frames=50 --overrun stop\n"
        "  contactplant run --bus udp:30000 --peer 127.0.0.1:30001 --base-id 0x240\n"
        "  contactplant run --bus can:can0 --realtime\n"
        "  contactplant run rig --scope                       and its picture in a browser\n"
        "  contactplant run --lockstep --log run.log          with contactplant control --lockstep: no "
        "clock\n"
        "  contactplant run --plants farm.txt --extended      a hundred plants on one bus\n"
        "  contactplant run --faults drop=0.02,in.delay=0.1:30,freeze@5:7   is the controller up to this?\n",
    .max_words = 1,
    .table = {run_options, run_outcome_options, scope_options, lockstep_options, bus_options, scene_options},
};

/* How often something took so long. */
struct spread {
    uint32_t bin[SPREAD_BINS + 1]; /* 0.1 us each, the last one everything above */
    uint64_t n;
    double max_us;
};

struct run {
    const struct options *o;
    struct plants plants;
    struct scene_app *scene; /* the first plant's: the only one, unless a list was given */
    struct bus bus;
    struct lockstep lockstep;
    struct scope_child scope;
    struct spread lateness, compute;
    uint64_t missed, half_late; /* frames that never began on time; frames later than half a period */
    double period_s;
    bool warned; /* others use a plant's identifiers */
};

static void spread_add(struct spread *s, int64_t ns)
{
    int64_t i = ns < 0 ? 0 : ns / 100;
    s->bin[i < SPREAD_BINS ? i : SPREAD_BINS]++;
    s->n++;
    s->max_us = (double)ns * 1e-3 > s->max_us ? (double)ns * 1e-3 : s->max_us;
}

/* The time in us that `share` of all stayed below or at. */
static double spread_quantile(const struct spread *s, double share)
{
    uint64_t wanted = (uint64_t)ceil(share * (double)s->n), seen = 0;
    for (int i = 0; i < SPREAD_BINS; i++) {
        seen += s->bin[i];
        if (seen >= wanted)
            return 0.1 * (i + 1) < s->max_us ? 0.1 * (i + 1) : s->max_us;
    }
    return s->max_us;
}

/* ---- what the system may or may not grant ---- */

static void not_granted(const char *what, const char *advice)
{
    fprintf(stderr, "contactplant run: %s was not granted (%s); %s; continuing without it\n", what,
            strerror(errno), advice);
}

static void touch_stack(void)
{
    volatile char page[STACK_BYTES];
    for (int i = 0; i < STACK_BYTES; i += 1024)
        page[i] = 0;
    (void)page[0];
}

static void ask_for_realtime(const struct options *o)
{
    const struct sched_param p = {.sched_priority = PRIORITY};
    cpu_set_t set;
    if (options_given(o, "cpu")) {
        CPU_ZERO(&set);
        CPU_SET((size_t)options_number(o, "cpu"), &set);
        if (sched_setaffinity(0, sizeof set, &set))
            not_granted("the processor of --cpu", "choose one that nproc counts");
    }
    if (options_given(o, "realtime")) {
        if (mlockall(MCL_CURRENT | MCL_FUTURE))
            not_granted("locked memory", "run as root or raise ulimit -l");
        if (sched_setscheduler(0, SCHED_FIFO, &p))
            not_granted("SCHED_FIFO", "run as root or raise ulimit -r to 80");
    }
    touch_stack();
}

/* ---- the loop ---- */

static void print_status(struct run *s)
{
    const struct app *a = &s->scene->app;
    const struct model *m = s->scene->config.model;
    double output[MODEL_OUTPUTS];
    char states[BUS_REASON], faults[TROUBLE_TEXT];
    if (s->plants.n > 1) {
        plants_states(&s->plants, states, sizeof states);
        fprintf(stderr, "%8.1f s  %s  missed %llu\n", (double)a->frame * s->period_s, states,
                (unsigned long long)s->missed);
        return;
    }
    plant_output(&a->plant, output);
    trouble_note_faults(a->faults, faults);
    fprintf(stderr, "%8.1f s  %-8s%s plant %.3f s ", (double)a->frame * s->period_s,
            names_text(m, NAMES_STATE, (unsigned)a->state), faults, plant_time(&a->plant));
    for (int i = 0; i < m->n_outputs && i < 4; i++)
        fprintf(stderr, " %s %.4g %s", m->output_signal[i].name, output[i], m->output_signal[i].unit);
    fprintf(stderr, "  touchdowns+lift-offs %u  command age %u  missed %llu\n", a->plant.counts.switches,
            (unsigned)session_command_age(a), (unsigned long long)s->missed);
}

static void print_news(struct run *s)
{
    char news[BUS_REASON];
    while (bus_news(&s->bus, news))
        fprintf(stderr, "contactplant run: %s\n", news);
}

/* Whether this plant has heard frames under its identifiers that are none of its commands: a wrong length or
 * CHECKSUM, or an identifier that only a plant sends. Then one line on stderr tells what they were. */
static bool warn_of_neighbours(const struct app *a)
{
    const uint32_t *n = a->count, base = a->scene.base_id;
    if (!(n[DIAG_CRC] | n[DIAG_LENGTH] | n[DIAG_UNKNOWN_ID]))
        return false;
    fprintf(stderr,
            "contactplant run: others use identifiers of this plant, 0x%X to 0x%X: %u frames that only a "
            "plant sends, %u with a wrong length, %u with a wrong CHECKSUM; choose --base-id "
            "(docs/guide/neighbours.md)\n",
            (unsigned)base, (unsigned)(base + WIRE_KINDS - 1), (unsigned)n[DIAG_UNKNOWN_ID],
            (unsigned)n[DIAG_LENGTH], (unsigned)n[DIAG_CRC]);
    return true;
}

/* How late a frame of a plant began that was waited for. */
static void note_lateness(struct run *s, struct app *a, int64_t late_ns)
{
    spread_add(&s->lateness, late_ns);
    s->half_late += (double)late_ns * 1e-9 > 0.5 * s->period_s;
    histogram_add(&a->timing.lateness,
                  late_ns < INT64_C(4000000000000) ? (uint32_t)(late_ns / 1000) : UINT32_MAX, a->frame);
}

/* A frame of each plant that is due; the first one begins `late_ns` late, or below 0: was not waited for. */
static void one_frame(struct run *s, int64_t late_ns)
{
    int64_t begin = clock_now_ns();
    bus_set_frame(&s->bus, s->scene->app.frame, s->period_s, 0);
    plants_collect(&s->plants);
    for (int i = 0, n; i < s->plants.n; i += n) {
        n = plants_together(&s->plants, i);
        int64_t late = late_ns + (i ? clock_now_ns() - begin : 0);
        for (int k = i; k < i + n && late_ns >= 0; k++)
            note_lateness(s, &s->plants.one[k].scene.app, late);
        plants_frames(&s->plants, i, n);
        for (int k = i; k < i + n; k++)
            s->warned = s->warned || warn_of_neighbours(&s->plants.one[k].scene.app);
    }
    plants_flush(&s->plants);
    spread_add(&s->compute, clock_now_ns() - begin);
    print_news(s);
}

/* One frame: that of the period which begins at `next_ns`, or, where some are due, one of those; and then the
 * periods that have begun meanwhile are missed ones, too. Returns the periods gone by. */
static uint64_t turn(struct run *s, int64_t next_ns)
{
    bool waited = !plants_due(&s->plants);
    int64_t late_ns = clock_now_ns() - next_ns;
    late_ns = waited && late_ns < 0 ? 0 : late_ns;
    double periods = late_ns < 0 ? 0.0 : floor((double)late_ns * 1e-9 / s->period_s) + 1.0;
    uint32_t begun = periods < FRAMES_MISSED_MAX ? (uint32_t)periods : FRAMES_MISSED_MAX;
    s->missed += begun - waited;
    bus_set_frame(&s->bus, s->scene->app.frame, s->period_s, begun - waited);
    plants_begin(&s->plants, begun);
    one_frame(s, waited ? late_ns : -1);
    return begun;
}

static void loop(struct run *s)
{
    double duration = options_number(s->o, "duration");
    bool status = options_given(s->o, "status"), endless = !(duration > 0.0),
         realtime = options_given(s->o, "realtime");
    uint64_t n_frames = (uint64_t)llround(duration / s->period_s), next_status = 0, n = 0;
    int64_t start = clock_now_ns(); /* every period counts from here: nothing accumulates */
    while ((endless || n < n_frames || plants_due(&s->plants)) && !clock_interrupted()) {
        bool over = !endless && n >= n_frames; /* frames that are due are made up, no others */
        int64_t next = over ? INT64_MAX : start + llround((double)n * s->period_s * 1e9);
        if (!plants_due(&s->plants))
            (realtime ? clock_wait_until_ns : clock_sleep_until_ns)(next);
        if (clock_interrupted())
            break;
        n += turn(s, next);
        if (status && n >= next_status) {
            print_status(s);
            next_status = n + (uint64_t)(1.0 / s->period_s);
        }
    }
}

/* Bus frames begin with words instead of instants; nothing is missed. Returns the exit status. */
static int loop_in_lockstep(struct run *s)
{
    double duration = options_number(s->o, "duration");
    bool status = options_given(s->o, "status"), endless = !(duration > 0.0),
         realtime = options_given(s->o, "realtime");
    uint64_t n_frames = (uint64_t)llround(duration / s->period_s);
    int64_t next_status = 0;
    char why[BUS_REASON];
    while ((endless || s->compute.n < n_frames) && !clock_interrupted()) {
        enum lockstep_turn turn = lockstep_await(&s->lockstep, realtime, why);
        if (turn == LOCKSTEP_SILENT) {
            fprintf(stderr, "contactplant run: %s\n", why);
            return STATUS_SILENT;
        }
        if (turn == LOCKSTEP_BEGINS) {
            plants_begin(&s->plants, 1);
            one_frame(s, -1);
        } else {
            print_news(s);
        }
        if (status && clock_now_ns() >= next_status) {
            print_status(s);
            next_status = clock_now_ns() + INT64_C(1000000000);
        }
    }
    return STATUS_DONE;
}

/* ---- the report ---- */

static void print_histogram(const char *what, const struct histogram *h)
{
    printf("%s histogram, us:", what);
    for (unsigned i = 0; i < TIMING_BINS; i++)
        if (h->bin[i])
            printf("  <%u %u", 1u << i, h->bin[i]);
    printf("; largest in frame %llu\n", (unsigned long long)h->max_frame);
}

/* The scene's target for one step, against the frame's whole work shared by its steps. */
static void print_cost(const struct run *s)
{
    double step_us = spread_quantile(&s->compute, 0.99) / s->scene->config.substeps;
    double asked_us = s->scene->scene.cost_s * 1e6;
    printf("cost per step p99 %.3f us, asked %g us: %s\n", step_us, asked_us,
           step_us <= asked_us ? "kept" : "missed");
}

static void print_faults(const struct faults *f)
{
    printf("faults of the link, frames hit:");
    for (int i = 0; i < FAULTS_KINDS; i++)
        if (f->count[i])
            printf("  %s %llu", faults_name[i], (unsigned long long)f->count[i]);
    printf("; %llu lost in a full queue\n", (unsigned long long)f->lost);
}

/* Says whether the scene's watch has tripped. */
static void print_watch(const struct run *s)
{
    const struct app *a = &s->scene->app;
    const struct watch *w = &a->watch;
    const struct signal *g = model_observable(s->scene->config.model, w->limits.observable);
    if (!s->scene->scene.watch.on)
        return;
    if (w->tripped)
        printf("watch: %s was %g%s%s at tick %llu, outside its limits; ", g->name, w->value,
               *g->unit ? " " : "", g->unit, (unsigned long long)w->tick);
    else
        printf("watch: %s is inside its limits; ", g->name);
    printf("the model is %s\n", a->plant.model->name);
}

static void report_lateness(const struct run *s)
{
    printf("frames %llu of %g us, missed %llu, later than half a period %llu\n",
           (unsigned long long)s->compute.n, s->period_s * 1e6, (unsigned long long)s->missed,
           (unsigned long long)s->half_late);
    if (s->compute.n)
        printf("%s p50 %.1f us, p99 %.1f us, max %.1f us\n",
               s->plants.n > 1 ? "lateness of all plants' frames" : "wake-up lateness",
               spread_quantile(&s->lateness, 0.5), spread_quantile(&s->lateness, 0.99), s->lateness.max_us);
}

static void report_lockstep(const struct run *s)
{
    double bus_s = (double)s->compute.n * s->period_s,
           took_s = (double)(s->lockstep.last_ns - s->lockstep.begin_ns) * 1e-9;
    printf("frames %llu of %g us in lockstep", (unsigned long long)s->compute.n, s->period_s * 1e6);
    if (s->compute.n > 1)
        printf(", %g s in %.3f s: %.3g times real time", bus_s, took_s, bus_s / took_s);
    printf("\n");
}

static void report_counters(const struct app *a)
{
    uint32_t count[DIAG_COUNTERS];
    account_counts(a, count);
    for (unsigned i = 0; i < DIAG_COUNTERS; i++)
        if (count[i])
            printf("%-22s %u %s\n", diag_name[i].name, count[i], diag_name[i].unit);
}

/* A run's only plant. */
static void report_plant(const struct run *s)
{
    const struct app *a = &s->scene->app;
    const struct model *m = s->scene->config.model;
    char faults[TROUBLE_TEXT];
    if (s->compute.n && s->scene->scene.cost_s > 0.0)
        print_cost(s);
    if (s->compute.n && !s->lockstep.on) {
        print_histogram("lateness", &a->timing.lateness);
        print_histogram("compute", &a->timing.compute);
    }
    trouble_note_faults(a->faults, faults);
    printf("plant time %.6f s, tick %llu, hash %016llx, state %s%s\n", plant_time(&a->plant),
           (unsigned long long)a->plant.now.tick, (unsigned long long)plant_hash(&a->plant),
           names_text(m, NAMES_STATE, (unsigned)a->state), faults);
    if (a->plant.method == &auto_method) /* parameters may have turned the choice since the banner */
        printf("method %s, chosen by auto\n", scene_method(s->scene)->name);
    if (s->bus.faults)
        print_faults(s->bus.faults);
    print_watch(s);
    report_counters(a);
}

static void report(struct run *s)
{
    (s->lockstep.on ? report_lockstep : report_lateness)(s);
    if (s->compute.n)
        printf("compute per frame p50 %.1f us, p99 %.1f us, max %.1f us\n", spread_quantile(&s->compute, 0.5),
               spread_quantile(&s->compute, 0.99), s->compute.max_us);
    if (s->plants.n == 1)
        report_plant(s);
    else if (s->bus.faults)
        print_faults(s->bus.faults);
    if (s->plants.n > 1)
        plants_report(&s->plants);
    fflush(stdout);
}

static void announce_plants(const struct run *s, const char *bus)
{
    const struct app_config *c = &s->scene->config;
    if (s->plants.n > 1) {
        fprintf(stderr,
                "contactplant run: %d plants on %s, identifiers 0x%X to 0x%X, 64 each, %g frames/s; Ctrl-C "
                "ends it\n",
                s->plants.n, bus, c->base_id, c->base_id + (uint32_t)s->plants.n * FRAME_IDS - 1,
                1.0 / c->frame_s);
        return;
    }
    fprintf(stderr,
            "contactplant run: %s by %s on %s, identifiers 0x%X to 0x%X, %g frames/s of %u substeps, "
            "resonance %.4g Hz on the bus; Ctrl-C ends it\n",
            c->model->name, scene_method(s->scene)->name, bus, c->base_id, c->base_id + WIRE_KINDS - 1,
            1.0 / c->frame_s, c->substeps, scene_resonance_Hz(s->scene));
}

static void announce(const struct run *s)
{
    char bus[BUS_REASON];
    bus_describe(&s->bus, bus);
    announce_plants(s, bus);
    if (!s->lockstep.on)
        return;
    lockstep_describe(&s->lockstep, bus);
    fprintf(stderr, "contactplant run: in lockstep: each bus frame waits for a word of %s\n", bus);
}

/* ---- set-up ---- */

static int take_policy(struct run *s)
{
    static const char *const policy[] = {"catch_up", "skip", "freeze", "stop"};
    const char *text = options_text(s->o, "overrun", 0);
    for (int i = 0; text && i < 4; i++)
        if (!strcmp(text, policy[i])) {
            for (int k = 0; k < s->plants.n; k++)
                s->plants.one[k].scene.setting[SET_OVERRUN_POLICY] = i;
            return 0;
        }
    return text ? options_misuse(s->o->usage, "--overrun is catch_up, skip, freeze or stop, not %s", text)
                : 0;
}

/* A plant that fails its self-test runs, tells it and refuses to be enabled. */
static int test_itself(struct run *s)
{
    struct selftest_result r;
    if (!selftest_of_host(&r))
        return options_failure(s->o->usage, "out of memory");
    for (int i = 0; i < s->plants.n; i++)
        app_take_selftest(&s->plants.one[i].scene.app, &r);
    if (r.failed)
        fprintf(
            stderr,
            "contactplant run: the self-test failed, no session can be opened; see contactplant selftest\n");
    return STATUS_DONE;
}

static int start_session(struct run *s)
{
    char why[SCENE_REASON];
    const struct wire_scene identity = {.base_id = s->scene->config.base_id,
                                        .extended = s->scene->config.extended};
    int status = take_policy(s);
    status = status ? status : lockstep_check(s->o);
    status = status ? status : run_outcome_check(s->o);
    if (status)
        return status;
    const char *log = options_text(s->o, "log", 0);
    if (!log && options_given(s->o, "log-limit"))
        return options_misuse(s->o->usage, "--log-limit needs --log");
    status = run_report_check(s->o);
    if (status)
        return status;
    status = plants_start(&s->plants, &s->bus.hal, s->o);
    if (!status)
        status = test_itself(s);
    s->bus.n_plants = (uint32_t)s->plants.n;
    if (!status)
        status = scope_child_start(&s->scope, s->o);
    if (!status)
        status = bus_open_options(&s->bus, s->o, BUS_PLANT, &identity);
    const char *faults = options_text(s->o, "faults", 0);
    s->period_s = s->scene->config.frame_s;
    if (!status)
        status = lockstep_open(&s->lockstep, s->o, &s->bus, s->period_s);
    if (!status && faults &&
        !bus_add_faults(&s->bus, faults, (uint64_t)options_number(s->o, "faults-seed"), s->period_s, why))
        status = options_misuse(s->o->usage, "--faults %s", why);
    uint64_t limit = (uint64_t)(options_number(s->o, "log-limit") * 1e6);
    if (!status && log && !bus_record(&s->bus, log, limit, why))
        status = options_failure(s->o->usage, "%s", why);
    if (!status)
        scope_child_attach(&s->scope, &s->bus.hal, &s->scene->app.timing);
    return status;
}

static int run(struct run *s, int argc, char **argv)
{
    char why[BUS_REASON];
    int status = plants_read(&s->plants, s->o);
    s->scene = status ? NULL : &s->plants.one[0].scene;
    status = status ? status : start_session(s);
    if (!status) {
        clock_catch_signals();
        announce(s);
        for (int i = 0; i < s->plants.n; i++)
            scene_warn(&s->plants.one[i].scene, s->o->usage);
        ask_for_realtime(s->o);
        if (s->lockstep.on)
            status = loop_in_lockstep(s);
        else
            loop(s);
        report(s);
        const struct run_outcome outcome = {&s->scene->app, s->compute.n, s->missed, s->plants.one[0].faults};
        int told = run_outcome_tell(&outcome, s->o);
        status = status ? status : told;
        if (!bus_end_record(&s->bus, why))
            status = options_failure(s->o->usage, "%s", why);
        status = status ? status : run_report(s->o, s->scene, argc, argv);
    }
    scope_child_end(&s->scope);
    bus_close(&s->bus);
    plants_free(&s->plants);
    return status;
}

int cmd_run(int argc, char **argv)
{
    struct options o;
    int status;
    if (!options_parse(&o, &run_usage, argc, argv, &status))
        return status;
    struct run *s = calloc(1, sizeof *s);
    if (!s)
        return options_failure(&run_usage, "out of memory");
    s->o = &o;
    status = run(s, argc, argv);
    free(s);
    return status;
}
