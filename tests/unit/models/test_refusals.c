/* test_refusals.c - refusals of models, names, logs, faults and links; drives and noise at the ends of
 * their ranges. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "firmware/plant/plant.h"
#include "firmware/plant/plant_change.h"
#include "hal/can/can.h"
#include "hal/link/faults.h"
#include "hal/posix/log.h"
#include "hal/link/loopback.h"
#include "hal/ethernet/net.h"
#include "hal/posix/log_read.h"
#include "host_sim/replay/replay_source.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/scenes/scenes.h"
#include "tests/unit/test.h"

static char path[] = "/tmp/contactplant_refusals_XXXXXX";

static void new_path(void)
{
    memcpy(path + strlen(path) - 6, "XXXXXX", 6);
    close(mkstemp(path));
}

TEST(refusals_names)
{
    const struct scene_drive held = {.noise_hold = 2.4};
    check_true("a method by name", method_find("taylor") == &taylor);
    check_true("none of this name", method_find("Taylor") == NULL);
    check_true("no scene of this name", scenes_find("") == NULL);
    check_near("noise held for 2.4 steps of 1", scenes_noise_steps(&held, 1.0), 2.0, 0.0);
    check_near("for 1.2 steps of 2: at least one", scenes_noise_steps(&held, 2.0), 1.0, 0.0);
}

/* si with n values put in place: the reason must contain this. */
static void model_refuses(const struct model *m, int n, const int *index, const double *value,
                          const char *part)
{
    double si[MODEL_PARAMETERS];
    int which;
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = m->parameter[i].initial;
    for (int i = 0; i < n; i++)
        si[index[i]] = value[i];
    const char *why = plant_check(m, si, &which);
    check_contains(part, why, part);
    check_int("  each of them is inside its range", which, -1);
}

TEST(refusals_models)
{
    /* zs = 1e-4 m, so nu = sqrt(1.5e-9/(1e6 * 1e-4)) = 4e-6 rad/s */
    model_refuses(&hertz_rig, 4, (const int[]){RIG_MASS, RIG_CONTACT_STIFFNESS, RIG_PRELOAD, RIG_DAMPING},
                  (const double[]){1e6, 1e-3, 1e-9, 0.0}, "contact eigenfrequency outside");
    /* sqrt(1e-9 N/m / 1 kg) = 3e-5 rad/s; beta = 1.5 */
    model_refuses(&afm_tip, 6,
                  (const int[]){TIP_MASS, TIP_LEVER_STIFFNESS, TIP_DAMPING, TIP_CONTACT_STIFFNESS,
                                TIP_INDENTATION, TIP_SIGN},
                  (const double[]){1.0, 1e-9, 0.0, 1e-9, 1.0, -1.0}, "eigenfrequency of the lever outside");
}

/* 2.7e18 parts of a tick have more bits than a double: near the end the ramp's position rounds to 1. */
TEST(refusals_longest_ramp)
{
    struct drive d;
    struct wave w;
    struct input u[3];
    const struct drive_setting from = {1.0, 0.1, 0.0, 0}, to = {2.0, 0.2, 0.25, (uint64_t)41 << 40};
    drive_init(&d);
    drive_start(&d, &from);
    drive_change(&d, &to);
    d.ramp_left = TICK_FRACTIONS + 100;
    (void)drive_segment(&d, TICK_FRACTIONS, 1.0, &w, &u[0], &u[1], &u[2]);
    check_int("left", (int64_t)d.ramp_left, 100);
    check_hex("frequency of its end", d.step, d.step_to);
    check_hex("phase of its end", d.offset, d.offset_to);
    check_near("amplitude", d.amplitude, 2.0, 0.0);
    (void)drive_segment(&d, 100, 1.0, &w, &u[0], &u[1], &u[2]);
    check_int("and there it ends", (int64_t)d.ramp_left, 0);
}

/* Noise that begins at once is noise that was always there:
 * from the first instant on the same as after a ramp. */
TEST(refusals_noise_start)
{
    static const struct noise_setting setting = {0.5, 3, 7};
    const double deviate = noise_deviate(noise_word((UINT64_C(1) << 32) + 7, 4));
    struct noise n;
    struct segment e;
    memset(&e, 0, sizeof e);
    noise_init(&n, 1, false);
    noise_start(&n, &setting);
    check_true("it sounds", n.active);
    check_true("a first segment", noise_add(&n, &(struct noise_span){13, 0.0, 1.0, 1.0, 1.0}, &e, 1));
    check_near("tick 13 with hold 3: value 4", e.at[0][1].value, 0.5 * deviate, 1e-16);
    check_near("to its end", e.at[2][1].value, 0.5 * deviate, 1e-16);
    noise_start(&n, &(struct noise_setting){0.0, 3, 7});
    check_true("deviation 0: silent", !n.active);
}

TEST(refusals_faults)
{
    static struct faults f;
    static struct loopback_bus wires;
    const struct faults_rule good = {FAULTS_DROP, true, true, 0.5, 1, 0, UINT64_MAX};
    struct faults_rule r = good;
    loopback_init(&wires, 1, 1);
    faults_init(&f, &wires.port[0].hal, 1);
    r.probability = 1.5;
    check_string("probability 1.5", faults_add(&f, &r), "a probability is 0 to 1");
    r.probability = (double)NAN;
    check_string("probability not a number", faults_add(&f, &r), "a probability is 0 to 1");
    r = good;
    r.kind = FAULTS_DELAY;
    r.frames = 0;
    check_string("a delay of 0 frames", faults_add(&f, &r), "delay and burst last 1 frame or more");
    r = good;
    r.begin = r.until = 10;
    check_string("from 10 to 10", faults_add(&f, &r), "a fault ends after it begins");
    r = good;
    r.kind = FAULTS_FREEZE;
    check_string("a freeze for ever", faults_add(&f, &r), "a freeze needs an end; give freeze@FROM:UNTIL");
    check_int("nothing was taken", f.n_rules, 0);
}

static int64_t lines_in_file(void)
{
    char text[256];
    int64_t n = 0;
    FILE *f = fopen(path, "r");
    while (fgets(text, sizeof text, f))
        n++;
    fclose(f);
    return n;
}

/* More lines in one frame than the buffer holds; a file that cannot be closed; a file that is no text. */
TEST(refusals_log)
{
    static struct log record;
    static struct loopback_bus wires;
    const struct frame f = {.id = 0x254, .length = 8};
    struct log_reader reader;
    struct log_line line;
    new_path();
    loopback_init(&wires, 1, 1);
    check_no_error("opens", log_open(&record, path, "can0", &wires.port[0].hal));
    for (int i = 0; i < 3000; i++)
        record.hal.send(record.hal.context, &f);
    check_no_error("closes", log_close(&record));
    check_int("3000 frames without a flush, behind the first line", lines_in_file(), 3001);
    check_no_error("opens again", log_open(&record, path, "can0", &wires.port[0].hal));
    close(record.file);
    const char *why = log_close(&record);
    check_contains("an error that closing tells", why, "Bad file descriptor");
    FILE *text = fopen(path, "w");
    fwrite("\0\n", 1, 2, text);
    fclose(text);
    check_no_error("a reader", log_reader_open(&reader, path));
    check_int("a zero byte", log_read_line(&reader, &line), -1);
    check_contains("  is told", reader.reason, "line 1, column 1: a zero byte");
    log_reader_close(&reader);
    unlink(path);
}

static void write_lines(FILE *f, int n, const char *what)
{
    for (int i = 0; i < n; i++)
        fprintf(f, "(0000000001.000000) can0 %s\n", what);
}

TEST(refusals_replay)
{
    static struct replay r;
    const struct wire_scene scene = {.base_id = 0x240, .lsb = {1.0, 1.0, 1.0, 1.0}};
    new_path();
    FILE *f = fopen(path, "w");
    write_lines(f, 3, "262#00");
    write_lines(f, REPLAY_LINES, "242#00");
    fclose(f);
    check_no_error("opens", replay_open(&r, path, NULL, &scene, 1e-3, NULL));
    check_int("a frame of as many commands as there is room for", replay_frame(&r, 0), 1);
    check_int("the recorder's own self-test is left out", (int64_t)r.excluded_lines, 3);
    replay_close(&r);
    f = fopen(path, "a");
    write_lines(f, 1, "242#00");
    fclose(f);
    check_no_error("opens with one more", replay_open(&r, path, NULL, &scene, 1e-3, NULL));
    check_int("is refused", replay_frame(&r, 0), -1);
    check_contains("and says so", r.reason, "more than 262144 lines in one bus frame");
    replay_close(&r);
    unlink(path);
}

static int hear_nothing(void *context, uint8_t *frame)
{
    (void)context, (void)frame;
    return 0;
}

static bool take_nothing(void *context, const uint8_t *frame, size_t n)
{
    (void)context, (void)frame, (void)n;
    return false;
}

/* An Ethernet controller that takes no packet: counted,
 * not waited for. A CAN driver has no watchdog to feed. */
TEST(refusals_links)
{
    static struct net n;
    const struct ethernet full = {NULL, hear_nothing, take_nothing};
    const struct net_config c = {
        {{2, 0, 0, 0, 0, 1}, {{192, 0, 2, 15}, {0x4E, 0x20}}}, 1, {{{192, 0, 2, 7}, {0x4E, 0x21}}}};
    check_no_error("opens", net_open(&n, &c, &full));
    check_true("its peer stays unknown", !net_resolve(&n, true));
    check_int("questions refused", (int64_t)n.refused, 1);
    can_no_watchdog(NULL);
}
