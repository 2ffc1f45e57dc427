# Fuzz targets: `make fuzz SECONDS=600` searches with libFuzzer and adds what it finds to tests/fuzz/corpus after
# minimising, one packed file a target (tests/fuzz/pack.py); `make fuzz-corpus` runs the committed corpus under the sanitizers.
FUZZ := frame session packet log scene arguments ethernet trial library http scope
SECONDS ?= 60
# Reports need lines, and no more of the debug information.
FUZZ_FLAGS := -g1 -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all
fuzz_make = $(MAKE) -s CC=clang OPT=-O1
sanitized = $(fuzz_make) BUILD=build/asan "EXTRA=$(FUZZ_FLAGS)"

# One build under the sanitizers for all tests: TARGETS are files in build/asan.
sanitized-targets:
	+@$(sanitized) $(TARGETS)

fuzz-corpus:
	+@$(sanitized) $(FUZZ:%=build/asan/corpus_%)
	@for t in $(FUZZ); do \
	    if inputs=$$(build/asan/corpus_$$t tests/fuzz/corpus/$$t.hex 2>build/asan/fuzz.log); then \
	        echo "ok    fuzz corpus $$t: $$inputs inputs, no property broken"; \
	    else tail -30 build/asan/fuzz.log; echo "FAIL  fuzz corpus $$t"; fi; done

# The short form searches from what the corpus has: only the targets themselves are instrumented there.
FUZZ_ROOM := $(if $(SHORT),build/asan,build/fuzz)
fuzz-targets:
	+@$(fuzz_make) BUILD=$(FUZZ_ROOM) "EXTRA=$(FUZZ_FLAGS) $(if $(SHORT),,-fsanitize=fuzzer-no-link)" $(FUZZ:%=$(FUZZ_ROOM)/fuzz_%)
fuzz: fuzz-targets ## searches with libFuzzer: SECONDS=600 for each target (clang)
	@tests/fuzz/search.sh $(FUZZ_ROOM) $(SECONDS) $(if $(SHORT),keep,merge) $(FUZZ)
ifneq (,$(findstring address,$(EXTRA)))
# Rooms that do not compute are not optimised: they are compiled in two thirds of the time, and tests run as long as ever.
$(call obj,$(filter-out $(AT_O2),$(HOST_SRC) $(TEST_SRC))): override OPT = -O0
# Where it inlines its kernels, clang checks their unrolled loops for a minute; without that for eight seconds.
$(call obj,firmware/method/modal.c firmware/method/modal_run.c): FLAGS += -Dalways_inline=noinline
$(call obj,$(FUZZ:%=tests/fuzz/%.c)): FLAGS += -fsanitize=fuzzer-no-link
$(FUZZ:%=$(BUILD)/corpus_%): FLAGS += -fsanitize=fuzzer-no-link
endif

$(BUILD)/corpus_%: $(BUILD)/tests/fuzz/%.o $(call obj,tests/fuzz/corpus.c tests/fixture/packet.c) $(HOST_LIB) $(LIB)
	$(link)
$(BUILD)/fuzz_%: $(BUILD)/tests/fuzz/%.o $(BUILD)/tests/fixture/packet.o $(HOST_LIB) $(LIB)
	@$(CC) $(CFLAGS) -fsanitize=fuzzer $(filter %.o %.a,$^) -lm -o $@
.PHONY: fuzz fuzz-corpus fuzz-targets sanitized-targets
