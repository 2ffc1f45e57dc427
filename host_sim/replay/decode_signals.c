/* decode_signals.c - see decode_signals.h. */
#include "host_sim/replay/decode_signals.h"

#include <stdio.h>
#include "firmware/bus/wire_table.h"
#include "host_sim/out/cell.h"
#include "host_sim/cli/names.h"
#include "host_sim/commands.h"

const struct option decode_log_options[] = {
    {"interface", "NAME", "of a log of several interfaces, the one that the plant is on", OPTION_TEXT,
     .initial = NULL},
    {.name = NULL},
};

const struct option decode_logs_options[] = {
    {"model", "NAME", "the plant's model or scene, as given to contactplant run (hertz_rig)", OPTION_TEXT,
     .initial = NULL},
    {"interface", "NAME",
     "of logs of several interfaces, the one that the plant is on; given twice: of each log", OPTION_TEXT,
     .many = true},
    {.name = NULL},
};

const char *decode_interface(const struct options *o, int i)
{
    return options_text(o, "interface", options_count(o, "interface") > 1 ? i : 0);
}

int decode_signals(const struct model *m)
{
    return DECODE_OUTPUTS + m->n_inputs;
}

const struct signal *decode_signal(const struct model *m, int i)
{
    return i < DECODE_OUTPUTS ? &m->output_signal[i] : &m->input_signal[i - DECODE_OUTPUTS];
}

void decode_name(const struct model *m, int i, char text[DECODE_NAME])
{
    snprintf(text, DECODE_NAME, "%s%s", i < DECODE_OUTPUTS ? "" : "command_", decode_signal(m, i)->name);
}

int decode_no_rows(const struct options *o, const char *path)
{
    return options_failure(o->usage, "%s has no SYNC of this plant; is its --base-id another one?", path);
}

void decode_put_header(FILE *f, const struct model *m)
{
    char name[DECODE_NAME];
    fputs("t_s,frame,tick,state,in_contact", f);
    for (int i = 0; i < decode_signals(m); i++) {
        decode_name(m, i, name);
        fprintf(f, ",%s [%s]", name, decode_signal(m, i)->unit);
    }
    fputc('\n', f);
}

void decode_put_row(FILE *f, const struct model *m, const struct decode_row *r)
{
    const char *state = r->state >= 0 ? names_text(m, NAMES_STATE, (unsigned)r->state) : NULL;
    fprintf(f, "%.9f,%llu,%llu,%s,", r->t_s, (unsigned long long)r->frame, (unsigned long long)r->tick,
            state ? state : "");
    if (r->contact_known)
        fprintf(f, "%u", r->closed);
    for (int i = 0; i < decode_signals(m); i++)
        fputc(',', f), cell_put(f, r->value[i], 9);
    fputc('\n', f);
}
