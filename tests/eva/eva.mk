# Proofs with Frama-C's Eva (Debian: frama-c-base): no input of a harness in tests/eva leads to an undefined operation or a failed
# assertion. `make eva` prints alarms per module; docs/PROOFS.md lists what each proof assumes.
EVA := wire mailbox drive command
EVA_FLAGS := -machdep gcc_x86_64 -c11 -cpp-extra-args="-I." -warn-special-float none -eva-no-show-progress -eva
EVA_RIG := $(filter-out firmware/exact% firmware/taylor% firmware/rk4_float32% firmware/auto.c firmware/method.c \
           firmware/selftest.c firmware/plant_scene.c models/scenes%,$(CORE_SRC))
eva_src_wire    := firmware/wire.c firmware/wire_table.c models/elementary.c
eva_src_mailbox := firmware/mailbox.c $(eva_src_wire)
eva_src_drive   := firmware/drive.c firmware/noise.c
eva_src_command := $(filter-out firmware/plant.c firmware/wire.c,$(EVA_RIG))
# How many states Eva keeps apart: more is sharper, and slower.
eva_flags_wire    := -eva-precision 5 -eva-slevel 100 -eva-auto-loop-unroll 150 -eva-slevel-function wire_lsb:5000
eva_flags_mailbox := -eva-precision 5 -eva-slevel 100 -eva-auto-loop-unroll 150
eva_flags_drive   := -eva-precision 5 -eva-slevel 100 -eva-auto-loop-unroll 150
eva_flags_command := -eva-precision 1 -eva-slevel 8 -eva-auto-loop-unroll 150

eva: $(EVA:%=eva-%)
$(EVA:%=eva-%): eva-%:
	@mkdir -p $(BUILD)/eva
	@frama-c $(EVA_FLAGS) $(eva_flags_$*) tests/eva/$*.c $(eva_src_$*) >$(BUILD)/eva/$*.log 2>&1; \
	tests/eva/alarms.sh $* $(BUILD)/eva/$*.log
.PHONY: eva $(EVA:%=eva-%)
