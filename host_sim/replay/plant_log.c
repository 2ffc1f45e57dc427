/* plant_log.c - see plant_log.h. */
#include "host_sim/replay/plant_log.h"

#include <stdio.h>
#include <string.h>
#include "firmware/bus/identity.h"
#include "hal/posix/log_read.h"
#include "models/check.h"

STATIC_ASSERT((int)LOG_COMMANDS == (int)WIRE_COMMANDS, commands_of_the_recorder);

/* ---- the first look ---- */

/* The entry of this interface, made if there is room; NULL without. */
static struct plant_log_interface *find_interface(struct plant_log *l, const char *name)
{
    for (int i = 0; i < l->n_on; i++)
        if (!strcmp(l->on[i].name, name))
            return &l->on[i];
    if (l->n_on == PLANT_LOG_INTERFACES)
        return NULL;
    struct plant_log_interface *on = &l->on[l->n_on++];
    memcpy(on->name, name, sizeof on->name);
    return on;
}

static void note_message(struct plant_log *l, const struct log_line *line, const struct message *m)
{
    struct plant_log_interface *on = find_interface(l, line->interface);
    double identity = 0.0;
    if (!on || m->kind != WIRE_INFO || (int)m->value[INFO_ITEM] != INFO_IDENTITY)
        return;
    (void)identity_item(&l->scene, INFO_IDENTITY, &identity);
    on->has_identity = true;
    on->is_another = on->is_another || m->value[INFO_VALUE] != (double)(float)identity;
}

/* Reads all of it, and goes back to its begin: 0, or -1. */
static int look_through(struct plant_log *l)
{
    struct log_line line;
    struct message m;
    bool begun = false;
    int got;
    while ((got = plant_log_next(l, &line, &m)) > 0) {
        if (m.kind != WIRE_KINDS)
            note_message(l, &line, &m);
        if (!begun && line.fault == 0) { /* a fault tells nothing of its log */
            begun = true;
            l->on_bus = line.time_us >= PLANT_LOG_EPOCH_US;
            l->marked = line.way != LOG_UNKNOWN;
        }
    }
    l->marked = !l->on_bus && (l->marked || l->reader.of_plant);
    l->others = l->unsound = 0;
    if (got < 0)
        snprintf(l->reason, sizeof l->reason, "%s", l->reader.reason);
    log_reader_rewind(&l->reader);
    return got;
}

/* "can0, can1 and can2" */
static void name_interfaces(const struct plant_log *l, char *text, size_t size)
{
    size_t n = 0;
    *text = 0;
    for (int i = 0; i < l->n_on && n < size; i++)
        n += (size_t)snprintf(text + n, size - n, "%s%s",
                              !i                 ? ""
                              : i == l->n_on - 1 ? " and "
                                                 : ", ",
                              l->on[i].name);
}

/* The interface to read; false, and the reason. */
static bool choose(struct plant_log *l, const char *interface)
{
    char names[PLANT_LOG_INTERFACES * (LOG_INTERFACE + 5)];
    const char *path = l->reader.path;
    bool known = !interface;
    for (int i = 0; i < l->n_on; i++)
        known = known || !strcmp(l->on[i].name, interface);
    name_interfaces(l, names, sizeof names);
    if (l->n_on && !known) {
        snprintf(l->reason, sizeof l->reason, "%.120s has no frame of this plant on %.15s, but on %s", path,
                 interface, names);
        return false;
    }
    if (l->n_on > 1 && !interface) {
        snprintf(l->reason, sizeof l->reason,
                 "%.120s has frames under this plant's identifiers on %s; choose one, as by --interface %s",
                 path, names, l->on[0].name);
        return false;
    }
    interface = interface ? interface : l->n_on ? l->on[0].name : "";
    snprintf(l->chosen, sizeof l->chosen, "%s", interface);
    l->reader.interface = *l->chosen ? l->chosen : NULL;
    return true;
}

/* A log tells its plant's identity; another plant's numbers mean other things. */
static bool is_of_plant(struct plant_log *l)
{
    bool another = false;
    for (int i = 0; i < l->n_on; i++) {
        if (strcmp(l->on[i].name, l->chosen) != 0)
            continue;
        l->tells_identity = l->on[i].has_identity;
        another = l->on[i].is_another;
    }
    if (another)
        snprintf(l->reason, sizeof l->reason,
                 "%.120s is of another plant: another scene, rate or substeps; record it anew, or name its "
                 "scene",
                 l->reader.path);
    return !another;
}

const char *plant_log_open(struct plant_log *l, const char *path, const char *interface,
                           const struct wire_scene *scene)
{
    memset(l, 0, sizeof *l);
    l->scene = *scene;
    const char *reason = log_reader_open(&l->reader, path);
    if (reason) {
        snprintf(l->reason, sizeof l->reason, "%s", reason);
        return l->reason;
    }
    if (look_through(l) == 0 && choose(l, interface) && is_of_plant(l))
        return NULL;
    plant_log_close(l);
    return l->reason;
}

/* ---- its lines ---- */

/* The message in a line that was read, where `got` is above 0. Returns got. */
static int look_into(struct plant_log *l, int got, const struct log_line *line, struct message *m)
{
    m->kind = WIRE_KINDS;
    if (got <= 0)
        return got;
    bool word = line->way == LOG_NO_ROOM || line->way == LOG_OVERRUN || line->way == LOG_BEGIN ||
                line->way == LOG_TURN;
    if (line->kind != LOG_DATA || line->fault || word)
        return got;
    enum wire_status status = wire_decode(&l->scene, &line->frame, m);
    l->others += status == WIRE_NOT_OURS;
    l->unsound += status != WIRE_NOT_OURS && status != WIRE_OK;
    return got;
}

int plant_log_next(struct plant_log *l, struct log_line *line, struct message *m)
{
    return look_into(l, log_read_line(&l->reader, line), line, m);
}

int plant_log_any(struct plant_log *l, struct log_line *line, struct message *m)
{
    return look_into(l, log_read_any(&l->reader, line), line, m);
}

void plant_log_close(struct plant_log *l)
{
    log_reader_close(&l->reader);
}

/* ---- for people ---- */

void plant_log_tell_identity(const struct plant_log *l, const char *command)
{
    if (l->n_on && !l->tells_identity)
        fprintf(stderr, "contactplant %s: %s tells no identity (INFO); see that it is of this scene\n",
                command, l->reader.path);
}

void plant_log_tell(const struct plant_log *l, const char *command)
{
    const struct log_reader *r = &l->reader;
    const struct {
        uint64_t n;
        const char *one, *many;
    } over[] = {
        {r->count[LOG_FD], "CAN FD frame", "CAN FD frames"},
        {r->count[LOG_REMOTE], "remote frame", "remote frames"},
        {r->count[LOG_ERROR], "error frame", "error frames"},
        {l->others, "frame of others", "frames of others"},
        {r->elsewhere, "line of other interfaces", "lines of other interfaces"},
        {l->unsound, "frame that fails its check", "frames that fail their check"},
        {r->count[LOG_DAMAGED], "damaged line", "damaged lines"},
        {r->count[LOG_CUT], "line that is cut off", "lines that are cut off"},
    };
    const char *before = "passed over";
    for (size_t i = 0; i < sizeof over / sizeof over[0]; i++) {
        if (!over[i].n)
            continue;
        if (*before == 'p')
            fprintf(stderr, "contactplant %s: %s: ", command, r->path);
        fprintf(stderr, "%s %llu %s", before, (unsigned long long)over[i].n,
                over[i].n == 1 ? over[i].one : over[i].many);
        before = ",";
    }
    if (*before == ',')
        fprintf(stderr, "%s%s\n", *r->damage ? "; the first damaged one is " : "", r->damage);
    plant_log_tell_identity(l, command);
}
