/* test_soak.c - a plant on a bus for a long time: tick, phase, counters and balance are as exact at the
 * end as at the start.
 *
 * 1e6 ticks in the unit tests; SOAK_TICKS in the environment says another number, as `make soak` does with
 * 1e9 (the bus frame then passes 16 bits 238 times). The expected values are integer arithmetic of this
 * file. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "firmware/app/account.h"
#include "firmware/plant/plant_report.h"
#include "tests/fixture/bus.h"
#include "tests/fixture/exact.h"
#include "tests/unit/test.h"

enum {
    SUBSTEPS = 64,
    BEAT_FRAMES = 20,     /* heartbeats */
    SETTLED_FRAMES = 600, /* the ramp is over: from here on everything is counted */
    KINDS = WIRE_KINDS
};

static struct bus bus;

struct tally {
    uint64_t count[KINDS]; /* messages heard */
    int last[KINDS];       /* their last COUNTER, -1 at first */
    uint64_t gaps;         /* COUNTERs that did not follow */
    uint64_t sync_wrong;   /* SYNCs with another frame or tick than ours */
    double residual_J;     /* the largest seen */
};

static void listen(struct tally *t, uint64_t frame, uint64_t tick)
{
    for (int i = 0; i < bus.n_seen; i++) {
        const struct message *m = &bus.seen[i];
        t->gaps += t->last[m->kind] >= 0 && m->counter != (t->last[m->kind] + 1) % WIRE_COUNTER_STATES;
        t->last[m->kind] = m->counter;
        t->count[m->kind]++;
        if (m->kind == WIRE_SYNC)
            t->sync_wrong += m->value[SYNC_FRAME] != (uint16_t)frame || m->value[SYNC_TICK] != (uint32_t)tick;
    }
    t->residual_J = fmax(t->residual_J, fabs(plant_residual(&bus.app.plant)));
    bus_forget(&bus);
}

/* One bus frame, with a heartbeat when it is due. Returns the commands sent. */
static uint64_t soak_frame(uint64_t i)
{
    bool beat = i % BEAT_FRAMES == 0;
    if (beat)
        bus_enable(&bus, true);
    bus_silent(&bus, 1);
    return beat;
}

/* A running plant on a drive that keeps contact, its ramp behind it. Returns the commands sent. */
static uint64_t soak_settle(void)
{
    struct app_config c = bus_config();
    uint64_t commands = 2 + 4 + 1;
    c.substeps = SUBSTEPS;
    bus_start_running(&bus, &c);
    bus_drive(&bus, RIG_FORCE, 3.0, 200.25, 0.5, 0.5);
    bus_fire(&bus, 1u << RIG_FORCE, false, 10 * SUBSTEPS, 77);
    for (uint64_t i = 1; i < SETTLED_FRAMES; i++)
        commands += soak_frame(i);
    bus_forget(&bus);
    return commands;
}

static void check_counters(const struct tally *t, uint64_t frames, uint64_t commands)
{
    static const struct {
        const char *name;
        unsigned kind;
        uint64_t every;
    } row[] = {{"SYNC", WIRE_SYNC, 1},       {"MOTION", WIRE_MOTION, 1},
               {"CONTACT", WIRE_CONTACT, 1}, {"HEALTH", WIRE_HEALTH, 5},
               {"LEDGER", WIRE_LEDGER, 10},  {"STATUS", WIRE_STATUS, 10},
               {"HASH", WIRE_HASH, 1000},    {"EVENT_SUMMARY", WIRE_EVENT_SUMMARY, 100}};
    uint32_t count[DIAG_COUNTERS];
    account_counts(&bus.app, count);
    check_int("commands received", count[DIAG_FRAMES_RECEIVED], (int64_t)(uint32_t)commands);
    for (unsigned i = DIAG_CRC; i <= DIAG_TIMEOUTS; i++)
        check_int(diag_name[i].name, count[i], 0);
    check_int("frames deferred on the way out", bus.app.telemetry.deferred, 0);
    check_int("COUNTERs that did not follow", (int64_t)t->gaps, 0);
    check_int("SYNCs with a wrong frame or tick", (int64_t)t->sync_wrong, 0);
    for (unsigned i = 0; i < sizeof row / sizeof row[0]; i++) { /* frames SETTLED_FRAMES .. + frames - 1 */
        uint64_t first = (SETTLED_FRAMES + row[i].every - 1) / row[i].every;
        uint64_t end = (SETTLED_FRAMES + frames + row[i].every - 1) / row[i].every;
        check_int(row[i].name, (int64_t)t->count[row[i].kind], (int64_t)(end - first));
    }
}

/* The balance of rk4 and the ledger's own quadrature are of fourth order: their errors stay below (omega h)^4
 * of the energy that goes through, however long it takes. */
static void check_soak_balance(const struct tally *t, double settled_J, double damped_J)
{
    double omega_h = 6.283185307179586477 * 200.25 * bus.app.plant.tick_s;
    printf("energy through the damper %.6g J, residual now %.3g J\n", damped_J,
           plant_residual(&bus.app.plant));
    check_below("largest residual, as a fraction of the energy that went through",
                (t->residual_J - settled_J) / damped_J, pow(omega_h, 4.0));
    check_int("faults", bus.app.faults, 0);
}

TEST(soak_session)
{
    const char *asked = getenv("SOAK_TICKS");
    uint64_t frames = (uint64_t)(asked ? atof(asked) : 1e6) / SUBSTEPS;
    struct tally t = {.residual_J = 0.0};
    uint64_t commands = soak_settle();
    const struct plant *pl = &bus.app.plant;
    const struct drive *d = &pl->drive[RIG_FORCE];
    for (int i = 0; i < KINDS; i++)
        t.last[i] = -1;
    uint64_t frame = bus.app.frame, tick = pl->now.tick, carrier = d->carrier, offset = d->offset;
    double settled_J = fabs(plant_residual(pl)), damped_J = sum_of(&pl->ledger.damping);
    check_int("frames before the count begins", (int64_t)frame, SETTLED_FRAMES);
    for (uint64_t i = 0; i < frames; i++) {
        commands += soak_frame(SETTLED_FRAMES + i);
        listen(&t, frame + i, tick + (i + 1) * SUBSTEPS);
    }
    uint64_t ticks = frames * SUBSTEPS;
    printf("%llu frames, %llu ticks\n", (unsigned long long)frames, (unsigned long long)ticks);
    check_int("bus frame", (int64_t)bus.app.frame, (int64_t)(frame + frames));
    check_int("tick", (int64_t)pl->now.tick, (int64_t)(tick + ticks));
    check_int("its fraction", pl->now.fraction, 0);
    check_near("plant time, s", plant_time(pl),
               (double)((long double)(tick + ticks) * (long double)pl->tick_s), 0.0);
    check_hex("phase: the turns * 2^64 of so many ticks", d->carrier - carrier,
              exact_phase(200.25 * pl->tick_s, ticks));
    check_hex("phase offset", d->offset, offset);
    check_counters(&t, frames, commands);
    check_soak_balance(&t, settled_J, (sum_of(&pl->ledger.damping) - damped_J) * pl->scale.energy_J);
}
