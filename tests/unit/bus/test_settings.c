/* test_settings.c - the tables of settings and counters: complete, consistent, and what a setting refuses. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/bus/diag.h"
#include "firmware/bus/mailbox.h"
#include "firmware/bus/settings.h"
#include "models/hertz_rig.h"

TEST(settings_table)
{
    int unnamed = 0, refused = 0, inexact = 0, twice = 0;

    for (int i = 0; i < SETTINGS; i++) {
        const struct parameter *s = &setting_table[i];
        if (!s->name || !s->unit || !s->meaning) {
            unnamed++;
            continue;
        }
        refused +=
            !setting_accepts(i, s->initial) || !setting_accepts(i, s->min) || !setting_accepts(i, s->max);
        inexact += (double)(float)s->min != s->min || (double)(float)s->max != s->max;
        for (int k = 0; k < i; k++)
            twice += setting_table[k].name && strcmp(setting_table[k].name, s->name) == 0;
    }
    check_int("settings without a name", unnamed, 0);
    check_int("names used twice", twice, 0);
    check_int("defaults or limits refused", refused, 0);
    check_int("limits that float32 does not hold", inexact, 0);
    check_is("wire indices fit", SETTING_FIRST + SETTINGS, <=, STAGED_VALUES);
    check_true("a half frame is refused", !setting_accepts(SET_TIMEOUT_FRAMES, 100.5));
    check_true("a half second is taken", setting_accepts(SET_REACTION_RAMP_S, 0.5));
    check_true("above the range", !setting_accepts(SET_REACTION, 4.0));
    check_true("below the range", !setting_accepts(SET_SYNC_EVERY, 0.0));
    check_true("a sampled base cannot jump", !setting_accepts(SET_STREAM_LINEAR + 2, 0.0));
    check_true("not a number", !setting_accepts(SET_LEDGER_ALARM, (double)NAN) &&
                                   !setting_accepts(SET_REACTION, (double)NAN));
    check_true("infinite", !setting_accepts(SET_REACTION_RAMP_S, HUGE_VAL));
    check_string("last input", setting_table[SET_STREAM_LINEAR_LAST].name, "stream_linear_stiffness");
    check_string("last slot", setting_table[SET_LOCKIN_OUTPUT_LAST].name, "lockin_output_3");
    check_string("last setting", setting_table[SETTINGS - 1].name, "stream_echo_every");
}

/* A dead controller has as long at any rate; where frames are long, it has some of them. */
TEST(settings_seconds)
{
    static const struct {
        double rate_Hz, timeout, age_limit;
    } row[] = {{1e6, 10000, 10000}, {20000, 2000, 1000}, {10000, 1000, 500}, {1000, 100, 50},
               {300, 30, 50},       {200, 20, 50},       {100, 20, 50},      {1, 20, 50}};
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        check_near("frames to a time-out",
                   setting_initial(SET_TIMEOUT_FRAMES, &hertz_rig, 1.0 / row[i].rate_Hz), row[i].timeout,
                   0.0);
        check_near("frames that an echo may be old",
                   setting_initial(SET_AGE_LIMIT_FRAMES, &hertz_rig, 1.0 / row[i].rate_Hz), row[i].age_limit,
                   0.0);
    }
    check_near("the table's, at 1000 frames a second", setting_initial(SET_TIMEOUT_FRAMES, &hertz_rig, 1e-3),
               setting_table[SET_TIMEOUT_FRAMES].initial, 0.0);
    check_near("the table's, at 1000 frames a second",
               setting_initial(SET_AGE_LIMIT_FRAMES, &hertz_rig, 1e-3),
               setting_table[SET_AGE_LIMIT_FRAMES].initial, 0.0);
}

TEST(diag_names)
{
    int unnamed = 0, twice = 0;

    for (int i = 0; i < DIAG_COUNTERS; i++) {
        if (!diag_name[i].name || !diag_name[i].unit || !diag_name[i].meaning) {
            unnamed++;
            continue;
        }
        for (int k = 0; k < i; k++)
            twice += diag_name[k].name && strcmp(diag_name[k].name, diag_name[i].name) == 0;
    }
    check_int("counters without a name", unnamed, 0);
    check_int("names used twice", twice, 0);
    check_string("first", diag_name[DIAG_FRAMES_RECEIVED].name, "frames_received");
    check_string("last", diag_name[DIAG_SENSOR_FAULTS].name, "sensor_faults");
}
