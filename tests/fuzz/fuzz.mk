# Fuzz targets: `make fuzz SECONDS=600` searches with libFuzzer and adds what it finds to tests/fuzz/corpus after
# minimising, one packed file a target (tests/fuzz/pack.py); `make fuzz-corpus` runs the committed corpus under the sanitizers.
FUZZ := frame session packet log scene arguments ethernet
SECONDS ?= 60
FUZZ_FLAGS := -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all
FUZZ_SRC := $(HOST_PARTS) tests/packet.c
fuzz_make = $(MAKE) -s CC=clang OPT=-O1

fuzz-corpus:
	@$(fuzz_make) BUILD=build/asan "EXTRA=$(FUZZ_FLAGS)" $(FUZZ:%=build/asan/corpus_%)
	@for t in $(FUZZ); do \
	    if inputs=$$(build/asan/corpus_$$t tests/fuzz/corpus/$$t.hex 2>build/asan/fuzz.log); then \
	        echo "ok    fuzz corpus $$t: $$inputs inputs, no property broken"; \
	    else tail -30 build/asan/fuzz.log; echo "FAIL  fuzz corpus $$t"; fi; done

fuzz: ## searches with libFuzzer: SECONDS=600 for each target (clang)
	@$(fuzz_make) BUILD=build/fuzz "EXTRA=$(FUZZ_FLAGS) -fsanitize=fuzzer-no-link" $(FUZZ:%=build/fuzz/fuzz_%)
	@tests/fuzz/search.sh $(SECONDS) $(FUZZ)

$(BUILD)/corpus_%: $(BUILD)/tests/fuzz/%.o $(call obj,tests/fuzz/corpus.c $(FUZZ_SRC)) $(LIB)
	$(link)
$(BUILD)/fuzz_%: $(BUILD)/tests/fuzz/%.o $(call obj,$(FUZZ_SRC)) $(LIB)
	@$(CC) $(CFLAGS) -fsanitize=fuzzer $(filter %.o %.a,$^) -lm -o $@
.PHONY: fuzz fuzz-corpus
