/* shaft_numbers.c - numbers that the shaft-bearing paper states and that have no chart of their own, to
 * standard error.
 *
 * They are linear theory (section 3), small asymmetries (8), bands (12), contacts a period (18), and
 * amplitudes near 700 Hz (11, 23). */
#include <math.h>
#include <stdio.h>
#include "tests/papers/rows.h"
#include "tests/papers/survival.h"

static const double mm = 1e3, wait = 3.0;

/* ---- linear theory ---- */

/* Eq 3 against the eigenvalues. */
static void tell_closed_forms(void)
{
    double paper[MODEL_PARAMETERS], hz[3], shape[3][3];
    attractor_paper(SHAFT_HARD, 25.0, paper);
    attractor_modes(paper, 0.0, hz, shape);
    double kl = 79161.0 / (0.1614 * 0.1614), turn = 6.283185307179586477;
    double w0 = sqrt(kl / 0.629), g = 2.0 * 8030.0 / kl + 1.0, alpha = sqrt(g * g - 2.0 * g + 17.0);
    rows_number("eq 3a, the first written: Hz", w0 * sqrt(g - 1.0) / turn);
    rows_number("  mode 2", hz[1]);
    rows_number("eq 3a, the minus sign: Hz", w0 * sqrt(0.5 * (g + 3.0 - alpha)) / turn);
    rows_number("  mode 1", hz[0]);
    rows_number("eq 3a, the plus sign: Hz", w0 * sqrt(0.5 * (g + 3.0 + alpha)) / turn);
    rows_number("  mode 3", hz[2]);
    rows_number("eq 3b, x2 over x1 of mode 1", (g - 5.0 + alpha) / (g + 3.0 - alpha));
    rows_number("  eigenvector", shape[0][1] / shape[0][0]);
    rows_number("eq 3b, of mode 3", (g - 5.0 - alpha) / (g + 3.0 + alpha));
    rows_number("  eigenvector", shape[2][1] / shape[2][0]);
}

/* Exponents of the frequencies between two stiffnesses:
 * the gap springs', closed, or one support's, gaps open. */
static void tell_exponents(bool closed, double low, double high)
{
    double paper[MODEL_PARAMETERS], hz[2][3];
    for (int i = 0; i < 2; i++) {
        double k = i ? high : low;
        attractor_paper(closed ? k : SHAFT_HARD, 25.0, paper);
        paper[SHAFT_KS3] = closed ? 8030.0 : k;
        attractor_frequencies(paper, closed, hz[i]);
    }
    rows_number(closed ? "fig 4: exponents, kg up to" : "fig 5: exponents, ks3 up to", high);
    for (int k = 0; k < 3; k++)
        rows_number("  mode", log(hz[1][k] / hz[0][k]) / log(high / low));
}

/* Figure 6: the first peak as support 3 weakens. Figure 7: the second mode in x1 and x2. */
static void tell_peaks(void)
{
    static const double support[] = {8030.0, 4015.0, 803.0, 80.3};
    double paper[MODEL_PARAMETERS], hz[3], amplitude[3];
    for (int k = 0; k < 4; k++) {
        attractor_paper(SHAFT_HARD, 25.0, paper);
        paper[SHAFT_KS3] = support[k];
        attractor_frequencies(paper, 0.0, hz);
        paper[SHAFT_PAPER_HZ] = hz[0];
        attractor_linear(paper, amplitude);
        rows_number("fig 6: ks3", support[k]);
        rows_number("  first peak, Hz", hz[0]);
        for (int i = 0; i < 3; i++)
            rows_number("  amplitude of x1, x2, x3 there, mm", amplitude[i] * mm);
    }
    attractor_paper(SHAFT_HARD, 25.0, paper);
    attractor_frequencies(paper, 0.0, hz);
    for (int off = 0; off < 2; off++) {
        paper[SHAFT_PAPER_P1] = 25.0;
        paper[SHAFT_PAPER_P1 + 1] = 0.0;
        paper[SHAFT_PAPER_HZ] = hz[1] * (off ? 0.98 : 1.0);
        attractor_linear(paper, amplitude);
        rows_number("fig 7, 25 N on bearing 1, Hz", paper[SHAFT_PAPER_HZ]);
        for (int i = 0; i < 3; i++)
            rows_number("  amplitude of x1, x2, x3, mm", amplitude[i] * mm);
    }
}

/* ---- 15 % more or less: where half of the starts still impact ---- */

static void tell_near(const char *what, int first, int last, double share)
{
    struct survival s = {.seconds = wait, .level = 0.5, .starts = 100};
    attractor_paper(SHAFT_HARD, 700.0, s.paper);
    for (int i = first; i <= last; i++)
        s.paper[i] *= share;
    rows_number(what, share);
    rows_number("  half impact after 3 s up to, Hz", survival_edge(&s, 20.0, 350.0));
    rows_number("  from", survival_edge(&s, 700.0, 500.0));
    rows_number("  to", survival_edge(&s, 700.0, 850.0));
}

/* ---- figure 12: bands of motions with small basins ---- */

/* The first and the last frequency, in steps of 0.5 Hz, at
 * which a start ends on a motion of this period (0: none). */
static void tell_band(int period, double from, double to, int starts)
{
    double first = (double)NAN, last = (double)NAN;
    uint64_t seed = 1;
    for (double hz = from; hz <= to; hz += 0.5) {
        double paper[MODEL_PARAMETERS], state[MODEL_STATES];
        struct attractor_shaft s;
        struct attractor a;
        bool found = false;
        attractor_paper(SHAFT_SOFT, hz, paper);
        if (!attractor_open(&s, &shaft_bearing, paper))
            continue;
        for (int i = 0; i < starts && !found; i++) {
            attractor_start(&seed, paper[SHAFT_G1], state);
            found = attractor_settle(&s, state, 16.0, &a) && a.period == period;
        }
        attractor_close(&s);
        last = found ? hz : last;
        first = found && isnan(first) ? hz : first;
    }
    rows_number("fig 12, soft contact: period (0: none)", period);
    rows_number("  from, Hz", first);
    rows_number("  to", last);
}

/* ---- figure 18: contacts in a period ---- */

static void tell_contacts(double hz, bool proportional)
{
    double paper[MODEL_PARAMETERS], state[MODEL_STATES];
    char name[80];
    struct attractor_shaft s;
    struct attractor a;
    uint64_t seed = 3;
    attractor_paper(SHAFT_HARD, hz, paper);
    for (int i = 0; i < 3; i++)
        paper[SHAFT_C1 + i] = proportional && i == 1 ? 278.0 : 139.0;
    if (!attractor_open(&s, &shaft_bearing, paper))
        return;
    for (int i = 0; i < 8; i++) {
        attractor_start(&seed, paper[SHAFT_G1], state);
        if (!attractor_settle(&s, state, 2.0, &a))
            continue;
        snprintf(name, sizeof name, "fig 18, %g Hz, c(1, %d, 1): contacts of x1 a period and side", hz,
                 proportional + 1);
        rows_number(name, a.switches / 8.0); /* two bearings, two sides, closing and opening */
    }
    attractor_close(&s);
}

/* ---- near 700 Hz ---- */

/* The largest values of some starts at some frequencies. */
static void find_largest(const double *hz, int frequencies, double kg1, double kg3, int starts,
                         double high[3])
{
    double paper[MODEL_PARAMETERS], state[MODEL_STATES];
    uint64_t seed = 17;
    high[0] = high[1] = high[2] = 0.0;
    for (int k = 0; k < frequencies; k++) {
        struct attractor_shaft s;
        struct attractor a;
        attractor_paper(kg1, hz[k], paper);
        paper[SHAFT_KG3] = kg3;
        if (!attractor_open(&s, &shaft_bearing, paper))
            continue;
        for (int i = 0; i < starts; i++) {
            attractor_start(&seed, paper[SHAFT_G1], state);
            if (!attractor_settle(&s, i ? state : NULL, wait, &a))
                continue;
            for (int j = 0; j < 3; j++)
                high[j] = fmax(high[j], a.high[j]);
        }
        attractor_close(&s);
    }
}

static void tell_resonance(void)
{
    static const double hz[] = {699.0, 699.5, 700.0, 700.5, 701.0};
    for (double power = 7.5; power >= 2.9; power -= 0.5) {
        double high[3];
        find_largest(hz, 5, SHAFT_HARD, pow(10.0, power), 4, high);
        rows_number("fig 23, 699 to 701 Hz, log10 of kg3", power);
        for (int i = 0; i < 3; i++)
            rows_number("  largest x1, x2, x3, mm", high[i] * mm);
    }
}

static void tell_high_motions(void)
{
    double hz[16], high[3];
    for (double power = 5.5; power < 7.03; power += 0.05) {
        double kg = pow(10.0, power);
        for (int i = 0; i < 16; i++)
            hz[i] = 698.0 + 2.0 * i;
        find_largest(hz, 16, kg, kg, 12, high);
        rows_number("fig 11, 698 to 728 Hz, log10 of kg", power);
        rows_number("  largest x1, mm", high[0] * mm);
    }
}

int main(void)
{
    tell_closed_forms();
    tell_exponents(true, 3.502e9, 3.502e10);
    tell_exponents(false, 0.803, 8.03);
    tell_exponents(false, 803.0, 8030.0);
    tell_peaks();
    tell_band(2, 40.0, 49.0, 1000);
    tell_band(3, 52.0, 76.0, 300);
    tell_band(0, 73.0, 88.0, 300);
    tell_contacts(15.0, false);
    tell_contacts(15.0, true);
    tell_resonance();
    tell_high_motions();
    tell_near("nominal", SHAFT_KG3, SHAFT_KG3, 1.0);
    for (int side = -1; side <= 1; side += 2) {
        double share = 1.0 + 0.15 * side;
        tell_near("section 8, kg3 times", SHAFT_KG3, SHAFT_KG3, share);
        tell_near("section 8, gap 3 times", SHAFT_G3, SHAFT_G3, share);
        tell_near("section 7, c times", SHAFT_C1, SHAFT_C1 + 2, share);
    }
    return 0;
}
