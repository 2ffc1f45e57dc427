/* test_faults_session.c - a session over bad links: what
 * holds for every seed, whatever is lost, late or damaged. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant_report.h"
#include "hal/link/faults.h"
#include "host_sim/live/fault_list.h"
#include "tests/fixture/bus.h"
#include "tests/fixture/fault_lists.h"
#include "tests/unit/test.h"

enum {
    SEEDS = 1000,
    BEGIN = 40,    /* frames, of the faults */
    UNTIL = 200,   /* their end, as in the lists below */
    SETTLED = 420, /* a held frame, the time-out and the age limit have passed */
    END = 520,
    TUNINGS = 64, /* parameter sets that the controller goes through */
    SESSION_FRAMES = 16384,
    INSTANTS = 8 /* fires that one frame may see */
};

static struct bus bus;
static struct faults faults;

/* ---- what the plant was given: a hal around the bad link that sees each frame before the plant does ---- */

struct tap {
    struct hal hal, inner;
    struct wire_scene scene;
    double sample[SESSION_FRAMES]; /* the last good one that names this frame */
    int forged;                    /* samples that were damaged without their CRC knowing */
    uint64_t fire_tick[INSTANTS];
    int n_fires; /* that came in since the last look */
    uint32_t received, crc, length;
    int calls, fail; /* recv and send so far; the one that fails, or 0 */
    int failure;     /* its return value */
    int sends_failed;
};

static struct tap tap;

static double sample_of(uint64_t frame)
{
    return (double)(frame % 4096) / 256.0;
}

static void note_frame(struct tap *t, const struct frame *f)
{
    struct message m;
    enum wire_status status = wire_decode(&t->scene, f, &m);
    t->received += status != WIRE_NOT_OURS;
    t->crc += status == WIRE_BAD_CRC;
    t->length += status == WIRE_BAD_LENGTH;
    if (status == WIRE_OK && m.kind == WIRE_FIRE && t->n_fires < INSTANTS)
        t->fire_tick[t->n_fires++] = (uint64_t)m.value[FIRE_TICK];
    if (status == WIRE_OK && m.kind == WIRE_STREAM + RIG_FORCE) {
        uint64_t frame = (uint64_t)m.value[STREAM_FRAME];
        t->sample[frame % SESSION_FRAMES] = m.value[STREAM_SAMPLE];
        t->forged += m.value[STREAM_SAMPLE] != sample_of(frame);
    }
}

static bool fails(struct tap *t)
{
    return ++t->calls == t->fail;
}

static int tap_recv(void *context, struct frame *f)
{
    struct tap *t = context;
    if (fails(t))
        return t->failure;
    int got = t->inner.recv(t->inner.context, f);
    if (got > 0)
        note_frame(t, f);
    return got;
}

static int tap_send(void *context, const struct frame *f)
{
    struct tap *t = context;
    if (fails(t)) {
        t->sends_failed++;
        return 0;
    }
    return t->inner.send(t->inner.context, f);
}

static void tap_flush(void *context)
{
    struct tap *t = context;
    t->inner.flush(t->inner.context);
}

static uint32_t tap_now(void *context)
{
    struct tap *t = context;
    return t->inner.now_us(t->inner.context);
}

static void tap_healthy(void *context)
{
    (void)context;
}

/* A session over a link with these faults; the app speaks with the tap. */
static void begin_session(const char *list, uint64_t seed)
{
    const struct app_config c = bus_config();
    char why[FAULT_LIST_REASON] = "";
    bus_start(&bus, &c);
    faults_init(&faults, &bus.wires.port[0].hal, seed);
    if (*list && !fault_list_read(&faults, list, c.frame_s, why))
        check_string(list, why, "no refusal");
    memset(&tap, 0, sizeof tap);
    tap.inner = faults.hal;
    tap.scene = bus.app.scene;
    tap.hal = (struct hal){&tap, tap_recv, tap_send, tap_flush, tap_now, tap_healthy};
    bus.app.hal = &tap.hal;
}

/* ---- the controller: every value says what it belongs to ---- */

static const unsigned tuned[] = {RIG_MASS, RIG_CONTACT_STIFFNESS, RIG_DAMPING};
static const double tuned_to[] = {6.5, 3.4e9, 188.0};

static double tuning(int which, int k)
{
    return (double)(float)(tuned_to[which] * (1.0 + k / 1024.0));
}

static void tune(int k)
{
    struct staged set = {{0}, {0}};
    for (int i = 0; i < 3; i++) {
        staged_put(&set, tuned[i], tuning(i, k));
        bus_write(&bus, tuned[i], tuning(i, k));
    }
    bus_commit(&bus, &set, COMMIT_NOW);
}

/* One frame of a controller that knows the plant's frame:
 * heartbeat, sample, now and then a drive or a tuning. */
static void command(int frame)
{
    uint64_t tick = bus.app.plant.now.tick;
    bus_enable(&bus, true);
    bus_stream(&bus, RIG_FORCE, tick / BUS_TICKS + 2, sample_of(tick / BUS_TICKS + 2));
    if (frame % 16 == 3) {
        bus_drive(&bus, RIG_BASE, 1e-7, 150.0, 0.0, 0.0);
        bus_fire(&bus, 1 << RIG_BASE, false, tick + 4 * BUS_TICKS + 5, 0);
    }
    if (frame % 8 == 5)
        tune(frame / 8 % TUNINGS);
}

/* ---- what must hold after each frame ---- */

struct verdict {
    int told; /* messages of the plant */
    int not_finite, wrong_time, torn, wrong_sample, wrong_fire, told_nan;
};

static bool is_torn(const struct app *a)
{
    for (int k = 0; k < TUNINGS; k++) {
        int same = 0;
        for (int i = 0; i < 3; i++)
            same += (float)a->plant.si[tuned[i]] == (float)tuning(i, k);
        if (same == 3)
            return false;
    }
    return true;
}

static int instants_in(uint64_t tick)
{
    int n = 0;
    for (int i = 0; i < tap.n_fires; i++)
        n += tap.fire_tick[i] / BUS_TICKS == tick / BUS_TICKS;
    return n;
}

/* Fires that cannot come any more make room. */
static void forget_fires(uint64_t tick)
{
    int kept = 0;
    for (int i = 0; i < tap.n_fires; i++)
        if (tap.fire_tick[i] >= tick)
            tap.fire_tick[kept++] = tap.fire_tick[i];
    tap.n_fires = kept;
}

static int count_nan(void)
{
    int n = 0;
    for (int i = 0; i < bus.n_seen; i++) {
        const struct message *m = &bus.seen[i];
        bool motion = m->kind == WIRE_MOTION || m->kind == WIRE_CONTACT;
        n += motion && !(isfinite(m->value[1]) && isfinite(m->value[2]));
        n += m->kind == WIRE_LEDGER && !isfinite(m->value[LEDGER_VALUE]);
    }
    return n;
}

static void one_frame(struct verdict *v)
{
    struct app *a = &bus.app;
    uint64_t tick = a->plant.now.tick, frame = a->frame;
    uint32_t fired = a->count[DIAG_FIRE_APPLIED], streamed = a->count[DIAG_STREAM_APPLIED];
    bus_silent(&bus, 1);
    v->not_finite += !isfinite(a->plant.x[0]) || !isfinite(a->plant.x[1]);
    v->wrong_time += a->frame != frame + 1;
    v->wrong_time += a->plant.now.tick != tick + (a->state == STATE_RUNNING ? BUS_TICKS : 0);
    v->torn += is_torn(a);
    double force = a->plant.drive[RIG_FORCE].sample * a->plant.scale.force_N;
    if (a->count[DIAG_STREAM_APPLIED] != streamed)
        v->wrong_sample += fabs(force - tap.sample[tick / BUS_TICKS % SESSION_FRAMES]) > 1e-9;
    v->wrong_fire += (int)(a->count[DIAG_FIRE_APPLIED] - fired) > instants_in(tick);
    forget_fires(a->plant.now.tick);
    v->told += bus.n_seen;
    v->told_nan += count_nan();
    bus_forget(&bus);
}

/* ---- a thousand bad links ---- */

/* Between one and all of these, with probabilities by the seed. */
static void make_list(char *list, size_t size, unsigned seed)
{
    static const char *const kind[] = {"drop=%.2f@.04:.2",     "duplicate=%.2f@.04:.2", "repeat=%.2f@.04:.2",
                                       "reorder=%.2f@.04:.2",  "truncate=%.2f@.04:.2",  "flip=%.2f@.04:.2",
                                       "delay=%.2f:60@.04:.2", "refuse=%.2f@.04:.2",    "in.freeze@.06:.1",
                                       "bus-off@.12:.14",      "out.freeze@.15:.19",    "burst=17@.1:.2"};
    fault_list_draw(list, size, kind, sizeof kind / sizeof kind[0], seed);
}

/* A new session after the trouble: true when everything works as if nothing had been. */
static bool recovers(struct verdict *v)
{
    struct app *a = &bus.app;
    bus.session = 2;
    memset(bus.counter, 0, sizeof bus.counter);
    bus_enable(&bus, true);
    bus_order(&bus, CONTROL_PAUSE);
    bus_order(&bus, CONTROL_RESET);
    bus_order(&bus, CONTROL_START);
    one_frame(v);
    uint32_t before[DIAG_COUNTERS];
    memcpy(before, a->count, sizeof before);
    for (int frame = SETTLED; frame < END; frame++) {
        command(frame);
        one_frame(v);
    }
    int refused = 0;
    for (int i = DIAG_CRC; i <= DIAG_SELF_TEST; i++)
        refused += a->count[i] != before[i];
    uint32_t samples = a->count[DIAG_STREAM_APPLIED] - before[DIAG_STREAM_APPLIED];
    uint32_t fires = a->count[DIAG_FIRE_APPLIED] - before[DIAG_FIRE_APPLIED];
    return refused == 0 && a->faults == 0 && a->state == STATE_RUNNING && samples >= END - SETTLED - 3 &&
           fires >= (END - SETTLED) / 16 - 1;
}

TEST(faults_thousand_seeds)
{
    struct verdict v = {0};
    int miscounted = 0, lost = 0, forged = 0;
    uint64_t hit[FAULTS_KINDS] = {0};
    for (unsigned seed = 1; seed <= SEEDS; seed++) {
        char list[512];
        make_list(list, sizeof list, seed);
        begin_session(list, seed);
        bus_enable(&bus, true);
        bus_order(&bus, CONTROL_START);
        tune(0);
        bus_silent(&bus, 1);
        for (int frame = 1; frame < UNTIL; frame++) {
            command(frame);
            one_frame(&v);
        }
        for (int frame = UNTIL; frame < SETTLED; frame++)
            one_frame(&v);
        lost += !recovers(&v);
        const uint32_t *n = bus.app.count;
        miscounted +=
            n[DIAG_FRAMES_RECEIVED] != tap.received || n[DIAG_CRC] != tap.crc || n[DIAG_LENGTH] != tap.length;
        forged += tap.forged;
        for (int i = 0; i < FAULTS_KINDS; i++)
            hit[i] += faults.count[i];
    }
    printf("      %d seeds, frames hit:", SEEDS);
    for (int i = 0; i < FAULTS_KINDS; i++)
        printf(" %s %llu", faults_name[i], (unsigned long long)hit[i]);
    printf("; %d damaged samples that their CRC let through\n", forged);
    check_below("share of them: three wrong bits in a third of the flips, 1/255 of those", forged,
                2.0 * (double)hit[FAULTS_FLIP] / 765.0);
    check_int("frames after which the state was not finite", v.not_finite, 0);
    check_int("motion, contact or ledger told as NaN", v.told_nan, 0);
    check_int("frames with a wrong number or tick", v.wrong_time, 0);
    check_int("frames under a torn parameter set", v.torn, 0);
    check_int("samples applied in a frame that they do not name", v.wrong_sample, 0);
    check_int("fires applied in a frame that they do not name", v.wrong_fire, 0);
    check_int("sessions with a frame or a damage not counted by its cause", miscounted, 0);
    check_int("sessions that did not recover", lost, 0);
    for (int i = 0; i < FAULTS_KINDS; i++)
        check_above(faults_name[i], (double)hit[i], 1000);
}

/* ---- the n-th call of the hal fails ---- */

/* A short session; how many calls of recv and send it made. */
static int short_session(int fail, int failure, struct verdict *v)
{
    begin_session("", 1);
    tap.fail = fail;
    tap.failure = failure;
    bus_enable(&bus, true);
    bus_order(&bus, CONTROL_START);
    tune(0);
    bus_silent(&bus, 1);
    for (int frame = 1; frame < 24; frame++) {
        command(frame);
        one_frame(v);
    }
    return tap.calls;
}

/* A failing call costs what it says and nothing else: the plant moves as it does without. */
TEST(faults_nth_call)
{
    static const struct {
        int failure;
        enum diag counter;
    } kind[] = {{-HAL_DROPPED, DIAG_RX_DROPPED},
                {-HAL_FOREIGN, DIAG_RX_FOREIGN},
                {-HAL_BUS_OFF, DIAG_BUS_OFF},
                {-HAL_ERROR_PASSIVE, DIAG_BUS_PASSIVE},
                {-HAL_DOWN, DIAG_BUS_DOWN}};
    struct verdict v = {0};
    int calls = short_session(0, 0, &v), n = 0, uncounted = 0, moved = 0, sends = 0, vanished = 0,
        told = v.told;
    uint64_t hash = plant_hash(&bus.app.plant);
    for (size_t k = 0; k < sizeof kind / sizeof kind[0]; k++) {
        for (int fail = 1; fail <= calls; fail++, n++) {
            v.told = 0;
            (void)short_session(fail, kind[k].failure, &v);
            const uint32_t *count = bus.app.count;
            bool counted = tap.sends_failed ? bus.app.telemetry.deferred >= 1 : count[kind[k].counter] == 1;
            uncounted += !counted;
            vanished += tap.sends_failed &&
                        told != v.told + (int)(bus.app.telemetry.replaced + bus.app.telemetry.n_tx);
            moved += plant_hash(&bus.app.plant) != hash;
            sends += tap.sends_failed;
        }
    }
    printf("      %d calls of recv and send, each failed in %zu ways: %d sessions, %d with a failed send\n",
           calls, sizeof kind / sizeof kind[0], n, sends);
    check_above("calls that failed", n, 1000);
    check_int("failures not counted under their name", uncounted, 0);
    check_int("sessions with a message neither sent, kept nor counted as replaced", vanished, 0);
    check_int("sessions whose plant moved otherwise", moved, 0);
    check_int("invariants broken",
              v.not_finite + v.wrong_time + v.torn + v.wrong_sample + v.wrong_fire + v.told_nan, 0);
}

/* ---- the emergency stop that was not needed: ten seconds of queued commands ---- */

/* The link stalls for 10 s and then brings all that was sent; `list`: in which directions. */
static void stall(const char *list)
{
    struct app *a = &bus.app;
    struct verdict v = {0};
    begin_session(list, 1);
    bus_enable(&bus, true);
    bus_order(&bus, CONTROL_START);
    tune(0);
    bus_set(&bus, SETTING_FIRST + SET_REACTION, REACTION_ZERO);
    bus_silent(&bus, 1);
    for (int frame = 1; frame < 1200; frame++) {
        command(frame);
        one_frame(&v);
    }
    uint32_t fired = a->count[DIAG_FIRE_APPLIED], streamed = a->count[DIAG_STREAM_APPLIED];
    double mass = a->plant.si[RIG_MASS];
    check_int("timed out", a->enabled, 0);
    check_int("drives off",
              drive_active(&a->plant.drive[RIG_FORCE]) + drive_active(&a->plant.drive[RIG_BASE]), 0);
    for (int frame = 1200; frame < 11500; frame++) {
        command(frame);
        one_frame(&v);
        v.wrong_sample += drive_active(&a->plant.drive[RIG_FORCE]) || drive_active(&a->plant.drive[RIG_BASE]);
    }
    printf("      %llu frames were queued and came at once\n",
           (unsigned long long)faults.count[FAULTS_FREEZE]);
    check_above("queued frames", (double)faults.count[FAULTS_FREEZE], 28000);
    check_int("left in the queue", faults.in.n, 0);
    check_int("fires applied since", a->count[DIAG_FIRE_APPLIED], fired);
    check_int("samples applied since", a->count[DIAG_STREAM_APPLIED], streamed);
    check_near("mass", a->plant.si[RIG_MASS], mass, 0.0);
    check_int("frames with a sounding drive, a wrong tick or a torn set",
              v.wrong_sample + v.wrong_time + v.torn, 0);
    check_int("still no session", a->enabled, 0);
    check_int("frames that took in their limit of 256: after two it is a flood", a->count[DIAG_RX_BUDGET], 2);
    check_above("what was dropped of it", a->count[DIAG_RX_FLOOD], 15000);
}

TEST(faults_stalled_link)
{
    printf("      the link stalls both ways\n");
    stall("freeze@1:11");
    printf("      only commands stall: the controller sees the plant and goes on\n");
    stall("in.freeze@1:11");
}
