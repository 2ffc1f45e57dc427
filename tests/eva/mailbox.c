/* mailbox.c - one operation on any mailbox whose counts are within its arrays leaves them there: by
 * induction, so does any sequence of operations from mailbox_empty on. */
#include "firmware/bus/mailbox.h"
#include "tests/eva/eva.h"

/* instant_compare stands in plant.c, which this proof does not need. */
int instant_compare(struct instant a, struct instant b)
{
    (void)a, (void)b;
    return Frama_C_interval(-1, 1);
}

static void any_mailbox(struct mailbox *b, uint32_t n_fires, uint32_t n_samples)
{
    eva_any(b, sizeof *b);
    b->n_fires = n_fires;
    b->n_samples = n_samples;
    b->commit_with_fire = eva_bool();
    for (int i = 0; i < MAILBOX_FIRES; i++)
        b->fire[i].parameters = eva_bool();
}

static void fires(uint32_t n)
{
    struct mailbox b;
    struct fire f;
    struct instant at;
    eva_any(&f, sizeof f);
    f.parameters = eva_bool();
    any_mailbox(&b, n, 0);
    (void)mailbox_next_fire(&b, &at);
    (void)mailbox_put_fire(&b, &f);
    /*@ assert fires_fit_after_put: b.n_fires <= MAILBOX_FIRES; */
    any_mailbox(&b, n, 0);
    (void)mailbox_take_fire(&b, f.at, &f);
    /*@ assert fires_fit_after_take: b.n_fires <= MAILBOX_FIRES; */
}

static void samples(uint32_t n)
{
    struct mailbox b;
    struct sample s;
    eva_any(&s, sizeof s);
    any_mailbox(&b, 0, n);
    (void)mailbox_put_sample(&b, &s);
    /*@ assert samples_fit_after_put: b.n_samples <= MAILBOX_SAMPLES; */
    any_mailbox(&b, 0, n);
    (void)mailbox_take_sample(&b, eva_word(), Frama_C_interval(0, MODEL_INPUTS - 1), &s);
    /*@ assert samples_fit_after_take: b.n_samples <= MAILBOX_SAMPLES; */
}

/* float32 of what was staged: parameters.c stages only what came as a float32. */
static void staging(void)
{
    struct staged s;
    eva_any(&s, sizeof s);
    for (int i = 0; i < STAGED_VALUES; i++)
        s.value[i] = eva_between(-(double)FLT_MAX, (double)FLT_MAX);
    (void)staged_count(&s);
    (void)staged_crc(&s);
    (void)staged_has(&s, eva_uint(0, UINT32_MAX));
    staged_put(&s, eva_uint(0, STAGED_VALUES - 1), s.value[0]);
}

int main(void)
{
    for (uint32_t n = 0; n <= MAILBOX_FIRES; n++)
        fires(n);
    for (uint32_t n = 0; n <= MAILBOX_SAMPLES; n++)
        samples(n);
    staging();
    struct mailbox b;
    mailbox_empty(&b);
    return (int)(b.n_fires + b.n_samples);
}
