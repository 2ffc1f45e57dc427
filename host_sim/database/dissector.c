/* dissector.c - see dissector.h. */
#include "host_sim/database/dissector.h"

#include <math.h>
#include "firmware/bus/wire_table.h"
#include "host_sim/cli/names.h"

/* dissector.lua, as it is; the Makefile knows that this file depends on it. */
__asm__(".pushsection .rodata\n"
        "dissector_begin:\n"
        ".incbin \"host_sim/database/dissector.lua\"\n"
        "dissector_end:\n"
        ".byte 0\n"
        ".globl dissector_begin, dissector_end\n"
        ".popsection\n");
extern const char dissector_begin[], dissector_end[];

static void print_text(FILE *out, const char *text)
{
    fputc('"', out);
    for (; *text; text++)
        fprintf(out, *text == '"' || *text == '\\' ? "\\%c" : "%c", *text);
    fputc('"', out);
}

static void print_values(FILE *out, const struct bus_scene *s, const struct bus_signal *g)
{
    if (g->names == NAMES_NONE || g->multiplex >= 0)
        return;
    fputs(", value = {", out);
    for (unsigned i = 0; i < NAMES_INDICES; i++) {
        const char *name = names_text(s->model, g->names, i);
        if (name)
            fprintf(out, "[%u] = \"%s\", ", i, name);
    }
    fputc('}', out);
}

static void print_signal(FILE *out, const struct bus_scene *s, const struct bus_signal *g)
{
    static const char kind[] = {[FIELD_UNSIGNED] = 'u', [FIELD_SIGNED] = 'i', [FIELD_FLOAT] = 'f'};
    char factor[BUS_NUMBER];
    fprintf(out,
            "            {name = \"%s\", start = %d, bits = %d, kind = \"%c\", factor = %s, unit = \"%s\"",
            g->name, g->start, g->bits, kind[g->kind], bus_number(factor, g->factor), g->unit);
    if (!isnan(g->none))
        fprintf(out, ", none = %.0f", g->none);
    if (g->multiplex == BUS_MULTIPLEXER)
        fputs(", selects = true", out);
    if (g->multiplex >= 0)
        fprintf(out, ", selected = %d", g->multiplex);
    print_values(out, s, g);
    fputs(", meaning = ", out);
    print_text(out, g->meaning);
    fputs("},\n", out);
}

static void print_message(FILE *out, const struct bus_scene *s, unsigned kind)
{
    const struct message_layout *l = wire_layout(kind);
    struct bus_signal g[BUS_SIGNALS];
    int n = bus_signals(s, kind, g);
    fprintf(out, "        [%u] = {name = \"%s\", command = %s, meaning = ", kind, names_kind(kind),
            l->command ? "true" : "false");
    print_text(out, l->meaning);
    fputs(", signal = {\n", out);
    for (int i = 0; i < n; i++)
        print_signal(out, s, &g[i]);
    fputs("        }},\n", out);
}

void dissector_print(FILE *out, const struct bus_scene *s)
{
    fprintf(out,
            "-- Messages of the contactplant %s, whose INFO identity is %u: believe no scaled number of "
            "another one.\nlocal plant = {\n    model = \"%s\", base = %u, extended = %s,\n    message = {\n",
            s->model->name, (unsigned)s->wire.identity, s->model->name, (unsigned)s->wire.base_id,
            s->wire.extended ? "true" : "false");
    for (unsigned kind = 0; kind < WIRE_KINDS; kind++)
        if (bus_has(s, kind))
            print_message(out, s, kind);
    fputs("    },\n}\n", out);
    (void)fwrite(dissector_begin, 1, (size_t)(dissector_end - dissector_begin), out);
}
