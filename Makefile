# contactplant - `make help` lists what there is.
CC    = gcc
OPT   = -O2
BUILD = build
WARN  = -Wall -Wextra -Werror -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wdouble-promotion -Wvla \
        -Wpointer-arith -Wcast-qual -Wwrite-strings -Wundef
# Contraction off is part of the physics (the same bits everywhere); -fno-math-errno makes sqrt one instruction.
# So are the two that keep gcc from vectorising: its vectoriser contracts in spite of -ffp-contract=off (seen with gcc
# 12 and -march=x86-64-v3), and one trajectory has nothing to vectorise: packed loads of fresh stores only stall.
FLAGS  = -std=c99 -ffp-contract=off -fno-math-errno -fno-tree-vectorize -fno-tree-slp-vectorize $(WARN) -I.
CFLAGS = $(OPT) -g $(FLAGS) $(EXTRA) -MMD -MP
POSIX  = -D_GNU_SOURCE
PYTHON = /usr/bin/python3

# For boards only, see linker/boards.mk: the firmware's main, and devices.
TARGET_ONLY := firmware/main.c hal/board.c hal/board_%.c hal/console.c hal/cortex_m.c hal/cortex_r.c hal/riscv.c hal/network.c \
               hal/uart_cmsdk.c
CORE_SRC := $(filter-out $(TARGET_ONLY),$(wildcard models/*.c firmware/*.c))
HAL_SRC  := $(filter-out $(TARGET_ONLY),$(wildcard hal/*.c))
HOST_SRC := $(wildcard host_sim/*.c)
BOARD_TEST := test_board board_bench board_hostile board_record packet
BATCH_SRC := $(wildcard host_sim/batch*.c)
# The program without its main: what tests link.
HOST_PARTS := $(filter-out host_sim/main.c,$(HOST_SRC))
# What the charts of docs/PAPERS.md share with the tests.
PAPER_SRC := $(addprefix tests/papers/,motion.c branch.c branch_read.c theory.c contact.c attractor.c stroboscope.c survival.c one_mode.c)
# Programs of their own in tests/; everything else there is linked into build/unit.
TEST_MAIN := example_embed sizes dbc_vectors hash_print hash_run hash_batch arithmetic can_session can_session_print \
             board_hash board_fault board_main board_watchdog board_can board_cost work_pieces work_rungs worst worst_cases \
             $(filter-out packet,$(BOARD_TEST)) test_board_can test_socketcan flood bench_frame bench_batch bench_time instructions choose_scenes choose_grid choose_draw choose_judge choose_one \
             tolerance_scenes tolerance_force tolerance_draw
UNIT_SRC  := $(filter-out $(TEST_MAIN:%=tests/%.c) tests/uml_%.c tests/vm_init.c,$(wildcard tests/*.c))
obj = $(patsubst %.c,$(BUILD)/%.o,$(1))
CORE := $(call obj,$(CORE_SRC))
LIB  := $(BUILD)/libcontactplant.a

all: $(BUILD)/contactplant $(LIB)

help:
	@echo "make            build/contactplant and build/libcontactplant.a"
	@echo "make run        ten seconds of the plant on a bus with a controller; picture in build/demo"
	@echo "make test       every test; installs what is missing on Debian 12 when run as root"
	@echo "make check      format, layers, symbols, sizes"
	@echo "make bench      time per frame, and error against cost beside SUNDIALS, GSL and Boost (8 minutes; numbers, not pass/fail)"
	@echo "make charts     the charts of docs/ACCURACY.md and docs/MAPS.md, those of cost from the last make bench (needs gnuplot and the peers)"
	@echo "make tolerance  546 random scenes by auto, each against an integrator of the tests' own: SEED=1 (a minute)"
	@echo "make choose-seeds  certificates of 300 random scenes before another judge: SEED=2, DRAW=motion or force (two minutes)"
	@echo "make maps       the maps of docs/MAPS.md (a minute)"
	@echo "make papers     the figures of the four papers, redrawn beside the true contact: docs/PAPERS.md (needs gnuplot)"
	@echo "make test-can   SocketCAN on a real kernel: the hal, and plants with can-utils and python-can"
	@echo "make test-can-vm  the same under sanitizers on an emulated PC: Linux's driver, two SJA1000 (qemu-system-x86_64, a Debian kernel)"
	@echo "make firmware   an image for a board: BOARD=mps2-an500 MODEL=hertz_rig METHOD=rk4 SUBSTEPS=64, or SCENE=kb-fig16 (arm-none-eabi-gcc)"
	@echo "make test-boards  the images in QEMU: bits, faults, and a session over Ethernet (qemu-system-arm)"
	@echo "make mutation   mutants of the code against the unit tests: MUTANTS=200 for a sample (hours without)"
	@echo "make coverage   lines and branches that the unit tests run, of the core and the wire path (gcov); 100 % of lines or FAIL"
	@echo "make misra      rules of MISRA C:2012 that cppcheck reports, against docs/DEVIATIONS.md"
	@echo "make eva        proofs that no input leads to an undefined operation (frama-c-base), docs/PROOFS.md"
	@echo "make fuzz       searches with libFuzzer: SECONDS=600 for each target (clang)"
	@echo "make bench-flood  frames kept in time without and under a flood, UDP and CAN (a minute; numbers, not pass/fail)"
	@echo "make soak       a plant on a bus for 1e9 ticks: tick, phase, counters exact (two minutes; make test has 1e6)"
	@echo "make test-boards-bits  every model and method for 100,000 ticks on every board, both orders of taylor"
	@echo "make clean"
	@echo "variables: CC=clang OPT=-O3 BUILD=dir EXTRA=-fsanitize=address,undefined"

# Vectors by value between functions that are always inlined: there is no ABI to take note of.
$(call obj,$(BATCH_SRC) tests/test_batch_series.c tests/bench_batch.c): FLAGS += -Wno-psabi
# Batches a second time for AVX2, which x86-64's default leaves out: host_sim/batch_rk4.h.
ifneq (,$(findstring x86_64,$(shell $(CC) -dumpmachine)))
$(call obj,$(BATCH_SRC)): FLAGS += -DBATCH_AVX2
$(call obj,$(filter %_avx2.c,$(BATCH_SRC))): FLAGS += -mavx2
endif
# The core is plain C99 and reports its stack; hal, host_sim and tests also see POSIX.
$(CORE): $(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	@echo "  $(CC) $<"
	@$(CC) $(CFLAGS) -fstack-usage -c $< -o $@
$(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	@echo "  $(CC) $<"
	@$(CC) $(CFLAGS) $(POSIX) -c $< -o $@

$(LIB): $(CORE) $(call obj,$(HAL_SRC))
	@rm -f $@
	@ar rcs $@ $^
link = @$(CC) $(CFLAGS) $(filter %.o %.a,$^) -lm -o $@
$(BUILD)/contactplant: $(call obj,$(HOST_SRC)) $(LIB)
	$(link)
UNIT_OBJ := $(call obj,$(UNIT_SRC) $(PAPER_SRC) $(HOST_PARTS) tests/work_rungs.c linker/soft_sqrt.c)
$(BUILD)/unit: $(UNIT_OBJ) $(LIB)
	$(link)
$(BUILD)/dbc_vectors: $(call obj,tests/dbc_vectors.c host_sim/names.c host_sim/dbc.c) $(LIB)
	$(link)
$(BUILD)/test_board: $(call obj,$(BOARD_TEST:%=tests/%.c) $(HOST_PARTS)) $(LIB)
	$(link)
WORST := $(call obj,tests/worst.c tests/worst_cases.c tests/bench/rate_cases.c)
$(BUILD)/worst: $(WORST) $(LIB)
	@$(CC) $(CFLAGS) -Wl,--wrap=taylor_begin,--wrap=exact_follow $(WORST) $(LIB) -lm -o $@
$(BUILD)/instructions: $(call obj,tests/instructions.c tests/work_pieces.c tests/work_rungs.c) $(LIB)
	$(link)
$(BUILD)/choose_scenes: $(call obj,$(addprefix tests/,choose_scenes.c choose_draw.c choose_judge.c) $(HOST_PARTS)) $(LIB)
	$(link)
$(BUILD)/choose_grid: $(call obj,$(addprefix tests/,choose_grid.c choose_draw.c choose_judge.c) $(HOST_PARTS)) $(LIB)
	$(link)
$(BUILD)/tolerance_scenes: $(call obj,$(addprefix tests/,tolerance_scenes.c tolerance_force.c tolerance_draw.c extrapolation.c exact.c)) $(LIB)
	$(link)
$(BUILD)/choose_one: $(BUILD)/tests/choose_one.o $(call obj,$(HOST_PARTS)) $(LIB)
	$(link)
$(BUILD)/flood: $(call obj,tests/flood.c $(HOST_PARTS)) $(LIB)
	$(link)
$(BUILD)/test_board_can: $(call obj,tests/test_board_can.c tests/board_bench.c $(HOST_PARTS)) $(LIB)
	$(link)
$(BUILD)/hash_print: $(call obj,tests/hash_print.c tests/hash_run.c tests/arithmetic.c tests/hash_batch.c $(BATCH_SRC)) $(LIB)
	$(link)
$(BUILD)/bench_frame: $(call obj,tests/bench_frame.c tests/bench_time.c tests/work_pieces.c) $(LIB)
	$(link)
$(BUILD)/bench_batch: $(call obj,tests/bench_batch.c tests/bench_time.c $(BATCH_SRC)) $(LIB)
	$(link)
$(BUILD)/can_session: $(call obj,tests/can_session_print.c tests/can_session.c) $(LIB)
	$(link)
$(BUILD)/%: $(BUILD)/tests/%.o $(LIB)
	$(link)

run: all
	@$(BUILD)/contactplant demo --out $(BUILD)/demo

test:
	@tests/run.sh

check: $(CORE) $(BUILD)/sizes
	@status=0; tests/check_format.sh || status=1; tests/check_layers.sh || status=1; \
	tests/check_symbols.sh nm $(CORE) || status=1; tests/check_sizes.sh $(BUILD) || status=1; exit $$status

bench: $(BUILD)/bench_frame
	@$(BUILD)/bench_frame
	@$(MAKE) -s bench-peers

tolerance: $(BUILD)/tolerance_scenes
	@$(BUILD)/tolerance_scenes 546 $(or $(SEED),1)

choose-seeds: $(BUILD)/choose_scenes
	@$(BUILD)/choose_scenes 360 $(or $(SEED),2) $(or $(DRAW),motion) -v

charts: charts-sweeps charts-physics charts-float32 charts-rate charts-tolerance charts-peers

charts-sweeps: $(BUILD)/contactplant
	@rm -f docs/sweep_rig.csv
	@$(BUILD)/contactplant sweep rig --sweep "force.frequency=75 Hz:300 Hz:120" --out docs/sweep_rig.csv --svg docs/sweep_rig.svg

# Long: a minute of two cores.
maps: all
	@mkdir -p build/maps
	@rm -f build/maps/basin_705.csv
	@$(BUILD)/contactplant basin shaft-fig16-705 --starts 10000 --out build/maps/basin_705.csv --svg docs/basin_705.svg \
	    >docs/basin_705.txt
	@rm -f build/maps/tongues.csv build/maps/steps.csv build/maps/random.csv
	@$(BUILD)/contactplant stability hertz_rig --method rk4 --step "0.7 ms" --out build/maps/tongues.csv --svg docs/stability_tongues.svg
	@$(BUILD)/contactplant stability rig --map contact --method rk4 --set "force.amplitude=50 N" --set "force.frequency=180 Hz" \
	    --x "step=0.03 ms:2 ms:80:log" --y "stiffness=1 GN/m^1.5:10 GN/m^1.5:60:log" --out build/maps/steps.csv --svg docs/stability_steps.svg
	@$(BUILD)/contactplant random nayak-random --observable displacement --range=-1:3 --bins 80 --seeds 400 --over 2000 \
	    --out build/maps/random.csv --svg docs/random_nayak.svg >docs/random_nayak.csv

test-boards: all $(BUILD)/test_board $(BUILD)/can_session $(BUILD)/test_board_can
	@tests/boards.sh

# Every model and method for 1e5 ticks on every board: six minutes more.
test-boards-bits:
	@tests/boards.sh --bits

# gcov on the unit tests: lines are a gate, branches are numbers (docs/PROOFS.md). Nothing is inlined: each copy of a kernel would be
# counted, with the conditions of all the others constant in it. Two minutes.
coverage:
	@$(MAKE) -s OPT=-O0 EXTRA="--coverage -Dalways_inline=noinline -Wno-attributes -Wno-psabi" BUILD=build/coverage build/coverage/unit
	@find build/coverage -name '*.gcda' -delete
	@build/coverage/unit >build/coverage/unit.log || tail -1 build/coverage/unit.log
	@tests/coverage.sh build/coverage

# MISRA C:2012 by cppcheck's addon, against docs/DEVIATIONS.md.
misra:
	@tests/misra.sh $(BUILD)

# In one boot: the hal by itself, then plants with peers of other hands.
test-can: all $(BUILD)/test_socketcan $(BUILD)/flood
	@tests/can_vm.sh -n 3 -- sh -c '$(BUILD)/test_socketcan; status=$$?; $(BUILD)/flood check can:vcan0 || status=1; \
	    tests/test_can_peers.sh $(BUILD)/contactplant && exit $$status'

# The same under the sanitizers, on an emulated PC with a real driver: a minute.
SANITIZED := test_socketcan flood contactplant
test-can-vm:
	@$(MAKE) -s CC=clang OPT=-O1 BUILD=build/asan "EXTRA=$(FUZZ_FLAGS)" \
	    $(SANITIZED:%=build/asan/%) >build/asan.log || { echo "FAIL  build/asan: see above and build/asan.log"; exit 1; }
	@CAN_VM_TIMEOUT=900 tests/can_pc.sh -- sh -c 'build/asan/test_socketcan; status=$$?; \
	    tests/test_can_sja1000.sh build/asan/contactplant build/asan/flood && exit $$status' || \
	    { echo "FAIL  the emulated PC: see above"; exit 1; }

# Every mutant takes a second or two: the whole takes hours, MUTANTS=200 a sample.
MUTANTS ?= 0
mutation:
	@$(MAKE) -s OPT=-O1 BUILD=build/mutate build/mutate/unit
	@tests/mutate.py --count $(MUTANTS)
mutation-compiler:
	@echo $(CC) $(CFLAGS)
mutation-objects:
	@echo $(UNIT_OBJ) $(call obj,$(CORE_SRC) $(HAL_SRC))

# How late frames are without and under a flood; numbers, not pass/fail.
bench-flood: all $(BUILD)/flood
	@tests/bench_flood.sh udp $(BUILD)/contactplant $(BUILD)/flood
	@CAN_VM_TIMEOUT=120 tests/can_vm.sh -- tests/bench_flood.sh can:vcan0 $(BUILD)/contactplant $(BUILD)/flood

# 1e9 ticks of test_soak, one to three minutes.
soak: $(BUILD)/unit
	@SOAK_TICKS=1e9 $(BUILD)/unit soak_session

clean:
	rm -rf $(BUILD)

include linker/boards.mk
include tests/bench/bench.mk
include tests/fuzz/fuzz.mk
include tests/papers/papers.mk
include tests/eva/eva.mk
# Of this build and board: builds in folders of their own lie in the same one.
-include $(foreach room,models firmware hal host_sim linker tests tests/bench tests/fuzz tests/papers,$(wildcard $(BUILD)/$(room)/*.d $(FW)/$(room)/*.d))
.PHONY: all help run test check bench tolerance choose-seeds charts test-can test-can-vm test-boards test-boards-bits clean charts-sweeps mutation mutation-compiler mutation-objects maps soak bench-flood coverage misra
.SECONDARY:
