/* test_papers_reference.c - closed forms of the four papers and direct runs, line by line against
 * tests/data/paper_reference.txt.
 *
 * That file was made without this code. Other tests are coexisting motions of the shaft, and the totals of
 * the table in docs/papers/numbers.md. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "models/reduced/afm_tip_reduced.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "tests/fixture/paper.h"
#include "tests/papers/attractor.h"
#include "tests/papers/contact.h"
#include "tests/papers/motion.h"
#include "tests/papers/theory.h"

#define PI 3.14159265358979323846

enum { LINE_NUMBERS = 8 };

/* kind key[] : value[] */
struct line {
    char kind[16];
    double key[LINE_NUMBERS], value[LINE_NUMBERS];
    int n_key, n_value;
};

static int read_numbers(const char *text, double *number)
{
    int n = 0;
    for (char *end; n < LINE_NUMBERS; text = end) {
        double x = strtod(text, &end);
        if (end == text)
            break;
        number[n++] = x;
    }
    return n;
}

static bool read_line(char *text, struct line *l)
{
    char *values = strchr(text, ':');
    int used;
    if (text[0] == '#' || !values || sscanf(text, "%15s%n", l->kind, &used) != 1)
        return false;
    *values = '\0';
    l->n_key = read_numbers(text + used, l->key);
    l->n_value = read_numbers(values + 1, l->value);
    return l->n_key > 0;
}

/* ---- Kirrou & Belhaq ---- */

static struct tip_theory tip(double beta, double r, double omega)
{
    double paper[MODEL_PARAMETERS];
    paper_defaults(&afm_tip, paper);
    paper[TIP_PAPER_BETA] = beta;
    paper[TIP_PAPER_R] = r;
    paper[TIP_PAPER_FAST_OMEGA] = omega;
    struct slow s = theory_slow(&afm_tip_averaged, paper, -1.0);
    return theory_tip(&s);
}

static void check_tip(const struct line *l)
{
    static const char *const name[] = {"tip: w1", "rho_n", "rho_l", "detuning of the peak", "its amplitude"};
    struct tip_theory t = tip(l->key[0], l->key[1], l->key[2]);
    double value[5] = {t.w1, t.rho_n, t.rho_l}, jump[2];
    value[3] = theory_tip_peak(&t, l->key[3], &value[4]);
    for (int i = 0; i < 5; i++)
        check_near(name[i], value[i], l->value[i], 1e-9);
    check_int("jumps of eq 21", 2 * theory_tip_jumps(&t, l->key[3], jump), l->n_value - 5);
    for (int i = 5; i < l->n_value; i++)
        check_near(i == 5 ? "jump down" : "jump up", jump[i - 5], l->value[i], 1e-6);
}

static void check_edge(const struct line *l)
{
    for (int k = 0; k < 2; k++) {
        double side[2];
        for (int i = 0; i < 2; i++) {
            struct tip_theory t = tip(l->key[0], l->value[k] + (i ? 1e-8 : -1e-8), l->key[1]);
            side[i] = t.rho_n + (k ? 0.0 : t.rho_l);
        }
        check_is(k ? "r_s: rho_n changes its sign" : "r_l: rho_n + rho_l changes its sign", side[0], >, 0.0);
        check_is(k ? "r_s: rho_n changes its sign" : "r_l: rho_n + rho_l changes its sign", side[1], <, 0.0);
    }
}

/* From rest: the start of the ten time units in which |u| passes 30, or the range of u. */
static void check_direct(const struct line *l)
{
    static struct motion m;
    double paper[MODEL_PARAMETERS], escaped = -1.0;
    paper_defaults(&afm_tip, paper);
    paper[TIP_PAPER_R] = l->key[0];
    paper[TIP_PAPER_FAST_OMEGA] = l->key[1];
    paper[TIP_PAPER_OMEGA] = l->key[2];
    paper[TIP_PAPER_F] = 0.008;
    const char *error = motion_start(&m, l->key[3] > 0.0 ? &afm_tip_cubic : &afm_tip, paper,
                                     MOTION_TWO_PI / l->key[1] / 48.0, 1e-12, NULL);
    check_string("starts", error ? error : "", "");
    double time = 0.0, state[MODEL_STATES];
    while (time < 2500.0 && escaped < 0.0 && plant_run(&m.pl, 1)) {
        time += m.pl.tick_s;
        motion_state(&m, state);
        escaped = fabs(state[0]) > 30.0 ? 10.0 * floor(time / 10.0) : -1.0;
    }
    check_near("tip from rest: escapes in the ten time units from (-1: stays)", escaped,
               l->n_value == 1 ? l->value[0] : -1.0, 0.0);
    if (l->n_value == 1)
        return;
    struct seen s = motion_watch(&m, 0, l->key[2], 500.0);
    check_near("tip from rest: lowest u", s.low, l->value[0], 2e-3);
    check_near("highest u", s.high, l->value[1], 2e-3);
}

/* ---- Bichri ---- */

static int rig_amplitudes(const struct line *l, double omega, double *amplitude)
{
    double paper[MODEL_PARAMETERS];
    paper_defaults(&hertz_rig, paper);
    paper[RIG_PAPER_FAST_OMEGA] = 8.0;
    paper[RIG_PAPER_FORCE] = l->key[0];
    paper[RIG_PAPER_BASE] = l->key[1];
    paper[RIG_PAPER_STIFFNESS] = l->key[2];
    struct slow s = theory_slow(&hertz_rig_averaged, paper, 1.5);
    return theory_rig(&s, 0.04, omega, amplitude);
}

static void check_rig(const struct line *l)
{
    double a[3];
    for (int i = 0; i < l->n_value; i++) {
        int before = rig_amplitudes(l, l->value[i] - 1e-6, a),
            after = rig_amplitudes(l, l->value[i] + 1e-6, a);
        check_int("Bichri eq 18, 24, 35: two amplitudes come or go within 1e-6", abs(after - before), 2);
    }
}

static void check_amplitude(const struct line *l)
{
    double a[3] = {0.0};
    check_int("Bichri eq 18, 24, 35: amplitudes", rig_amplitudes(l, l->key[3], a), l->n_value);
    for (int i = 0; i < l->n_value; i++)
        check_near("  one", a[i], l->value[i], 1e-8);
}

/* ---- Nayak ---- */

static void check_free(const struct line *l)
{
    struct free_vibration f = contact_free(l->key[0]);
    check_near("free vibration: frequency", f.omega, l->value[0], 1e-6);
    check_near("amplitude", f.amplitude / l->value[1], 1.0, 1e-9);
    check_near("mean area", f.area, l->value[2], 1e-6);
}

static void check_balance(const struct line *l)
{
    struct balance b = contact_balance(l->key[0]);
    check_near("harmonic balance: a0", b.a0, l->value[0], 1e-6);
    check_near("frequency", sqrt(b.stiffness), l->value[1], 1e-6);
}

static void check_upward(const struct line *l)
{
    check_near("harmonic balance: jump up", contact_balance_jump(l->key[0], l->key[1]), l->value[0], 1e-5);
}

/* Eq 61 for the jump, eq 65 for half of its power. */
static void check_downward(const struct line *l)
{
    for (int half = 0; half < 2; half++) {
        double low = 1.01, high = 9.0, least = l->key[0] / (half ? 2.0 * sqrt(2.0) : 2.0);
        for (int i = 0; i < 50; i++) {
            double middle = 0.5 * (low + high);
            struct free_vibration f = contact_free(middle);
            *(f.amplitude / f.omega < least ? &low : &high) = middle;
        }
        check_near(half ? "half power by eq 65" : "jump down by eq 61", contact_free(low).omega,
                   l->value[half], 1e-6);
    }
}

static double ratio(double got, double expected)
{
    return got / expected;
}

static void check_random(const struct line *l)
{
    const double *v = l->value, zeta = 0.05;
    struct density d = contact_density(l->key[0]);
    double spread = contact_deviation(&d), phi = l->key[0] * zeta;
    check_near("random: variance", spread * spread, v[1], 1e-6);
    check_near("mean contact force", contact_mean(&d, 1.5), 1.0, 1e-6);
    if (v[3] > 1e-6)
        check_near("share without contact", 1.0 - contact_above(&d, 0.0), v[3], 1e-7);
    check_near("its rate, relative", ratio(contact_crossings(&d, 0.0), v[4]), 1.0, 1e-5);
    /* p(eta = 0, rate = 0) is G itself. */
    double joint = contact_density_at(&d, 0.0) / (d.speed * sqrt(2.0 * PI));
    check_near("G of eq 69, relative", ratio(joint, v[5]), 1.0, 1e-5);
    check_near("G of eq 73, relative", ratio(zeta / (PI * PI * phi) * exp(-0.8 * zeta / (PI * phi)), v[6]),
               1.0, 1e-9);
}

static void check_level(const struct line *l)
{
    struct density d = contact_density(l->key[0]);
    double above = contact_above(&d, l->key[1]), rate = contact_crossings(&d, l->key[1]);
    check_near("above a level, relative", ratio(above, l->value[0]), 1.0, 1e-4);
    check_near("up-crossings of it", ratio(rate, l->value[1]), 1.0, 1e-5);
    check_near("mean length above it", ratio(above / rate, l->value[2]), 1.0, 1e-4);
}

TEST(papers_reference)
{
    static const struct {
        const char *kind;
        void (*check)(const struct line *);
        int lines;
    } kinds[] = {{"tip", check_tip, 10},
                 {"edge", check_edge, 4},
                 {"direct", check_direct, 30},
                 {"rig", check_rig, 4},
                 {"amplitude", check_amplitude, 20},
                 {"free", check_free, 11},
                 {"balance", check_balance, 4},
                 {"upward", check_upward, 3},
                 {"downward", check_downward, 7},
                 {"random", check_random, 2},
                 {"level", check_level, 10}};
    enum { KINDS = sizeof kinds / sizeof *kinds };
    int lines[KINDS] = {0};
    FILE *file = fopen("tests/data/paper_reference.txt", "r");
    char text[256];
    while (file && fgets(text, sizeof text, file)) {
        struct line l;
        if (!read_line(text, &l))
            continue;
        for (int i = 0; i < KINDS; i++) {
            if (strcmp(l.kind, kinds[i].kind) != 0)
                continue;
            printf("      %s\n", text);
            kinds[i].check(&l);
            lines[i]++;
        }
    }
    if (file)
        fclose(file);
    for (int i = 0; i < KINDS; i++) {
        check_int(check_name("lines compared: %s", kinds[i].kind), lines[i], kinds[i].lines);
    }
}

/* Soft contact: coexisting motions that another integrator found
 * from random starts, a few of each; two digits where aperiodic. */
TEST(papers_attractors)
{
    static const struct {
        double hz;
        int period;
        double high_mm, tolerance;
    } known[] = {{12.47, 0, 0.816, 0.005}, {12.47, 0, 0.62, 0.005}, {21.0, 1, 1.038, 1e-3},
                 {21.0, 0, 1.677, 0.03},   {45.0, 1, 0.148, 1e-3},  {45.0, 2, 0.413, 1e-3},
                 {80.0, 1, 0.042, 1e-3},   {80.0, 0, 0.43, 0.015}};
    enum { STARTS = 200 };
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        double paper[MODEL_PARAMETERS], state[MODEL_STATES];
        struct attractor_shaft s;
        struct attractor a;
        uint64_t seed = 1;
        int found = 0;
        attractor_paper(SHAFT_SOFT, known[k].hz, paper);
        bool good = attractor_open(&s, &shaft_bearing, paper);
        for (int i = 0; i < STARTS && good && found == 0; i++) {
            attractor_start(&seed, paper[SHAFT_G1], state);
            good = attractor_settle(&s, state, 16.0, &a);
            double high = 1e3 * a.high[0];
            found +=
                good && a.period == known[k].period && fabs(high - known[k].high_mm) < known[k].tolerance;
        }
        attractor_close(&s);
        check_int(check_name("%g Hz: a motion of period %d (0: none) with a largest x1 of %g mm", known[k].hz,
                             known[k].period, known[k].high_mm),
                  found, 1);
    }
}

/* Whether the cell that says whether a number agrees, the fourth, is this. */
static bool agrees(const char *row, const char *verdict)
{
    for (int i = 0; i < 3 && row; i++)
        row = strchr(row + 1, '|');
    return row && strncmp(row, verdict, strlen(verdict)) == 0;
}

/* The table of docs/papers/numbers.md: as many rows of each kind as the sentence above it says. */
TEST(papers_table)
{
    static const char *const verdict[] = {"| **no** |", "| 2 of 3 |"};
    FILE *file = fopen("docs/papers/numbers.md", "r");
    char text[512];
    int rows[2] = {0}, total = 0, told[4] = {-1, -1, -1, -1}; /* told: all, those that agree, rows of each */
    bool table = false;
    while (file && fgets(text, sizeof text, file)) {
        table = table || strncmp(text, "# Papers: the published numbers", 31) == 0;
        if (table && told[0] < 0)
            (void)sscanf(text, "%d numbers compared: %d agree, %d do not, %d in two", &told[0], &told[1],
                         &told[2], &told[3]);
        if (!table || text[0] != '|' || strncmp(text, "|---", 4) == 0 || strncmp(text, "| quantity", 10) == 0)
            continue;
        total++;
        for (int i = 0; i < 2; i++)
            rows[i] += agrees(text, verdict[i]);
    }
    if (file)
        fclose(file);
    check_int("rows of the table", total, told[2] + told[3]);
    check_int("numbers compared", told[1] + total, told[0]);
    for (int i = 0; i < 2; i++)
        check_int(verdict[i], rows[i], told[i + 2]);
}
