/* excitation.c - parts of an excitation: up to an instant (head) and from an instant on (tail). */
#include "firmware/method.h"

#include "models/elementary.h"

void wave_at(const struct wave *w, double s, struct input *u)
{
    double c, d;
    double amplitude = w->amplitude + w->growth * s;
    cos_sin(w->omega * s, &c, &d);
    double cosine = w->cosine * c - w->sine * d;
    double sine = w->sine * c + w->cosine * d;
    u->value = (w->offset + w->slope * s) + amplitude * cosine;
    u->rate = (w->slope + w->growth * cosine) - amplitude * w->omega * sine;
}

void excitation_head(const struct excitation *e, int n_inputs, double length, struct excitation *head)
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

void excitation_tail(struct excitation *e, int n_inputs, double done)
{
    double left = e->length - done;
    for (int i = 0; i < n_inputs; i++) {
        struct wave *w = &e->wave[i];
        double c, s;
        if (!((e->active >> i) & 1u))
            continue;
        wave_at(w, done, &e->at[0][i]);
        wave_at(w, done + 0.5 * left, &e->at[1][i]);
        cos_sin(w->omega * done, &c, &s);
        double cosine = w->cosine * c - w->sine * s;
        w->sine = w->sine * c + w->cosine * s;
        w->cosine = cosine;
        w->offset += w->slope * done;
        w->amplitude += w->growth * done;
    }
    e->length = left;
    e->changed = true;
}
