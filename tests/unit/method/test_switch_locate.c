/* test_switch_locate.c - sharpening a switch with a method's
 * steps: gaps that are known functions of time, steps counted. */
#include "tests/unit/test.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include "firmware/method/switch.h"

/* Four states: two positions, which stay, a velocity, which stays, and the time. */
enum { VELOCITY = 2, TIME = 3 };
static double start_state[MODEL_STATES];
static int n_steps;
static void (*gaps)(double t, struct input *gap);

static void advance(const struct model *m, const double *p, const double *work, const struct segment *e,
                    const double *x, double *x1)
{
    (void)p, (void)work;
    n_steps++;
    for (int i = 0; i < m->n_states; i++)
        x1[i] = x[i];
    x1[TIME] += e->length;
}

/* Functions of time, with the rounding of a difference of positions. */
static void gap_now(const double *p, const struct input *u, const double *x, struct input *gap)
{
    (void)p, (void)u;
    gaps((x[0] + x[1] + x[TIME]) - (x[0] + x[1]), gap);
}

/* One step over `length` from `start`. */
static enum step_status locate(int n_contacts, double length, unsigned regime, struct crossing *c)
{
    const struct model m = {.n_states = 4, .n_contacts = n_contacts, .gap = gap_now};
    const struct switch_stepper by = {advance, &m, NULL, NULL, 4.0 * DBL_EPSILON * length};
    const struct segment e = {.length = length};
    double x[MODEL_STATES];
    memcpy(x, start_state, sizeof x);
    n_steps = 0;
    *c = (struct crossing){-1.0, -1, -1, 0.0};
    enum step_status status = switch_locate(&by, &e, regime, x, c);
    check_bytes("the others stay", x, start_state, TIME * sizeof *x);
    if (status == STEP_END)
        check_near("at the end", x[TIME], length, 0.0);
    else if (!c->residual)
        check_near("the state there", x[TIME], c->done, 0.0);
    return status;
}

/* Opens or closes at `root` with a constant rate. */
static double root, line_slope;

static void line(double t, struct input *gap)
{
    /* In two parts: a zero between two doubles near t. */
    double whole = floor(root);
    *gap = (struct input){line_slope * ((t - whole) - (root - whole)), line_slope};
}

/* A straight gap takes the step itself, the guess, which is good to 2^-40, and one Newton step. */
TEST(switch_locate_lines)
{
    const double lengths[] = {1e-3, 1.0, 1000.0}, slopes[] = {0.25, 1.0, 3.0};
    memset(start_state, 0, sizeof start_state);
    gaps = line;
    for (int i = 0; i < 9; i++) {
        for (int closed = 0; closed < 2; closed++) {
            struct crossing c;
            double length = lengths[i / 3];
            root = 0.7001 * length;
            line_slope = slopes[i % 3] * fmax(1.0, 1.0 / length) * (closed ? 1.0 : -1.0);
            check_int("a switch", locate(1, length, (unsigned)closed, &c), STEP_SWITCH);
            check_near("its instant over the length", c.done / length, 0.7001, 4.0 * DBL_EPSILON);
            check_int("no residual", c.residual, 0);
            check_int("steps", n_steps, 3);
        }
    }
    root = 1.1;
    check_int("none within the step", locate(1, 1.0, line_slope > 0.0, &(struct crossing){0}), STEP_END);
    check_int("which was one", n_steps, 1);
}

static void quartic(double t, struct input *gap)
{
    *gap = (struct input){t * t * t * t - 0.1, 4.0 * t * t * t};
}

/* The positions, and they alone, decide which gap is zero to rounding. */
TEST(switch_locate_rounding)
{
    struct crossing c;
    for (int i = 0; i < 2; i++) {
        memset(start_state, 0, sizeof start_state);
        start_state[i] = 1e6; /* where doubles are 1.2e-10 apart: the zero lies between two of them */
        gaps = line;
        root = 0.3;
        line_slope = 1.0;
        check_int("a switch far out", locate(1, 1.0, 1, &c), STEP_SWITCH);
        check_int("no residual", c.residual, 0);
        check_near("to 8 roundings of the position", c.done, root, 8.0 * DBL_EPSILON * start_state[i]);
    }
    memset(start_state, 0, sizeof start_state);
    start_state[VELOCITY] = 1e8;
    gaps = quartic;
    check_int("a switch at a high velocity", locate(1, 1.0, 1, &c), STEP_SWITCH);
    check_int("no residual", c.residual, 0);
    check_near("to rounding", c.done, sqrt(sqrt(0.1)), 4.0 * DBL_EPSILON);
}

static void jump(double t, struct input *gap)
{
    *gap = (struct input){t < root ? -1.0 : t < 0.95 ? 0.0 : 1.0, 0.0};
}

/* A gap that jumps to zero and beyond has no simple zero: halved as often as allowed, and said so. */
TEST(switch_locate_jump)
{
    memset(start_state, 0, sizeof start_state);
    gaps = jump;
    for (int i = 1; i < 10; i++) {
        struct crossing c;
        root = 0.1 * i;
        check_int("a switch", locate(1, 1.0, 1, &c), STEP_SWITCH);
        check_int("with a residual", c.residual, 1);
        check_int("the step, and all iterations", n_steps, 1 + SWITCH_ITERATIONS);
        check_near("halved from the guess on", c.done, root, ldexp(1.0, -SWITCH_ITERATIONS));
    }
}

static void touch(double t, struct input *gap)
{
    *gap = (struct input){-(t - 0.5) * (t - 0.5), 1.0 - 2.0 * t};
}

/* A gap that reaches zero with rate zero, and no more: sought on the side where the gap was before. */
TEST(switch_locate_touch)
{
    struct crossing c;
    memset(start_state, 0, sizeof start_state);
    gaps = touch;
    check_int("a switch", locate(1, 1.0, 1, &c), STEP_SWITCH);
    check_near("to where the gap is zero to rounding", c.done, 0.5, sqrt(8.0 * DBL_EPSILON));
    check_int("no residual", c.residual, 0);
}

/* Zeros of three contacts. */
static double zero[3];

static void three(double t, struct input *gap)
{
    for (int i = 0; i < 3; i++)
        gap[i] = (struct input){t - zero[i], 1.0};
}

static void check_first(const char *name, double zero0, double zero1, unsigned regime, int first)
{
    struct crossing c;
    zero[0] = zero0;
    zero[1] = zero1;
    check_int("a switch", locate(2, 1.0, regime, &c), STEP_SWITCH);
    check_int(name, c.contact, first);
    check_near("at its instant", c.done, zero[first], 4.0 * DBL_EPSILON);
    check_below("steps", n_steps, 3.0);
}

TEST(switch_locate_contacts)
{
    struct crossing c;
    memset(start_state, 0, sizeof start_state);
    gaps = three;
    zero[2] = 0.1; /* no contact of this model */
    check_first("the first contact", 0.3, 0.7, 3, 0);
    check_first("the second contact", 0.7, 0.3, 3, 1);
    check_first("of two at one instant the first", 0.5, 0.5, 3, 0);
    check_first("the closed one", 1.2, 0.3, 3, 1);
    check_first("the open one goes on opening", -0.3, 0.7, 2, 1);
    check_first("the other is open", 0.7, -0.3, 1, 0);
    zero[0] = zero[1] = 1.2;
    check_int("none", locate(2, 1.0, 3, &c), STEP_END);
}

/* Two powers of time and a straight gap: the powers' Hermite cubics put their zeros too late (0.63 and 0.62),
 * so that the straight one at 0.6 is guessed to be first. `turn` is the place of the straight one. */
static int turn;

static void late_guesses(double t, struct input *gap)
{
    double rate = 4.0 * t * t * t;
    gap[turn] = (struct input){line_slope * (t - 0.6), line_slope};
    gap[(turn + 1) % 3] = (struct input){line_slope * (t * t * t * t - 0.1), line_slope * rate};
    gap[(turn + 2) % 3] = (struct input){line_slope * 0.5 * (t * t * t * t - 0.095), line_slope * 0.5 * rate};
}

/* When contacts switch nearly at once, the first one is found, whatever their guesses. */
TEST(switch_locate_order)
{
    struct crossing c;
    memset(start_state, 0, sizeof start_state);
    gaps = late_guesses;
    for (int i = 0; i < 6; i++) {
        unsigned regime = i < 3 ? 7 : 0;
        line_slope = i < 3 ? 1.0 : -1.0; /* opening, closing */
        turn = i % 3;
        check_int("of three", locate(3, 1.0, regime, &c), STEP_SWITCH);
        check_int("the first", c.contact, (turn + 2) % 3);
        check_near("at its instant", c.done, sqrt(sqrt(0.095)), 4.0 * DBL_EPSILON);
        check_int("no residual", c.residual, 0);
        if (turn == 0) {
            check_int("of two", locate(2, 1.0, regime, &c), STEP_SWITCH);
            check_int("the first", c.contact, 1);
            check_near("at its instant", c.done, sqrt(sqrt(0.1)), 4.0 * DBL_EPSILON);
            check_int("alone", locate(1, 1.0, regime, &c), STEP_SWITCH);
            check_near("the straight one", c.done, 0.6, 4.0 * DBL_EPSILON);
        }
    }
}

static void coming_back(double t, struct input *gap)
{
    gap[0] = (struct input){t - 0.1, 1.0};
    gap[1] = (struct input){0.5 - t, -1.0};
}

/* A contact that began beyond its switch and comes back has not switched. */
TEST(switch_locate_back)
{
    struct crossing c;
    memset(start_state, 0, sizeof start_state);
    gaps = coming_back;
    check_int("a switch", locate(2, 1.0, 3, &c), STEP_SWITCH);
    check_int("of the other contact", c.contact, 0);
    check_near("at its instant", c.done, 0.1, 4.0 * DBL_EPSILON);
    check_int("no residual", c.residual, 0);
}
