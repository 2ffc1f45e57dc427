# bench.mk - rules of the speed-against-accuracy benchmark; included by the Makefile, used by `make bench` and `make charts`.
# Library code (SUNDIALS, GSL, Boost) stays out of every other target.
PEERS_SRC := $(filter-out tests/bench/classical.c tests/bench/float32.c,$(wildcard tests/bench/*.c))
PEERS_OBJ := $(call obj,$(PEERS_SRC)) $(patsubst %.cpp,$(BUILD)/%.o,$(wildcard tests/bench/*.cpp))
PEERS_LIB := -lsundials_cvode -lsundials_nvecserial -lsundials_sunlinsoldense -lsundials_sunmatrixdense \
             -lsundials_sunnonlinsolfixedpoint -lgsl -lgslcblas -lm
PEERS_TOLD = -DBENCH_FLAGS='"$(OPT) -ffp-contract=off -fno-math-errno"'

# What is not ours may be vectorised: no flag may hold a peer back. The reference is long double, to which clang's -Wdouble-promotion objects.
$(PEERS_OBJ): FLAGS += -ftree-vectorize -ftree-slp-vectorize -Wno-double-promotion $(PEERS_TOLD)
# Boost's own headers trip the optimiser's guesses.
$(BUILD)/%.o: %.cpp $(BUILD)/flags
	@$(info $()  $(CXX) $<)$(CXX) -std=c++17 $(OPT) -ffp-contract=off -fno-math-errno -Wall -Wextra -Wno-uninitialized \
	    -Wno-maybe-uninitialized -Wno-array-bounds -I. -MMD -MP -c $< -o $@
$(BUILD)/peers: $(PEERS_OBJ) $(call obj,$(BATCH_SRC)) $(LIB)
	@$(CXX) $(OPT) $^ $(PEERS_LIB) -o $@

# Everything with AVX2, then the cases that say most on baseline x86-64.
bench-peers: $(if $(SHORT),$(BUILD)/peers $(BUILD)/bench_batch)
	@tests/bench/install.sh --check
ifneq (,$(SHORT))
	@mkdir -p $(WHERE)
	@$(BUILD)/bench_batch $(WHERE)/batch.csv 1
	@$(BUILD)/peers --short $(WHERE) A1 tip C2
	@tests/bench/tables.sh $(WHERE)/ratios.csv $(WHERE)/ratios.csv >$(WHERE)/tables.md
	@tests/bench/check_short.sh $(WHERE)
else
	@$(MAKE) -s BUILD=build/bench/v3 OPT='-O3 -march=x86-64-v3' build/bench/v3/peers build/bench/v3/bench_batch
	@build/bench/v3/bench_batch build/bench/batch.csv
	@$(MAKE) -s BUILD=build/bench/baseline OPT='-O3 -march=x86-64' build/bench/baseline/peers
	@build/bench/v3/peers build/bench | tee build/bench/peers.txt
	@build/bench/baseline/peers build/bench/baseline A1 base5 tip C1 C2 | tee build/bench/baseline/peers.txt
	@tests/bench/tables.sh build/bench/ratios.csv build/bench/baseline/ratios.csv | tee build/bench/tables.md
endif

# draw SCRIPT, OPTIONS: gnuplot where docs/img shall be written to.
draw = mkdir -p build/bench; (cd $(WHERE) && gnuplot $2 $(CURDIR)/$1) 2>build/bench/charts.log || { cat build/bench/charts.log; exit 1; }

# Charts of what methods get wrong. Small programs without peers, a minute in all: physics_NAME.c prints docs/img/NAME.csv.
PHYSICS      := order_kink energy_bounce energy_drift observables floquet phasor
PHYSICS_WITH := $(call obj,$(call test_src,physics classical orbit mathieu gap_oscillator exact)) $(HOST_LIB)
$(BUILD)/physics_%: $(BUILD)/tests/bench/physics/physics_%.o $(PHYSICS_WITH) $(LIB)
	$(link)
charts-physics: $(PHYSICS:%=$(BUILD)/physics_%)
	@for name in $(PHYSICS); do echo "  docs/img/$$name.csv"; $(call print_rows,$(BUILD)/physics_$$name,docs/img/$$name.csv) || exit 1; done
	@$(call draw,tests/bench/physics/physics.gp)

# The AFM lever: error against cost, amplitude over height, and a modulated contact with real modes. A minute.
AFM_CHARTS := afm_cost afm_tapping afm_shift
$(AFM_CHARTS:%=$(BUILD)/%): $(BUILD)/%: $(BUILD)/tests/bench/afm/%.o $(call obj,$(call test_src,physics classical lever tapping pressed)) $(LIB)
	$(link)
charts-afm: $(AFM_CHARTS:%=$(BUILD)/%)
	@for name in $(AFM_CHARTS); do echo "  docs/img/$$name.csv"; $(call print_rows,$(BUILD)/$$name,docs/img/$$name.csv) || exit 1; done
	@$(call draw,tests/bench/afm/afm.gp,-e "top='$(CURDIR)'")

# Rules for the energy ledger: error against instructions, counted by callgrind. Half a minute.
$(BUILD)/ledger_rules: $(call obj,$(wildcard tests/bench/ledger/*.c)) $(LIB)
	$(link)
charts-ledger: $(BUILD)/ledger_rules
	@echo "  docs/img/ledger.csv"
	@BUILD=$(BUILD) $(if $(SHORT),LENGTHS=0) $(call print_rows,tests/bench/ledger/ledger.sh,docs/img/ledger.csv)
	@$(call draw,tests/bench/ledger/ledger.gp)

# What adaptive solvers deliver for a tolerance: the benchmark's entries once each, without timing. Settings with relative
# and absolute tolerance are drawn.
charts-tolerance: $(if $(SHORT),$(BUILD)/peers)
	@tests/bench/install.sh --check
ifneq (,$(SHORT))
	@mkdir -p $(WHERE)/build/bench $(WHERE)/docs/img
	@$(BUILD)/peers --errors $(WHERE)/build/bench A1 C1
else
	@$(MAKE) -s BUILD=build/bench/v3 OPT='-O3 -march=x86-64-v3' build/bench/v3/peers
	@build/bench/v3/peers --errors build/bench A1 C1
endif
	@sed '/absolute only/d; s/, / + /g' $(WHERE)/build/bench/tolerance.csv >$(WHERE)/docs/img/tolerance_truth.csv
	@$(call draw,tests/bench/tolerance.gp)

# From the last `make bench`; the CSV goes to docs/img with the pictures drawn from it.
charts-peers:
ifneq (,$(SHORT))
	@mkdir -p $(WHERE)/docs/img && awk 'NR % 5 == 1' docs/img/bench_front.csv >$(WHERE)/docs/img/bench_front.csv
else
	@if [ -e build/bench/front.csv ]; then cp build/bench/front.csv docs/img/bench_front.csv; else \
	    echo "no build/bench/front.csv: the charts of cost are drawn from docs/img/bench_front.csv; make bench renews it"; fi
endif
	@$(call draw,tests/bench/charts.gp,-e "csv='docs/img/bench_front.csv'; out='docs/img'")

# What single precision costs; needs no library of others.
$(BUILD)/float32: $(BUILD)/tests/bench/float32.o $(LIB)
	$(link)
charts-float32: $(BUILD)/float32
	@$(call print_rows,$(BUILD)/float32,docs/img/float32.csv)
	@$(call draw,tests/bench/float32.gp,-e "csv='docs/img/float32.csv'; out='docs/img/float32.svg'")

# Error against instructions on a board: errors from this machine, instructions from QEMU, in seconds.
$(BUILD)/rate_host: $(call obj,tests/bench/rate/rate_host.c tests/bench/rate/rate_cases.c) $(LIB)
	$(link)
charts-rate: $(BUILD)/rate_host $(FW)/rate_board.elf
	@mkdir -p build/bench $(WHERE)/docs/img
	@$(BUILD)/rate_host >build/bench/rate_error.txt
	@$(subst IMAGE,$(FW)/rate_board.elf,$($(BOARD)_QEMU)) -icount shift=10 -serial stdio -nic none </dev/null \
	    2>build/bench/charts.log >build/bench/rate_instructions.txt || { cat build/bench/charts.log; exit 1; }
	@{ echo "case,method,steps,tolerance,error,instructions"; awk 'NR == FNR { error[$$1, $$2, $$3, $$4] = $$5; next } \
	    ($$1, $$2, $$3, $$4) in error { print $$1 "," $$2 "," $$3 "," $$4 "," error[$$1, $$2, $$3, $$4] "," $$5 }' \
	    build/bench/rate_error.txt build/bench/rate_instructions.txt; } >$(WHERE)/docs/img/board_rate.csv
	@$(call draw,tests/bench/rate/rate.gp,-e "csv='docs/img/board_rate.csv'; out='docs/img/board_rate.svg'")
lever-cycles: $(FW)/lever_board.elf ## the AFM lever's tick on a Cortex-M7, by QEMU and LLVM's model of the part (needs llvm; seconds)
	@$(PYTHON) tests/bench/rate/lever_cycles.py $< $(subst IMAGE,$<,$($(BOARD)_QEMU))
.PHONY: lever-cycles bench-peers charts-peers charts-physics charts-tolerance charts-float32 charts-rate charts-afm charts-ledger
