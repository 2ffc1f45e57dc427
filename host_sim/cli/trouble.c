/* trouble.c - see trouble.h. */
#include "host_sim/cli/trouble.h"
#include "firmware/bus/diag.h"

#include <stdarg.h>
#include <stdio.h>

const struct named trouble_fault[TROUBLE_FAULTS] = {
    {"not_finite", "", "the state left the finite numbers; the last good state is kept"},
    {"budget", "", "a tick needed more contact switches than the bound"},
    {"ledger", "", "more energy than ledger_alarm allows did not balance"},
    {"overrun", "", "an overrun under the policy stop"},
    {"bus", "", "bus-off or interface down was seen"},
    {"timeout", "", "heartbeats stopped"},
    {"assert", "", "the last run on the board ended by a fault"},
    {"self_test", "", "the power-on self-test failed"},
};

/* A reader of a report has to know these first. */
static const struct {
    enum diag counter;
    const char *one, *several;
} told[] = {
    {DIAG_OVERRUNS, "overrun", "overruns"},
    {DIAG_FRAMES_MISSED, "frame missed", "frames missed"},
    {DIAG_TIMEOUTS, "time-out of the controller", "time-outs of the controller"},
    {DIAG_STREAM_MISSED, "streamed sample missing", "streamed samples missing"},
    {DIAG_LOST, "frame lost on its way to the plant", "frames lost on their way to the plant"},
    {DIAG_RX_DROPPED, "report of dropped frames", "reports of dropped frames"},
    {DIAG_TX_REPLACED, "message of the plant lost", "messages of the plant lost"},
    {DIAG_EVENTS_LOST, "contact event lost", "contact events lost"},
    {DIAG_LOG_ENDED, "recording that ended before the run", "recordings that ended before the run"},
};

static void append(char *text, size_t size, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Adds to the text in its room, behind a comma. */
static void append(char *text, size_t size, const char *format, ...)
{
    size_t n = 0;
    va_list arguments;
    while (n < size && text[n])
        n++;
    if (n && n < size)
        n += (size_t)snprintf(text + n, size - n, ", ");
    va_start(arguments, format);
    if (n < size)
        (void)vsnprintf(text + n, size - n, format, arguments);
    va_end(arguments);
}

void trouble_faults(unsigned faults, char *text, size_t size)
{
    *text = '\0';
    for (int i = 0; i < TROUBLE_FAULTS; i++)
        if (faults >> i & 1u)
            append(text, size, "%s", trouble_fault[i].name);
}

void trouble_note_faults(unsigned faults, char text[TROUBLE_TEXT])
{
    char names[TROUBLE_TEXT / 2];
    trouble_faults(faults, names, sizeof names);
    snprintf(text, TROUBLE_TEXT, *names ? " (%s)" : "%s", names);
}

static bool is_refusal(int counter)
{
    return counter >= DIAG_CRC && counter <= DIAG_SELF_TEST && counter != DIAG_LOST;
}

void trouble_refusals(const uint32_t *count, char *text, size_t size)
{
    *text = '\0';
    for (int i = 0; i < DIAG_COUNTERS; i++)
        if (is_refusal(i) && count[i])
            append(text, size, "%u %s", count[i], diag_name[i].name);
}

double trouble_refused(const uint32_t *count)
{
    double n = 0.0;
    for (int i = 0; i < DIAG_COUNTERS; i++)
        n += is_refusal(i) ? count[i] : 0.0;
    return n;
}

bool trouble_list(const uint32_t *count, unsigned faults, char text[TROUBLE_TEXT])
{
    char more[TROUBLE_TEXT / 2];
    *text = '\0';
    for (size_t i = 0; i < sizeof told / sizeof *told; i++)
        if (count[told[i].counter])
            append(text, TROUBLE_TEXT, "%u %s", count[told[i].counter],
                   count[told[i].counter] == 1 ? told[i].one : told[i].several);
    trouble_refusals(count, more, sizeof more);
    if (*more)
        append(text, TROUBLE_TEXT, "%.0f refused (%s)", trouble_refused(count), more);
    trouble_faults(faults, more, sizeof more);
    if (faults)
        append(text, TROUBLE_TEXT, "faults: %s", more);
    return *text != '\0';
}
