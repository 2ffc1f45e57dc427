/* dbc_vectors.c - prints the .dbc of a scene, and frames with the values they were made from, for
 * tests/cli/test_dbc.py.
 *
 *   dbc_vectors dbc SCENE       prints the .dbc
 *   dbc_vectors vectors SCENE   prints `id-hex extended data-hex MESSAGE SIGNAL value` for each signal
 *   dbc_vectors tables SCENE    prints the tables of the pages in docs/reference, row by row
 *
 * SCENE 0 is the default rig; 1 has 29-bit identifiers and time dilation. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/bus/identity.h"
#include "firmware/bus/settings.h"
#include "firmware/bus/wire_table.h"
#include "host_sim/database/dbc.h"
#include "host_sim/cli/names.h"
#include "models/math/elementary.h"
#include "models/hertz_rig.h"

enum { ROUNDS = 3 }; /* frames of each message and each multiplexed signal: smallest, largest, in between */

static struct bus_scene make_scene(int which)
{
    struct bus_scene s = {.model = &hertz_rig};
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], setting[SETTINGS];
    struct scale scale;

    for (int i = 0; i < hertz_rig.n_parameters; i++)
        si[i] = hertz_rig.parameter[i].initial;
    for (int i = 0; i < SETTINGS; i++)
        setting[i] = setting_initial(i, &hertz_rig, 1e-3);
    hertz_rig.prepare(si, p, &scale);
    s.f0_Hz = hertz_rig.eigenfrequency(p) / (2.0 * ELEMENTARY_PI * scale.time_s);
    s.wire = (struct wire_scene){.base_id = which == 0 ? 0x200 : 0x18FF0040,
                                 .extended = which != 0,
                                 .frame_rate_Hz = 1000.0,
                                 .dilation = which == 0 ? 1.0 : 100.0,
                                 .substeps = 64};
    s.wire.lsb[0] = wire_lsb(scale.length_m);
    s.wire.lsb[1] = wire_lsb(scale.length_m / (scale.time_s * s.wire.dilation));
    s.wire.lsb[2] = s.wire.lsb[0];
    s.wire.lsb[3] = wire_lsb(scale.force_N);
    identity_fill(&s.wire, &hertz_rig, setting);
    return s;
}

/* A value that the field holds exactly. */
static double pick(const struct bus_scene *s, const struct field *d, int round)
{
    static const double floats[ROUNDS] = {-0x1.fffffep+127, 0x1p-149, 0x1.23456p-10};
    double span = ldexp(1.0, d->bits), low = 0.0, high = span - 1.0;

    if (d->kind == FIELD_FLOAT)
        return floats[round];
    if (d->kind == FIELD_SIGNED) {
        low = 1.0 - span / 2.0;
        high = span / 2.0 - 1.0;
    }
    return (round == 0   ? low
            : round == 1 ? high
                         : floor(low + (high - low) * 0.6180339887)) *
           wire_factor(&s->wire, d->scale);
}

static void print_vector(const struct bus_scene *s, const struct message *msg, const struct frame *f, int i,
                         const char *name)
{
    printf("%lx %d ", (unsigned long)f->id, s->wire.extended);
    for (int k = 0; k < FRAME_DATA; k++)
        printf("%02x", f->data[k]);
    printf(" %s %s %.17g\n", names_kind(msg->kind), name, msg->value[i]);
}

/* `index`: the multiplexer's value, `name` of the signal it selects; NULL for a message without one. */
static void print_frame(const struct bus_scene *s, unsigned kind, int by, unsigned index, const char *name)
{
    const struct message_layout *l = wire_layout(kind);
    struct message msg = {.kind = (uint8_t)kind};
    struct frame f;

    for (int round = 0; round < ROUNDS; round++) {
        for (int i = 0; i < l->n_fields; i++)
            msg.value[i] = i == by ? index : pick(s, &l->field[i], round);
        msg.counter = (uint8_t)(7 * round);
        wire_encode(&s->wire, &msg, &f);
        for (int i = 0; i < l->n_fields; i++)
            print_vector(s, &msg, &f, i, name && i == l->n_fields - 1 ? name : l->field[i].name);
    }
}

static void print_vectors(const struct bus_scene *s)
{
    for (unsigned kind = 0; kind < WIRE_KINDS; kind++) {
        const struct message_layout *l = wire_layout(kind);
        int by = l ? names_multiplexer(l) : -1;
        if (l && by < 0)
            print_frame(s, kind, -1, 0, NULL);
        for (unsigned i = 0; by >= 0 && i < NAMES_INDICES; i++)
            if (names_text(s->model, l->field[by].names, i))
                print_frame(s, kind, by, i, names_text(s->model, l->field[by].names, i));
    }
}

static const char *scale_text(const struct field *d)
{
    static const char *const text[] = {
        [SCALE_ONE] = "",         [SCALE_FRACTION_8] = "1/256", [SCALE_FRACTION_16] = "1/65536",
        [SCALE_LOSS] = "1/65535", [SCALE_ANGLE] = "pi/32768",   [SCALE_DISPLACEMENT] = "LSB",
        [SCALE_VELOCITY] = "LSB", [SCALE_PENETRATION] = "LSB",  [SCALE_FORCE] = "LSB",
    };

    return text[d->scale];
}

static void print_message_table(const struct message_layout *l)
{
    static const char *const kinds[] = {"uint", "int", "float"};
    bool four = wire_is_of_input(l);

    printf("### 0x%02X%s %s%s: %s\n\n", l->kind, four ? "-" : "", l->name, four ? "_0.._3" : "", l->meaning);
    printf("| signal | first bit | type | unit | scale | meaning |\n|---|---|---|---|---|---|\n");
    for (int i = 0; i < l->n_fields; i++) {
        const struct field *d = &l->field[i];
        printf("| %s | %d | %s%d | %s | %s | %s |\n", d->name, d->start, kinds[d->kind], d->bits, d->unit,
               scale_text(d), d->meaning);
    }
    printf("\n");
}

static void print_list(const struct bus_scene *s, const char *title, enum field_names list)
{
    struct named n;

    printf("%s\n\n| number | name | unit | meaning |\n|---|---|---|---|\n", title);
    for (unsigned i = 0; i < NAMES_INDICES; i++)
        if (names_get(s->model, list, i, &n))
            printf("| %u | %s | %s | %s |\n", i, n.name, n.unit, n.meaning);
    printf("\n");
}

static void print_parameters(const struct parameter *p, int n, int first)
{
    printf("| index | name | unit | min | max | default | meaning |\n|---|---|---|---|---|---|---|\n");
    for (int i = 0; i < n; i++)
        printf("| %d | %s | %s | %g | %g | %g | %s |\n", first + i, p[i].name, p[i].unit, p[i].min, p[i].max,
               p[i].initial, p[i].meaning);
    printf("\n");
}

static void print_tables(const struct bus_scene *s)
{
    for (unsigned kind = 0; kind < WIRE_KINDS; kind++)
        if (wire_layout(kind) && wire_layout(kind)->kind == kind)
            print_message_table(wire_layout(kind));
    print_list(s, "OPERATION of CONTROL:", NAMES_OPERATION);
    print_list(s, "OPERATION of CAPTURE:", NAMES_CAPTURE);
    print_list(s, "FIELD of ARM and DRIVE_ECHO:", NAMES_ARM);
    print_list(s, "WHEN of PARAM_COMMIT:", NAMES_WHEN);
    print_list(s, "STATE of STATUS:", NAMES_STATE);
    print_list(s, "REACTION of STATUS:", NAMES_REACTION);
    print_list(s, "CAUSE of REPLY:", NAMES_CAUSE);
    print_list(s, "ITEM of LEDGER:", NAMES_LEDGER);
    print_list(s, "ITEM of INFO:", NAMES_INFO);
    print_list(s, "ITEM of SELF_TEST:", NAMES_SELF_TEST);
    print_list(s, "VERDICT of SELF_TEST:", NAMES_VERDICT);
    print_list(s, "Inputs:", NAMES_INPUT);
    print_list(s, "Outputs:", NAMES_OUTPUT);
    print_list(s, "ITEM of HEALTH:", NAMES_COUNTER);
    print_parameters(s->model->parameter, s->model->n_parameters, 0);
    print_parameters(setting_table, SETTINGS, SETTING_FIRST);
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: dbc_vectors dbc|vectors|tables SCENE\n");
        return 2;
    }
    struct bus_scene s = make_scene(atoi(argv[2]));
    if (strcmp(argv[1], "dbc") == 0)
        dbc_print(stdout, &s);
    if (strcmp(argv[1], "vectors") == 0)
        print_vectors(&s);
    if (strcmp(argv[1], "tables") == 0)
        print_tables(&s);
    return ferror(stdout) != 0;
}
