/* monitor_rows.c - see monitor_rows.h. */
#include "host_sim/replay/monitor_rows.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>
#include "hal/posix/udp.h"
#include "host_sim/replay/decode_signals.h"

enum { ROW_ROOM = 1024 }; /* at most, of JSON */

const struct option monitor_rows_options[] = {
    {.name = "wide", .meaning = "print a row a frame, with the columns of contactplant decode"},
    {"json", "WHERE",
     "rows as JSON with a timestamp in plant seconds: udp:HOST:PORT for PlotJuggler (udp:127.0.0.1:9870), or "
     "-",
     OPTION_TEXT, .initial = NULL},
    {"batch", "N", "with --json: rows of one packet, an array (33; 1: bare objects)", OPTION_INTEGER, 1.0,
     33.0, .initial = "33"},
    {.name = NULL},
};

/* A socket to udp:A.B.C.D:PORT, or -1. */
static int open_socket(const char *where)
{
    struct sockaddr_in at;
    if (strncmp(where, "udp:", 4) != 0 || !udp_address(where + 4, &at) || at.sin_port == 0)
        return -1;
    int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (fd >= 0 && connect(fd, (struct sockaddr *)&at, sizeof at) == 0)
        return fd;
    if (fd >= 0)
        close(fd);
    return -1;
}

static void begin_packet(struct monitor_rows *k)
{
    k->n_rows = 0;
    json_begin(&k->text, k->packet, sizeof k->packet);
    if (k->batch > 1)
        json_put(&k->text, "[");
}

int monitor_rows_open(struct monitor_rows *k, const struct options *o, const struct scene_app *s)
{
    const char *where = options_text(o, "json", 0);
    k->o = o;
    k->model = s->config.model;
    k->wide = options_given(o, "wide");
    k->json = where != NULL;
    k->socket = -1;
    k->batch = (uint64_t)options_number(o, "batch");
    begin_packet(k);
    decode_begin(&k->rows, &s->app.scene, s->app.plant.tick_s);
    if (k->wide + k->json + options_given(o, "csv") > 1)
        return options_misuse(o->usage, "--csv, --wide and --json are three forms; give one of them");
    if ((k->wide || k->json) && options_given(o, "only"))
        return options_misuse(o->usage, "--only picks messages; --wide and --json give rows of all of them");
    if (k->wide)
        decode_put_header(stdout, k->model);
    if (!k->json || !strcmp(where, "-"))
        return 0;
    k->socket = open_socket(where);
    return k->socket >= 0
               ? 0
               : options_misuse(o->usage, "--json %s: give udp:A.B.C.D:PORT, udp:localhost:PORT, or -",
                                where);
}

/* Nobody may listen yet: that is no failure. */
static void send_packet(struct monitor_rows *k)
{
    if (!k->n_rows)
        return;
    if (k->batch > 1)
        json_put(&k->text, "]");
    if (k->socket >= 0)
        (void)!send(k->socket, k->packet, k->text.n, MSG_DONTWAIT);
    else
        printf("%s\n", k->packet);
    begin_packet(k);
}

/* Members are the signals that have been said. */
static void add_row(struct monitor_rows *k, const struct decode_row *r)
{
    char name[DECODE_NAME];
    json_item(&k->text, "{'timestamp':%t", r->t_s);
    if (r->contact_known)
        json_item(&k->text, "'in_contact':%u", (uint64_t)r->closed);
    for (int i = 0; i < decode_signals(k->model); i++) {
        decode_name(k->model, i, name);
        if (isfinite(r->value[i]))
            json_item(&k->text, "'%r':%n", name, r->value[i]);
    }
    json_put(&k->text, "}");
    k->n_rows++;
    if (k->n_rows == k->batch || k->text.n + ROW_ROOM > MONITOR_PACKET)
        send_packet(k);
}

bool monitor_rows_take(struct monitor_rows *k, const struct message *m)
{
    struct decode_row row;
    if (!k->wide && !k->json)
        return false;
    if (!decode_take(&k->rows, m, &row))
        return true;
    k->printed++;
    if (k->wide)
        decode_put_row(stdout, k->model, &row);
    else
        add_row(k, &row);
    return true;
}

void monitor_rows_close(struct monitor_rows *k)
{
    decode_tell_missing(&k->rows, "monitor", "on the bus");
    send_packet(k);
    if (k->socket > 0) /* 0: it was never opened */
        close(k->socket);
    k->socket = -1;
}
