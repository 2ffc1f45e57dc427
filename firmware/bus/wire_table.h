/* wire_table.h - the layout of every message, bit by bit, with names and units. */
#ifndef FIRMWARE_WIRE_TABLE_H
#define FIRMWARE_WIRE_TABLE_H

#include "firmware/bus/wire.h"

enum field_kind { FIELD_UNSIGNED, FIELD_SIGNED, FIELD_FLOAT };

/* Which list gives an index field its names (the multiplexer of the .dbc, and the names that tools print). */
enum field_names {
    NAMES_NONE,
    NAMES_OPERATION,
    NAMES_CAPTURE,
    NAMES_ARM,
    NAMES_WHEN,
    NAMES_STATE,
    NAMES_REACTION,
    NAMES_CAUSE,
    NAMES_MESSAGE,
    NAMES_PARAMETER, /* model parameters, then settings */
    NAMES_LEDGER,
    NAMES_COUNTER,
    NAMES_INFO,
    NAMES_INPUT,
    NAMES_OUTPUT,
    NAMES_OBSERVABLE, /* outputs, states of other names, time, eigenfrequency: see model_observable */
    NAMES_ON_OFF,
    NAMES_TOUCH,
    NAMES_SELF_TEST,
    NAMES_VERDICT
};

struct field {
    const char *name;
    const char *meaning;
    uint8_t start, bits; /* little endian bit position in the 64 bits of the frame */
    enum field_kind kind;
    enum field_scale scale;
    enum field_names names;
    const char *unit; /* SI, or "" */
};

struct message_layout {
    const char *name;
    const char *meaning;
    uint8_t kind;
    bool command; /* controller to plant */
    uint8_t n_fields;
    struct field field[WIRE_FIELDS];
};

/* The layout of a kind (any number), or NULL where there is no such message. STREAM, ARM and STREAM_ECHO have
 * one layout for their four kinds. */
const struct message_layout *wire_layout(unsigned kind);

/* The layout is that of a message for each input, whose number is a kind's distance from the layout's. */
static inline bool wire_is_of_input(const struct message_layout *l)
{
    return l->kind == WIRE_STREAM || l->kind == WIRE_ARM || l->kind == WIRE_STREAM_ECHO;
}

#endif
