/* taylor_load.c - the inputs of a plant as constants, slopes and tones. */
#include "firmware/method/taylor/taylor_load.h"

#include <string.h>
#include "models/math/elementary.h"

static void add_term(struct taylor_lanes *lanes, int *n, int lane, double value, double rate,
                     double acceleration)
{
    if (value != 0.0 || rate != 0.0 || acceleration != 0.0)
        lanes->term[(*n)++] = (struct taylor_term){lane, value, rate, acceleration};
}

static void lanes_of_hertz(const struct hertz_form *f, struct taylor_lanes *lanes)
{
    int n = 0;
    lanes->damping = f->damping;
    lanes->stiffness = f->stiffness;
    lanes->base[0] = f->constant;
    lanes->base[1] = f->hertz;
    for (int i = 0; i < MODEL_INPUTS; i++) {
        add_term(lanes, &n, 0, f->force[i], f->drag[i], f->shift[i]);
        add_term(lanes, &n, 1, f->hertz * f->modulation[i], 0.0, 0.0);
        lanes->first[i + 1] = n;
    }
}

static void lanes_of_polynomial(const struct polynomial_form *f, struct taylor_lanes *lanes)
{
    int n = 0;
    lanes->damping = f->damping;
    memcpy(lanes->base, f->constant, sizeof lanes->base);
    for (int i = 0; i < MODEL_INPUTS; i++) {
        for (int l = 0; l < TAYLOR_LANES; l++)
            add_term(lanes, &n, l, f->modulation[l][i], f->rate[l][i], 0.0);
        lanes->first[i + 1] = n;
    }
}

void taylor_lanes_of(const struct model *m, const double *p, struct taylor_lanes *lanes)
{
    struct hertz_form hertz;
    struct polynomial_form polynomial;
    memset(lanes, 0, sizeof *lanes);
    if (m->hertz_form) {
        m->hertz_form(p, &hertz);
        lanes_of_hertz(&hertz, lanes);
    } else if (m->polynomial_form) {
        m->polynomial_form(p, &polynomial);
        lanes_of_polynomial(&polynomial, lanes);
    }
}

static void add_tone(struct taylor_load *load, const struct taylor_tone *t)
{
    for (int i = 0; i < load->n_tones; i++) {
        struct taylor_tone *other = &load->tone[i];
        if (other->omega == t->omega && other->lane == t->lane) {
            other->p += t->p;
            other->q += t->q;
            other->tp += t->tp;
            other->tq += t->tq;
            return;
        }
    }
    load->tone[load->n_tones++] = *t;
}

static void add(struct taylor_load *load, const struct taylor_term *term, const struct wave *w)
{
    int l = term->lane;
    unsigned bit = 1u << l;
    load->constant[l] += term->value * w->offset + term->rate * w->slope;
    load->slope[l] += term->value * w->slope;
    load->varies |= w->slope != 0.0 ? bit : 0;
    load->ramping |= w->slope != 0.0 || w->growth != 0.0 ? bit : 0;
    if (w->amplitude == 0.0 && w->growth == 0.0)
        return;
    struct taylor_tone t = taylor_tone_of(term, w);
    load->varies |= bit;
    add_tone(load, &t);
}

void taylor_load_begin(struct taylor_load *load, const struct taylor_lanes *lanes, const struct segment *e)
{
    unsigned active = e->active;
    load->damping = lanes->damping;
    load->stiffness = lanes->stiffness;
    load->varies = load->ramping = 0;
    load->n_tones = 0;
    for (int l = 0; l < TAYLOR_LANES; l++) {
        load->constant[l] = lanes->base[l];
        load->slope[l] = 0.0;
    }
    for (int i = 0; active != 0; i++, active >>= 1) {
        if (!(active & 1u))
            continue;
        int end = lanes->first[i + 1];
        for (int k = lanes->first[i]; k < end; k++)
            add(load, &lanes->term[k], &e->wave[i]);
    }
}

void taylor_load_move(struct taylor_load *load, double s)
{
    for (int l = 0; l < TAYLOR_LANES; l++)
        load->constant[l] += load->slope[l] * s;
    for (int i = 0; i < load->n_tones; i++) {
        struct taylor_tone *t = &load->tone[i];
        double c, d, p = t->p + t->tp * s, q = t->q + t->tq * s, tp = t->tp;
        cos_sin(t->omega * s, &c, &d);
        t->p = p * c + q * d;
        t->q = q * c - p * d;
        t->tp = tp * c + t->tq * d;
        t->tq = t->tq * c - tp * d;
    }
}
