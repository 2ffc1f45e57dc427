# contactplant: make help
CC     = gcc
OPT    = -O2
BUILD  = build
WARN   = -Wall -Wextra -Werror -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wdouble-promotion -Wvla \
         -Wpointer-arith -Wcast-qual -Wwrite-strings -Wundef
# Contraction off is part of the physics (same bits everywhere); -fno-math-errno makes sqrt one instruction.
# One trajectory has nothing to vectorise: packed loads of what was just stored one by one only stall.
FLAGS  = -std=c99 -ffp-contract=off -fno-math-errno -fno-tree-vectorize -fno-tree-slp-vectorize $(WARN) -I.
CFLAGS = $(OPT) -g $(FLAGS) -MMD -MP
POSIX  = -D_GNU_SOURCE

CORE_SRC := $(wildcard models/*.c) $(wildcard firmware/*.c)
HAL_SRC  := $(wildcard hal/*.c)
HOST_SRC := $(wildcard host_sim/*.c)
TEST_SRC := $(filter-out tests/example_embed.c tests/bench_%.c,$(wildcard tests/*.c))
obj = $(patsubst %.c,$(BUILD)/%.o,$(1))

all: $(BUILD)/contactplant $(BUILD)/libcontactplant.a

# The core is plain C99; hal, host_sim and tests also see POSIX.
$(BUILD)/models/%.o: models/%.c
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) -c $< -o $@
$(BUILD)/firmware/%.o: firmware/%.c
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) -c $< -o $@
$(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(POSIX) -c $< -o $@

$(BUILD)/libcontactplant.a: $(call obj,$(CORE_SRC) $(HAL_SRC))
	@rm -f $@
	ar rcs $@ $^
$(BUILD)/contactplant: $(call obj,$(HOST_SRC)) $(BUILD)/libcontactplant.a
	$(CC) $(CFLAGS) $^ -lm -o $@
$(BUILD)/unit: $(call obj,$(TEST_SRC)) $(BUILD)/libcontactplant.a
	$(CC) $(CFLAGS) $^ -lm -o $@

clean:
	rm -rf $(BUILD)

-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)
.PHONY: all run test check clean help
