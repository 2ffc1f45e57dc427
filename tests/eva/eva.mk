# Proofs with Frama-C's Eva (Debian: frama-c-base): no input of a harness in tests/eva leads to an undefined operation or a failed
# assertion. `make eva` prints alarms per module; docs/why/proofs.md lists what each proof assumes.
EVA := wire mailbox arm settings capture drive command advance telemetry plant change rk4 elementary
# Sources are put into one file without the plugins that nothing there uses: that takes two thirds of the time.
EVA_ALONE := -no-autoload-plugins -load-module eva
EVA_LANGUAGE := -machdep gcc_x86_64 -c11
EVA_FLAGS := -warn-special-float none -eva-no-show-progress -eva
EVA_RIG := $(filter-out firmware/method/adams/% firmware/method/exact/% firmware/method/taylor/% firmware/method/float32/% firmware/method/auto.c firmware/method/method.c \
           firmware/app/selftest.c firmware/app/plant_scene.c models/scenes/%,$(CORE_SRC))
eva_src_wire    := firmware/bus/wire.c firmware/bus/wire_table.c models/math/elementary.c
eva_src_mailbox := firmware/bus/mailbox.c $(eva_src_wire)
eva_src_drive   := firmware/plant/drive.c firmware/plant/noise.c models/math/deviate.c
eva_src_arm     := firmware/app/command_drives.c firmware/app/app_apply.c firmware/bus/mailbox.c firmware/observe/capture.c \
                   $(filter models/%,$(filter-out models/scenes/%,$(CORE_SRC))) firmware/plant/plant.c firmware/bus/wire.c firmware/bus/wire_table.c
eva_src_plant   := $(filter models/%,$(filter-out models/scenes/% models/math/elementary.c,$(CORE_SRC))) \
                   $(filter-out firmware/plant/plant.c,$(wildcard firmware/plant/plant*.c)) \
                   $(addprefix firmware/plant/,drive.c noise.c ledger.c) firmware/method/segment.c
eva_src_change  := $(eva_src_plant)
eva_src_rk4     := $(filter models/%,$(eva_src_plant)) $(wildcard firmware/method/rk4*.c firmware/method/float32/*.c) firmware/method/switch.c firmware/method/segment.c
eva_src_elementary := models/math/elementary.c
eva_src_settings := firmware/app/parameters.c $(addprefix firmware/bus/,mailbox.c settings.c wire.c wire_table.c) \
                   $(addprefix firmware/observe/,lockin.c lockin_fit.c lockin_slots.c sensor.c) models/afm_tip.c models/model.c models/math/elementary.c
eva_src_capture := $(addprefix firmware/observe/,capture.c lockin.c lockin_fit.c)
eva_src_command := $(filter-out firmware/plant/plant_change.c firmware/bus/wire.c,$(EVA_RIG))
eva_src_advance := $(filter-out firmware/plant/plant_change.c,$(eva_src_plant)) $(addprefix firmware/app/,app_advance.c parameters.c session.c) \
                   $(addprefix firmware/observe/,lockin.c lockin_fit.c lockin_slots.c sensor.c watch.c) $(addprefix firmware/bus/,settings.c wire.c wire_table.c)
eva_src_telemetry := $(filter-out firmware/plant/plant_change.c,$(eva_src_plant)) $(addprefix firmware/app/,telemetry.c account.c session.c) \
                   firmware/observe/sensor.c $(addprefix firmware/bus/,settings.c identity.c mailbox.c wire_table.c)
# How many states Eva keeps apart: more is sharper, and slower.
eva_flags_wire    := -eva-precision 5 -eva-slevel 100 -eva-auto-loop-unroll 150 -eva-slevel-function wire_lsb:5000
eva_flags_mailbox := -eva-precision 5 -eva-slevel 100 -eva-auto-loop-unroll 150
eva_flags_drive   := -eva-precision 5 -eva-slevel 100 -eva-auto-loop-unroll 150
eva_flags_arm     := -eva-precision 1 -eva-slevel 100 -eva-slevel-function app_apply_fire:8,plant_set_drive:8 -eva-auto-loop-unroll 40
eva_flags_settings := -eva-precision 1 -eva-slevel 200 -eva-auto-loop-unroll 200
eva_flags_capture := -eva-split-return full -eva-precision 1 -eva-slevel 100 -eva-auto-loop-unroll 40
eva_flags_command := -eva-precision 1 -eva-slevel 8 -eva-auto-loop-unroll 250
eva_flags_advance := -eva-precision 0 -eva-slevel 0 -eva-auto-loop-unroll 64 -eva-split-return-function list_tones:1:2:3:4:5 \
                     -eva-slevel-function list_tones:1000,end_slot:60,lockin_fit:60,lockin_solve:60,set_up:100,eliminate:100 \
                     -eva-slevel-function advance_ticks:6,advance_tick_by_tick:6,advance_tick:6,plant_run_seen:6,lockin_slots_tick:6,advance_through_fires:6,advance_frame:8 \
                     -eva-slevel-function model_same_name:400,is_output:200,model_observable_state:200,model_observable:200,watch_start:100,watch:100
eva_flags_telemetry := -eva-precision 0 -eva-slevel 0 -eva-auto-loop-unroll 64 -eva-slevel-function send_parameters:2400,send_info:40,send_selftest:40 \
                     -eva-slevel-function keep:2500,telemetry_send_kept_itself:2500,telemetry_send_itself:10,send_echo:80
eva_flags_plant   := -eva-precision 0 -eva-plevel 5000 -eva-slevel-function integrate_rest:40,segment_length:60,excite:60,any_inputs:60 -eva-auto-loop-unroll 20
eva_flags_change  := -eva-precision 1 -eva-slevel 30 -eva-slevel-function plant_check:100 -eva-auto-loop-unroll 40 -eva-partition-history 1
eva_flags_rk4     := -eva-precision 1 -eva-slevel 20 -eva-auto-loop-unroll 12
eva_flags_elementary := -eva-precision 5

# Eva 25 takes `if (x <= 1.0)` for undecided where x may be NaN, and `if ((x <= 1.0) != 0)` for what it is; what a condition on fabs(x)
# says of x it does not see. So conditions and fabs are written out in the one file that Frama-C makes of all sources: the same
# meaning in other words.
eva_conditions = perl -0777 -pe 's/\bif \(! (\((?:[^()]++|(?1))*\))\)/if ($$1 == 0)/g; s/\bif (\((?:[^()]++|(?1))*\))/if ($$1 != 0)/g; \
    s/= fabs(\((?:[^()]++|(?1))*\));/= ($$1 <= 0.0) != 0 ? 0.0 - $$1 : $$1;/g'

eva: $(EVA:%=eva-%) ## proofs that no input leads to an undefined operation (frama-c-base, five minutes), docs/why/proofs.md
# Proofs that take more than some seconds are kept: make test compares the code that they are of with the code of today.
EVA_KEPT := $(filter-out drive elementary,$(EVA))
eva-checksums: $(EVA_KEPT:%=eva-kept-%) ## that the code is the one of its last proof, by checksums
eva_code = '$(EVA_FLAGS) $(eva_flags_$*)' tests/eva/$*.c $(eva_src_$*)
$(EVA:%=eva-%): eva-%:
	@mkdir -p $(BUILD)/eva
	@frama-c $(EVA_ALONE) $(EVA_LANGUAGE) -cpp-extra-args="-I." tests/eva/$*.c $(eva_src_$*) -print -ocode $(BUILD)/eva/$*.c >$(BUILD)/eva/$*.log 2>&1 && \
	$(eva_conditions) -i $(BUILD)/eva/$*.c && \
	frama-c $(EVA_LANGUAGE) $(EVA_FLAGS) $(eva_flags_$*) $(BUILD)/eva/$*.c >$(BUILD)/eva/$*.log 2>&1; \
	tests/eva/alarms.sh $* $(BUILD)/eva/$*.log
	@$(if $(filter $*,$(EVA_KEPT)),tests/eva/proved.sh keep $* $(eva_code))
$(EVA_KEPT:%=eva-kept-%): eva-kept-%:
	@tests/eva/proved.sh check $* $(eva_code)
eva-losses: ## a limit that the firmware loses is an alarm of the harness that proves it: each by itself (ten minutes)
	@tests/eva/losses.sh
.PHONY: eva eva-checksums eva-losses $(EVA:%=eva-%) $(EVA_KEPT:%=eva-kept-%)
