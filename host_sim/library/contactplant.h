/* contactplant.h - a real-time plant in a program of your own: the one public header of libcontactplant,
 * and its manual.
 *
 * A plant is a mechanical system whose contact makes and breaks: a mass on a preloaded Hertzian contact, an
 * AFM tip on a sample, a shaft in bearings with clearance. The program gives forces and reads motion,
 * contact force and contact events:
 *
 *     static union contactplant_memory memory;
 *     struct contactplant_error error;
 *     struct contactplant *rig = contactplant_open(&memory, sizeof memory, "hertz_rig", &error);
 *     if (!rig)
 *         return fail(error.text);
 *     int force = contactplant_find(rig, CONTACTPLANT_INPUT, "force");
 *     contactplant_set_drive(rig, force, 3.0, 225.0, 0.0, 0.1);   3 N at 225 Hz, ramped up in 0.1 s
 *     contactplant_advance_to(rig, 0.5);
 *     double newton = contactplant_output(rig, contactplant_find(rig, CONTACTPLANT_OUTPUT, "contact_force"));
 *
 * There are four ways to use it:
 *   a plant alone       contactplant_open: set inputs, advance time, read outputs and events
 *   a microscope        contactplant_afm_open: one call a sample, in codes of DAC and ADC
 *   a plant on a bus    contactplant_open_bus: `contactplant run` without sockets and clock
 *   a controller        contactplant_client_open: the other end of the bus, over a transport of the caller
 *
 * MEMORY AND THREADS. An object lives in the caller's memory. There is no heap, no global state, no file,
 * no output, and nothing to close: the memory is the caller's again when it is no longer used. It must not
 * be moved. Two objects know nothing of each other: each thread may have its own; one object is used by one
 * thread at a time.
 *
 * ERRORS. A function that can fail returns CONTACTPLANT_OK or a code above it, and has then changed
 * nothing. The text behind the code says what to do: contactplant_error(plant),
 * contactplant_client_error(client), or struct contactplant_error where there is no object yet. A function
 * that returns a number returns NaN or 0 then, a function that returns an index -1.
 *
 * UNITS. Everything is in SI: N, m, s, Hz, rad. Where a scene slows its plant down (dilation) seconds and
 * Hz are those of the slow plant, as on the bus.
 *
 * BITS. Equal calls give equal bits, with any compiler and on any machine. The program must leave the
 * processor's rounding mode alone: link without -ffast-math, which switches small numbers off.
 *
 * PROMISE. Within one CONTACTPLANT_ABI a program runs with every later library without being compiled
 * again. The sizes below are larger than what this version needs, so that it may grow. Enumerations grow at
 * their end; of the structs only contactplant_latest does. */
#ifndef CONTACTPLANT_H
#define CONTACTPLANT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define CONTACTPLANT_API __attribute__((visibility("default")))
#else
#define CONTACTPLANT_API
#endif

/* ---- versions ---- */

#define CONTACTPLANT_VERSION_MAJOR 0
#define CONTACTPLANT_VERSION_MINOR 9
#define CONTACTPLANT_VERSION_PATCH 0
#define CONTACTPLANT_VERSION       "0.9.0"
#define CONTACTPLANT_ABI           1 /* the number behind libcontactplant.so */
#define CONTACTPLANT_PROTOCOL      2 /* on the bus: docs/reference/protocol.md */

/* Those of the library that runs. A program that loads it by hand compares the ABI with its own. */
CONTACTPLANT_API const char *contactplant_version(void);
CONTACTPLANT_API int contactplant_abi(void);
CONTACTPLANT_API int contactplant_protocol(void);

/* ---- errors ---- */

enum contactplant_code {
    CONTACTPLANT_OK,
    CONTACTPLANT_BAD_HANDLE, /* NULL, or no object of this library */
    CONTACTPLANT_BAD_MEMORY, /* NULL, too small or not aligned */
    CONTACTPLANT_BAD_SCENE,  /* no such name, or a mistake in the text */
    CONTACTPLANT_BAD_NAME,   /* no such input, output, parameter or setting */
    CONTACTPLANT_BAD_INDEX,  /* no such index */
    CONTACTPLANT_BAD_VALUE,  /* outside its range, not finite, or a NULL pointer */
    CONTACTPLANT_BAD_ORDER,  /* not possible with this object, or not now */
    CONTACTPLANT_BAD_BYTES,  /* to be restored: damaged, of another version or of another scene */
    CONTACTPLANT_FULL,       /* no room; take frames, or send later */
    CONTACTPLANT_DIVERGED, /* the motion left the finite numbers; the plant stands at its last good instant */
    CONTACTPLANT_TIMEOUT,  /* waited in vain */
    CONTACTPLANT_REFUSED   /* by the plant at the other end */
};

enum { CONTACTPLANT_TEXT = 512 };

struct contactplant_error {
    int code;                     /* enum contactplant_code */
    char text[CONTACTPLANT_TEXT]; /* one line; "" with CONTACTPLANT_OK */
};

/* ---- opening a plant ---- */

struct contactplant;

/* Memory for a plant: CONTACTPLANT_SIZE bytes, aligned to CONTACTPLANT_ALIGN, do within this ABI.
 * contactplant_size() is what this version needs. On a bus, what is beyond serves the burst capture, 4
 * bytes a number. */
enum { CONTACTPLANT_SIZE = 131072, CONTACTPLANT_ALIGN = 8 };
union contactplant_memory {
    uint64_t word;
    double number;
    unsigned char bytes[CONTACTPLANT_SIZE];
};
CONTACTPLANT_API size_t contactplant_size(void);

/* A plant in these `size` bytes. `scene` is the name of a model, the name of a preset, or the text of a
 * scene file. A string with a line break or a bracket is a text. A model alone has its defaults: 64 ticks
 * of rk4 a millisecond. The plant is in the scene's initial state, its drives sound as soon as time runs.
 * NULL after a mistake: *error, where it is not NULL, says which, in a text with its line. */
CONTACTPLANT_API struct contactplant *contactplant_open(void *memory, size_t size, const char *scene,
                                                        struct contactplant_error *error);

/* Such a plant on a bus in memory: below. */
CONTACTPLANT_API struct contactplant *contactplant_open_bus(void *memory, size_t size, const char *scene,
                                                            struct contactplant_error *error);

/* The names that `scene` may be: model or preset number `i`, and one line about it; NULL when there are no
 * more. */
CONTACTPLANT_API const char *contactplant_scene_name(int i);
CONTACTPLANT_API const char *contactplant_scene_title(int i);

/* The text of the last call of this plant that failed; "" when none has. */
CONTACTPLANT_API const char *contactplant_error(const struct contactplant *plant);

/* ---- inputs, outputs and parameters: names, units, ranges ---- */

enum contactplant_kind {
    CONTACTPLANT_INPUT,     /* a force, a base that moves, a stiffness that varies */
    CONTACTPLANT_OUTPUT,    /* displacement, velocity, penetration, contact force, and more of some models */
    CONTACTPLANT_STATE,     /* the numbers that the model integrates */
    CONTACTPLANT_PARAMETER, /* a number of the model: a mass, a stiffness */
    CONTACTPLANT_SETTING    /* a number of the program on the bus: time-outs, intervals, sensor faults */
};
/* Settings are parameters whose index begins here, as on the wire. */
enum { CONTACTPLANT_SETTING_FIRST = 64 };

struct contactplant_number {
    const char *name, *unit, *meaning; /* live as long as the library */
    double min, max, initial;          /* an input, output or state has -infinity, infinity, 0 */
};

/* How many there are. */
CONTACTPLANT_API int contactplant_count(struct contactplant *plant, enum contactplant_kind kind);

/* The index of a name; -1, and the nearest name in the error, when there is none. */
CONTACTPLANT_API int contactplant_find(struct contactplant *plant, enum contactplant_kind kind,
                                       const char *name);

CONTACTPLANT_API int contactplant_describe(struct contactplant *plant, enum contactplant_kind kind, int index,
                                           struct contactplant_number *number);

/* ---- what is done to a plant alone ---- */

/* Input `input` goes to amplitude cos(2 pi frequency t + phase) within ramp_s, at least one tick. A NaN
 * leaves its part as it is. The phase of a drive that sounds stays continuous. Frequencies up to a quarter
 * of the tick rate are sound. */
CONTACTPLANT_API int contactplant_set_drive(struct contactplant *plant, int input, double amplitude,
                                            double frequency_Hz, double phase_rad, double ramp_s);

/* Gaussian noise on top of it: standard deviation in the input's unit, a new value every `ticks` (1 to
 * 65535). Equal seeds give equal noise. */
CONTACTPLANT_API int contactplant_set_noise(struct contactplant *plant, int input, double deviation,
                                            uint32_t ticks, uint32_t seed, double ramp_s);

/* A sampled command on top of both: a controller's output. It jumps there now (ticks 0), or moves there in
 * a straight line. A base never jumps: it takes one tick. */
CONTACTPLANT_API int contactplant_set_sample(struct contactplant *plant, int input, double value,
                                             uint64_t ticks);

/* Every drive, noise and sample goes to zero within ramp_s. */
CONTACTPLANT_API int contactplant_silence(struct contactplant *plant, double ramp_s);

/* Parameters now, as one set: position and velocity go on. On a bus also settings, and only before the
 * first bus frame; afterwards they are the controller's. */
CONTACTPLANT_API int contactplant_set_parameter(struct contactplant *plant, int index, double value);
CONTACTPLANT_API int contactplant_set_parameters(struct contactplant *plant, int n, const int *index,
                                                 const double *value);

/* A state of the caller's choice: all `n` of them. The energy balance begins anew. */
CONTACTPLANT_API int contactplant_set_state(struct contactplant *plant, const double *state, int n);

/* Runs whole ticks. */
CONTACTPLANT_API int contactplant_advance(struct contactplant *plant, uint64_t ticks);

/* Runs n samples of this input, each held for `ticks` ticks: contactplant_set_sample and contactplant_advance
 * for each, with equal bits, in less time. Where one is refused, none acts. */
CONTACTPLANT_API int contactplant_advance_samples(struct contactplant *plant, int input, const double *value,
                                                  uint32_t n, uint64_t ticks);

/* Runs to this instant of plant time, rounded to 1/65536 of a tick; not into the past. */
CONTACTPLANT_API int contactplant_advance_to(struct contactplant *plant, double time_s);

/* ---- what a plant says, alone or on a bus ---- */

CONTACTPLANT_API double contactplant_time(struct contactplant *plant);       /* s */
CONTACTPLANT_API uint64_t contactplant_tick(struct contactplant *plant);     /* whole ticks */
CONTACTPLANT_API double contactplant_tick_time(struct contactplant *plant);  /* seconds in a tick */
CONTACTPLANT_API uint32_t contactplant_substeps(struct contactplant *plant); /* ticks in a bus frame */

/* One number by its index. Inputs: the sum of drive, noise and sample. */
CONTACTPLANT_API double contactplant_input(struct contactplant *plant, int index);
CONTACTPLANT_API double contactplant_output(struct contactplant *plant, int index);
CONTACTPLANT_API double contactplant_state(struct contactplant *plant, int index);
CONTACTPLANT_API double contactplant_parameter(struct contactplant *plant, int index);

/* All outputs at once, into `n` numbers: as many as there are. */
CONTACTPLANT_API int contactplant_outputs(struct contactplant *plant, double *output, int n);

/* Energy stored now, and what the energy balance cannot account for: the error of the integration. J. */
CONTACTPLANT_API double contactplant_energy(struct contactplant *plant);
CONTACTPLANT_API double contactplant_residual(struct contactplant *plant);

/* A contact switched: its instant is located inside the tick. */
struct contactplant_event {
    double time_s;
    uint64_t tick;
    double fraction;     /* share of that tick */
    double speed;        /* m/s, of the gap */
    double peak_force_N; /* at lift-off: the largest contact force since touchdown */
    int32_t contact;     /* which one */
    int32_t touch;       /* 1: touchdown, 0: lift-off */
};

/* The oldest event that was not taken: 1, or 0 when there is none. A plant keeps 32; contactplant_counter
 * counts the lost ones. On a bus the events go there. */
CONTACTPLANT_API int contactplant_next_event(struct contactplant *plant, struct contactplant_event *event);

enum contactplant_counter {
    CONTACTPLANT_SWITCHES,        /* contact switches located */
    CONTACTPLANT_EVENTS_LOST,     /* events overwritten before they were taken */
    CONTACTPLANT_SWITCHES_MISSED, /* ticks with more switches than are located: the rest was run through */
    CONTACTPLANT_UNSURE,          /* switches whose instant is less exact than it should be */
    CONTACTPLANT_NOT_FINITE       /* ticks refused because the motion left the finite numbers */
};
CONTACTPLANT_API uint64_t contactplant_counter(struct contactplant *plant, enum contactplant_counter which);

/* A check of time, state, parameters, drives and energy: two runs are equal to the last bit when their
 * hashes are. */
CONTACTPLANT_API uint64_t contactplant_hash(struct contactplant *plant);

/* The whole plant as bytes, and back: the run goes on with the same bits. Bytes are taken by a plant of the
 * same scene, memory size, version and kind of machine; others are refused, and so are damaged ones. Restore
 * bytes of your own only: a check against accidents is in them, and what has forged it is believed. */
CONTACTPLANT_API size_t contactplant_save_size(struct contactplant *plant);
CONTACTPLANT_API int contactplant_save(struct contactplant *plant, void *bytes, size_t size);
CONTACTPLANT_API int contactplant_restore(struct contactplant *plant, const void *bytes, size_t size);

/* ---- a microscope: the plant of an AFM controller, one call a sample, in codes of its converters ----
 *
 *     struct contactplant_afm *afm = contactplant_afm_open(&memory, sizeof memory, "tapping", &error);
 *     contactplant_afm_set(afm, contactplant_afm_find(afm, "surface"), 1.0);
 *     for (;;) {
 *         int32_t dac[CONTACTPLANT_AFM_DACS] = {my_dither(), my_z(), my_x(), my_y()};
 *         int32_t adc[CONTACTPLANT_AFM_ADCS];
 *         contactplant_afm_sample(afm, dac, adc);
 *         my_controller(adc[CONTACTPLANT_AFM_DEFLECTION]);
 *     }
 *
 * Codes have 16 bits over +-10 V: 32767 is the largest, and one is 20 V/65536. A sample lasts `ticks` ticks
 * of the scene; contactplant_afm_sample_time has its seconds. Delays:
 *   dither   jumps to its code at the beginning and stays: half a sample on average
 *   z        goes in a straight line to its code, which it has at the end: half a sample
 *   x, y     move the surface below the tip: 64 ticks
 *   ADCs     read at the end: their codes belong to the instant at which the next sample begins
 *
 * The reference loops (z, AGC, PLL, DART) can run beside a controller: each is a number that is 0 or 1. The
 * one that runs takes the place of the caller's code. All are off after contactplant_afm_open, and there is
 * no tone but the caller's. Drives of the scene do not sound. */

struct contactplant_afm;

enum { CONTACTPLANT_AFM_SIZE = 32768 };
union contactplant_afm_memory {
    uint64_t word;
    double number;
    unsigned char bytes[CONTACTPLANT_AFM_SIZE];
};
CONTACTPLANT_API size_t contactplant_afm_size(void);

/* The microscope of a scene of afm_lever (tapping, soft, stiff or a text), at rest at its height over the
 * surface. NULL after a mistake. */
CONTACTPLANT_API struct contactplant_afm *contactplant_afm_open(void *memory, size_t size, const char *scene,
                                                                struct contactplant_error *error);
CONTACTPLANT_API const char *contactplant_afm_error(const struct contactplant_afm *afm);

/* Numbers of surface, loops and converters by name; `contactplant list microscope` prints them. They are set
 * before the first sample, which checks them together. */
CONTACTPLANT_API int contactplant_afm_find(struct contactplant_afm *afm, const char *name);
CONTACTPLANT_API int contactplant_afm_describe(struct contactplant_afm *afm, int index,
                                               struct contactplant_number *number);
CONTACTPLANT_API int contactplant_afm_set(struct contactplant_afm *afm, int index, double value);

enum {
    CONTACTPLANT_AFM_DITHER,
    CONTACTPLANT_AFM_Z,
    CONTACTPLANT_AFM_X,
    CONTACTPLANT_AFM_Y,
    CONTACTPLANT_AFM_DACS
};
enum { CONTACTPLANT_AFM_DEFLECTION, CONTACTPLANT_AFM_Z_SENSOR, CONTACTPLANT_AFM_ADCS };

/* One sample. Codes beyond 16 bits are held, and counted. */
CONTACTPLANT_API int contactplant_afm_sample(struct contactplant_afm *afm,
                                             const int32_t dac[CONTACTPLANT_AFM_DACS],
                                             int32_t adc[CONTACTPLANT_AFM_ADCS]);
CONTACTPLANT_API double contactplant_afm_sample_time(struct contactplant_afm *afm);

/* Numbers that the microscope knows and a controller does not: to judge it by. */
enum contactplant_afm_truth {
    CONTACTPLANT_AFM_TRUE_DEFLECTION, /* m */
    CONTACTPLANT_AFM_TRUE_Z,          /* m, of the base over its start */
    CONTACTPLANT_AFM_TRUE_SURFACE,    /* m, below the tip */
    CONTACTPLANT_AFM_PEAK_FORCE,      /* N, of the last sample; 0 apart */
    CONTACTPLANT_AFM_AMPLITUDE,       /* m, of the reference lock-in; 0 without a tone of the station */
    CONTACTPLANT_AFM_FREQUENCY,       /* Hz, of its tone */
    CONTACTPLANT_AFM_CRASHES,         /* contact forces above crash_N, so far */
    CONTACTPLANT_AFM_CRASH_FORCE,     /* N, peak of the last one */
    CONTACTPLANT_AFM_CLIPPED,         /* codes that were held, so far */
    CONTACTPLANT_AFM_CYCLE_FORCE,     /* N, peak of the last cycle of peak_force_N; 0 without */
    CONTACTPLANT_AFM_ADHESION,        /* N, of that cycle; 0: not found */
    CONTACTPLANT_AFM_MODULUS,         /* Pa, of that cycle; 0: not found */
    CONTACTPLANT_AFM_DEFORMATION,     /* m */
    CONTACTPLANT_AFM_DISSIPATION,     /* J */
    CONTACTPLANT_AFM_SNAP_IN,         /* N, deepest force of that cycle before its peak */
    CONTACTPLANT_AFM_BASELINE         /* N, of its far half: stiffness times the detector's offset */
};
CONTACTPLANT_API double contactplant_afm_truth(struct contactplant_afm *afm,
                                               enum contactplant_afm_truth which);

/* The whole microscope as bytes, numbers and heat included, and back: it goes on with the same bits. Bytes
 * are taken by a microscope of the same scene, version and kind of machine; others are refused. Restore bytes
 * of your own only, as with contactplant_restore. */
CONTACTPLANT_API size_t contactplant_afm_save_size(struct contactplant_afm *afm);
CONTACTPLANT_API int contactplant_afm_save(struct contactplant_afm *afm, void *bytes, size_t size);
CONTACTPLANT_API int contactplant_afm_restore(struct contactplant_afm *afm, const void *bytes, size_t size);

/* ---- a plant on a bus in memory ---- */

/* A classic CAN frame. */
struct contactplant_frame {
    uint32_t id;      /* 11 bits, or 29 when extended */
    uint8_t length;   /* 0 to 8 */
    uint8_t extended; /* 0 or 1 */
    uint8_t data[8];
};

/* Puts a frame on the bus; the next bus frame reads it. CONTACTPLANT_FULL beyond 256. */
CONTACTPLANT_API int contactplant_bus_put(struct contactplant *plant, const struct contactplant_frame *frame);

/* One bus frame of the plant (a millisecond unless the scene says otherwise): reads commands, advances,
 * reports. */
CONTACTPLANT_API int contactplant_bus_frame(struct contactplant *plant);

/* The oldest frame that the plant has sent: 1, or 0 when there is none. A plant whose frames are not taken
 * keeps 512, then the newest of each identifier. */
CONTACTPLANT_API int contactplant_bus_take(struct contactplant *plant, struct contactplant_frame *frame);

/* ---- packets: frames in the datagrams of cannelloni, as `contactplant run` sends and takes them over UDP
 * ---- */

enum { CONTACTPLANT_PACKET = 1400, CONTACTPLANT_PACKET_FRAMES = 408 };

/* Up to `n` frames into a packet of at most CONTACTPLANT_PACKET bytes; `sequence` counts a sender's
 * packets. Returns the packet's length; *taken frames are in it. A packet without a frame is valid, and
 * says that its sender has nothing to say. */
CONTACTPLANT_API size_t contactplant_pack(uint8_t sequence, const struct contactplant_frame *frame, int n,
                                          uint8_t packet[CONTACTPLANT_PACKET], int *taken);

/* The classic data frames of a packet of `size` bytes; frames of other kinds in it are passed over. -1 when
 * it is malformed or has more than `n`. */
CONTACTPLANT_API int contactplant_unpack(const uint8_t *packet, size_t size, struct contactplant_frame *frame,
                                         int n);

/* ---- a controller's client ---- */

struct contactplant_client;

enum { CONTACTPLANT_CLIENT_SIZE = 131072 };
union contactplant_client_memory {
    uint64_t word;
    double number;
    unsigned char bytes[CONTACTPLANT_CLIENT_SIZE];
};
CONTACTPLANT_API size_t contactplant_client_size(void);

/* The way to the plant. Each function is called with `context`. */
struct contactplant_transport {
    void *context;
    /* The next frame that has arrived: 1 and *frame, 0 when there is none, -1 when the link lost some. Does
     * not wait. */
    int (*receive)(void *context, struct contactplant_frame *frame);
    /* 1 when the frame was taken, 0 when there is no room now. */
    int (*send)(void *context, const struct contactplant_frame *frame);
    /* Frames that were sent go out now, and the plant may work on them; NULL where send does that. The client
     * calls it before it listens. */
    void (*flush)(void *context);
    /* Waits until a frame may have come, at most `seconds`. Returns the seconds that went by, or a negative
     * number to end the wait. */
    double (*wait)(void *context, double seconds);
};

/* A client of the plant that runs this scene. *transport is copied. NULL after a mistake. */
CONTACTPLANT_API struct contactplant_client *
contactplant_client_open(void *memory, size_t size, const char *scene,
                         const struct contactplant_transport *transport, struct contactplant_error *error);

CONTACTPLANT_API const char *contactplant_client_error(const struct contactplant_client *client);

/* A plant alone of the same scene, for names, units and numbers; the client does not use it. A microscope,
 * and a scene with a sensor, have none: theirs is on a bus of its own, and does not move. */
CONTACTPLANT_API struct contactplant *contactplant_client_plant(struct contactplant_client *client);

/* Opens a session, and closes it, within `seconds`. CONTACTPLANT_REFUSED when the plant is another one than
 * the scene says, or takes no session. */
CONTACTPLANT_API int contactplant_client_begin(struct contactplant_client *client, double seconds);
CONTACTPLANT_API int contactplant_client_end(struct contactplant_client *client, double seconds);

/* "I am here", at least every `timeout_frames` bus frames (a setting). */
CONTACTPLANT_API int contactplant_client_heartbeat(struct contactplant_client *client);

enum contactplant_operation {
    CONTACTPLANT_START = 1, /* plant time runs */
    CONTACTPLANT_STOP,      /* drives to zero at once, the session ends */
    CONTACTPLANT_PAUSE,     /* plant time stands */
    CONTACTPLANT_STEP,      /* while paused: runs `argument` frames */
    CONTACTPLANT_RUN_UNTIL, /* while paused: runs to tick `argument`, the end of a frame */
    CONTACTPLANT_RESET      /* clears faults, state to rest */
};
CONTACTPLANT_API int contactplant_client_control(struct contactplant_client *client,
                                                 enum contactplant_operation operation, uint64_t argument);

/* Stages a drive, as contactplant_set_drive sets it; and applies all that is staged on these inputs (bit i:
 * input i) at this instant. */
CONTACTPLANT_API int contactplant_client_arm(struct contactplant_client *client, int input, double amplitude,
                                             double frequency_Hz, double phase_rad, double ramp_s);
CONTACTPLANT_API int contactplant_client_fire(struct contactplant_client *client, unsigned inputs,
                                              uint64_t tick, double fraction);

/* One sample of a command, applied at the start of that plant frame (tick / substeps). */
CONTACTPLANT_API int contactplant_client_stream(struct contactplant_client *client, int input, uint64_t frame,
                                                double value);

/* Parameters and settings as one set; and one as the plant says it, NaN when it does not answer within
 * `seconds`. */
CONTACTPLANT_API int contactplant_client_set_parameters(struct contactplant_client *client, int n,
                                                        const int *index, const double *value);
CONTACTPLANT_API double contactplant_client_parameter(struct contactplant_client *client, int index,
                                                      double seconds);

/* Hears everything that has arrived; returns the number of messages. */
CONTACTPLANT_API int contactplant_client_poll(struct contactplant_client *client);

enum contactplant_wait {
    CONTACTPLANT_WAIT_ALIVE,   /* the plant has said something of itself */
    CONTACTPLANT_WAIT_STATE,   /* its state is `value` */
    CONTACTPLANT_WAIT_TICK,    /* its time is `value` ticks or later */
    CONTACTPLANT_WAIT_CONTACT, /* penetration and contact force of tick `value` or later were heard */
    CONTACTPLANT_WAIT_REPLY    /* `value` replies were heard */
};

/* Hears until that holds. */
CONTACTPLANT_API int contactplant_client_wait(struct contactplant_client *client, enum contactplant_wait what,
                                              uint64_t value, double seconds);

enum contactplant_plant_state {
    CONTACTPLANT_STATE_OFF,     /* no session */
    CONTACTPLANT_STATE_READY,   /* session open, plant time stands */
    CONTACTPLANT_STATE_RUNNING, /* plant time runs */
    CONTACTPLANT_STATE_PAUSED,  /* plant time stands, steps are possible */
    CONTACTPLANT_STATE_STOPPED, /* plant time stands, drives at zero */
    CONTACTPLANT_STATE_FROZEN,  /* plant time stands after a time-out */
    CONTACTPLANT_STATE_FAULT    /* plant time stands after a fault: reset */
};

/* The latest words of the plant; NaN and 0 until there are any. */
struct contactplant_latest {
    uint64_t frame, tick;  /* bus frame, plant tick */
    uint64_t contact_tick; /* penetration and force belong to it */
    int32_t state;         /* enum contactplant_plant_state */
    int32_t session;       /* 1: the session is open and this client's */
    uint32_t faults;       /* latched: fault bits of the protocol */
    int32_t in_contact;
    double displacement_m, velocity_m_per_s, penetration_m, force_N;
    double contact_loss; /* share of time without contact */
    uint64_t touchdowns, liftoffs;
    uint64_t accepted, refused;            /* replies */
    uint64_t refused_late;                 /* those refused because the instant named had passed */
    uint64_t unsent, bad;                  /* commands without room, frames that did not decode */
    double lockin[4], lockin_phase_rad[4]; /* by slot; of a mean (harmonic 0): its size, and 0 or pi */
};

/* Copies what fits into `size`, the size of the caller's struct: later versions may have more at its end. */
CONTACTPLANT_API int contactplant_client_latest(struct contactplant_client *client,
                                                struct contactplant_latest *latest, size_t size);

#ifdef __cplusplus
}
#endif

#endif
