/* test_papers_peaks.c - periodic motions of tests/data/paper_peaks.txt and paper_responses.txt, which were
 * made without this code.
 *
 * They are the highest point of each branch, its largest peak to peak, one motion before it, and motions
 * under a modulated stiffness alone. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "models/reduced/afm_tip_reduced.h"
#include "tests/fixture/paper.h"
#include "tests/papers/branch_read.h"

enum { HIGH, AMPLITUDE, PEAK_NUMBERS = MODEL_STATES + 7 };

static double size(const struct branch_point *p, int which)
{
    return which == HIGH ? p->high : 0.5 * (p->high - p->low);
}

/* Length of the branch from one point to the next, in its units of frequency and the model's of the state. */
static double chord(const struct branch *b, const struct branch_point *from, const struct branch_point *to)
{
    double sum = (to->at - from->at) * (to->at - from->at) / (b->unit * b->unit);
    for (int k = 0; k < b->model->n_states; k++)
        sum += (to->x[k] - from->x[k]) * (to->x[k] - from->x[k]);
    return sqrt(sum);
}

/* Lagrange's parabola through three points at -before, 0 and after. */
static double parabola(const double y[3], double before, double after, double s)
{
    return y[0] * s * (s - after) / (before * (before + after)) -
           y[1] * (s + before) * (s - after) / (before * after) +
           y[2] * s * (s + before) / (after * (before + after));
}

/* Frequency and size where the parabola through the largest
 * point and its neighbours is highest; NaN: it is an end. */
static void find_top(const struct branch *b, const struct branch_point *point, int n, int which,
                     double found[2])
{
    int best = 0;
    for (int i = 1; i < n; i++)
        best = size(&point[i], which) > size(&point[best], which) ? i : best;
    found[0] = found[1] = (double)NAN;
    if (best == 0 || best == n - 1)
        return;
    const struct branch_point *p = &point[best - 1];
    double before = chord(b, &p[0], &p[1]), after = chord(b, &p[1], &p[2]), y[3], at[3];
    for (int i = 0; i < 3; i++) {
        y[i] = size(&p[i], which);
        at[i] = p[i].at;
    }
    double rise = (y[1] - y[0]) / before, fall = (y[1] - y[2]) / after;
    double s = 0.5 * (rise * after - fall * before) / (rise + fall);
    found[0] = parabola(at, before, after, s);
    found[1] = parabola(y, before, after, s);
}

static void check_peaks(struct branch *b, const double *number, int n_numbers)
{
    static struct branch_point point[BRANCH_POINTS];
    const double *motion = number + b->model->n_states, *peak = motion + 3;
    b->start = number;
    b->coordinate = 0;
    b->ticks *= 2;
    int n = branch_follow(b, point);
    if (n == 0) {
        check_true("the branch begins at the reference's state", 0);
        return;
    }
    check_near("there: highest, relative", point[0].high / motion[0], 1.0, 1e-6);
    check_near("lowest", point[0].low / motion[1], 1.0, 1e-6);
    check_near("largest multiplier, relative", point[0].multiplier / motion[2], 1.0, 1e-4);
    for (int which = HIGH; which <= AMPLITUDE && peak + 2 * which < number + n_numbers; which++) {
        double found[2];
        find_top(b, point, n, which, found);
        check_near(which == HIGH ? "peak: frequency, relative" : "peak to peak: frequency, relative",
                   found[0] / peak[2 * which], 1.0, 2e-5);
        check_near(which == HIGH ? "  highest" : "  half of it", found[1] / peak[2 * which + 1], 1.0, 1e-5);
    }
}

/* Two peaks of the cubic tip where a small distance grows 192- and 1933-fold a period. Differences of the
 * map are too coarse to follow the branch there, so the reference's state runs for one period. */
static void check_unstable(void)
{
    static const struct {
        double f, omega, state[2], high, low;
    } peaks[] = {{0.008, 0.184215204, {-0.6761355065, 0.2102086358}, 0.5981640131, -1.237855205},
                 {0.01, 0.1573492099, {-0.6753247111, 0.2164158373}, 0.617088622, -1.253103853}};
    enum { TICKS = 4096 };
    static struct motion m;
    for (int i = 0; i < 2; i++) {
        double paper[MODEL_PARAMETERS], end[MODEL_STATES], period = MOTION_TWO_PI / peaks[i].omega;
        paper_defaults(&afm_tip_cubic, paper);
        paper[TIP_PAPER_F] = peaks[i].f;
        paper[TIP_PAPER_OMEGA] = peaks[i].omega;
        printf("      afm_tip_cubic f = %g, omega = %g\n", peaks[i].f, peaks[i].omega);
        check_no_error("starts",
                       motion_start(&m, &afm_tip_cubic, paper, period / TICKS, 1e-12, peaks[i].state));
        struct seen s = motion_watch(&m, 0, peaks[i].omega, period * (1.0 - 0.5 / TICKS));
        check_near("highest", s.high, peaks[i].high, 1e-6);
        check_near("lowest", s.low, peaks[i].low, 1e-6);
        motion_state(&m, end);
        for (int k = 0; k < 2; k++)
            check_near("a period later", end[k], peaks[i].state[k], 1e-6);
    }
}

/* How many branches the file has. */
static int check_file(const char *path)
{
    FILE *file = fopen(path, "r");
    char line[512];
    int lines = 0;
    while (file && fgets(line, sizeof line, file)) {
        struct branch b;
        double number[PEAK_NUMBERS];
        int n = 0;
        if (line[0] == '#')
            continue;
        printf("      %s", line);
        const char *text = branch_read(line, &b);
        if (!text)
            continue;
        for (char *end; n < PEAK_NUMBERS; text = end, n++) {
            number[n] = strtod(text, &end);
            if (end == text)
                break;
        }
        check_peaks(&b, number, n);
        lines++;
    }
    if (file)
        fclose(file);
    return lines;
}

TEST(papers_peaks)
{
    check_int("branches compared", check_file("tests/data/paper_peaks.txt"), 16);
    check_unstable();
}

/* Without a slow drive. */
TEST(papers_responses)
{
    check_int("responses compared", check_file("tests/data/paper_responses.txt"), 80);
}
