/* decode_log.c - see decode_log.h. */
#include "host_sim/replay/decode_log.h"
#include "host_sim/out/plural.h"

#include <stdio.h>

const char *decode_log_open(struct decode_log *d, const char *path, const char *interface,
                            const struct wire_scene *scene, double tick_s)
{
    decode_begin(&d->rows, scene, tick_s);
    d->ended = false;
    d->hear = NULL;
    return plant_log_open(&d->log, path, interface, scene);
}

void decode_log_close(struct decode_log *d)
{
    plant_log_close(&d->log);
}

/* A row ends where the next SYNC begins one, or with the log. */
int decode_log_next(struct decode_log *d, struct decode_row *row)
{
    struct log_line line;
    struct message m;
    int got = 0;
    while (!d->ended && (got = plant_log_next(&d->log, &line, &m)) > 0) {
        if (m.kind == WIRE_KINDS)
            continue;
        if (d->hear)
            d->hear(d->context, &m);
        if (decode_take(&d->rows, &m, row))
            return 1;
    }
    bool last = !d->ended && got == 0 && d->rows.begun;
    d->ended = true;
    decode_end(&d->rows, row);
    return got < 0 ? -1 : last;
}

void decode_log_tell(const struct decode_log *d, const char *command)
{
    unsigned runs = d->rows.row.run;
    plant_log_tell(&d->log, command);
    if (runs)
        fprintf(stderr,
                "contactplant %s: %s: plant time begins anew %u time%s; the plant was started again, or this "
                "is more than one log\n",
                command, d->log.reader.path, runs, plural(runs));
    decode_tell_missing(&d->rows, command, d->log.reader.path);
}
