/* demo_report.c - the record as a CSV, and the numbers in one paragraph. */
#include "host_sim/demo/demo.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* A value, or nothing where there is none. */
static void put(FILE *f, const char *format, double value)
{
    fputc(',', f);
    if (!isnan(value))
        fprintf(f, format, value);
}

static void put_row(FILE *f, const struct demo_row *row)
{
    fprintf(f, "%.6f,%s", row->t_s, demo_phase_name[row->phase]);
    put(f, "%.6e", row->displacement_min);
    put(f, "%.6e", row->displacement_max);
    put(f, "%.6e", row->penetration_min);
    put(f, "%.6e", row->penetration_max);
    put(f, "%.5f", row->force_min);
    put(f, "%.5f", row->force_max);
    put(f, "%.5f", row->command_N);
    put(f, "%.5f", row->drive_N);
    put(f, "%.6e", row->base_m);
    put(f, "%.5f", row->loss);
    put(f, "%.0f", row->age_frames);
    fprintf(f, ",%d\n", row->reaction != REACTION_NONE);
}

bool demo_write_csv(const struct demo_record *r, const char *path, char *why)
{
    FILE *f = fopen(path, "w");
    if (!f) {
        snprintf(why, DEMO_REASON, "cannot write %s: %s", path, strerror(errno));
        return false;
    }
    fputs("plant_time_s,phase,displacement_min_m,displacement_max_m,penetration_min_m,penetration_max_m,"
          "contact_force_min_N,contact_force_max_N,control_force_N,slow_drive_amplitude_N,base_amplitude_m,"
          "contact_loss_1,command_age_frames,reaction\n",
          f);
    for (int i = 0; i < r->n_rows; i++)
        put_row(f, &r->row[i]);
    bool bad = ferror(f) != 0;
    bad = fclose(f) != 0 || bad;
    if (bad)
        snprintf(why, DEMO_REASON, "%s could not be written completely (disk full?)", path);
    return !bad;
}

/* Breaks lines between words at WIDTH columns. */
static void print_wrapped(const char *text)
{
    enum { WIDTH = 100 };
    int column = 0;
    while (*text) {
        int word = (int)strcspn(text, " ");
        if (column > 0 && column + 1 + word > WIDTH) {
            putchar('\n');
            column = 0;
        }
        column += printf("%s%.*s", column > 0 ? " " : "", word, text);
        text += word;
        text += strspn(text, " ");
    }
    putchar('\n');
}

static int tell_drives(char *text, size_t size, const struct demo *d, const struct demo_result *m)
{
    return snprintf(
        text, size,
        "The rig rests with a preload of %.2f N on %.2f um of compression; its resonance is %.1f Hz. Contact "
        "was first lost at %.4f s, at a slow force amplitude of %.2f N (%.1f %% of the preload); settled, "
        "%.1f %% of the time was without contact. The controller brought this to %.1f %% while the drive "
        "stayed: it pushed with up to %.1f N, then held %.2f um of compression or more with %.1f N. ",
        d->rest.force_N, 1e6 * d->rest.penetration_m, d->client.latest.info[INFO_F0_BUS_HZ], m->first_loss_s,
        m->first_loss_N, 100.0 * m->first_loss_N / d->rest.force_N, 100.0 * m->loss_before,
        100.0 * m->loss_controlled, m->force_peak_N, 1e6 * m->penetration_held, m->force_held_N);
}

static int tell_fast(char *text, size_t size, const struct demo_result *m)
{
    if (!(m->loss_fast > 0.0))
        return snprintf(text, size,
                        "The fast base drive of %.2f um did not break the contact; it took %.1f N. ",
                        1e6 * m->base_m, m->force_fast_N);
    return snprintf(
        text, size,
        "The fast base drive of %.2f um broke the contact again: up to %.1f %% of the time, %.2f s long, "
        "until the controller pushed with %.1f N; at the end %.1f %% were lost, with %.1f N. ",
        1e6 * m->base_m, 100.0 * m->loss_fast, m->fast_lost_s, m->force_fast_peak_N, 100.0 * m->loss_fast_end,
        m->force_fast_N);
}

static int tell_end(char *text, size_t size, const struct demo *d, const struct demo_result *m)
{
    const struct latest *l = &d->client.latest;
    const double *health = l->health;
    return snprintf(
        text, size,
        "Then the controller fell silent: the plant reacted %.0f frames after the frame that the last "
        "heartbeat named (limit %.0f) and had its drives at zero %.2f s later. Timing: overruns %.0f, "
        "frames missed and made up %.0f, streamed samples missed %.0f, worst wake-up %.0f us late, worst "
        "frame %.0f us of computing, "
        "worst pause of the controller %.1f ms.",
        m->reaction_frames, l->parameter[SETTING_FIRST + SET_TIMEOUT_FRAMES], m->reaction_s,
        health[DIAG_OVERRUNS], health[DIAG_FRAMES_MISSED], d->stream_missed, health[DIAG_LATENESS_MAX_US],
        health[DIAG_COMPUTE_MAX_US], 1e3 * d->stall_s);
}

void demo_print_summary(const struct demo *d)
{
    char text[4096];
    struct demo_result m;
    int n = 0;
    demo_measure(&d->record, &m);
    n += tell_drives(text, sizeof text, d, &m);
    n += tell_fast(text + n, sizeof text - (size_t)n, &m);
    tell_end(text + n, sizeof text - (size_t)n, d, &m);
    printf("\n");
    print_wrapped(text);
    printf("\n");
}
