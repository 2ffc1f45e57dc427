/* bus.h - an app on one port of a loopback bus and a controller on the other, for tests: frames in, frames out.
 *
 * The controller keeps counters and session as a good controller would; a test changes them to be a bad one. Commands
 * are sent at once and taken by the next frame; bus_run and bus_silent collect what the plant says. */
#ifndef TESTS_BUS_H
#define TESTS_BUS_H

#include "firmware/app.h"
#include "hal/loopback.h"
#include "models/hertz_rig.h"

enum { BUS_SEEN = 20000, BUS_CAPTURE = 8192 };

struct bus {
    struct loopback_bus wires;
    struct app app;
    struct wire_scene scene; /* the controller's: what it encodes and decodes with */
    uint8_t session;
    uint8_t counter[WIRE_COMMANDS]; /* of the next command of each kind */
    struct message seen[BUS_SEEN];  /* telemetry in order of arrival, since bus_forget */
    int n_seen;
    float capture[BUS_CAPTURE];
};

/* Default rig, rk4, 1 ms frames, 16 ticks a frame, base identifier 0x200. */
struct app_config bus_config(void);

/* A fresh app on a fresh bus; not in session. */
void bus_start(struct bus *b, const struct app_config *c);

/* The same, in session 1 and running. */
void bus_start_running(struct bus *b, const struct app_config *c);

/* From here on the controller speaks in the session after the plant's last one; the next bus_run opens it. */
void bus_next_session(struct bus *b);

/* A raw frame to the plant. */
void bus_put(struct bus *b, const struct frame *f);

/* The frame of a command in the controller's session, with the counter of its kind; value[0] is filled in. */
void bus_encode(struct bus *b, unsigned kind, const double value[WIRE_FIELDS], struct frame *f);
void bus_command(struct bus *b, unsigned kind, const double value[WIRE_FIELDS]);

void bus_enable(struct bus *b, bool on); /* echoes the app's frame */
void bus_control(struct bus *b, enum control_operation operation, double argument);
void bus_order(struct bus *b, enum control_operation operation); /* argument: the app's frame */
void bus_arm(struct bus *b, int channel, enum arm_field field, double value);
void bus_drive(struct bus *b, int channel, double amplitude, double frequency_Hz, double phase_rad,
               double ramp_s);
void bus_fire(struct bus *b, unsigned channels, bool parameters, uint64_t tick, unsigned fraction_256);
void bus_stream(struct bus *b, int channel, uint64_t frame, double value);
void bus_write(struct bus *b, unsigned index, double value);
void bus_commit(struct bus *b, const struct staged *set, enum commit_when when);
void bus_set(struct bus *b, unsigned index, double value); /* one value, committed now; runs no frame */

/* n frames with a heartbeat in each, or without any. */
void bus_run(struct bus *b, int n);
void bus_silent(struct bus *b, int n);

/* Takes what the plant has sent. */
void bus_collect(struct bus *b);
void bus_forget(struct bus *b);

/* The last message of a kind, or NULL; how many there were. */
const struct message *bus_last(const struct bus *b, unsigned kind);
int bus_count(const struct bus *b, unsigned kind);

/* One value of the last message of a kind; NaN when there was none. */
double bus_value(const struct bus *b, unsigned kind, int field);

/* Cause of the last REPLY to a command of this kind; -1 when there was none. */
int bus_cause(const struct bus *b, unsigned kind);

/* The newest value of an item of LEDGER, HEALTH, INFO or PARAM_ECHO; NaN when it was not told. */
double bus_item(const struct bus *b, unsigned kind, unsigned item);

/* Checks that the bits of two doubles are equal. */
void check_bits(const char *name, double got, double expected);

#endif
