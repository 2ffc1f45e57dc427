/* station.c - see station.h. */
#include "firmware/afm/station.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/hash.h"
#include "models/math/elementary.h"

#define TWO_PI (2.0 * ELEMENTARY_PI)

const struct parameter station_number[STATION_NUMBERS] = {STATION_ROWS};

void station_defaults(double *number)
{
    for (int i = 0; i < STATION_NUMBERS; i++)
        number[i] = station_number[i].initial;
}

double station_ring_time(const double *si)
{
    return si[LEVER_Q] / (ELEMENTARY_PI * si[LEVER_F0]);
}

/* ---- checks ---- */

static bool whole(double x)
{
    return x == (double)(int64_t)x;
}

static const char *check_range(const double *n, int *which)
{
    static const int counts[] = {STATION_TICKS,  STATION_SURFACE, STATION_SURFACE_SEED, STATION_MAP,
                                 STATION_PIXELS, STATION_LINES,   STATION_Z_LOOP,       STATION_AGC,
                                 STATION_PLL,    STATION_DART};
    for (*which = 0; *which < STATION_NUMBERS; ++*which) {
        const struct parameter *p = &station_number[*which];
        if (!(n[*which] >= p->min && n[*which] <= p->max))
            return "out of range";
    }
    for (unsigned i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        *which = counts[i];
        if (!whole(n[*which]))
            return "must be a whole number";
    }
    return NULL;
}

bool station_swings(const double *number)
{
    return number[STATION_PEAK_FORCE] > 0.0;
}

/* A force of the station's own on the lever. */
static bool has_tone(const double *number)
{
    return number[STATION_DRIVE] > 0.0 && !station_swings(number);
}

/* Frequency of the tone, or of z's swing. */
static double frequency_of(const double *number, double f0_Hz)
{
    double swing = f0_Hz < 16e3 ? f0_Hz / 8.0 : 2e3;
    return number[STATION_FREQUENCY] > 0.0 ? number[STATION_FREQUENCY]
           : station_swings(number)        ? swing
                                           : f0_Hz;
}

/* Turns of a tone in a sample, at most: a quarter, and room for the rounding of exactly that. */
static const double turns_max = 0.25 * (1.0 + 1e-9);

/* The loops against each other and against the lever. */
static const char *check_tone(const struct station_config *c, int *which)
{
    const double *n = c->number;
    bool amplitude = n[STATION_Z_LOOP] == Z_AMPLITUDE;
    double f = frequency_of(n, c->si[LEVER_F0]);
    *which = STATION_DRIVE;
    if (n[STATION_DRIVE] == 0.0 && (amplitude || n[STATION_AGC] + n[STATION_PLL] + n[STATION_DART] > 0.0))
        return "the lock-in would listen to a silent tone: give an amplitude, or z_loop 2 or 0, and agc, pll "
               "and "
               "dart 0";
    *which = STATION_SETPOINT;
    if (amplitude && !(n[STATION_SETPOINT] > 0.0 && n[STATION_SETPOINT] < n[STATION_DRIVE]))
        return "is not below the free amplitude drive_m: the z loop would never find the surface";
    *which = STATION_DART;
    if (n[STATION_DART] > 0.0 && n[STATION_PLL] > 0.0)
        return "and pll both set the frequency: switch one off";
    *which = STATION_FREQUENCY;
    if (n[STATION_DRIVE] > 0.0 && (f + n[STATION_DART_DISTANCE]) * n[STATION_TICKS] * c->tick_s > turns_max)
        return "leaves fewer than 4 samples in a period: give fewer ticks a sample";
    return NULL;
}

/* The lever leaves the sample in each cycle if z swings further than the tip sticks: from the deflection of
 * set point and adhesion to beyond the gap of the snap-in. That is (H R/(3 k))^(1/3), and half as much again.
 */
static double least_swing(const struct station_config *c)
{
    double k = c->si[LEVER_K], hamaker = c->si[LEVER_HAMAKER_OUT], second[LEVER_PARAMETERS];
    if (station_second(c, second) && second[LEVER_HAMAKER_OUT] > hamaker)
        hamaker = second[LEVER_HAMAKER_OUT];
    double a0 = c->si[LEVER_A0], pull = hamaker * c->si[LEVER_RADIUS], adhesion = pull / (6.0 * a0 * a0);
    return (c->number[STATION_PEAK_FORCE] + adhesion) / k + 1.5 * cube_root(pull / (3.0 * k));
}

/* Four standard deviations of the thermal force up to the resonance: its density is 4 k_B T k/(Q w0). */
static double thermal_force(const double *si)
{
    return 4.0 * sqrt(2.0 * BOLTZMANN_J_PER_K * si[LEVER_TEMPERATURE] * si[LEVER_K] /
                      (ELEMENTARY_PI * si[LEVER_Q]));
}

static const char *check_swing(const struct station_config *c, int *which)
{
    const double *n = c->number;
    double f0 = c->si[LEVER_F0], f = frequency_of(n, f0), sample_s = n[STATION_TICKS] * c->tick_s;
    *which = STATION_PEAK_FORCE;
    if (n[STATION_AGC] + n[STATION_PLL] + n[STATION_DART] > 0.0)
        return "leaves the lever without a tone: give agc, pll and dart 0";
    if (n[STATION_PEAK_FORCE] < thermal_force(c->si))
        return "is below the noise of a cycle, 4 standard deviations of the thermal force: give more";
    *which = STATION_TICKS;
    if (f0 * sample_s * PEAK_FORCE_PERIOD_MIN > 1.0 + 1e-9)
        return "leaves fewer than 32 samples in a period of the lever, too few for peak_force: give less";
    *which = STATION_FREQUENCY;
    if (f < 100.0 || f > f0 / 8.0 * (1.0 + 1e-9))
        return "of peak_force is 100 Hz to an eighth of f0";
    *which = STATION_DRIVE;
    if (2.0 * n[STATION_DRIVE] < least_swing(c))
        return "is too small for peak_force: the tip would not leave the sample in each cycle; give more";
    *which = STATION_PIXEL;
    if (n[STATION_PIXEL] * f < 1.0 - 1e-9)
        return "is shorter than a cycle of peak_force: give more";
    return NULL;
}

static const char *check_loops(const struct station_config *c, int *which)
{
    *which = STATION_KI;
    if (c->number[STATION_Z_LOOP] > 0.0 && c->number[STATION_KI] == 0.0)
        return "is 0: the z loop would not move";
    return station_swings(c->number) ? check_swing(c, which) : check_tone(c, which);
}

void station_surface(struct surface *s, const struct station_config *c)
{
    const double *n = c->number;
    *s = (struct surface){.kind = (enum surface_kind)n[STATION_SURFACE],
                          .height = n[STATION_SURFACE_HEIGHT],
                          .pitch = n[STATION_SURFACE_PITCH],
                          .duty = n[STATION_SURFACE_DUTY],
                          .edge = n[STATION_SURFACE_EDGE],
                          .map = (enum surface_map)n[STATION_MAP],
                          .map_size = n[STATION_MAP_SIZE],
                          .map_x = n[STATION_MAP_X],
                          .map_y = n[STATION_MAP_Y]};
    if (c->grid)
        s->grid = *c->grid;
    if (s->kind == SURFACE_ROUGH)
        surface_set_waves(s, (uint32_t)n[STATION_SURFACE_SEED]);
}

static const char *check_surface(const struct station_config *c, int *which)
{
    const double *n = c->number;
    const struct surface_grid *g = c->grid;
    *which = STATION_SURFACE;
    if (n[STATION_SURFACE] == SURFACE_GRID && !(g && g->count && g->nx >= 2 && g->ny >= 2))
        return "is from a file, and there is none: give 0 to 4; contactplant scan alone takes a file, of at "
               "least 2 x 2 heights, by --surface";
    *which = STATION_SURFACE_EDGE;
    double duty = n[STATION_SURFACE_DUTY], narrow = duty < 0.5 ? duty : 1.0 - duty;
    if (n[STATION_SURFACE] == SURFACE_GRATING && n[STATION_SURFACE_EDGE] > narrow * n[STATION_SURFACE_PITCH])
        return "is wider than a line or a groove of the grating";
    return NULL;
}

const char *station_check(const struct station_config *c, int *which)
{
    const char *why = check_range(c->number, which);
    why = why ? why : check_loops(c, which);
    why = why ? why : check_surface(c, which);
    *which = why ? *which : STATION_Z_MIN;
    if (!why && c->number[STATION_Z_LOOP] > 0.0 && c->si[LEVER_HEIGHT] > -c->number[STATION_Z_MIN])
        why = "is nearer than the surface: height_m of the lever lies beyond the piezo's range";
    return why;
}

/* ---- set-up ---- */

static const double unbounded = 1e300;

static void set_loops(struct station *s)
{
    const double *n = s->number;
    double top = station_swings(n) ? 2.0 * n[STATION_DRIVE] : 0.0; /* z over its lowest point */
    s->z = (struct loop){n[STATION_KP], n[STATION_KI], n[STATION_Z_MIN], n[STATION_Z_MAX] - top, 0.0, false};
    s->agc = (struct loop){0.0, n[STATION_AGC_KI], 0.0, unbounded, n[STATION_DRIVE], false};
    s->pll = (struct loop){n[STATION_PLL_KP],           n[STATION_PLL_KI], 0.0,
                           0.25 / s->microscope.tick_s, s->frequency_Hz,   false};
    s->dart =
        (struct loop){0.0, n[STATION_DART_KI], n[STATION_DART_DISTANCE], s->pll.max, s->frequency_Hz, false};
}

/* Frequencies of the tones, around the one of the station. */
static void tune(struct station *s)
{
    bool dart = s->number[STATION_DART] > 0.0;
    double half = dart ? 0.5 * s->number[STATION_DART_DISTANCE] : 0.0;
    microscope_tune(&s->microscope, 0, s->frequency_Hz - half);
    if (dart)
        microscope_tune(&s->microscope, 1, s->frequency_Hz + half);
}

static void set_force(struct station *s, double free_amplitude)
{
    free_amplitude = has_tone(s->number) ? free_amplitude : 0.0;
    s->microscope.tone[0].force_N = free_amplitude * s->free_force;
    s->microscope.tone[1].force_N = s->number[STATION_DART] > 0.0 ? free_amplitude * s->free_force : 0.0;
}

/* A quarter of the set point is a contact. */
static void set_least(struct station *s)
{
    s->swing.least_N = 0.25 * s->number[STATION_PEAK_FORCE];
}

/* z begins to swing, from where it is. */
static void begin_swing(struct station *s)
{
    const double *n = s->number;
    const struct peak_force_config c = {.stiffness = s->stiffness,
                                        .f0_Hz = s->f0_Hz,
                                        .quality = s->stiffness / s->free_force,
                                        .radius_m = s->radius_m,
                                        .sample_s = s->sample_s,
                                        .frequency_Hz = s->frequency_Hz,
                                        .amplitude_m = n[STATION_DRIVE]};
    peak_force_init(&s->swing, &c, s->in.z_m);
    set_least(s);
}

bool station_second(const struct station_config *c, double *second)
{
    memcpy(second, c->si, LEVER_PARAMETERS * sizeof *second);
    second[LEVER_MODULUS] = c->number[STATION_MAP_MODULUS];
    second[LEVER_HAMAKER] = c->number[STATION_MAP_HAMAKER];
    second[LEVER_HAMAKER_OUT] = c->number[STATION_MAP_HAMAKER_OUT];
    second[LEVER_VISCOSITY] = c->number[STATION_MAP_VISCOSITY];
    return c->number[STATION_MAP] > 0.0;
}

const char *station_init(struct station *s, const struct station_config *c)
{
    double second[LEVER_PARAMETERS];
    struct surface surface;
    int which;
    const char *why = station_check(c, &which);
    if (why)
        return why;
    memset(s, 0, sizeof *s);
    memcpy(s->number, c->number, sizeof s->number);
    struct microscope_config m = {.si = c->si,
                                  .second = station_second(c, second) ? second : NULL,
                                  .tick_s = c->tick_s,
                                  .ticks = (uint32_t)s->number[STATION_TICKS],
                                  .crash_N = s->number[STATION_CRASH],
                                  .piezo = c->piezo,
                                  .sensor = c->sensor,
                                  .at = c->at,
                                  .z_m = c->z_m};
    station_surface(&surface, c);
    why = microscope_init(&s->microscope, &m, &surface);
    if (why)
        return why;
    s->sample_s = c->tick_s * m.ticks;
    s->f0_Hz = c->si[LEVER_F0];
    s->free_force = c->si[LEVER_K] / c->si[LEVER_Q];
    s->stiffness = c->si[LEVER_K];
    s->radius_m = c->si[LEVER_RADIUS];
    s->frequency_Hz = frequency_of(s->number, s->f0_Hz);
    set_loops(s);
    s->in = c->at;
    s->out.z_m = c->z_m;
    s->z.sum = c->at.z_m;
    for (int i = 0; i < MICROSCOPE_TONES; i++)
        demodulator_init(&s->lockin[i], s->number[STATION_BANDWIDTH], s->sample_s);
    if (has_tone(s->number))
        tune(s);
    set_force(s, s->number[STATION_DRIVE]);
    if (station_swings(s->number))
        begin_swing(s);
    return NULL;
}

/* ---- a change on the way ---- */

int station_fixed(const struct station *s, const double *number)
{
    static const int fixed[] = {STATION_TICKS,        STATION_BANDWIDTH,   STATION_MAP,
                                STATION_MAP_MODULUS,  STATION_MAP_HAMAKER, STATION_MAP_HAMAKER_OUT,
                                STATION_MAP_VISCOSITY};
    for (unsigned i = 0; i < sizeof fixed / sizeof fixed[0]; i++)
        if (number[fixed[i]] != s->number[fixed[i]])
            return fixed[i];
    return -1;
}

static const char *check_fixed(const struct station *s, const double *number, int *which)
{
    int fixed = station_fixed(s, number);
    if (fixed < 0)
        return NULL;
    *which = fixed;
    return "cannot change while the microscope runs: give it at the beginning";
}

/* The integral of a loop with new limits: where it was, or at what it is to set now. */
static void go_on(struct loop *l, bool was_on, double sum, double at)
{
    double from = was_on ? sum : at;
    l->sum = from < l->min ? l->min : from > l->max ? l->max : from;
}

const char *station_change(struct station *s, const struct station_config *c, int *which)
{
    const double *n = c->number;
    const char *why = station_check(c, which);
    why = why ? why : check_fixed(s, n, which);
    if (why)
        return why;
    double was[STATION_NUMBERS], z = s->z.sum, agc = s->agc.sum, pll = s->pll.sum, dart = s->dart.sum;
    memcpy(was, s->number, sizeof was);
    memcpy(s->number, n, sizeof s->number);
    station_surface(&s->microscope.surface, c);
    s->microscope.crash_N = n[STATION_CRASH];
    bool swings = station_swings(n), swung = station_swings(was);
    bool another = n[STATION_FREQUENCY] != was[STATION_FREQUENCY] || swings != swung;
    if (another)
        s->frequency_Hz = frequency_of(n, s->f0_Hz);
    set_loops(s);
    another |= swings && n[STATION_DRIVE] != was[STATION_DRIVE];
    go_on(&s->z, was[STATION_Z_LOOP] > 0.0 && !(another && (swings || swung)), z, s->in.z_m);
    go_on(&s->agc, was[STATION_AGC] > 0.0, agc, n[STATION_DRIVE]);
    go_on(&s->pll, was[STATION_PLL] > 0.0, pll, s->frequency_Hz);
    go_on(&s->dart, was[STATION_DART] > 0.0, dart, s->frequency_Hz);
    if (has_tone(n))
        tune(s);
    if (swings && another)
        begin_swing(s);
    set_least(s);
    set_force(s, n[STATION_AGC] > 0.0 ? s->agc.sum : n[STATION_DRIVE]);
    return NULL;
}

/* ---- one sample ---- */

void station_begin_scan(struct station *s)
{
    const double *n = s->number;
    double samples = n[STATION_PIXEL] / s->sample_s;
    s->raster = (struct raster){.width_m = n[STATION_SCAN_WIDTH],
                                .length_m = n[STATION_SCAN_LENGTH],
                                .pixels = (uint32_t)n[STATION_PIXELS],
                                .lines = (uint32_t)n[STATION_LINES],
                                .samples = samples < 1.0   ? 1
                                           : samples > 4e9 ? 4000000000u
                                                           : (uint32_t)(samples + 0.5)};
    s->scans = true;
    s->scanned = 0;
    s->sum = (struct pixel_sum){.n = 0};
}

void station_begin_ramp(struct station *s, double speed_m_per_s, double dwell_s)
{
    s->ramp = (struct ramp){.speed_m_per_s = speed_m_per_s,
                            .low_m = s->number[STATION_Z_MIN],
                            .high_m = s->in.z_m,
                            .dwell_s = dwell_s,
                            .phase = RAMP_IN,
                            .z_m = s->in.z_m};
}

/* How much the tip is too far away. */
static double z_error(const struct station *s)
{
    if (station_swings(s->number))
        return (s->number[STATION_PEAK_FORCE] - s->swing.cycle.peak_N) / s->stiffness;
    if (s->number[STATION_Z_LOOP] == Z_AMPLITUDE)
        return s->lockin[0].amplitude - s->number[STATION_SETPOINT];
    return s->number[STATION_SETPOINT] - s->out.deflection_m;
}

static bool triggered(const struct station *s)
{
    return has_tone(s->number) ? s->lockin[0].amplitude <= s->number[STATION_SETPOINT]
                               : s->out.deflection_m >= s->number[STATION_SETPOINT];
}

/* z swings. At the top its lowest point is told where to go. */
static void swing(struct station *s, double user_m)
{
    struct peak_force *p = &s->swing;
    bool loop = s->number[STATION_Z_LOOP] != Z_OFF;
    s->cycle_ready = peak_force_read(p, s->out.deflection_m, s->out.z_m);
    if (s->cycle_ready)
        s->error_m = z_error(s);
    if (p->i == 0) {
        p->from_m = p->to_m;
        p->to_m = loop ? loop_run(&s->z, -s->error_m, p->samples * s->sample_s) : user_m;
        s->n_limited += s->z.limited ? p->samples : 0;
    }
    s->in.z_m = peak_force_z(p);
}

static void control_z(struct station *s, double user_m)
{
    if (s->ramp.phase == RAMP_OFF && station_swings(s->number)) {
        swing(s, user_m);
        return;
    }
    s->error_m = z_error(s);
    if (s->ramp.phase != RAMP_OFF) {
        s->in.z_m = ramp_run(&s->ramp, triggered(s), s->sample_s);
        s->z.sum = s->in.z_m;
        if (station_swings(s->number))
            begin_swing(s);
    } else if (s->number[STATION_Z_LOOP] != Z_OFF) {
        s->in.z_m = loop_run(&s->z, -s->error_m, s->sample_s);
        s->n_limited += s->z.limited;
    }
}

/* Frequency and force of the tones. */
static void control_tones(struct station *s)
{
    if (s->number[STATION_AGC] > 0.0)
        set_force(s,
                  loop_run(&s->agc, s->number[STATION_AGC_SETPOINT] - s->lockin[0].amplitude, s->sample_s));
    if (s->number[STATION_PLL] > 0.0) {
        double turns = (demodulator_phase(&s->lockin[0]) - s->number[STATION_PLL_PHASE]) / TWO_PI;
        s->frequency_Hz = loop_run(&s->pll, TWO_PI * turns_to_double(turns_of(turns)), s->sample_s);
        tune(s);
    }
    if (s->number[STATION_DART] > 0.0) {
        double low = s->lockin[0].amplitude, high = s->lockin[1].amplitude;
        s->frequency_Hz = loop_run(&s->dart, (high - low) / (high + low + 1e-300), s->sample_s);
        tune(s);
    }
}

/* A cycle has ended in this pixel. */
static void add_cycle(struct pixel_sum *m, const struct force_cycle *c)
{
    struct force_cycle *f = &m->force;
    f->n++;
    m->n_touched += c->touched;
    m->n_fitted += c->fitted;
    f->peak_N += c->peak_N;
    f->snap_in_N += c->snap_in_N;
    f->adhesion_N += c->adhesion_N;
    f->baseline_N += c->baseline_N;
    f->work_J += c->work_J;
    f->deformation_m += c->deformation_m;
    f->low_m += c->low_m;
    f->modulus_Pa += c->modulus_Pa;
}

/* Means of the cycles of a pixel, one at least, of those that know each. Its height is that of their lowest
 * points. */
static void finish_cycles(struct pixel *p, const struct pixel_sum *m)
{
    const struct force_cycle *f = &m->force;
    double part = 1.0 / f->n, touched = m->n_touched ? 1.0 / m->n_touched : 0.0;
    p->force = (struct force_cycle){.n = f->n,
                                    .touched = m->n_touched > 0,
                                    .fitted = m->n_fitted > 0,
                                    .peak_N = f->peak_N * part,
                                    .snap_in_N = f->snap_in_N * touched,
                                    .adhesion_N = f->adhesion_N * touched,
                                    .baseline_N = f->baseline_N * part,
                                    .work_J = f->work_J * touched,
                                    .deformation_m = f->deformation_m * touched,
                                    .modulus_Pa = m->n_fitted ? f->modulus_Pa / m->n_fitted : 0.0,
                                    .low_m = f->low_m * part};
    p->height_m = p->force.low_m;
}

static void finish_pixel(struct station *s, const struct raster_place *at)
{
    struct pixel_sum *m = &s->sum;
    double part = 1.0 / m->n;
    s->pixel = (struct pixel){.line = at->line,
                              .column = at->pixel,
                              .back = at->back,
                              .height_m = m->height * part,
                              .error_m = m->error * part,
                              .amplitude_m = m->amplitude * part,
                              .phase_rad = arc_tangent(m->quadrature, m->in_phase),
                              .peak_N = m->peak,
                              .frequency_Hz = m->frequency * part,
                              .surface_m = m->surface * part};
    if (m->force.n > 0)
        finish_cycles(&s->pixel, m);
    *m = (struct pixel_sum){.n = 0};
    s->pixel_ready = true;
}

static void add_to_pixel(struct station *s, const struct raster_place *at)
{
    struct pixel_sum *m = &s->sum;
    m->n++;
    m->height += s->out.z_m;
    if (s->cycle_ready)
        add_cycle(m, &s->swing.cycle);
    m->error += s->error_m;
    m->amplitude += s->lockin[0].amplitude;
    m->in_phase += s->lockin[0].i[1];
    m->quadrature += s->lockin[0].q[1];
    m->frequency += s->frequency_Hz;
    m->surface += s->out.surface_m;
    if (s->out.peak_N > m->peak)
        m->peak = s->out.peak_N;
    if (at->last)
        finish_pixel(s, at);
}

bool station_run(struct station *s, const struct microscope_in *user)
{
    struct raster_place at;
    s->pixel_ready = s->cycle_ready = false;
    s->in.force_N = user->force_N;
    s->in.x_m = user->x_m;
    s->in.y_m = user->y_m;
    if (s->number[STATION_Z_LOOP] == Z_OFF && s->ramp.phase == RAMP_OFF && !station_swings(s->number))
        s->in.z_m = user->z_m;
    if (s->scans && (s->scans = raster_at(&s->raster, s->scanned, &at))) {
        s->in.x_m = at.x_m;
        s->in.y_m = at.y_m;
        s->scanned++;
    }
    if (!microscope_run(&s->microscope, &s->in, &s->out))
        return false;
    for (int i = 0; i < MICROSCOPE_TONES; i++) {
        const struct tone *t = &s->microscope.tone[i];
        if (t->step != 0)
            demodulator_run(&s->lockin[i], s->out.deflection_m, t->cosine, t->sine);
    }
    control_z(s, user->z_m);
    control_tones(s);
    if (s->scans)
        add_to_pixel(s, &at);
    return true;
}

uint64_t station_hash(const struct station *s, uint64_t hash)
{
    for (int i = 0; i < MODEL_STATES; i++)
        hash = hash_double(hash, s->microscope.x[i]);
    hash = hash_double(hash, s->in.z_m);
    hash = hash_double(hash, s->frequency_Hz);
    hash = hash_double(hash, s->lockin[0].amplitude);
    hash = hash_word(hash, s->microscope.n_crashes);
    return hash_word(hash, s->microscope.tick);
}
