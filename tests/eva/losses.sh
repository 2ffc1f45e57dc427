#!/bin/sh
# losses.sh - each line below takes one limit out of a copy of the firmware: the harness that proves it must then raise
# an alarm. A line is: harness @ file @ what stands there @ what stands there instead. Run from the top folder.
set -u
copy=$(mktemp -d) || exit 1
trap 'rm -rf "$copy"' EXIT
passed=0
failed=0

lose() { # harness, file, old, new
    rm -rf "$copy/tree" && mkdir "$copy/tree" || exit 1
    cp -r Makefile firmware hal host_sim linker models tests "$copy/tree" || exit 1
    count=$(grep -cF -e "$3" "$2")
    OLD=$3 NEW=$4 perl -0777 -pi -e 's/\Q$ENV{OLD}\E/$ENV{NEW}/' "$copy/tree/$2"
    said=$(make -s -C "$copy/tree" BUILD=build "eva-$1" 2>&1)
    if [ "$count" = 1 ] && echo "$said" | grep -q "^FAIL  eva $1: alarms"; then
        echo "ok    eva $1 has an alarm without: $3"
        passed=$((passed + 1))
    else
        echo "FAIL  eva $1 without: $3 ($count lines of $2 have it): $(echo "$said" | tail -1)"
        failed=$((failed + 1))
    fi
}

while IFS='@' read -r harness file old new; do
    lose "$harness" "$file" "$old" "$new"
done <<'END'
arm@firmware/app/command_drives.c@static const double ramp_max_s = 1e4;@static const double ramp_max_s = 1e300;
capture@firmware/observe/capture.c@(uint64_t)n_signals * n_samples > n_floats || @
settings@firmware/app/parameters.c@if (setting[SET_LOCKIN_CHANNEL + i] >= m->n_inputs)@if (setting[SET_LOCKIN_CHANNEL + i] > 1e9)
settings@firmware/app/parameters.c@return output < m->n_outputs ? NULL@return output < 1000 ? NULL
settings@firmware/bus/settings.c@if (!(value >= s->min && value <= s->max))@if (!(value >= s->min))
command@firmware/app/command.c@(uint32_t)a->plant.model->n_outputs,@MODEL_OUTPUTS,
command@firmware/app/parameters.c@index < (unsigned)a->plant.model->n_parameters ||@index < SETTING_FIRST ||
advance@firmware/app/app_advance.c@if (app_apply_fire(a, &f))@if (!app_apply_fire(a, &f))
advance@firmware/observe/lockin_fit.h@LOCKIN_TONES = MODEL_INPUTS + 1@LOCKIN_TONES = MODEL_INPUTS
telemetry@firmware/app/telemetry.c@t->health_next = (item + 1) % DIAG_COUNTERS;@t->health_next = item + 1;
END
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
