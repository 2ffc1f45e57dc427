/* test_afm_blocks.c - blocks of converter codes over a bus: the delay, equal bits, closed forms, refusals. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/afm/afm_plant.h"
#include "firmware/afm/codes.h"
#include "firmware/plant/plant_report.h"
#include "firmware/stage/stages.h"
#include "host_sim/library/library.h"
#include "tests/fixture/afm/plant_bus.h"
#include "tests/fixture/bus.h"

#define TWO_PI 6.283185307179586

enum { BLOCK = 8, BLOCKS = 40, HIGHEST = 32767, LOWEST = -32768 };

static struct bus bus, kept_bus;
STATIC_ASSERT(sizeof(struct stages) <= METHOD_SCRATCH * sizeof(double), stages_fit);
static double scratch[METHOD_SCRATCH], kept_scratch[METHOD_SCRATCH], si[MODEL_PARAMETERS], setting[SETTINGS];

/* The codes that the board heard last, by place in the block, and how many. */
static int deflection[MAILBOX_CODES], z_sensor[MAILBOX_CODES], heard;

/* A cold lever 100 nm over the sample that all loops leave alone. */
static void blocks_defaults(void)
{
    plant_bus_defaults(si, setting, 1e-3);
    si[AFM_PLANT_NUMBERS + STATION_Z_LOOP] = si[AFM_PLANT_NUMBERS + STATION_DRIVE] = 0.0;
}

/* Samples of 1/32 of the lever's period, in frames of so many. */
static void blocks_start(uint32_t samples, double frame_s)
{
    struct app_config c = plant_bus_config(si, setting, samples, scratch);
    c.frame_s = frame_s;
    c.dilation = frame_s / samples * 32.0 * si[LEVER_F0];
    bus_start_running(&bus, &c);
}

static void put(uint64_t tick, int dither, int z)
{
    bus_command(&bus, WIRE_DAC, (double[WIRE_FIELDS]){0, (double)(uint16_t)tick, dither, z});
}

/* Runs a frame, and hears its block. */
static void exchange(void)
{
    uint64_t first = bus.app.plant.now.tick;
    bus_forget(&bus);
    bus_run(&bus, 1);
    heard = 0;
    for (int i = 0; i < bus.n_seen; i++) {
        const struct message *m = &bus.seen[i];
        if (m->kind != WIRE_ADC || (int16_t)(uint16_t)((uint16_t)m->value[ADC_TICK] - first) < 0)
            continue; /* that of an earlier frame had to wait for room */
        check_is("its tick", (uint16_t)m->value[ADC_TICK], ==, (uint16_t)(first + (unsigned)heard));
        deflection[heard] = (int)m->value[ADC_DEFLECTION];
        z_sensor[heard++] = (int)m->value[ADC_Z_SENSOR];
    }
}

static uint64_t hash(void)
{
    return plant_hash(&bus.app.plant) ^ station_hash(afm_plant_station(scratch), 1);
}

/* ---- closed forms ---- */

/* A board sends back what it has just heard. So a period of a sine that it sends once comes again in each
 * block, if the way through both is one block. */
TEST(afm_blocks_delay_of_one_block)
{
    int sine[BLOCK], wrong = 0;
    blocks_defaults();
    blocks_start(BLOCK, 1e-3);
    for (int k = 0; k < BLOCK; k++)
        put(bus.app.plant.now.tick + (unsigned)k, 0,
            sine[k] = (int)floor(3000.0 * sin(TWO_PI * k / BLOCK) + 0.5));
    for (int block = 0; block < BLOCKS; block++) {
        exchange();
        check_int("samples of a block", heard, BLOCK);
        for (int k = 0; k < BLOCK; k++) {
            wrong += z_sensor[k] != sine[k];
            put(bus.app.plant.now.tick + (unsigned)k, 0, z_sensor[k]);
        }
    }
    check_int("codes that are not those of a block before", wrong, 0);
    check_int("samples applied", (int)bus.app.count[DIAG_STREAM_APPLIED], BLOCK * BLOCKS);
    check_int("  and missed", (int)bus.app.count[DIAG_STREAM_MISSED], 0);
}

/* A tone of 3 V at the resonance has 30 nm, less what the DAC's steps of 1/32 period take: sin(x)/x. */
TEST(afm_blocks_dither_at_resonance)
{
    double re = 0.0, im = 0.0, step = TWO_PI / 32.0, lsb_m = CODES_VOLT * 50e-9;
    blocks_defaults();
    si[LEVER_Q] = 20.0;
    si[LEVER_HEIGHT] = 1e-6;
    blocks_start(BLOCK, 1e-3);
    for (uint64_t i = 0; i < 200 * 4; i++) {
        for (uint64_t t = i * BLOCK; t < i * BLOCK + BLOCK; t++)
            put(t, (int)floor(3.0 / CODES_VOLT * cos(step * (double)(t % 32)) + 0.5), 0);
        exchange();
        for (uint64_t k = 0; k < BLOCK && i >= 199 * 4; k++) {
            re += deflection[k] * cos(step * (double)((i * BLOCK + k) % 32)) / 16.0;
            im += deflection[k] * sin(step * (double)((i * BLOCK + k) % 32)) / 16.0;
        }
    }
    double share = sin(0.5 * step) / (0.5 * step);
    check_near("amplitude, nm", hypot(re, im) * lsb_m * 1e9, 30.0 * share, 0.01);
    /* read a sample later than the step begins, of which half a sample is the held tone's own */
    check_near("phase, samples", (atan2(im, re) - TWO_PI / 4) / step, 0.5 - 1.0, 0.01);
}

/* ---- equal bits ---- */

static int tick_code(uint64_t tick, unsigned times)
{
    return (int)(tick * times % 2001) - 1000;
}

/* Blocks of 8, and frames of one sample. */
TEST(afm_blocks_equal_sample_by_sample)
{
    uint64_t end[2];
    int32_t sum[2] = {0, 0};
    for (int way = 0; way < 2; way++) {
        uint32_t samples = way == 0 ? BLOCK : 1;
        blocks_defaults();
        si[LEVER_TEMPERATURE] = 295.0;
        si[LEVER_HEIGHT] = 60e-9;
        blocks_start(samples, 1e-3 / BLOCK * samples);
        for (uint64_t tick = 0; tick < BLOCK * BLOCKS; tick += samples) {
            for (uint64_t t = tick; t < tick + samples; t++)
                put(t, tick_code(t, 373), tick_code(t, 7) - 400);
            exchange();
            for (int k = 0; k < heard; k++)
                sum[way] = sum[way] * 31 % 65521 + deflection[k];
        }
        end[way] = hash();
    }
    check_hex("hash after 40 blocks of 8", end[0], end[1]);
    check_int("checksum of the codes that were read", sum[0], sum[1]);
}

static union contactplant_afm_memory memory;

static struct contactplant_afm *open_same(void)
{
    struct contactplant_error error;
    struct contactplant_afm *a =
        contactplant_afm_open(&memory, sizeof memory,
                              "[plant]\nmodel = afm_lever\nmethod = modal\n[deadline]\nframe = 1 "
                              "ms\nsubsteps = 32\ndilation = 280\n",
                              &error);
    check_string("open", error.text, "");
    return a;
}

/* Codes in, codes out: those of a program that calls the microscope itself. */
TEST(afm_blocks_equal_the_library)
{
    struct contactplant_afm *a = open_same();
    int32_t dac[CONTACTPLANT_AFM_DACS] = {0}, adc[CONTACTPLANT_AFM_ADCS];
    int wrong = 0, span = 0;
    blocks_defaults();
    blocks_start(BLOCK, 1e-3);
    for (uint64_t tick = 0; tick < BLOCK * BLOCKS; tick += BLOCK) {
        for (uint64_t t = tick; t < tick + BLOCK; t++)
            put(t, tick_code(t, 373), tick_code(t, 7));
        exchange();
        for (uint64_t k = 0; k < BLOCK; k++) {
            dac[CONTACTPLANT_AFM_DITHER] = tick_code(tick + k, 373);
            dac[CONTACTPLANT_AFM_Z] = tick_code(tick + k, 7);
            check_int("a sample", contactplant_afm_sample(a, dac, adc), CONTACTPLANT_OK);
            wrong += deflection[k] != adc[CONTACTPLANT_AFM_DEFLECTION] ||
                     z_sensor[k] != adc[CONTACTPLANT_AFM_Z_SENSOR];
            span = abs(deflection[k]) > span ? abs(deflection[k]) : span;
        }
    }
    check_int("codes that differ", wrong, 0);
    check_above("the lever moves, codes", span, 500);
}

/* A block that waits is part of the app: a copy goes on with it. */
TEST(afm_blocks_snapshot)
{
    uint64_t end[2];
    blocks_defaults();
    blocks_start(BLOCK, 1e-3);
    bus_order_now(&bus, CONTROL_PAUSE);
    for (unsigned k = 0; k < BLOCK; k++)
        put(bus.app.plant.now.tick + k, 1000, 100 * (int)k);
    exchange();
    check_int("time stands: nothing is read", heard, 0);
    kept_bus = bus;
    memcpy(kept_scratch, scratch, sizeof scratch);
    for (int way = 0; way < 2; way++) {
        bus_control(&bus, CONTROL_STEP, 1.0);
        exchange();
        check_int("the block is applied", z_sensor[BLOCK - 1], 700);
        end[way] = hash();
        bus = kept_bus;
        memcpy(scratch, kept_scratch, sizeof scratch);
    }
    check_hex("both", end[1], end[0]);
}

/* ---- what does not fit ---- */

/* The whole range of codes, and readings beyond it. */
TEST(afm_blocks_ends_of_the_range)
{
    blocks_defaults();
    si[LEVER_HEIGHT] = 1e-5;
    si[AFM_PLANT_DEFLECTION_GAIN] = 1e-15;
    blocks_start(2, 1e-3);
    put(0, 0, HIGHEST);
    put(1, 0, LOWEST);
    exchange();
    check_int("highest z", z_sensor[0], HIGHEST);
    check_int("lowest z", z_sensor[1], LOWEST);
    check_int("deflection below the range", deflection[0], LOWEST);
    check_int("  and above it", deflection[1], HIGHEST);
}

/* A block that stays away, is too short, comes late or is too long: the last code stays, and it counts. */
TEST(afm_blocks_missing_and_late)
{
    blocks_defaults();
    blocks_start(BLOCK, 1e-3);
    exchange();
    check_int("no block, no codes", heard, 0);
    check_int("  nothing missed", (int)bus.app.count[DIAG_STREAM_MISSED], 0);
    for (unsigned k = 0; k < BLOCK; k++)
        put(bus.app.plant.now.tick + k, 0, 10 * (int)k);
    exchange();
    exchange();
    check_int("none: the last code stays", z_sensor[0], 70);
    check_int("  to the end", z_sensor[BLOCK - 1], 70);
    check_int("  missed", (int)bus.app.count[DIAG_STREAM_MISSED], BLOCK);
    for (unsigned k = 0; k < 3; k++)
        put(bus.app.plant.now.tick + k, 0, 20 + (int)k);
    exchange();
    check_int("three samples", z_sensor[2], 22);
    check_int("  and the last of them", z_sensor[BLOCK - 1], 22);
    check_int("  missed", (int)bus.app.count[DIAG_STREAM_MISSED], BLOCK + BLOCK - 3);
    put(bus.app.plant.now.tick - 2, 0, 5);
    exchange();
    check_int("late", bus_cause(&bus, WIRE_DAC), CAUSE_LATE);
    check_near("  by ticks", bus_value(&bus, WIRE_REPLY, REPLY_TICKS_LATE), 2.0, 0.0);
    put(bus.app.plant.now.tick + BLOCK, 0, 5);
    exchange();
    check_int("beyond the coming frame", bus_cause(&bus, WIRE_DAC), CAUSE_STALE);
    check_int("  neither acts", z_sensor[0], 22);
}

/* Frames that are made up in one go: the block counts for the first of them, the last one is told. */
TEST(afm_blocks_overrun)
{
    blocks_defaults();
    setting[SET_OVERRUN_POLICY] = OVERRUN_SKIP;
    blocks_start(BLOCK, 1e-3);
    bus_run(&bus, 1);
    for (unsigned k = 0; k < BLOCK; k++)
        put(BLOCK + k, 0, 10 * (int)k);
    bus_forget(&bus);
    check_int("one call is due", (int)app_overrun(&bus.app, 1), 1);
    bus_run(&bus, 1);
    check_int("codes of one frame", bus_count(&bus, WIRE_ADC), BLOCK);
    check_near("  the last tick", bus_value(&bus, WIRE_ADC, ADC_TICK), 3 * BLOCK - 1, 0.0);
    check_near("  it holds", bus_value(&bus, WIRE_ADC, ADC_Z_SENSOR), 10 * (BLOCK - 1), 0.0);
    check_int("  missed", (int)bus.app.count[DIAG_STREAM_MISSED], BLOCK);
}

TEST(afm_blocks_refused)
{
    const struct app_config rig = bus_config();
    blocks_defaults();
    blocks_start(MAILBOX_CODES + 1, 1e-3);
    put(0, 0, 5);
    exchange();
    check_int("33 samples in a frame", bus_cause(&bus, WIRE_DAC), CAUSE_FULL);
    blocks_start(MAILBOX_CODES, 1e-3);
    put(MAILBOX_CODES - 1, 0, 5);
    exchange();
    check_int("32", heard, MAILBOX_CODES);
    check_int("  the last of them", z_sensor[MAILBOX_CODES - 1], 5);
    bus_order_now(&bus, CONTROL_STOP);
    bus_next_session(&bus);
    bus_run(&bus, 1);
    put(bus.app.plant.now.tick, 0, 5);
    exchange();
    check_int("in STOPPED", bus_cause(&bus, WIRE_DAC), CAUSE_STATE);
    bus_start_running(&bus, &rig);
    put(0, 0, 5);
    exchange();
    check_int("a plant without stages", bus_cause(&bus, WIRE_DAC), CAUSE_UNKNOWN);
}

/* A plant with stages has no converters. */
TEST(afm_blocks_refused_by_a_rig)
{
    struct app_config rig = bus_config();
    rig.stage_calls = &stages_for_plants;
    rig.stages = (struct stages *)(void *)scratch;
    bus_start_running(&bus, &rig);
    put(0, 0, 5);
    exchange();
    check_int("a plant with stages", bus_cause(&bus, WIRE_DAC), CAUSE_UNKNOWN);
}

/* A bus that has no room for the codes of a block takes no further one. */
TEST(afm_blocks_without_room)
{
    blocks_defaults();
    blocks_start(BLOCK, 1e-3);
    bus.wires.port[0].tx_limit = 5;
    put(bus.app.plant.now.tick, 0, 5);
    exchange();
    check_is("codes that found no room", heard, <, BLOCK);
    check_above("  are counted", bus.app.telemetry.replaced, 0);
    put(bus.app.plant.now.tick, 0, 6);
    bus.wires.port[0].tx_limit = 1000;
    exchange();
    check_int("the next block", bus_cause(&bus, WIRE_DAC), CAUSE_FULL);
    put(bus.app.plant.now.tick, 0, 7);
    exchange();
    check_int("with room again", z_sensor[0], 7);
}

/* A stop forgets a block that waits, and ends the exchange. */
TEST(afm_blocks_stop)
{
    blocks_defaults();
    blocks_start(BLOCK, 1e-3);
    put(0, 0, 500);
    exchange();
    put(bus.app.plant.now.tick + 1, 0, 900);
    bus_order(&bus, CONTROL_STOP);
    exchange();
    check_int("no codes", heard, 0);
    check_is("  none waits", bus.app.mailbox.block.given, ==, 0u);
    bus_next_session(&bus);
    bus_run(&bus, 1);
    bus_order(&bus, CONTROL_START);
    exchange();
    check_int("started again: no codes", heard, 0);
    check_near("  z is back, m", bus.app.plant.x[AFM_PLANT_HEIGHT], 0.0, 0.0);
    put(bus.app.plant.now.tick, 0, 3);
    exchange();
    check_int("a new exchange", z_sensor[0], 3);
}

/* Gains whose codes would leave the numbers of a drive. */
TEST(afm_blocks_gains)
{
    int which;
    blocks_defaults();
    si[LEVER_RANGE] = 1e-9;
    check_no_error("the defaults", afm_plant_check(si, &which));
    si[AFM_PLANT_Z_GAIN] = 1.0;
    check_contains("1 m/V of z", afm_plant_check(si, &which), "larger range_m");
    check_int("  by its gain", which, AFM_PLANT_Z_GAIN);
    si[AFM_PLANT_DITHER_GAIN] = 1.0;
    si[LEVER_Q] = 1.0;
    check_contains("1 m/V of dither", afm_plant_check(si, &which), "too large for this lever");
    check_int("  by its gain", which, AFM_PLANT_DITHER_GAIN);
}
