#!/bin/sh
# Code, struct and stack sizes against the limits below; prints them all. usage: check_sizes.sh BUILD_DIR
code_limit=88064   # bytes of machine code of the core, x86-64 -O2; a processor without lanes needs less
app_limit=16384    # sizeof(struct app): fits a small part's RAM beside its stacks; 512 of them are room to grow
stack_limit=4096   # of a whole app_frame, measured over busy frames
build=$1
status=0
limit() { # what, value, limit
    if [ "$2" -le "$3" ]; then
        echo "ok    $1: $2 bytes, at most $3"
    else
        echo "FAIL  $1: $2 bytes, above $3"
        status=1
    fi
}
text() { # bytes of machine code of these objects
    size -A "$@" | awk '$1 ~ /^\.text/ {n += $2} END {print n + 0}'
}
objects() { # the objects of the core whose names match, or with -v do not match; not those of sources that have gone
    find "$build"/models "$build"/firmware -name '*.o' ! -path '*/firmware/*-*/*' | sort | grep "$@" | while read -r object; do
        source=${object#"$build"/}
        [ ! -e "${source%.o}.c" ] || echo "$object"
    done
}
methods='firmware/method/(taylor/|exact/|float32/|adams/|auto|modal)[a-z_0-9]*\.o'
selftest='firmware/app/selftest\.o'
scenes='(models/scenes/|firmware/app/plant_scene)[a-z_]*\.o' # an image that names no scene leaves them out
station='firmware/afm/' # an image that names no microscope leaves it out
stages='firmware/stage/[a-z_]*\.o' # and one without actuators and sensors these
models='models/(rolling|afm|shaft|reduced/|math/symmetric)[a-z_0-9]*\.o'
# what rk4 and the ledger inline for the other models belongs to these models, and rk4_unlocated to the methods
inlined=$(nm -S -t d "$build"/firmware/method/rk4.o "$build"/firmware/plant/ledger.o | awk '$4 ~ /^((step|run|piece|ticks|begins)_(rolling_contact|afm_tip|shaft_[a-z]*|linear[a-z_0-9]*|cubic[a-z_0-9]*)(\.constprop\.0)?|shaft_bearing_flow(_open)?|through_[a-z_0-9]*|(step|refuse|bind)_unlocated|bind_through)(\.constprop\.0)?$/ {n += $2} END {print n + 0}')
beside='firmware/plant/plant_beside\.o' # an image of one plant leaves it out, and what calls it
besides=$(nm -S -t d "$build"/firmware/plant/plant.o "$build"/firmware/app/app.o "$build"/firmware/app/app_advance.o | awk '$4 ~ /^(quiet_step|quiet_stop|app_advance_beside|app_frames)$/ {n += $2} END {print n + 0}')
code=$(($(text $(objects -vE "$methods|$models|$selftest|$scenes|$stages|$station|$beside")) - inlined - besides))
limit "machine code of the app with hertz_rig and rk4" $code $code_limit
echo "      rk4 and ledger inlined for the other models: $inlined bytes"
echo "      plants side by side, which an image of one plant leaves out: $((besides + $(text $(objects -E "$beside")))) bytes"
for part in models methods selftest scenes station stages; do
    eval "pattern=\$$part"
    list=$(objects -E "$pattern") && echo "      $part beyond that: $(text $list) bytes"
done
tables() { # bytes of constant data of these objects
    size -A "$@" | awk '$1 ~ /^\.(rodata|data\.rel\.ro)/ {n += $2} END {print n + 0}'
}
echo "      constant tables of the core: $(tables $(objects -vE "$scenes")) bytes, of the scenes: $(tables $(objects -E "$scenes"))"
limit "struct app" "$("$build"/sizes app)" $app_limit
kib() { # BYTES, rounded
    echo $((($1 + 512) / 1024))
}
said="$(kib $code) KB of code and $(kib "$("$build"/sizes app)") KB of state"
if grep -q "| Size | $said for the rig by" README.md; then
    echo "ok    README.md says $said"
else
    echo "FAIL  README.md, Size: write $said"
    status=1
fi
"$build"/sizes
limit "stack of app_frame, measured" "$("$build"/sizes stack)" $stack_limit
find "$build"/models "$build"/firmware -name '*.su' ! -path '*/firmware/*-*/*' -exec cat {} + | sort -t'	' -k2 -n -r | head -3 |
    awk -F'\t' '{sub(".*:", "", $1); printf "      largest frames: %s %s bytes\n", $1, $2}'
exit $status
