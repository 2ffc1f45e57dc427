/* segment.c - waves, and parts of a segment. */
#include "firmware/method/segment.h"

#include "models/math/elementary.h"

/* The phasor at s. */
static void turn(const struct wave *w, double s, double *cosine, double *sine)
{
    double c = 1.0, d = 0.0;
    if (w->omega != 0.0)
        cos_sin(w->omega * s, &c, &d);
    *cosine = w->cosine * c - w->sine * d;
    *sine = w->sine * c + w->cosine * d;
}

static void input_at(const struct wave *w, double s, double cosine, double sine, struct input *u)
{
    double amplitude = w->amplitude + w->growth * s;
    u->value = (w->offset + w->slope * s) + amplitude * cosine;
    u->rate = (w->slope + w->growth * cosine) - amplitude * w->omega * sine;
}

void wave_at(const struct wave *w, double s, struct input *u)
{
    double cosine, sine;
    turn(w, s, &cosine, &sine);
    input_at(w, s, cosine, sine, u);
}

double wave_acceleration(const struct wave *w, double s, const struct input *u)
{
    double ramp = 0.0, c, d;
    if (w->omega == 0.0)
        return 0.0;
    if (w->growth != 0.0) {
        cos_sin(w->omega * s, &c, &d);
        ramp = 2.0 * w->growth * (w->sine * c + w->cosine * d);
    }
    return -w->omega * (w->omega * ((u->value - w->offset) - w->slope * s) + ramp);
}

void segment_head(const struct segment *e, int n_inputs, double length, struct segment *head)
{
    *head = *e;
    head->length = length;
    for (int i = 0; i < n_inputs; i++) {
        if (!((e->active >> i) & 1u))
            continue;
        wave_at(&e->wave[i], 0.5 * length, &head->at[1][i]);
        wave_at(&e->wave[i], length, &head->at[2][i]);
    }
}

/* The wave begins `done` later, where its phasor is (cosine, sine). */
static void pass(struct wave *w, double done, double cosine, double sine)
{
    w->cosine = cosine;
    w->sine = sine;
    w->offset += w->slope * done;
    w->amplitude += w->growth * done;
}

/* Input i of what is left from `done` on. */
static void tail(struct segment *e, int i, double done)
{
    struct wave *w = &e->wave[i];
    double cosine, sine, left = e->length - done;
    turn(w, done, &cosine, &sine);
    input_at(w, done, cosine, sine, &e->at[0][i]);
    wave_at(w, done + 0.5 * left, &e->at[1][i]);
    pass(w, done, cosine, sine);
}

static void begin_at(struct segment *e, double done)
{
    e->length -= done;
    e->changed = true;
}

void segment_tail(struct segment *e, int n_inputs, double done)
{
    for (int i = 0; i < n_inputs; i++) {
        if ((e->active >> i) & 1u)
            tail(e, i, done);
    }
    begin_at(e, done);
}

/* Nothing is left: the inputs at the end are known, and only the phasors are turned. */
static void end_at(struct segment *e, int n_inputs, struct segment *head)
{
    for (int i = 0; i < n_inputs; i++) {
        struct wave *w = &e->wave[i];
        double cosine, sine;
        for (int k = 0; k < 3; k++)
            head->at[k][i] = e->at[k][i];
        if (!((e->active >> i) & 1u))
            continue;
        turn(w, e->length, &cosine, &sine);
        pass(w, e->length, cosine, sine);
        e->at[0][i] = e->at[1][i] = e->at[2][i];
    }
}

/* Something is left: the inputs of both parts. */
static void part_at(struct segment *e, int n_inputs, double done, struct segment *head)
{
    for (int i = 0; i < n_inputs; i++) {
        for (int k = 0; k < 3; k++)
            head->at[k][i] = e->at[k][i];
        if (!((e->active >> i) & 1u))
            continue;
        wave_at(&e->wave[i], 0.5 * done, &head->at[1][i]);
        tail(e, i, done);
        head->at[2][i] = e->at[0][i];
    }
}

void segment_cut(struct segment *e, int n_inputs, double done, struct segment *head)
{
    head->length = done;
    head->active = e->active;
    if (done < e->length)
        part_at(e, n_inputs, done, head);
    else
        end_at(e, n_inputs, head);
    begin_at(e, done);
}
