# contactplant - `make help` lists what there is.
CC    = gcc
OPT   = -O2
BUILD = build
# Warnings are errors where the project is judged, not where it is used.
WERROR ?= $(if $(filter check test test-all,$(MAKECMDGOALS)),-Werror)
WARN  = -Wall -Wextra -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wdouble-promotion -Wvla \
        -Wpointer-arith -Wcast-qual -Wwrite-strings -Wundef
# Contraction off is part of the physics (the same bits everywhere); -fno-math-errno makes sqrt one instruction.
# So are the two that keep gcc from vectorising: its vectoriser contracts in spite of -ffp-contract=off (seen with gcc
# 12 and -march=x86-64-v3), and one trajectory has nothing to vectorise: packed loads of fresh stores only stall.
# x87 keeps more digits than a double has, and gcc for s390x by -std=c99 more than a float has. See models/check.h, which
# refuses what changes bits; some compilers do not tell it of these flags.
PLATFORM := $(shell $(CC) $(EXTRA) -dM -E -x c /dev/null 2>/dev/null | grep -oE '__i386__|__s390__|__clang__')
ROUND  = $(if $(filter __i386__,$(PLATFORM)),-msse2 -mfpmath=sse) $(if $(filter __s390__,$(PLATFORM)),$(if $(filter __clang__,$(PLATFORM)),,-fexcess-precision=fast))
UNSOUND := $(filter -ffast-math -Ofast -funsafe-math-optimizations -fassociative-math -freciprocal-math -ffinite-math-only \
           -fno-signed-zeros -ffp-contract=fast -ffp-contract=on -ffp-model=fast -fsingle-precision-constant -mfpmath=387,$(CC) $(OPT) $(EXTRA))
$(if $(UNSOUND),$(error $(UNSOUND) changes the bits of a plant: build without it))
FLAGS  = -std=c99 $(ROUND) -ffp-contract=off -fno-math-errno -fno-tree-vectorize -fno-tree-slp-vectorize $(WARN) -I.
# Each file is compiled once, for the program and for libcontactplant.so: position independent, all hidden but what
# contactplant.h declares, each function in a section of its own.
SECTIONS = -fvisibility=hidden -ffunction-sections -fdata-sections
SHARED_MODE = -fPIC $(SECTIONS)
CFLAGS = $(OPT) $(FLAGS) $(EXTRA) $(SHARED_MODE) $(WERROR) -MMD -MP
POSIX  = -D_GNU_SOURCE
PYTHON = /usr/bin/python3
# SHORT=1: bench, bench-flood, bench-lockstep, bench-plants, bench-scope, charts, papers, maps, fuzz and soak with little work, into build/short instead of docs; the tests
# of `make short`. There gnuplot draws from copies of the committed CSVs, for it writes to docs/img below where it runs.
SHORT =
WHERE := $(if $(SHORT),build/short,.)
print_rows = $(if $(SHORT),tests/bench/first_rows.sh $1 $2,$1 >$2)

# For boards only, see linker/boards.mk: the firmware's main, and devices.
TARGET_ONLY := firmware/main.c $(wildcard hal/board/*.c) hal/ethernet/network.c hal/device/uart_cmsdk.c
# The C files of folders and of the rooms in them; the files of tests/ with these names.
files = $(foreach folder,$(1),$(wildcard $(folder)/*.c $(folder)/*/*.c $(folder)/*/*/*.c))
CORE_SRC := $(filter-out $(TARGET_ONLY),$(call files,models firmware))
HAL_SRC  := $(filter-out $(TARGET_ONLY),$(call files,hal))
HOST_SRC := $(call files,host_sim)
TEST_SRC := $(call files,tests)
test_src = $(foreach name,$(1),$(filter tests/%/$(name).c,$(TEST_SRC)))
BOARD_TEST := test_board board_bench board_hostile board_record packet
BATCH_SRC := $(wildcard host_sim/batch/*.c)
HOST_PARTS := $(filter-out host_sim/main.c,$(HOST_SRC))
# What the charts of docs/papers/figures.md share with the tests.
PAPER_SRC := $(addprefix tests/papers/,motion.c branch.c branch_read.c theory.c contact.c attractor.c stroboscope.c survival.c one_mode.c)
# The unit tests with their fixtures, and parts of other programs that they check.
UNIT_SRC := $(call files,tests/unit tests/physics tests/fixture tests/device) $(call test_src,choose_out)
# What libcontactplant has of the program: what reads a scene, what talks to a plant; FMUs have no client.
LIB_CLIENT := host_sim/library/library_bus.c host_sim/library/library_client.c host_sim/live/client.c host_sim/live/explain.c \
              host_sim/listen/listen.c host_sim/listen/latest.c
LIB_HOST := $(filter-out $(LIB_CLIENT),$(wildcard host_sim/library/*.c)) host_sim/cli/unit.c host_sim/cli/names.c host_sim/cli/options_nearest.c \
            host_sim/cli/quotes.c host_sim/out/utf8.c host_sim/scene/plant_of_scene.c $(addprefix host_sim/scene/scene_,app.c check.c file.c keys.c lines.c name.c text.c)
obj = $(patsubst %.c,$(BUILD)/%.o,$(1))
CORE := $(call obj,$(CORE_SRC))
# What the program and the tests link; libcontactplant is made in host_sim/library/library.mk.
LIB  := $(BUILD)/libcore.a
# The program without its main, of which a test links what it calls: half the time of a link.
HOST_LIB := $(BUILD)/libhost.a

# All cores, unless the command line says how many.
ifeq ($(MAKELEVEL),0)
MAKEFLAGS += -j$(shell nproc)
endif

all: $(BUILD)/contactplant lib fmu ## build/contactplant, build/libcontactplant.a and .so; plain `make` does the same

help: ## this list
	@awk -F ' ## ' '/^[a-z-]+:.* ## / {sub(":.*", "", $$1); printf "make %-17s %s\n", $$1, $$2}' $(filter-out %.d,$(MAKEFILE_LIST))
	@echo "variables: CC=clang OPT=-O3 BUILD=dir EXTRA=-g for a debugger, EXTRA=-fsanitize=address,undefined WERROR=-Werror; others beside their target"

# -O1 takes two thirds of the time. At -O2 is what computes, or is called at every tick, and what measures that.
AT_O2 := host_sim/batch/% host_sim/beside/% host_sim/afm/% host_sim/fit/% host_sim/library/% host_sim/simulate/% tests/bench/%
$(call obj,$(filter-out $(AT_O2),$(HOST_SRC) $(TEST_SRC))): OPT = -O1
# Vectors by value between functions that are always inlined: there is no ABI to take note of.
$(call obj,$(BATCH_SRC) tests/unit/batch/test_batch_series.c): FLAGS += -Wno-psabi
# A second time for AVX2, which x86-64's default leaves out: batches (host_sim/batch/batch_taylor.h), and plants side
# by side (host_sim/beside/beside.h).
BESIDE_SRC := $(wildcard host_sim/beside/*.c)
ifneq (,$(findstring x86_64,$(shell $(CC) -dumpmachine)))
$(call obj,$(BATCH_SRC)): FLAGS += -DBATCH_AVX2
$(call obj,$(BESIDE_SRC) $(call test_src,test_beside)): FLAGS += -DBESIDE_AVX2
$(call obj,$(filter %_avx2.c,$(BATCH_SRC) $(BESIDE_SRC))): FLAGS += -mavx2
endif
# Flags are a dependency: a build folder keeps the compiler and flags that it was built with; others build it anew.
# What was built with -Werror does for a build without it.
# They make the folders of all objects, too: a mkdir for each object is a tenth of what its compilation takes.
quoted = $(subst ','"'"',$(strip $(1)))
SOURCE_ROOMS := $(sort $(dir $(CORE_SRC) $(TARGET_ONLY) $(HAL_SRC) $(HOST_SRC) $(TEST_SRC) linker/))
keep_flags = mkdir -p $(SOURCE_ROOMS:%=$(@D)/%) && { grep -qsxF -e '$(call quoted,$(1) $(WERROR))' -e '$(call quoted,$(1) -Werror)' $@ || \
    echo '$(call quoted,$(1) $(WERROR))' >$@; }
BUILT_WITH := $(CC) $(OPT) $(FLAGS) $(EXTRA) $(SHARED_MODE) $(COVER)
$(BUILD)/flags: FORCE
	@$(call keep_flags,$(BUILT_WITH))
# Flags of the files that make coverage counts; the tests that run them are compiled as ever, and take less time so.
COVER =
$(call obj,$(CORE_SRC) $(HAL_SRC) host_sim/replay/replay_source.c): CFLAGS += $(COVER)
# The core is plain C99 and reports its stack; hal, host_sim and tests also see POSIX.
$(CORE): $(BUILD)/%.o: %.c $(BUILD)/flags
	@$(info $()  $(CC) $<)$(CC) $(CFLAGS) -fstack-usage -c $< -o $@
$(BUILD)/%.o: %.c $(BUILD)/flags
	@$(info $()  $(CC) $<)$(CC) $(CFLAGS) $(POSIX) -c $< -o $@
$(LIB): $(CORE) $(call obj,$(HAL_SRC))
$(HOST_LIB): $(call obj,$(HOST_PARTS))
$(LIB) $(HOST_LIB):
	@rm -f $@
	@ar rcs $@ $^
link = @$(CC) $(CFLAGS) $(COVER) $(filter %.o,$^) $(filter %.a,$^) -lm -o $@
# The page of the scope is part of the program, as it is.
$(BUILD)/host_sim/report/page.o: $(wildcard host_sim/report/page/*)
$(BUILD)/host_sim/database/dissector.o: host_sim/database/dissector.lua
$(BUILD)/contactplant: $(call obj,$(HOST_SRC)) $(LIB)
	$(link)
UNIT_OBJ := $(call obj,$(UNIT_SRC) $(PAPER_SRC) $(HOST_PARTS) linker/soft_sqrt.c)
$(BUILD)/unit: $(UNIT_OBJ) $(LIB)
	$(link)
$(BUILD)/runner_cases: $(call obj,tests/house/runner_cases.c tests/unit/main.c tests/unit/check.c)
	$(link)
$(BUILD)/dbc_vectors: $(call obj,tests/cli/dbc_vectors.c) $(HOST_LIB) $(LIB)
	$(link)
$(BUILD)/test_board: $(call obj,$(call test_src,$(BOARD_TEST))) $(HOST_LIB) $(LIB)
	$(link)
WORST := $(call obj,tests/bench/cost/worst.c tests/bench/cost/worst_cases.c tests/bench/rate/rate_cases.c)
$(BUILD)/worst: $(WORST) $(LIB)
	@$(CC) $(CFLAGS) -Wl,--wrap=taylor_begin,--wrap=exact_follow $(WORST) $(LIB) -lm -o $@
$(BUILD)/instructions: $(call obj,tests/bench/cost/instructions.c tests/bench/cost/work_pieces.c tests/bench/cost/work_models.c tests/bench/cost/work_microscope.c) $(LIB)
	$(link)
$(BUILD)/costs: $(call obj,tests/bench/cost/costs.c tests/bench/cost/work_models.c) $(HOST_LIB) $(LIB)
	$(link)
# A model with a row of its own: the table's users compiled once more, with that row in it.
WITH_ROW := $(call obj,with_row/firmware/method/rk4.c with_row/firmware/plant/ledger.c)
$(WITH_ROW): $(BUILD)/with_row/%.o: %.c
	@mkdir -p $(@D)
	@echo "  $(CC) $< with tests/new_model/duffing.h"
	@$(CC) $(CFLAGS) -DINSTANCES_EXTRA='"tests/new_model/duffing.h"' -c $< -o $@
$(BUILD)/new_model: $(call obj,tests/new_model/new_model.c tests/new_model/duffing.c tests/fixture/bus.c) $(WITH_ROW) $(LIB)
	$(link)
$(BUILD)/choose_scenes: $(call obj,$(call test_src,choose_scenes choose_draw choose_judge choose_out)) $(HOST_LIB) $(LIB)
	$(link)
$(BUILD)/choose_levers: $(call obj,$(call test_src,choose_levers choose_judge choose_out lever_judge)) $(HOST_LIB) $(LIB)
	$(link)
$(BUILD)/choose_grid: $(call obj,$(call test_src,choose_grid choose_draw choose_judge)) $(HOST_LIB) $(LIB)
	$(link)
$(BUILD)/rig_curves: $(call obj,tests/fit/rig_curves.c)
	$(link)
# Fits against rigs of another integrator, about five minutes.
fits: $(BUILD)/contactplant $(BUILD)/rig_curves ## intervals of 200 noises, 100 random rigs, 30 shafts and 30 levers by contactplant fit
	@$(PYTHON) tests/fit/judge_fits.py $(BUILD)/contactplant $(BUILD)/rig_curves 200 100 30
	@$(PYTHON) tests/fit/judge_levers.py $(BUILD)/contactplant 30
$(BUILD)/tolerance_scenes: $(call obj,$(call test_src,tolerance_scenes tolerance_force tolerance_draw extrapolation exact)) $(LIB)
	$(link)
$(BUILD)/choose_one: $(BUILD)/tests/choose/choose_one.o $(HOST_LIB) $(LIB)
	$(link)
$(BUILD)/flood: $(call obj,tests/can/flood.c) $(HOST_LIB) $(LIB)
	$(link)
$(BUILD)/test_board_can: $(call obj,tests/boards/test_board_can.c tests/boards/board_bench.c) $(HOST_LIB) $(LIB)
	$(link)
$(BUILD)/hash_print: $(call obj,tests/bits/hash_print.c tests/bits/hash_run.c tests/bits/hash_peak_force.c tests/bits/arithmetic.c tests/bits/hash_batch.c $(BATCH_SRC)) $(LIB)
	$(link)
$(BUILD)/bench_frame: $(call obj,tests/bench/cost/bench_frame.c tests/bench/cost/bench_time.c tests/bench/cost/work_pieces.c) $(LIB)
	$(link)
$(BUILD)/bench_microscope: $(call obj,tests/bench/cost/bench_microscope.c tests/bench/cost/bench_time.c tests/bench/cost/work_microscope.c) $(LIB)
	$(link)
$(BUILD)/bench_batch: $(call obj,tests/bench/cost/bench_batch.c tests/bench/cost/bench_time.c $(BATCH_SRC)) $(LIB)
	$(link)
$(BUILD)/bench_lockstep: $(call obj,tests/bench/cost/bench_lockstep.c) $(LIB)
	$(link)
$(BUILD)/bench_plants: $(call obj,tests/bench/cost/bench_plants.c) $(LIB)
	$(link)
$(BUILD)/can_session: $(call obj,tests/can/can_session_print.c tests/can/can_session.c) $(LIB)
	$(link)
# A program of one file in tests/.
ALONE := sizes test_socketcan
$(ALONE:%=$(BUILD)/%): $(BUILD)/%: $(LIB)
	$(link)
$(foreach name,$(ALONE),$(eval $(BUILD)/$(name): $(call obj,$(call test_src,$(name)))))

run: all ## ten seconds of the plant on a bus with a controller; picture in build/demo
	@$(BUILD)/contactplant demo --out $(BUILD)/demo

# A line a file; with T the tests whose name contains it, each check with its values. Two take 35 s: make test and T=sweep run them.
unit: $(BUILD)/unit ## the unit tests in a minute (but sweep_grids and sweep_reference_fast); T=lockin runs those whose name contains lockin
	@$(BUILD)/unit --jobs $(shell nproc) $(or $(T),--brief --except sweep_grids --except sweep_reference_fast)

test: ## what a push needs (6 minutes); installs what is missing on Debian 12 when run as root
	@tests/run.sh push

test-all: ## every test (an hour), and the last line into tests/data/test_all.txt
	@tests/run.sh all

COUNTS := host_sim/choose/choose_counts.h
costs: $(BUILD)/costs ## the instruction counts of contactplant choose, from tests/data
	@$(BUILD)/costs >$(BUILD)/counts.h && cp $(BUILD)/counts.h $(COUNTS)

check: $(CORE) $(BUILD)/sizes $(BUILD)/costs $(call obj,$(HAL_SRC) $(HOST_SRC)) ## format, layers, circles, symbols, sizes, generated counts, pages, plain English, words
	@status=0; tests/house/check_format.sh || status=1; tests/house/check_layers.sh || status=1; $(PYTHON) tests/house/check_rooms.py || status=1; \
	tests/house/check_circles.sh nm $(CORE) $(call obj,$(HAL_SRC)) $(call obj,$(filter-out %_avx2.c,$(HOST_SRC))) || status=1; \
	tests/house/check_symbols.sh nm $(CORE) || status=1; tests/house/check_sizes.sh $(BUILD) || status=1; \
	if $(BUILD)/costs | cmp -s - $(COUNTS); then echo "ok    $(COUNTS) is what tests/data gives"; \
	else echo "FAIL  $(COUNTS) is not what tests/data gives: run make costs"; status=1; fi; \
	$(PYTHON) tests/house/check_pages.py || status=1; $(PYTHON) tests/house/check_language.py || status=1; \
	$(PYTHON) tests/house/check_words.py || status=1; exit $$status

SHORTS ?= bench charts papers maps fuzz soak bench-flood bench-lockstep bench-plants bench-scope
short: ## bench, bench-flood, bench-lockstep, bench-plants, bench-scope, charts, papers, maps, fuzz and soak in a short form, checked (a minute)
	@$(if $(filter charts,$(SHORTS)),rm -f $(wildcard build/short/docs/img/*.svg build/short/docs/img/papers/*.svg))
	@for target in $(SHORTS); do \
	    $(MAKE) -s SHORT=1 SECONDS=1 $$target >build/short-$$target.log 2>&1; status=$$?; grep -E '^(ok|FAIL)  ' build/short-$$target.log; \
	    if [ $$status = 0 ]; then echo "ok    make $$target SHORT=1"; else tail -20 build/short-$$target.log; echo "FAIL  make $$target SHORT=1"; fi; done
	@for svg in $(if $(filter charts,$(SHORTS)),$(filter-out docs/img/demo.svg docs/img/afm.svg docs/img/plants.svg,$(wildcard docs/img/*.svg docs/img/papers/*.svg))); do \
	    [ -s build/short/$$svg ] || { echo "FAIL  make short has not drawn $$svg"; exit 1; }; done

bench: $(BUILD)/bench_frame ## time per frame, and error against cost beside SUNDIALS, GSL and Boost (8 minutes; numbers, not pass/fail)
	@mkdir -p $(WHERE)
	@$(BUILD)/bench_frame $(if $(SHORT),1 >$(WHERE)/frame.txt)
	@$(MAKE) -s bench-peers

tolerance: $(BUILD)/tolerance_scenes ## 546 random scenes by auto, each against an integrator of the tests' own: SEED=1; LOOSE=1: 1000 at 1e-4 to 1e-2 (a minute)
	@$(BUILD)/tolerance_scenes $(if $(LOOSE),1000,546) $(or $(SEED),1) $(if $(LOOSE),loose)

sweep-grids: $(BUILD)/contactplant ## jumps of every preset by three grids: docs/reference/sweep_grids.md (PRESETS="rig tip": a part)
	@$(PYTHON) tests/sweep/sweep_grids.py $(BUILD)/contactplant $(BUILD)/sweep_grids docs/reference/sweep_grids.md $(PRESETS)

choose-seeds: $(BUILD)/choose_scenes ## certificates of 300 random scenes before another judge: SEED=2, DRAW=motion or force (two minutes)
	@$(BUILD)/choose_scenes 360 $(or $(SEED),2) $(or $(DRAW),motion) -v

# One after the other: some measure times.
CHARTS := charts-sweeps charts-physics charts-afm charts-ledger charts-float32 charts-rate charts-tolerance charts-peers
charts: ## the charts of docs/why and docs/guide/maps.md, those of cost from the last make bench (needs gnuplot, valgrind and the peers)
	@for part in $(CHARTS); do $(MAKE) -s $$part || exit 1; done

charts-sweeps: $(BUILD)/contactplant
	@mkdir -p $(WHERE)/docs/img
	@rm -f $(WHERE)/docs/img/sweep_rig.csv
	@$(BUILD)/contactplant sweep rig --sweep "force.frequency=75 Hz:300 Hz:$(if $(SHORT),4,120)" --out $(WHERE)/docs/img/sweep_rig.csv --svg $(WHERE)/docs/img/sweep_rig.svg >/dev/null

# Long: a minute of two cores.
MAPS = $(WHERE)/build/maps
maps: all ## the maps of docs/guide/maps.md (a minute)
	@mkdir -p $(MAPS) $(WHERE)/docs/img
	@rm -f $(MAPS)/basin_705.csv
	@$(BUILD)/contactplant basin shaft-fig16-705 --starts $(if $(SHORT),20,10000) --out $(MAPS)/basin_705.csv --svg $(WHERE)/docs/img/basin_705.svg \
	    >$(WHERE)/docs/img/basin_705.txt
	@rm -f $(MAPS)/tongues.csv $(MAPS)/steps.csv $(MAPS)/random.csv
	@$(BUILD)/contactplant stability hertz_rig --method rk4 --step "0.7 ms" $(if $(SHORT),--x stiffness.frequency=100:400:4 --y stiffness.amplitude=1e9:4e9:4) --out $(MAPS)/tongues.csv --svg $(WHERE)/docs/img/stability_tongues.svg \
	    >$(MAPS)/tongues.txt
	@$(BUILD)/contactplant stability rig --map contact --method rk4 --set "force.amplitude=50 N" --set "force.frequency=180 Hz" \
	    --x "step=0.03 ms:2 ms:$(if $(SHORT),4,80):log" --y "stiffness=1 GN/m^1.5:10 GN/m^1.5:$(if $(SHORT),4,60):log" \
	    --out $(MAPS)/steps.csv --svg $(WHERE)/docs/img/stability_steps.svg >$(MAPS)/steps.txt
	@$(BUILD)/contactplant random nayak-random --observable displacement --range=-1:3 --bins 80 --seeds $(if $(SHORT),4,400) \
	    --over $(if $(SHORT),100,2000) --out $(MAPS)/random.csv --svg $(WHERE)/docs/img/random_nayak.svg \
	    --statistics $(WHERE)/docs/img/random_nayak.csv >$(MAPS)/random.txt

test-boards: all $(BUILD)/test_board $(BUILD)/can_session $(BUILD)/test_board_can ## the images in QEMU: bits, faults, and a session over Ethernet (qemu-system-arm)
	@tests/boards/boards.sh

# Every model and method for 1e5 ticks on every board: six minutes more.
test-boards-bits: ## every model and method for 100,000 ticks on every board
	@tests/boards/boards.sh --bits

# gcov on the unit tests: each line runs, each branch not taken has a cause (docs/why/proofs.md). Nothing is inlined: each copy of a kernel would be
# counted, with the conditions of all the others constant in it. These tests take long, and run no line or branch that no other one
# runs: with them the count is the same. Sweeps run in processes that end without writing counts: most are left out.
COVERED_ELSEWHERE := sweep_grids sweep_reference sweep_reference_fast balance_quiet basin_methods basin_plant_shaft basin_plant_base \
    basin_plant_tip basin_plant_rig basin_rig basin_shaft_pairs papers_jumps papers_folds papers_reference \
    choose_refuse_modes choose_sweep_back choose_reference app_stop_line \
    $(addprefix sweep_,unsettled linear beats steep small_jump approach still unlocated harmonics escape resume chance \
    chance_of_long_steps jump_chance shards)
coverage: ## lines and branches that the unit tests run, of the core and the wire path (gcov); 100 % of lines, and a cause for each branch not taken, or FAIL
	@$(MAKE) -s COVER="-O1 --coverage -Dalways_inline=noinline -Wno-attributes -Wno-psabi" BUILD=build/coverage build/coverage/unit
	@find build/coverage -name '*.gcda' -delete
	@build/coverage/unit --jobs $(shell nproc) $(addprefix --except ,$(COVERED_ELSEWHERE)) >build/coverage/unit.log || tail -1 build/coverage/unit.log
	@tests/house/coverage.sh build/coverage

# MISRA C:2012 by cppcheck's addon, against docs/why/deviations.md.
misra: ## rules of MISRA C:2012 that cppcheck reports, against docs/why/deviations.md
	@tests/house/misra.sh $(BUILD)

trial-seeds: $(BUILD)/contactplant lib ## the example controllers on bad links, SEEDS=1000 of them; a controller stopped for 20 s; some 20 minutes
	@$(MAKE) -s sanitized-targets TARGETS="build/asan/contactplant build/asan/libcontactplant.a"
	@$(PYTHON) tests/trial/test_seeds.py $(BUILD) build/asan $(or $(SEEDS),1000) 20

test-can: all ## plants on a real kernel's SocketCAN, with can-utils and python-can
	@tests/can/test_can_peers.sh $(BUILD)/contactplant

# The hal by itself and plants, under the sanitizers, on an emulated PC with a real driver.
SANITIZED := test_socketcan flood contactplant
test-can-vm: $(BUILD)/contactplant ## the hal and plants under sanitizers on an emulated PC: Linux's driver, two SJA1000 (qemu-system-x86_64, a Debian kernel)
	+@$(sanitized) $(SANITIZED:%=build/asan/%) >build/asan.log || { echo "FAIL  build/asan: see above and build/asan.log"; exit 1; }
	@CAN_VM_TIMEOUT=900 tests/can/can_pc.sh -- sh -c 'build/asan/test_socketcan; status=$$?; \
	    tests/can/test_can_sja1000.sh build/asan/contactplant build/asan/flood $(BUILD)/contactplant && exit $$status' || \
	    { echo "FAIL  the emulated PC: see above"; exit 1; }

# Every mutant takes a second or two: the whole takes hours, MUTANTS=200 a sample.
MUTANTS ?= 0
mutation: ## mutants of the code against the unit tests: MUTANTS=200 for a sample (hours without)
	@$(MAKE) -s OPT=-O1 BUILD=build/mutate build/mutate/unit
	@tests/house/mutate.py --count $(MUTANTS)
mutation-compiler:
	@echo $(CC) $(CFLAGS)
mutation-objects:
	@echo $(UNIT_OBJ) $(call obj,$(CORE_SRC) $(HAL_SRC))

# How late frames are without and under a flood; numbers, not pass/fail.
bench-flood: all $(BUILD)/flood ## frames kept in time without and under a flood, UDP and CAN (a minute; numbers, not pass/fail)
	@tests/bench/cost/bench_flood.sh udp $(BUILD)/contactplant $(BUILD)/flood $(if $(SHORT),3 5000)
	@CAN_VM_TIMEOUT=120 tests/can/can_vm.sh -- tests/bench/cost/bench_flood.sh can:vcan0 $(BUILD)/contactplant $(BUILD)/flood $(if $(SHORT),3 5000)

bench-lockstep: all $(BUILD)/bench_lockstep ## words a second in lockstep from C, Python and control (15 s; numbers, not pass/fail)
	@tests/bench/cost/bench_lockstep.sh $(BUILD)/contactplant $(BUILD)/bench_lockstep $(if $(SHORT),4000)

bench-plants: all $(BUILD)/bench_plants ## time and lateness of run --plants over the number of plants, as a chart (a minute; numbers, not pass/fail)
	@mkdir -p $(WHERE)/docs/img
	@tests/bench/cost/bench_plants.sh $(BUILD)/contactplant $(BUILD)/bench_plants $(if $(SHORT),0.3 1 8) >$(WHERE)/docs/img/plants.csv || \
	    { cat $(WHERE)/docs/img/plants.csv; exit 1; }
	@$(call draw,tests/bench/cost/plants.gp,-e "csv='docs/img/plants.csv'; out='docs/img/plants.svg'")

bench-scope: all ## frames in time with and without run --scope (4 minutes; numbers, not pass/fail)
	@$(PYTHON) tests/scope/bench_scope.py $(BUILD)/contactplant $(if $(SHORT),1 1,60)

# 1e9 ticks of test_soak, one to three minutes.
soak: $(BUILD)/unit ## a plant on a bus for 1e9 ticks: tick, phase, counters exact (two minutes; make test has 1e6)
	@SOAK_TICKS=$(if $(SHORT),1e6,1e9) $(BUILD)/unit soak_session

clean: ## removes the build folder
	rm -rf $(BUILD)

include host_sim/library/library.mk
include host_sim/library/package.mk
include host_sim/fmu/fmu.mk
include linker/boards.mk
include tests/bench/bench.mk
include tests/fuzz/fuzz.mk
include tests/papers/papers.mk
include tests/eva/eva.mk

# What is a program: everything with a main, on this machine, on boards, under libFuzzer.
PROGRAMS = contactplant importer unit runner_cases sizes dbc_vectors test_socketcan flood worst choose_scenes choose_levers choose_grid choose_one tolerance_scenes rig_curves hash_print \
           instructions costs new_model test_board can_session test_board_can bench_frame bench_microscope bench_batch bench_lockstep bench_plants peers float32 rate_host ledger_rules \
           $(PHYSICS:%=physics_%) $(AFM_CHARTS) $(PAPERS:%=papers_%) $(FUZZ:%=corpus_%)
programs: $(PROGRAMS:%=$(BUILD)/%)
build-all: programs ## every program of this Makefile, images and fuzz targets too, and that no source is left out
	@for board in $(BOARDS); do $(MAKE) -s BOARD=$$board board-images || exit 1; done
	@$(MAKE) -s $(FW)/rate_board.elf $(FW)/lever_board.elf
	@$(MAKE) -s SHORT=1 fuzz-targets
	@tests/house/check_built.sh $(BUILD)

# Of this build and board: builds in folders of their own lie in the same one.
-include $(wildcard $(patsubst %.c,$(BUILD)/%.d,$(CORE_SRC) $(HAL_SRC) $(TARGET_ONLY) $(HOST_SRC) $(TEST_SRC) $(wildcard linker/*.c)) \
    $(WITH_ROW:.o=.d) $(patsubst %.c,$(FW)/%.d,$(CORE_SRC) $(call files,hal) $(TEST_SRC) $(wildcard linker/*.c) firmware/main.c))
.PHONY: all help run unit fits test test-all trial-seeds costs check programs build-all short bench tolerance sweep-grids choose-seeds charts test-can test-can-vm test-boards test-boards-bits clean charts-sweeps mutation mutation-compiler mutation-objects maps soak bench-flood bench-lockstep bench-plants bench-scope coverage misra
# Kept, though only a pattern names them. Not .SECONDARY: with it an object that is missing was not made again.
.PRECIOUS: $(BUILD)/%.o $(FW)/%.o $(FW)/%.elf
