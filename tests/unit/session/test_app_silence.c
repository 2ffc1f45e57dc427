/* test_app_silence.c - a controller that is dead is found out in bounded time, whatever the plant itself
 * misses; one that lives is not, by one short absence of the plant. Time is the test's own: frames take as
 * long as it says. */
#include <math.h>
#include <stdio.h>
#include "firmware/app/session.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { SILENCE_SEEDS = 2000, PERIOD_US = 1000 };

static struct bus bus;

/* The time that passes in the plant: how long a frame's work takes, and when it is away. */
struct pace {
    uint64_t seed, draws;
    unsigned work_us;       /* work in a frame */
    unsigned away_percent;  /* share of frames that begin with an absence */
    unsigned away_us;       /* the longest */
    unsigned every_us;      /* or: away for away_us of each so many; 0 for never */
    uint64_t time_us, next; /* now; periods told */
    uint32_t due;
};

static unsigned pace_draw(struct pace *p, unsigned n)
{
    return (unsigned)((noise_word(p->seed, p->draws++) >> 32) % n);
}

static void stall(struct pace *p)
{
    if (p->away_percent && pace_draw(p, 100) < p->away_percent)
        p->time_us += pace_draw(p, p->away_us + 1);
    if (p->every_us && p->time_us % p->every_us < p->away_us)
        p->time_us += p->away_us - p->time_us % p->every_us;
}

/* The loop of the host and of the boards, on this clock: one frame. */
static void turn(struct pace *p)
{
    bool waits = p->due == 0;
    if (waits && p->time_us < p->next * PERIOD_US)
        p->time_us = p->next * PERIOD_US;
    stall(p);
    uint64_t begun = p->time_us < p->next * PERIOD_US ? 0 : p->time_us / PERIOD_US - p->next + 1;
    p->next += begun;
    p->due = app_overrun(&bus.app, (uint32_t)(begun - waits));
    bus_silent(&bus, 1);
    bus_forget(&bus);
    p->time_us += p->work_us;
    p->due--;
}

static void begin_paced(enum overrun_policy policy, unsigned timeout, struct pace *p)
{
    bus_start_rig(&bus);
    bus_set(&bus, SETTING_FIRST + SET_OVERRUN_POLICY, policy);
    bus_set_now(&bus, SETTING_FIRST + SET_TIMEOUT_FRAMES, timeout);
    bus_forget(&bus);
    p->next = bus.app.frame;
    p->time_us = p->next * PERIOD_US;
}

/* From the controller's last heartbeat, sent now, to the time-out. True when it comes in the first frame that
 * begins when twice the time-out and two frames have passed, or before. */
static bool found_out(struct pace *p, unsigned timeout, double *took_us)
{
    uint64_t sent_us = p->time_us, frame_us = p->work_us > PERIOD_US ? p->work_us : PERIOD_US;
    bus_enable(&bus, true);
    for (unsigned i = 0; i < 8 * timeout && bus.app.enabled; i++) {
        bool last = p->time_us - sent_us > 2 * timeout * PERIOD_US + frame_us + PERIOD_US;
        turn(p);
        *took_us = (double)(p->time_us - p->work_us - sent_us);
        if (last)
            break;
    }
    return !bus.app.enabled;
}

TEST(app_silence_bound)
{
    static const char *const name[] = {"catch up", "skip", "freeze", "stop"};
    for (int policy = OVERRUN_CATCH_UP; policy <= OVERRUN_STOP; policy++) {
        double worst = 0.0;
        int undetected = 0, early = 0, untrue = 0;
        for (uint64_t seed = 1; seed <= SILENCE_SEEDS; seed++) {
            struct pace p = {.seed = seed * 4 + (uint64_t)policy};
            double took_us = 0.0;
            unsigned timeout = 10 + pace_draw(&p, 100);
            p.work_us = pace_draw(&p, 4) ? pace_draw(&p, PERIOD_US * 3 / 2) : pace_draw(&p, PERIOD_US * 12);
            p.away_percent = pace_draw(&p, 3) ? pace_draw(&p, 100) : 0;
            p.away_us = 1 + pace_draw(&p, timeout * PERIOD_US);
            p.every_us = pace_draw(&p, 3) ? 0 : p.away_us + 1 + pace_draw(&p, p.away_us);
            begin_paced((enum overrun_policy)policy, timeout, &p);
            undetected += !found_out(&p, timeout, &took_us);
            early += took_us < (timeout - 1) * (double)PERIOD_US;
            double age_us = (double)session_command_age(&bus.app) * PERIOD_US;
            untrue += fabs(age_us - took_us) > p.work_us + 2.0 * PERIOD_US;
            worst = took_us / timeout > worst ? took_us / timeout : worst;
        }
        printf(
            "      %s: %d patterns of absences and slow frames, the latest reaction after %.2f time-outs\n",
            name[policy], SILENCE_SEEDS, worst / PERIOD_US);
        check_int("dead controllers not found out within twice the time-out, or at the end of an absence",
                  undetected, 0);
        check_int("or found dead before it", early, 0);
        check_int("ages told that are not the truth", untrue, 0);
    }
}

/* A plant 10 % too slow for ever, and one that is stopped for 85 of every 86 ms. */
TEST(app_silence_examples)
{
    for (int policy = OVERRUN_CATCH_UP; policy <= OVERRUN_STOP; policy++) {
        struct pace slow = {.work_us = 1100}, stopped = {.work_us = 100, .away_us = 85000, .every_us = 86000};
        double slow_us = 0.0, stopped_us = 0.0;
        begin_paced((enum overrun_policy)policy, 100, &slow);
        check_true("frames of 1.1 ms: found out", found_out(&slow, 100, &slow_us));
        begin_paced((enum overrun_policy)policy, 100, &stopped);
        check_true("stopped for 85 of 86 ms: found out", found_out(&stopped, 100, &stopped_us));
        printf("      policy %d: after %.1f ms and %.1f ms, time-out 100 ms\n", policy, 1e-3 * slow_us,
               1e-3 * stopped_us);
        check_below("ms", 1e-3 * slow_us, 113.0);
        check_below("ms", 1e-3 * stopped_us, 3 * 86.0 + 1.0);
    }
}

/* A controller that answers what it hears, so that it says
 * nothing while the plant is away: a heartbeat every 20 frames. */
TEST(app_silence_alive)
{
    for (int policy = OVERRUN_CATCH_UP; policy <= OVERRUN_FREEZE; policy++) {
        int lost = 0;
        for (uint64_t seed = 1; seed <= SILENCE_SEEDS / 10; seed++) {
            struct pace p = {.seed = seed, .work_us = 300};
            begin_paced((enum overrun_policy)policy, 100, &p);
            unsigned at = 40 + pace_draw(&p, 20);
            for (unsigned i = 0; i < 200; i++) {
                if (i % 20 == 0)
                    bus_command(&bus, WIRE_ENABLE, (double[WIRE_FIELDS]){0, 1, (double)(bus.app.frame - 1)});
                p.time_us +=
                    i == at ? pace_draw(&p, 99) * PERIOD_US : 0; /* shorter than the time-out, at any time */
                turn(&p);
            }
            lost += !bus.app.enabled;
        }
        printf("      policy %d, one absence shorter than the time-out\n", policy);
        check_int("sessions of a living controller lost", lost, 0);
    }
}
