/* send_capture.c - the command capture of contactplant send. */
#include "host_sim/cli/clock.h"
#include "host_sim/commands.h"
#include "host_sim/cli/names.h"
#include "host_sim/live/send.h"
#include "host_sim/out/cell.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double full_s = 2.0;

int send_check_capture(const struct sender *s, int n, const char *const *word)
{
    int operation = names_find(send_model(s), NAMES_CAPTURE, word[0]);
    double x;
    bool range =
        n == 1 || (operation == CAPTURE_READ && n == 3 && send_read_whole(word[1], 0.0, 65535.0, &x) &&
                   send_read_whole(word[2], 1.0, 65535.0, &x));
    static const char *const name[] = {"arm", "trigger", "stop", "read"};
    char advice[OPTIONS_ADVICE];
    if (operation < 0)
        return options_misuse(s->o->usage, "capture %s: no such operation%s", word[0],
                              options_advise(word[0], strlen(word[0]), name, 4, NULL, advice, sizeof advice));
    return range ? 0
                 : options_misuse(s->o->usage,
                                  "write capture arm, trigger, stop, or read [FIRST COUNT] below 65536");
}

static void print_burst(const struct sender *s)
{
    const struct model *m = send_model(s);
    printf("sample");
    for (int k = 0; k < m->n_outputs; k++)
        printf(",%s", m->output_signal[k].name);
    for (uint32_t i = 0; i < s->count; i++) {
        printf("\n%u", (unsigned)(s->first + i));
        for (int k = 0; k < m->n_outputs; k++)
            putchar(','), cell_put(stdout, (double)s->burst[i * (uint32_t)m->n_outputs + (uint32_t)k], 9);
    }
    printf("\n");
}

/* Takes values until the plant sends no more. True when all came. */
static bool collect_burst(struct sender *s)
{
    const uint64_t *count = &s->station.client.latest.count[WIRE_CAPTURE_DATA];
    uint64_t seen;
    do {
        seen = *count;
        double end = clock_now_s() + SEND_ANSWER_S;
        s->answered = false;
        while (clock_now_s() < end && !clock_interrupted())
            (void)send_wait(s, SEND_LOOK_S);
    } while (*count != seen && !clock_interrupted());
    bool complete = true;
    for (uint32_t i = 0; i < s->count * (uint32_t)send_model(s)->n_outputs; i++)
        complete = complete && !isnan(s->burst[i]);
    return complete;
}

/* Sends it until it is answered: the first try may repeat a counter of the session's owner. */
static int order(struct sender *s, enum capture_operation operation, uint32_t first, uint32_t count)
{
    for (int i = 0; i < SEND_TRIES; i++) {
        send_expect(s, WIRE_CAPTURE);
        client_capture(&s->station.client, operation, first, count);
        if (send_answer(s))
            return s->refused ? STATUS_FAILED : STATUS_DONE;
    }
    return send_no_answer(s, "capture");
}

/* Waits for a burst that is filling, as HEALTH says. If there is none then, the plant refuses to read it
 * out. */
static void wait_full(struct sender *s)
{
    double *state = &s->station.client.latest.health[DIAG_CAPTURE_STATE], end = clock_now_s() + full_s;
    *state = (double)NAN; /* the state before the last command does not count */
    send_expect(s, WIRE_CAPTURE);
    while (*state != CAPTURE_FULL && *state != CAPTURE_IDLE && clock_now_s() < end && !clock_interrupted())
        (void)send_wait(s, SEND_LOOK_S);
}

static int read_burst(struct sender *s, int n, const char *const *word)
{
    double count = n == 3 ? strtod(word[2], NULL) : send_ask(s, SETTING_FIRST + SET_CAPTURE_SAMPLES);
    if (!(count >= 1.0 && count <= 65535.0))
        return send_no_answer(s, "read capture_samples");
    s->first = n == 3 ? (uint32_t)strtod(word[1], NULL) : 0;
    s->count = (uint32_t)count;
    size_t n_values = (size_t)s->count * (size_t)send_model(s)->n_outputs;
    s->burst = malloc(n_values * sizeof *s->burst);
    if (!s->burst)
        return options_failure(s->o->usage, "out of memory");
    for (size_t i = 0; i < n_values; i++)
        s->burst[i] = NAN;
    wait_full(s);
    int status = order(s, CAPTURE_READ, s->first, s->count);
    if (status)
        return status;
    bool complete = collect_burst(s);
    print_burst(s);
    free(s->burst);
    s->burst = NULL;
    return complete ? STATUS_DONE
                    : options_failure(s->o->usage,
                                      "some values did not arrive: their cells are empty; read again");
}

int send_run_capture(struct sender *s, int n, const char *const *word)
{
    int operation = names_find(send_model(s), NAMES_CAPTURE, word[0]);
    if (operation == CAPTURE_READ)
        return read_burst(s, n, word);
    return order(s, (enum capture_operation)operation, 0, 0);
}
