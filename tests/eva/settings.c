/* settings.c - the lock-in after a change of settings.
 *
 * A set in which any lock-in channel or output has any value of its range is applied as a whole or
 * refused. Afterwards every slot keeps to seam_lockin. Values are tried one by one, with the other
 * settings at their defaults. They are the channel of the first slot, the output of * the first and of the
 * last, and the highest harmonic of the first. The model has fewer inputs and outputs than the ranges
 * allow. */
#include "firmware/app/app_apply.h"
#include "firmware/app/command_drives.h"
#include "firmware/app/parameters.h"
#include "firmware/plant/plant_change.h"
#include "models/afm_tip.h"
#include "tests/eva/seams.h"

/* The plant's side of a change: `change` has it. The refusal is unknown. */
const char *plant_accepts(const struct plant *pl, const double *si)
{
    (void)pl, (void)si;
    return NULL;
}

const char *plant_could_climb(const struct plant *pl, const struct model *to, const double *si)
{
    (void)pl, (void)to, (void)si;
    return NULL;
}

const char *plant_change(struct plant *pl, const double *si)
{
    (void)pl, (void)si;
    return NULL;
}

static struct app app;

static void apply(int setting, double value)
{
    struct staged set = {{0}, {0.0}};
    app.plant.model = &afm_tip;
    app.config.model = &afm_tip;
    app.config.promote = NULL;
    app.config.substeps = eva_uint(1, 4096);
    for (int i = 0; i < SETTINGS; i++)
        app.setting[i] = setting_initial(i, &afm_tip, 1e-3);
    parameters_settings_changed(&app);
    staged_put(&set, (unsigned)(SETTING_FIRST + setting), value);
    if (!parameters_check(&app, &set))
        parameters_apply(&app, &set);
    for (int i = 0; i < LOCKIN_SLOTS; i++)
        ASSERT(seam_lockin(&app, i));
}

/* A value that is written: the staged one keeps to its range afterwards, also where it was refused. */
static void write_one(int setting, double value)
{
    const struct message m = {
        .kind = WIRE_PARAM_WRITE,
        .value = {[PARAM_WRITE_INDEX] = SETTING_FIRST + setting, [PARAM_WRITE_VALUE] = value}};
    double *staged = &app.mailbox.staged.value[SETTING_FIRST + setting];
    *staged = setting_table[setting].min;
    (void)parameters_write(&app, &m);
    ASSERT(seam_setting(setting, *staged));
}

/* Any double: those below, inside and above the range, and what is no number. */
static void write(int setting)
{
    double min = setting_table[setting].min, max = setting_table[setting].max;
    double below = min > 0.0 ? min * (1.0 - 0x1p-53) : min < 0.0 ? min * (1.0 + 0x1p-52) : -0x1p-1074;
    write_one(setting, eva_between(-DBL_MAX, below));
    write_one(setting, eva_between(min, max));
    write_one(setting, eva_between(max * (1.0 + 0x1p-52), DBL_MAX));
    write_one(setting, (double)NAN);
    write_one(setting, HUGE_VAL);
    write_one(setting, -HUGE_VAL);
}

int main(void)
{
    static const int of[] = {SET_LOCKIN_CHANNEL, SET_LOCKIN_OUTPUT, SET_LOCKIN_OUTPUT_LAST};
    for (int i = 0; i < 3; i++)
        for (int value = 0; value <= (int)setting_table[of[i]].max; value++)
            apply(of[i], value);
    apply(SET_LOCKIN_HARMONIC, setting_table[SET_LOCKIN_HARMONIC].max);
    /*@ loop unroll 100; */
    for (int i = 0; i < SETTINGS; i++)
        write(i);
    return 0;
}
